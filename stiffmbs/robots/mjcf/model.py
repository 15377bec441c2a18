"""Robots from MJCF files (mujoco.readthedocs.io, XML reference)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.orientation import conjugate, matrix, product, rotated
from ...reading.files.files_read import check_regular
from ...reading.files.quoted import quoted
from ...reading.files.requested import unused_notes
from ...reading.files.text_file import file_text
from ..robot import Connection, JointKind, Link, LinkJoint, Relation, Robot, RobotFault
from .actuators import Disabled, bounds, disabled_actuators, transmissions
from .contacts import contacts as touching
from .fields import REASONS, WITH_CONTACTS, RequestedModel, model_fields, name_of

if TYPE_CHECKING:
    import mujoco


def relations(m: RequestedModel) -> Iterator[Relation]:
    """Yield the couplings of joints, and joints held by a constraint."""
    import mujoco

    for k in _active(m):
        if mujoco.mjtEq(m.eq_type[k]) == mujoco.mjtEq.mjEQ_JOINT:
            other = int(m.eq_obj2id[k])
            yield Relation(
                name_of(m, "equality", k),
                m.joint(int(m.eq_obj1id[k])).name,
                m.joint(other).name if other >= 0 else None,
                tuple(map(float, m.eq_data[k, :5])),
            )


def connections(m: RequestedModel) -> Iterator[Connection]:
    """Yield the loops closed by a point or rigidly."""
    import mujoco

    for k in _active(m):
        kind = mujoco.mjtEq(m.eq_type[k])
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            continue
        if kind not in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
            raise RobotFault(
                f"equality {name_of(m, 'equality', k)}: found the kind {kind.name.split('_')[1].lower()}, expected connect, weld or joint"
            )
        yield _of_sites(m, k) if mujoco.mjtObj(m.eq_objtype[k]) == mujoco.mjtObj.mjOBJ_SITE else _of_bodies(m, k)


def _active(m: RequestedModel) -> Iterator[int]:
    return (k for k in range(m.neq) if m.eq_active0[k])


def _is_weld(m: RequestedModel, k: int) -> bool:
    import mujoco

    return bool(mujoco.mjtEq(m.eq_type[k]) == mujoco.mjtEq.mjEQ_WELD)


def _of_bodies(m: RequestedModel, k: int) -> Connection:
    """Return a connection: two points coincide, for a weld the anchor in body 2 with its place in body 1."""
    first, second = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
    data = [tuple(map(float, m.eq_data[k, a:b])) for a, b in ((0, 3), (3, 6), (6, 10))]
    if _is_weld(m, k):
        return Connection(name_of(m, "equality", k), _body(m, first), _body(m, second), data[1], data[0], data[2])
    return Connection(name_of(m, "equality", k), _body(m, first), _body(m, second), data[0], data[1], None)


def _of_sites(m: RequestedModel, k: int) -> Connection:
    """Return a connection of the frames of two sites, or of their points."""
    a, b = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
    point, other_point = (tuple(map(float, m.site_pos[site])) for site in (a, b))
    link, other = (_body(m, int(m.site_bodyid[site])) for site in (a, b))
    if not _is_weld(m, k):
        return Connection(name_of(m, "equality", k), link, other, point, other_point, None)
    turned = product(m.site_quat[a], conjugate(m.site_quat[b]))
    origin = tuple(float(x) for x in point - rotated(turned, other_point))
    return Connection(name_of(m, "equality", k), link, other, origin, ORIGIN, turned)


def _body(m: RequestedModel, body: int) -> str | None:
    return name_of(m, "body", body) if body else None  # body 0 is the world


KINDS: tuple[JointKind, ...] = ("free", "ball", "slide", "hinge")
"""Joint kinds in the order of MuJoCo's numbers."""


