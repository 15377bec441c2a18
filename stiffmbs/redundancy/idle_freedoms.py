"""Idle freedoms: motions of one body that move no other, such as the spin of a rod between ball joints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

import numpy as np

from ..compile.group import Group
from ..compile.quaternions import rotated
from ..compile.state import State
from ..compile.system import System
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import Dynamics
from .parameters import REDUNDANCY
from .uniqueness import by_functions


@dataclass(frozen=True)
class IdleFreedom:
    """Motion of one body that moves no other.

    `between`: joints and forces that connect it to others. `motion`: ``turn``, ``slide``, or ``move`` for several
    motions. `held_by`: forces that are stiff against it; empty if only joints and inertia act.
    """

    body: str
    between: tuple[str, ...]
    motion: str
    held_by: tuple[str, ...] = ()


def idle_freedoms(dynamics: Dynamics, t: float) -> list[IdleFreedom]:
    """Return the bodies with idle freedoms between others to which joints and elastic forces connect them.

    The motions are the null space of a single body's J. A force holds a motion by a nonzero tangent stiffness.
    `dynamics`: at an assembled pose; it is restored. `t`: s.
    """
    system, state = dynamics.system, dynamics.state
    around = _joints_around(system)
    J = system.term("motion", "J")
    for column in J.column[by_functions(system)[J.row]]:  # a formula with zero slope here may hold the body elsewhere
        around.pop(int(column) // system.of_body.n_u, None)
    for group in system.groups:
        if group.entries["inertia"]:  # of flexible bodies, whose coordinates are coupled by elasticity and inertia
            for body in group.bodies.ravel().tolist():
                around.pop(body, None)
    motions = dict(_free_motions(dynamics, list(around), t))
    if not motions:
        return []
    q = state.q.copy()
    random = Random(1)  # NumPy's takes longer to import than all of this
    move = np.array([random.uniform(-1.0, 1.0) for _ in range(system.n_u)])
    step = REDUNDANCY.perturbation * move * system.per_velocity(system.size, 1.0)
    state.q[:] = system.of_body.moved(q, step)
    also = dict(_free_motions(dynamics, list(motions), t)) if dynamics.assemble(t) >= 0 else {}
    state.q[:] = q
    always = {body: free for body, free in motions.items() if len(free) == len(also.get(body, ()))}
    found = [_classified(dynamics, body, free, around[body], t) for body, free in always.items()]
    return [freedom for freedom in found if freedom]


def _joints_around(system: System) -> dict[int, dict[str, set[int]]]:
    """Return the joints of each body that has any, each with its other bodies, including the ground."""
    around: dict[int, dict[str, set[int]]] = {}
    for group in system.groups:
        for name, bodies in zip(group.names, group.bodies.tolist(), strict=True) if group.record.n_equations else ():
            for body in set(bodies) - {len(system.bodies)}:
                around.setdefault(body, {})[name] = set(bodies) - {body}
    return around


def _classified(
    dynamics: Dynamics, body: int, free: np.ndarray, joints: dict[str, set[int]], t: float
) -> IdleFreedom | None:
    """Return the idle freedom of a body, or None if it is connected to a single other body or held by forces."""
    system = dynamics.system
    elastic = stiffnesses(dynamics.state, body, t)
    forces = (group for group in system.groups if not group.record.n_equations)
    others = {
        name: {*bodies} for group in forces for name, bodies in zip(group.names, group.bodies.tolist(), strict=True)
    }
    by_joints = set[int]().union(*joints.values())
    by_forces = set[int]().union(*(others[name] - {body} for name in elastic))
    if len(by_joints | by_forces) < 2:
        return None
    name, straight = system.bodies[body], system.of_body.linear
    holding, loose = _held(dynamics, body, free, t)
    if len(loose):
        return IdleFreedom(name, (*joints, *(elastic if len(by_joints) < 2 else ())), _motion(loose, straight))
    if len(by_joints) < 2:
        return None
    return IdleFreedom(name, tuple(joints), _motion(free, straight), tuple(holding))


def _held(dynamics: Dynamics, body: int, free: np.ndarray, t: float) -> tuple[list[str], np.ndarray]:
    """Return the forces that are stiff against motions of a body, here and further along, and the other motions."""
    state = dynamics.state
    scale = dynamics.system.per_velocity(dynamics.system.size, 1.0)[: dynamics.system.of_body.n_u]
    names, loose = held(stiffnesses(state, body, t), free, scale)
    q = state.q.copy()
    for free_motion in loose:
        state.q[:] = screwed(dynamics.system, q, body, REDUNDANCY.further * scale * free_motion)
        more, loose = held(stiffnesses(state, body, t), loose, scale)
        names = list(dict.fromkeys([*names, *more]))
        state.q[:] = q
    return names, loose


def _free_motions(dynamics: Dynamics, bodies: list[int], t: float) -> Iterator[tuple[int, np.ndarray]]:
    """Yield bodies with motions that no joint prevents, and these motions as rows, in sizes and rad."""
    system, state = dynamics.system, dynamics.state
    state.evaluate("motion", t)
    term, width = system.term("motion", "J"), system.of_body.n_u
    value = state.values["motion"][term.source] / system.per_velocity(1.0, system.size)[term.column]
    order = np.argsort(term.column // width, kind="stable")
    ends = np.searchsorted(term.column[order] // width, np.arange(len(system.bodies) + 1))
    for body in bodies:
        own = order[ends[body] : ends[body + 1]]
        rows, row = np.unique(term.row[own], return_inverse=True)
        J = np.zeros((max(len(rows), width), width))
        np.add.at(J, (row, term.column[own] % width), value[own])
        if not np.all(np.isfinite(J)):
            continue
        _, values, motions = np.linalg.svd(J)
        free = motions[values <= REDUNDANCY.dependent * values[0]]
        if len(free):
            yield body, free


def _motion(motions: np.ndarray, linear: int) -> str:
    """Return the type of some motions (rows of velocities)."""
    if len(motions) > 1:
        return "move"
    turning = motions[0, linear:]
    if np.linalg.norm(turning) < REDUNDANCY.takes_part:
        return "slide"
    return "turn"


def stiffnesses(state: State, body: int, t: float) -> dict[str, np.ndarray]:
    """Return the tangent stiffness -df/dq Z of each force against displacements of a body, by force.

    Weights, dampers, friction and open contacts have none. `state`: at the pose. `t`: s. Returns arrays of shape
    (n_u, n_u): angles and moments in the solver's axes; SI units.
    """
    system = state.system
    groups = [(g, group) for g, group in enumerate(system.groups) if group.entries["f_q"] and group.kind.element.kind]
    found: dict[str, np.ndarray] = {}
    if not groups:
        return found
    state.evaluate("tangent", t)
    at = 1 + TERM_SETS["tangent"].index("f_q")
    for g, group in groups:
        first, width = system.places["tangent"][g, at], group.entries["f_q"]
        values = state.values["tangent"][first : first + group.count * width].reshape(group.count, width)
        for e, k in zip(*np.nonzero(_acts(group, values) & (group.bodies == body)), strict=True):
            found[group.names[e]] = -_block(group, values[e], k) @ _moves(state, body)
    return found


def _acts(group: Group, values: np.ndarray) -> np.ndarray:
    """Return a mask of the bodies against which each element is stiff, shape (count, bodies)."""
    slot = _own(group)
    return np.array([np.any(values[:, slot == k] != 0.0, axis=1) for k in range(group.kind.n_bodies)]).T


def _own(group: Group) -> np.ndarray:
    """Return the body slot of each entry of df/dq in which a body's force depends on its own coordinates, else -1."""
    row, column = np.array(group.record.patterns["f_q"]).T
    of_row, of_column = row // group.of_body.n_u, column // group.of_body.n_q
    return np.where(of_row == of_column, of_row, -1)


