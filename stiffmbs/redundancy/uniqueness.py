"""Reactions that redundant equations leave without a unique value (Wojtyra, Mech. Mach. Theory 40, 2005)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times
from ..compile.reactions import reactions
from ..compile.system import System
from ..presolve.relations import curved
from ..reading.formula.formula import Formula
from ..reading.names import owner_of
from ..reading.table import Table
from .loop_equations import LoopEquations, Pose
from .loop_rank import LoopRank
from .parameters import REDUNDANCY
from .redundancy import Redundancy


class Direction(NamedTuple):
    """Direction of the indeterminate part of a reaction at all poses.

    - `quantity`: ``force`` or ``torque``.
    - `axes`: axes in which it is constant: a body, or ``ground``.
    - `vector`: unit vector in these axes, with arbitrary sign.
    - `across`: true if it is perpendicular to that vector (in space), not parallel.
    """

    quantity: str
    axes: str
    vector: tuple[float, ...]
    across: bool


def directions(
    equations: LoopEquations,
    poses: Sequence[Pose],
    changes: Sequence[Mapping[str, np.ndarray]],
    owner: str,
    negligible: float,
) -> Iterator[Direction]:
    """Yield the constant directions of an element's indeterminate force, and in space of its torque.

    In space, a direction that the kind of joint implies is omitted. `changes`: at each pose, the change of each channel
    along each null vector, shape (vectors,). `owner`: name of the element. `negligible`: change that counts as zero.
    """
    of_body = equations.state.system.of_body
    quantities = {"force": of_body.reactions[: of_body.linear]}
    if of_body.dimensions == 3:
        quantities["torque"] = of_body.reactions[of_body.linear :]
    transmits = next((joint.element.transmits for joint in equations.loop.joints if joint.name == owner), ())
    for quantity, components in quantities.items():
        stacks = [np.array([change[f"{owner}.{name}"] for name in components]) for change in changes]
        parts = [_space(stack, negligible) for stack in stacks]
        rank = parts[0][0]
        possible = [name for name in transmits if name[0] == quantity[0]] if len(components) == 3 else ()
        if any(found != rank for found, _ in parts) or not 0 < rank < (len(possible) or len(components)):
            continue
        across = rank == 2
        for axes, back in _frames(equations, poses, owner):
            own = [seen @ axis for seen, (_, axis) in zip(back, parts, strict=True)]
            if all(_same(vector, own[0]) for vector in own):
                yield Direction(quantity, axes, _rounded(own[0]), across)
                break


def _frames(equations: LoopEquations, poses: Sequence[Pose], owner: str) -> Iterator[tuple[str, list[np.ndarray]]]:
    """Yield the ground and an element's bodies, each with the rotation matrices into its axes at the poses."""
    system = equations.state.system
    yield "ground", [np.eye(system.of_body.dimensions)] * len(poses)
    for body in next((joint.bodies for joint in equations.loop.joints if joint.name == owner), ()):
        first = system.of_body.n_q * equations.loop.bodies.index(body) + system.of_body.linear
        turns = [pose.q[first : first + system.of_body.n_q - system.of_body.linear] for pose in poses]
        yield system.bodies[body], [_into_own_axes(turn, system.principal_axes[body]) for turn in turns]


def _into_own_axes(turn: np.ndarray, principal: np.ndarray) -> np.ndarray:
    """Return the rotation matrix for a body's angle, or for its quaternion and its principal axes in its own."""
    if len(turn) == 1:
        c, s = np.cos(turn[0]), np.sin(turn[0])
        return np.array([[c, s], [-s, c]])
    return rotated(times(turn, CONJUGATE * principal), np.eye(3))


def _space(change: np.ndarray, negligible: float) -> tuple[int, np.ndarray]:
    """Return the number of directions spanned by columns, and the one direction, or the normal to two."""
    axes, sizes, _ = np.linalg.svd(change, full_matrices=change.shape[1] < len(change))
    if sizes[0] <= negligible:
        return 0, axes[:, 0]
    rank = int(np.sum(sizes > REDUNDANCY.same_direction * sizes[0]))
    return rank, axes[:, 0] if rank == 1 else axes[:, -1]


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(min(np.linalg.norm(a - b), np.linalg.norm(a + b)) < REDUNDANCY.same_direction)


def _rounded(vector: np.ndarray) -> tuple[float, ...]:
    largest = int(np.argmax(np.abs(vector) > np.abs(vector).max() - REDUNDANCY.same_direction))
    return tuple(round(float(part), 9) + 0.0 for part in vector * np.sign(vector[largest]))


TORQUES = ("torque", "tx", "ty", "tz")


class Indeterminate(NamedTuple):
    """Indeterminate part of the reaction of a joint or force.

    `channels`: components in ground axes, such as ``hinge.fx``. `directions`: constant directions of the indeterminate
    force, and in space of the torque; perpendicular components are unique.
    """

    element: str
    channels: tuple[str, ...]
    directions: tuple[Direction, ...] = ()