def read_mjcf(path: str | Path, contacts: bool = False, ground: float | None = None) -> Robot:
    """Read a robot from an MJCF file, compiled by MuJoCo with its defaults, included files and inertias of shapes.

    `contacts`: True to read the contacts of geoms. `ground`: height of an added plane, m, with MuJoCo's defaults. Raises
    RobotFault if MuJoCo refuses the file, or it contains features without an equivalent in a scene. Raises InputError if
    the file cannot be read.
    """
    spec, compiled = _compiled(path, ground)
    m = RequestedModel(compiled)
    disabled = Disabled(m)
    read: dict[str, Any] = {
        "links": tuple(_link(m, body, disabled) for body in range(1, compiled.nbody)),
        "gravity": (0.0, 0.0, 0.0) if disabled("GRAVITY") else tuple(map(float, m.opt.gravity[:])),
        "transmissions": tuple(transmissions(m, disabled)),
        "relations": () if disabled("EQUALITY", "CONSTRAINT") else tuple(relations(m)),
        "connections": () if disabled("EQUALITY", "CONSTRAINT") else tuple(connections(m)),
    }
    own = [*_notes(m, disabled), *disabled_actuators(m, disabled)]
    if contacts:
        read["contacts"], of_contacts = touching(m, disabled)
        own += of_contacts
    else:
        own += _without_contacts(m, disabled)
    elements = [*model_fields(spec, m, contacts), *disabled.fields()]
    return Robot(
        name=compiled.names[: compiled.names.index(b"\0")].decode() or "robot",
        **read,
        notes=(*own, *unused_notes(elements, WITH_CONTACTS if contacts else REASONS)),
    )


def _compiled(path: str | Path, ground: float | None) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    try:
        import mujoco
    except ImportError:
        raise RobotFault(
            "found an MJCF file, expected the package mujoco, which reads them: pip install 'stiffmbs[robots]'"
        ) from None
    check_assets(Path(path))
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        if ground is not None:
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, ground])
        return spec, spec.compile()
    except ValueError as error:
        raise RobotFault(f"MuJoCo refuses the file: {' '.join(str(error).split())}") from None


def _link(m: RequestedModel, body: int, disabled: Disabled) -> Link:
    parent = int(m.body_parentid[body])
    turned = matrix(m.body_iquat[body])
    tensor = turned @ np.diag(m.body_inertia[body]) @ turned.T
    first = m.body_jntadr[body]
    return Link(
        name=name_of(m, "body", body),
        parent=name_of(m, "body", parent) if parent else None,
        position=tuple(map(float, m.body_pos[body])),
        orientation=tuple(map(float, m.body_quat[body])),
        mass=float(m.body_mass[body]),
        center_of_mass=tuple(map(float, m.body_ipos[body])),
        inertia=(tensor + tensor.T) / 2,
        joints=tuple(_joint(m, joint, disabled) for joint in range(first, first + m.body_jntnum[body])),
        lifted=0.0 if disabled.all("SPRING", "DAMPER") else float(m.body_gravcomp[body]),
    )


def _joint(m: RequestedModel, joint: int, disabled: Disabled) -> LinkJoint:
    name, kind = name_of(m, "joint", joint), KINDS[m.jnt_type[joint]]
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
        return _loose(m, joint, kind, disabled)
    return LinkJoint(
        name,
        kind,
        point=tuple(map(float, m.jnt_pos[joint])),
        axis=tuple(map(float, m.jnt_axis[joint])),
        stiffness=0.0 if disabled("SPRING") else float(m.jnt_stiffness[joint]),
        damping=0.0 if disabled("DAMPER") else float(m.dof_damping[dof]),
        rest=float(m.qpos_spring[coordinate]),
        friction=0.0 if disabled("FRICTIONLOSS", "CONSTRAINT") else float(m.dof_frictionloss[dof]),
        armature=float(m.dof_armature[dof]),
        limits=None if disabled("LIMIT", "CONSTRAINT") else bounds(m.jnt_limited[joint], m.jnt_range[joint]),
        effort=bounds(m.jnt_actfrclimited[joint], m.jnt_actfrcrange[joint]),
        zero=float(m.qpos0[coordinate]),
    )