def _block(group: Group, values: np.ndarray, k: int) -> np.ndarray:
    """Return df/dq of one element for one of its bodies, shape (n_u, n_q)."""
    n_u, n_q = group.of_body.n_u, group.of_body.n_q
    own = _own(group) == k
    row, column = np.array(group.record.patterns["f_q"])[own].T
    block = np.zeros((n_u, n_q))
    block[row % n_u, column % n_q] = values[own]
    return block


def _moves(state: State, body: int) -> np.ndarray:
    """Return Z of one body, q' = Z u, shape (n_q, n_u)."""
    of_body = state.system.of_body
    q = state.q[of_body.n_q * body : of_body.n_q * (body + 1)]
    return np.array([of_body.position_rates(q, unit) for unit in np.eye(of_body.n_u)]).T


def held(stiffness: dict[str, np.ndarray], motions: np.ndarray, scale: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return the forces that are stiff against motions of a body, and the motions without stiffness.

    `stiffness`: of each force, as from `stiffnesses`. `motions` of shape (n, n_u): independent motions, in units of
    `scale`. `scale` of shape (n_u,): units of displacements, m and rad.
    """
    scaled = {name: scale[:, None] * K * scale for name, K in stiffness.items()}
    largest = max((np.abs(K).max() for K in scaled.values()), default=0.0)
    names = [
        name for name, K in scaled.items() if np.abs(K @ motions.T).max() > REDUNDANCY.stiffness_rounding * largest
    ]
    if not names:
        return [], motions
    _, values, free = np.linalg.svd(sum(scaled[name] for name in names) @ motions.T)
    values = np.pad(values, (0, len(motions) - len(values)))
    return names, free[values <= REDUNDANCY.stiffness_rounding * largest] @ motions


def screwed(system: System, q: np.ndarray, body: int, twist: np.ndarray) -> np.ndarray:
    """Return coordinates after a motion of one body along a constant twist: a screw motion, in the plane a rotation.

    The centre moves by (I + (1 - cos theta)/theta^2 [w] + (theta - sin theta)/theta^3 [w]^2) v with theta = |w|: Lynch
    and Park, Modern Robotics, 2017, eq. 3.88. `twist`: velocity v of the centre of mass, m, and angular velocity w (in
    space in the body's axes), rad.
    """
    of_body = system.of_body
    v, w = np.zeros(3), np.zeros(3)
    v[: of_body.linear] = twist[: of_body.linear]
    own = q[of_body.n_q * body : of_body.n_q * (body + 1)]
    w[:] = rotated(own[3:], twist[3:]) if of_body.dimensions == 3 else (0.0, 0.0, twist[-1])
    theta = max(float(np.linalg.norm(w)), 1e-8)
    once = np.cross(w, v)
    shift = v + (1 - np.cos(theta)) / theta**2 * once + (theta - np.sin(theta)) / theta**3 * np.cross(w, once)
    step = np.zeros(system.n_u)
    first = of_body.n_u * body
    step[first : first + of_body.linear] = shift[: of_body.linear]
    step[first + of_body.linear : first + of_body.n_u] = twist[of_body.linear :]
    return of_body.moved(q, step)