def indeterminate(found: LoopRank, null_spaces: list[tuple[Pose, np.ndarray]]) -> list[Indeterminate]:
    """Return the reactions that change along the null space of J^T.

    `null_spaces`: poses and null vectors of the scaled J^T there.

    M u' = f - J^T lam leaves lam free along the null space of J^T; a reaction is unique if it does not change along it.
    A reaction that changes at one pose is not unique over time.
    """
    equations = found.equations
    changes = [changes_of(equations, pose, space) for pose, space in null_spaces]
    of_owner: dict[str, list[str]] = {}
    for name in changes[0]:
        if any(np.abs(change[name]).max() > REDUNDANCY.takes_part for change in changes):
            of_owner.setdefault(owner_of(name), []).append(name)
    poses = [pose for pose, _ in null_spaces]
    return [
        Indeterminate(owner, tuple(names), tuple(directions(equations, poses, changes, owner, REDUNDANCY.takes_part)))
        for owner, names in of_owner.items()
    ]


def forces_change(found: LoopRank, null_spaces: list[tuple[Pose, np.ndarray]]) -> bool:
    """Return True if applied forces (friction) depend on indeterminate reactions, so that the motion is not unique."""
    equations = found.equations
    state = equations.state
    if not (
        len(state.system.term("acceleration", "f_lam").source) or len(state.system.term("tangent", "rate_lam").source)
    ):
        return False
    for pose, space in null_spaces:
        _place(equations, pose)
        rng = np.random.default_rng(1)
        columns = equations.loop.columns
        state.u[columns] = equations.velocities(rng.uniform(-1, 1, len(columns)))  # friction is zero at rest
        for lam in (*_multipliers(equations, space).T, *-_multipliers(equations, space).T):
            at_zero, loaded = (_force(equations, part * lam, pose.t) for part in (0.0, 1.0))
            if np.abs(loaded - at_zero).max() > REDUNDANCY.takes_part:
                return True
    return False


EFFORT = ".effort"
"""Ending of the channel of a drive's effort."""


def changes_of(equations: LoopEquations, pose: Pose, space: np.ndarray) -> dict[str, np.ndarray]:
    """Return the change of each channel along each null vector, scaled to a maximum of one, torques by arms."""
    state = equations.state
    _place(equations, pose)
    rows = []
    for lam in (np.zeros(len(space)), *_multipliers(equations, space).T):
        state.lam[equations.loop.rows] = lam
        state.evaluate("output", pose.t)
        rows.append(state.values["output"].copy())
    state.lam[:] = 0.0
    found = {
        name: (values[1:] - values[0]) / (equations.length if name.rpartition(".")[2] in TORQUES else 1.0)
        for name, values in reactions(state.system, np.array(rows)).items()
    }
    compared = [np.abs(change) for name, change in found.items() if not name.endswith(EFFORT)]  # a force or a torque
    largest = np.max(compared, axis=0)
    return {name: change / np.where(largest > 0, largest, 1.0) for name, change in found.items()}


def _place(equations: LoopEquations, pose: Pose) -> None:
    equations.state.q[equations.loop.coordinates] = pose.q
    equations.state.u[equations.loop.columns] = 0.0


def _multipliers(equations: LoopEquations, space: np.ndarray) -> np.ndarray:
    """Return null vectors of J^T, scaled so that the generalised forces of their rows are of order one."""
    return equations.row_scale[:, None] * equations.length * space


def _force(equations: LoopEquations, lam: np.ndarray, t: float) -> np.ndarray:
    state = equations.state
    state.lam[equations.loop.rows] = lam
    state.evaluate("acceleration", t)
    state.lam[:] = 0.0
    return np.concatenate([state.vector("acceleration", name) for name in ("f", "rate")])


def unproven(redundancy: Redundancy) -> dict[int, tuple[int, ...]]:
    """Return the redundant equations that depend on others through formulas or tables: the other rows by row."""
    if not redundancy.redundant:
        return {}
    of_functions = by_functions(redundancy.system)
    found = {}
    for rank_result in redundancy.rank_results:
        rows = rank_result.rank.equations.loop.rows
        for part in rank_result.redundant:
            row, others = int(rows[part.row]), rows[list(part.others)]
            if of_functions[row] or of_functions[others].any():
                found[row] = tuple(others.tolist())
    return found


def by_functions(system: System) -> np.ndarray:
    """Return a mask of the rows with formulas or tables of pose or time, except linear ones of the pose."""
    rows = np.zeros(system.n_c, dtype=bool)
    for group in system.groups:
        functions = (part for sort in (Formula, Table) for part in group.elements[0].parts(sort))
        if group.record.n_equations and any(True for _ in functions):  # elements of a group have the same formulas
            last = group.first_row + group.count * group.record.n_equations
            nonholonomic = [True] * (group.record.n_equations - group.record.n_holonomic)
            timed_or_nonsmooth = np.array([*np.logical_not(group.record.removable), *nonholonomic])
            rows[group.first_row : last] = (curved(system, group) | timed_or_nonsmooth).ravel()
    return rows