def _loose(m: RequestedModel, joint: int, kind: JointKind, disabled: Disabled) -> LinkJoint:
    """Return a ball joint, or that of a free body."""
    name, dof = name_of(m, "joint", joint), m.jnt_dofadr[joint]
    count = 6 if kind == "free" else 3
    start, spring = m.jnt_qposadr[joint], 0.0 if disabled("SPRING") else float(m.jnt_stiffness[joint])
    same = np.array_equal(m.qpos_spring[start : start + count + 1], m.qpos0[start : start + count + 1])
    rubs = np.any(m.dof_frictionloss[dof : dof + count]) and not disabled("FRICTIONLOSS", "CONSTRAINT")
    if rubs or np.any(m.dof_armature[dof : dof + count]):
        raise RobotFault(
            f"joint {name}: found dry friction or an armature of a {kind} joint, expected a hinge or slide"
        )
    if spring and (kind == "free" or not same):
        raise RobotFault(
            f"joint {name}: found a spring of a {kind} joint, expected one of a hinge, slide or ball at rest as drawn"
        )
    damping = 0.0 if disabled("DAMPER") else float(m.dof_damping[dof])
    return LinkJoint(name, kind, tuple(map(float, m.jnt_pos[joint])), stiffness=spring, damping=damping)


def _without_contacts(m: RequestedModel, disabled: Disabled) -> Iterator[str]:
    if not disabled("CONTACT", "CONSTRAINT") and (
        np.any(m.geom_contype[: m.ngeom] | m.geom_conaffinity[: m.ngeom]) or m.npair
    ):
        yield "contacts between the shapes of MJCF are left out (convert --contacts adds them)"


def _notes(m: RequestedModel, disabled: Disabled) -> Iterator[str]:
    if m.opt.density or m.opt.viscosity:
        yield "the forces of the fluid around the bodies are left out"
    if m.nflex:
        raise RobotFault("found flexible bodies, expected rigid ones")
    limited = [name_of(m, "tendon", k) for k in range(m.ntendon) if m.tendon_limited[k]]
    if limited:
        yield f"the limits of tendons are left out: {', '.join(limited)}"


FILE, INCLUDE, REPLICATE = "file", "include", "replicate"
MOST_COPIES = 10_000
"""Largest number of copies by ``replicate``, repeated copies included: MuJoCo makes them all before it refuses any."""
FOLDERS = ("assetdir", "meshdir", "texturedir")


def check_assets(path: Path) -> None:
    """Refuse an MJCF file that refers, directly or through included files, to anything but regular files.

    Raises RobotFault or InputError if an included file cannot be read as text.
    """
    waiting, seen = [path], set[Path]()
    while waiting:
        file = waiting.pop()
        if file in seen:
            continue
        seen.add(file)
        for name, included in _named(file, path.parent):
            try:
                check_regular(name)
            except FileNotFoundError:
                continue
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", None) or error
                raise RobotFault(f"{quoted(str(name))}: the file cannot be read ({reason})") from None
            if included:
                waiting.append(name)


def _named(file: Path, folder: Path) -> Iterator[tuple[Path, bool]]:
    """Yield the paths where MuJoCo may search for named files, and True for included files."""
    with suppress(ElementTree.ParseError):  # MuJoCo reports the error
        root = ElementTree.fromstring(file_text(file))
        if (copies := _copies(root)) > MOST_COPIES:
            raise RobotFault(f"{file.name}: found {copies:.3g} copies by replicate, expected at most {MOST_COPIES}")
        folders = {folder} | {folder / value for part in root.iter() for at in FOLDERS if (value := part.get(at))}
        for part in root.iter():
            if name := part.get(FILE):
                yield from ((each / name, part.tag == INCLUDE) for each in folders)


def _copies(root: ElementTree.Element) -> float:
    """Return the largest number of copies of an element within nested replicates."""
    most, waiting = 1.0, [(root, 1.0)]
    while waiting:
        element, copies = waiting.pop()
        if element.tag == REPLICATE:
            with suppress(ValueError):  # MuJoCo reports the error
                copies *= float(element.get("count", "1"))
        most = max(most, copies)
        waiting += [(child, copies) for child in element]
    return most
