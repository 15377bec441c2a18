"""Checks of stiff forces: of their digits, and in long steps of BDF of order 1, as after restarts at loose tolerances.

The rounding of coordinates changes a force by 0.01 N at a coordinate of 1 m for a stiffness of 1e14 N/m.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..compile.group import Group
from ..compile.state import State
from ..compile.terms import TERM_SETS
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.storage import blocks, release
from ..notes import Note, NoteKind
from ..solve.error_control.newton import stiffness_at
from ..solve.stiff_rows import largest_force, lengths_of_steps
from ..solve.trajectory import Trajectory
from .parameters import RUN_CHECKS

LOST_DIGITS = NoteKind(
    "lost-digits",
    "the force of '{element}' is known to about {lost:.1g} N only, as are reactions: coordinates have 16 digits, and it is "
    "so stiff; the largest force is {largest:.3g} N",
    "use a joint, or less stiffness",
)
COARSE = NoteKind(
    "coarse-forces",
    "stiff forces and reactions are wrong by up to about {percent:.2g} % of the largest at {times} from t = {t:.6g} s on: "
    "steps of BDF of order 1 are long for them there",
    "reduce rtol, or use solver: radau",
)


def uncertain_forces(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows) -> Iterator[Note]:
    """Yield notes on forces of a run with implicit steps that are known to a few digits only; the state is changed."""
    if trajectory.statistics.get("jacobians"):
        yield from lost_digits_notes(dynamics, rows)
        if not trajectory.recorded:  # the estimate from recorded steps includes these errors
            yield from coarse_forces_notes(dynamics, trajectory, rows)


def coarse_forces_notes(dynamics: Dynamics, trajectory: Trajectory, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on stiff forces in long steps of order 1, if they contradict the motion; the state is changed.

    There they follow from second differences of positions, which are no accelerations where the step changes (Gear,
    Hsu and Petzold 1981, Differential-algebraic equations revisited). Accelerations then differ from the mean rate of
    velocities since the output before, at most a step earlier. The difference is relative to the largest force, and
    differences below the rounding of coordinates are ignored: unloaded bodies have no other forces.
    """
    ends, orders = trajectory.history.t, trajectory.history.order
    if len(orders) != len(ends) or len(rows.t) < 2 or not (orders == 1).any():
        return
    last = np.clip(np.searchsorted(ends, rows.t), 0, len(ends) - 1)
    at = 1 + np.flatnonzero(orders[last[1:]] == 1)
    if not len(at):
        return
    lengths = lengths_of_steps(trajectory)[at]
    within = (lengths > 0.0) & (lengths >= np.diff(rows.t)[at - 1])
    at, lengths = at[within], lengths[within]
    if not len(at):
        return
    mass, rate = dynamics.system.mass, (rows.u[at] - rows.u[at - 1]) / (rows.t[at] - rows.t[at - 1])[:, None]
    inertia = _largest_inertia(rows, mass)
    off = np.sqrt((rows.acceleration[at] - rate) ** 2 @ mass)
    found = off > RUN_CHECKS.contradicted_part * inertia
    at, off, lengths = at[found], off[found], lengths[found]
    if not len(at):
        return
    last = at[-1:]
    largest = max(inertia, largest_force(dynamics, (rows.q[last], rows.u[last]), float(rows.t[last[0]])))
    found = off > RUN_CHECKS.contradicted_part * largest
    at, off, lengths = at[found], off[found] / largest, lengths[found]
    if not len(at):
        return
    t = float(rows.t[at[-1]])
    dynamics.state.q[:], dynamics.state.u[:] = rows.q[at[-1]], rows.u[at[-1]]
    rounding = _inertia_by_rounding(dynamics.state, t)
    long = (lengths > stiffness_at(dynamics, t).long_step) & (off * largest > rounding)
    if long.any():
        at, off = at[long], off[long]
        times = f"{len(at)} output time{'s' * (len(at) > 1)}"
        yield COARSE(percent=100.0 * off.max(), times=times, t=rows.t[at[0]])


def _largest_inertia(rows: OutputRows, mass: np.ndarray) -> float:
    """Return the largest force of inertia at an output time, divided by the root of its inertia."""
    largest = 0.0
    for block in blocks(len(rows.t)):
        largest = max(largest, float(np.fmax.reduce(rows.acceleration[block] ** 2 @ mass)))
        release(rows.acceleration)
    return float(np.sqrt(largest))


