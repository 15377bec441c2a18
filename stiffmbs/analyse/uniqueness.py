"""Which reactions redundant equations leave without a unique value (Wojtyra, Mech. Mach. Theory 40, 2005)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.system import PLANAR, System
from .loop_equations import LoopEquations, Pose
from .loop_rank import LoopRank
from .reactions import reactions

CHANGES = 1e-6
"""Change of a reaction, in parts of the largest, from which on it is not unique."""
SAME_DIRECTION = 1e-5
"""Angle, rad, and part of a force across it, up to which a direction counts as the same."""
SPEED = 1.0
"""Velocity (arms and rad per second) at which forces that hang on reactions are looked at: friction has none at rest."""


@dataclass(frozen=True)
class Undetermined:
    """What of a joint's or force's reaction has no unique value.

    Attributes
    ----------
    element : str
    channels : tuple of str
        Components in ground axes, such as ``hinge.fx``.
    axes : str or None
        Where the undetermined force always has one direction: whose axes keep it (a body, or ``ground``); the force
        across that direction is unique.
    direction : float or None
        Its angle in those axes, rad, in [0, pi).
    """

    element: str
    channels: tuple[str, ...]
    axes: str | None = None
    direction: float | None = None


def undetermined(found: LoopRank, null_spaces: list[tuple[Pose, np.ndarray]]) -> list[Undetermined]:
    """The reactions that change along the null space of J^T.

    Parameters
    ----------
    null_spaces : list of (Pose, ndarray)
        Poses and null vectors of the scaled J^T there.

    Notes
    -----
    M u' = f - J^T lam leaves lam free along the null space of J^T; a reaction is unique where it does not change
    along it.  What changes at one of the poses is not unique as a history.
    """
    equations = found.equations
    system, changes = equations.state.system, [_changes(equations, pose, space) for pose, space in null_spaces]
    names = [name for name in changes[0] if any(np.abs(change[name]).max() > CHANGES for change in changes)]
    owners = dict.fromkeys(name.partition(".")[0] for name in names)
    poses = [pose for pose, _ in null_spaces]
    return [
        Undetermined(
            owner, tuple(name for name in names if name.partition(".")[0] == owner),
            *_direction(system, equations, poses, changes, owner),
        )
        for owner in owners
    ]  # fmt: skip


def forces_change(found: LoopRank, null_spaces: list[tuple[Pose, np.ndarray]]) -> bool:
    """Whether applied forces (friction) hang on reactions that are not unique: then the motion is not unique either."""
    equations = found.equations
    state = equations.state
    for pose, space in null_spaces:
        _place(equations, pose)
        rng = np.random.default_rng(1)
        state.u[equations.loop.columns] = equations.moved(0.0 * pose.q, SPEED * rng.uniform(-1, 1, len(pose.q)))
        for lam in (*_multipliers(equations, space).T, *-_multipliers(equations, space).T):
            at_zero, loaded = (_force(equations, part * lam, pose.t) for part in (0.0, 1.0))
            if np.abs(loaded - at_zero).max() > CHANGES:
                return True
    return False


def _changes(equations: LoopEquations, pose: Pose, space: np.ndarray) -> dict[str, np.ndarray]:
    """For each channel its change along each null vector, scaled so that the largest is one; torques by arms."""
    state = equations.state
    _place(equations, pose)
    rows = []
    for lam in (np.zeros(len(space)), *_multipliers(equations, space).T):
        state.lam[equations.loop.rows] = lam
        state.evaluate("output", pose.t)
        rows.append(state.values["output"].copy())
    state.lam[:] = 0.0
    found = {
        name: (values[1:] - values[0]) / (equations.length if name.endswith(".torque") else 1.0)
        for name, values in reactions(state.system, np.array(rows)).items()
    }
    largest = np.max([np.abs(change) for change in found.values()], axis=0)
    return {name: change / np.where(largest > 0, largest, 1.0) for name, change in found.items()}


def _place(equations: LoopEquations, pose: Pose) -> None:
    equations.state.q[equations.loop.columns] = pose.q
    equations.state.u[equations.loop.columns] = 0.0


def _multipliers(equations: LoopEquations, space: np.ndarray) -> np.ndarray:
    """Null vectors of J^T, scaled so that the generalised forces of their rows are of order one."""
    return equations.row_scale[:, None] * equations.length * space


def _force(equations: LoopEquations, lam: np.ndarray, t: float) -> np.ndarray:
    state = equations.state
    state.lam[equations.loop.rows] = lam
    state.evaluate("acceleration", t)
    state.lam[:] = 0.0
    return state.vector("acceleration", "f")


def _direction(
    system: System, equations: LoopEquations, poses: list[Pose], changes: Sequence[Mapping[str, np.ndarray]], owner: str
) -> tuple[str | None, float | None]:
    """In whose axes the undetermined force of an element has one direction at every pose, and which."""
    angles = []
    for change in changes:
        force = np.array([change[f"{owner}.fx"], change[f"{owner}.fy"]])
        axes, sizes, _ = np.linalg.svd(force, full_matrices=False)
        if sizes[0] <= CHANGES or sizes[1:].sum() > SAME_DIRECTION * sizes[0]:
            return None, None
        angles.append(np.arctan2(axes[1, 0], axes[0, 0]))
    turned = {"ground": np.zeros(len(poses))}
    for body in next((joint.bodies for joint in equations.loop.joints if joint.name == owner), ()):
        at = PLANAR * equations.loop.bodies.index(body) + PLANAR - 1
        turned[system.bodies[body]] = np.array([pose.q[at] for pose in poses])
    for name, turn in turned.items():
        relative = np.array(angles) - turn
        if np.abs(np.sin(relative - relative[0])).max() < SAME_DIRECTION:
            return name, round(float((relative[0] + SAME_DIRECTION) % np.pi - SAME_DIRECTION), 9) + 0.0
    return None, None
