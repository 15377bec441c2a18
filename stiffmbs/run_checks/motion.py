"""Checks of a run on its own motion."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator

import numpy as np

from ..compile.system import System
from ..compile.written_values import writer
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.friction_loads import REMEDY, ambiguous_loads_clause
from ..errors import InputError
from ..notes import Note, NoteKind, Severity
from ..results.joint_angles import joint_angles
from .parameters import RUN_CHECKS
from .singular_poses import singular_passage_notes, some_instants

OUT_OF_RANGE = NoteKind(
    "force-out-of-range",
    "'{element}' {doubt}, first at t = {t:.6g} s, for example because of a growing vibration (shimmy); the motion may then "
    "depend on the tolerances: {remedy}",
    "check it with --verify, and its growth with 'stiffmbs modes' and an earlier --at",
)
UNCERTAIN_TURNS = NoteKind(
    "uncertain-revolutions",
    "the revolutions of the angle of '{element}' are uncertain: at t = {t:.6g} s the orientation and the integral of the "
    "angular velocity differ by {apart:.2g} rad; the steps are too long for the speed ({remedy}), or the reference axis of "
    "the angle becomes parallel to the axis of rotation",
    "use a smaller rtol or step",
)
SEVERAL_MOTIONS = NoteKind(
    "several-motions",
    "several motions are possible from t = {t:.6g} s on, where {clause}; the solver follows one of them: {remedy}",
    REMEDY,
    severity=Severity.DOUBT,
)


def motion_notes(
    dynamics: Dynamics, rows: OutputRows, rtol: float, again: Callable[[np.ndarray], OutputRows]
) -> Iterator[Note]:
    """Yield notes on results that depend on rounding or tolerances: singular poses, missed turns, forces out of range.

    The state of `dynamics`, of the whole model, is changed; `again` is a rerun up to the last of other times, s, with rows
    at these.
    """
    if rows.lam.size:
        yield from singular_passage_notes(dynamics, rows, rtol, again)
    if dynamics.system.n_counters:
        yield from missed_revolutions_notes(dynamics, rows)
    if dynamics.system.of_body.dimensions == 3 and (angles := joint_angles(dynamics.system)) is not None:
        yield from angles.uncertain(rows)
    if dynamics.system.n_event_functions > dynamics.system.first_limit:
        yield from near_limits_notes(dynamics, rows)


def near_limits_notes(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the first force outside the range in which its kind is reliable; the state is changed."""
    system, at = dynamics.system, some_instants(len(rows.t))
    doubtful, doubts = _doubts(system)
    limits = slice(system.first_limit, system.n_event_functions)
    passed = dynamics.state.values_at("event_function", limits, rows.t[at], rows.q[at], rows.u[at]) < doubtful
    if passed.any():
        k, limit = np.argwhere(passed)[0]
        name, doubt = doubts[limit]
        yield OUT_OF_RANGE(name, doubt=doubt, t=rows.t[at[k]])


def _doubts(system: System) -> tuple[np.ndarray, tuple[tuple[str, str], ...]]:
    """Return, for each limit of a force, the value below which the motion is doubtful, and its name with the doubt."""
    found = [
        (group.kind.element.doubtful, (name, group.kind.element.doubt))  # type: ignore[attr-defined]
        for group in system.groups
        if group.entries["limit"]
        for name in group.names
        for _ in range(group.entries["limit"])
    ]
    return np.array([value for value, _ in found]), tuple(doubt for _, doubt in found)


def missed_revolutions_notes(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the angle that differs most from the counter of its turns, if the turn is uncertain."""
    system = dynamics.system
    solved = np.flatnonzero(~np.isnan(rows.position_violation))
    if not len(solved):
        return
    counted = system.term("position", "continuous_angle")
    at = solved[some_instants(len(solved))]
    angles = dynamics.state.values_at("position", counted.source, rows.t[at], rows.q[at], rows.u[at])
    apart = np.abs(angles - rows.q[np.ix_(at, counted.row)])
    if not np.nanmax(apart) > RUN_CHECKS.uncertain_turn:
        return
    k, worst = np.unravel_index(int(np.nanargmax(apart)), apart.shape)
    name = writer(system, "position", int(counted.source[worst]))
    yield UNCERTAIN_TURNS(name, t=rows.t[at[k]], apart=apart[k, worst])


def several_solutions_note(dynamics: Dynamics, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on the first checked output time at which loads have several solutions; the state is changed."""
    for k in some_instants(len(rows.t)):
        if clause := ambiguous_loads_clause(dynamics, rows.t[k], rows.q[k], rows.u[k], rows.lam[k]):
            yield SEVERAL_MOTIONS(t=rows.t[k], clause=clause)
            return


def refuse_far_away(system: System) -> None:
    """Refuse joints whose equations are dominated by rounding at the start, which no step size can satisfy.

    Raise an InputError that names the body.
    """
    if not system.n_c:
        return
    of_body = system.of_body
    farthest = np.abs(system.q[: system.n_pose].reshape(-1, of_body.n_q)[:, : of_body.linear]).max(axis=1)
    body = int(np.argmax(farthest))
    rounding, size = farthest[body] * sys.float_info.epsilon, system.size
    if rounding > RUN_CHECKS.coarse * size:
        raise InputError(
            f"bodies.{system.bodies[body]}.position: found {farthest[body]:.3g} m in a mechanism of {size:.3g} m, with a rounding "
            f"error of {rounding:.1g} m, expected a position nearer to the origin"
        )