class LostDigits(NamedTuple):
    """Element whose force rounding changes most, that change, and the largest force of an element on a body, N."""

    element: str
    lost: float
    largest: float


class _Changes(NamedTuple):
    """Changes of the forces of a group of elements by the rounding of coordinates.

    One row for each element, with their rows among the element's velocities and among those of the model.
    """

    group: Group
    values: np.ndarray
    own_rows: np.ndarray
    rows: np.ndarray


def _changes(state: State, t: float) -> list[_Changes]:
    """Return the changes of the forces of all elements at a state."""
    system = state.system
    found: list[_Changes] = []
    state.evaluate("tangent", t)
    size = np.append(np.abs(state.q), np.zeros(system.of_body.n_q))
    rounding = 0.5 * RUN_CHECKS.roundings * np.finfo(float).eps
    at = 1 + TERM_SETS["tangent"].index("f_q")
    for g, group in enumerate(system.groups):
        if group.entries["f_q"] and group.kind.element.kind:
            source, rows, column = group.placed("f_q", int(system.places["tangent"][g, at]))
            own = np.array(group.record.patterns["f_q"])[:, 0]
            values = rounding * np.abs(state.values["tangent"][source]) * size[column]
            found.append(_Changes(group, values.reshape(group.count, len(own)), own, rows))
    return found


def _inertia_by_rounding(state: State, t: float) -> float:
    """Return the largest force of inertia that rounding of coordinates causes, divided by the root of its inertia."""
    mass = state.system.mass
    forces = np.zeros_like(mass)
    for found in _changes(state, t):
        forces += np.bincount(found.rows, found.values.ravel(), minlength=len(mass))[: len(mass)]
    return float(np.sqrt(np.sum(forces**2 / mass)))


def rounded_forces(state: State, t: float) -> tuple[list[tuple[float, str]], list[tuple[float, str]]]:
    """Return the changes of forces, N, and those of torques, N m, by the rounding of coordinates, with their elements.

    Torques are those about the centres of mass of bodies; a torque about the origin of the ground has any lever.
    """
    of_body = state.system.of_body
    forces, torques = [(0.0, "")], [(0.0, "")]
    for group, changes, row, rows in _changes(state, t):
        own = np.arange(of_body.n_u * group.kind.n_bodies)
        straight = own % of_body.n_u < of_body.linear
        of_bodies = np.where(rows.reshape(changes.shape) < state.system.n_u, changes, 0.0)
        for found, of_entries, which in ((forces, changes, straight), (torques, of_bodies, ~straight)):
            of_rows = of_entries @ (row[:, None] == own[which])
            found += zip(of_rows.max(axis=1, initial=0.0).tolist(), group.names, strict=True)
    return forces, torques


def lost_digits(state: State, t: float) -> LostDigits:
    """Return the largest change of a force by the rounding of coordinates at a state."""
    system, (changes, _) = state.system, rounded_forces(state, t)
    state.evaluate("motion", t)
    term, linear = system.term("motion", "f"), system.per_velocity(1.0, 0.0) == 1.0
    forces = state.values["motion"][term.source][linear[term.row]]  # of each element: their sums vanish in equilibrium
    lost, element = max(changes)
    return LostDigits(element, lost, float(np.abs(forces).max(initial=0.0)))


def lost_digits_notes(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the force that rounding changes most at the end of a run, if that is much; the state is changed."""
    if not len(rows.t):
        return
    state, t = dynamics.state, float(rows.t[-1])
    state.q[:], state.u[:] = rows.q[-1], rows.u[-1]
    name, lost, at_end = lost_digits(state, t)
    if not lost > RUN_CHECKS.lost * at_end:
        return
    linear = dynamics.system.per_velocity(1.0, 0.0) == 1.0
    inertia = np.abs(dynamics.system.mass * rows.acceleration)[:, linear]  # forces may vanish at the end of a run
    largest = max(at_end, float(np.nanmax(inertia, initial=0.0)))
    if lost > RUN_CHECKS.lost * largest > 0.0:
        yield LOST_DIGITS(name, lost=lost, largest=largest)
