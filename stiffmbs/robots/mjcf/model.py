"""Robots from MJCF files (mujoco.readthedocs.io, XML reference)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...describe.files.text_file import file_text
from ...describe.spatial.orientation import matrix
from ..robot import JointKind, Link, LinkJoint, Robot, RobotFault
from .actuators import bounds, transmissions
from .closures import connections, relations

KINDS: tuple[JointKind, ...] = ("free", "ball", "slide", "hinge")
"""In the order of MuJoCo's numbers."""
WORLD = 0


def read_mjcf(path: str | Path) -> Robot:
    """Read a robot from an MJCF file, compiled by MuJoCo: defaults, included files and inertias of shapes are its work.

    Raises
    ------
    RobotFault
        Where MuJoCo refuses the file, or it holds what a scene cannot.
    InputError
        Where the file cannot be read.
    """
    compiled = _compiled(path)
    return Robot(
        name=compiled.names[: compiled.names.index(b"\0")].decode() or "robot",
        links=tuple(_link(compiled, body) for body in range(1, compiled.nbody)),
        gravity=_gravity(compiled),
        transmissions=tuple(transmissions(compiled)),
        relations=tuple(relations(compiled)),
        connections=tuple(connections(compiled)),
        notes=tuple(_notes(compiled)),
    )


def _compiled(path: str | Path) -> Any:
    try:
        import mujoco
    except ImportError:
        raise RobotFault(
            "found an MJCF file, expected the package mujoco, which reads them: pip install 'stiffmbs[robots]'"
        ) from None
    file_text(path)  # says why a file cannot be read
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise RobotFault(f"MuJoCo refuses the file: {' '.join(str(error).split())}") from None


def _gravity(m: Any) -> tuple[float, ...]:
    import mujoco

    off = m.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    return (0.0, 0.0, 0.0) if off else tuple(map(float, m.opt.gravity))


def _link(m: Any, body: int) -> Link:
    parent = int(m.body_parentid[body])
    turned = matrix(m.body_iquat[body])
    tensor = turned @ np.diag(m.body_inertia[body]) @ turned.T
    first = m.body_jntadr[body]
    return Link(
        name=m.body(body).name or f"body_{body}",
        parent=None if parent == WORLD else m.body(parent).name or f"body_{parent}",
        position=tuple(map(float, m.body_pos[body])),
        orientation=tuple(map(float, m.body_quat[body])),
        mass=float(m.body_mass[body]),
        center_of_mass=tuple(map(float, m.body_ipos[body])),
        inertia=(tensor + tensor.T) / 2,
        joints=tuple(_joint(m, joint) for joint in range(first, first + m.body_jntnum[body])),
        lifted=float(m.body_gravcomp[body]),
    )


def joint_name(m: Any, joint: int) -> str:
    """What a joint is called, or would be."""
    return m.joint(joint).name or f"joint_{joint}"


def _joint(m: Any, joint: int) -> LinkJoint:
    name, kind = joint_name(m, joint), KINDS[m.jnt_type[joint]]
    dof, coordinate = m.jnt_dofadr[joint], m.jnt_qposadr[joint]
    for what, values in (
        ("a stiffness that is no constant", getattr(m, "jnt_stiffnesspoly", ())),
        ("a spring that yields", getattr(m, "jnt_springyield", ())),
    ):
        if len(values) and np.any(values[joint]):
            raise RobotFault(f"joint {name}: found {what}, expected a linear spring")
    if hasattr(m, "dof_dampingpoly") and np.any(m.dof_dampingpoly[dof]):
        raise RobotFault(f"joint {name}: found a damping that is no constant, expected a linear damper")
    if kind in ("free", "ball"):
        return _loose(m, joint, kind)
    return LinkJoint(
        name,
        kind,
        point=tuple(map(float, m.jnt_pos[joint])),
        axis=tuple(map(float, m.jnt_axis[joint])),
        stiffness=float(m.jnt_stiffness[joint]),
        damping=float(m.dof_damping[dof]),
        rest=float(m.qpos_spring[coordinate]),
        friction=float(m.dof_frictionloss[dof]),
        armature=float(m.dof_armature[dof]),
        limits=bounds(m.jnt_limited[joint], m.jnt_range[joint]),
        zero=float(m.qpos0[coordinate]),
    )


def _loose(m: Any, joint: int, kind: JointKind) -> LinkJoint:
    """A ball joint, or that of a free body."""
    name, dof = joint_name(m, joint), m.jnt_dofadr[joint]
    count = 6 if kind == "free" else 3
    start, spring = m.jnt_qposadr[joint], float(m.jnt_stiffness[joint])
    same = np.array_equal(m.qpos_spring[start : start + count + 1], m.qpos0[start : start + count + 1])
    if np.any(m.dof_frictionloss[dof : dof + count]) or np.any(m.dof_armature[dof : dof + count]):
        raise RobotFault(
            f"joint {name}: found dry friction or an armature of a {kind} joint, expected a hinge or slide"
        )
    if spring and (kind == "free" or not same):
        raise RobotFault(
            f"joint {name}: found a spring of a {kind} joint, expected one of a hinge, slide or ball at rest as drawn"
        )
    return LinkJoint(
        name, kind, tuple(map(float, m.jnt_pos[joint])), stiffness=spring, damping=float(m.dof_damping[dof])
    )


def _notes(m: Any) -> Iterator[str]:
    """What is no part of the rigid mechanism, and is left out."""
    if np.any(m.geom_contype[: m.ngeom] | m.geom_conaffinity[: m.ngeom]) or m.npair:
        yield "contacts between the shapes of MJCF are left out"
    if m.opt.density or m.opt.viscosity:
        yield "the forces of the fluid around the bodies are left out"
    if m.nflex:
        raise RobotFault("found flexible bodies, expected rigid ones")
    limited = [m.tendon(k).name or f"tendon_{k}" for k in range(m.ntendon) if m.tendon_limited[k]]
    if limited:
        yield f"the limits of tendons are left out: {', '.join(limited)}"
