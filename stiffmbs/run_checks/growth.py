"""Detection of impossible results: unbounded growth and open joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..compile.reactions import reactions
from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..dynamics.storage import blocks, release
from ..model.settings import RunSettings
from ..notes import Note, NoteKind, Severity
from ..solve.events.refusals import DIVERGENCE, SPEED_OF_LIGHT, exponential, reaches
from ..solve.suspect import most_violated
from ..solve.trajectory import Trajectory
from .parameters import RUN_CHECKS

DIVERGES = NoteKind(
    "divergence",
    "the motion diverges: at t = {t:.6g} s '{element}' exceeds {what}, and reaches {value:.2g} {unit}{strongest}",
    "look for a wrong sign of a stiffness, damping or force",
    Severity.DOUBT,
)
OPEN_JOINT = NoteKind(
    "open-joint",
    "constraints are violated: joint '{element}' (equation {equation}) has an error of {violation:.3g} at t = {t:.6g} s, "
    "expected at most {allowed:.1g}, first exceeded at t = {first:.6g} s",
    severity=Severity.DOUBT,
)
WITHOUT_SIZE = NoteKind(
    "motion-within-tolerance",
    "the motion of {travel:.2g} m is smaller than the absolute tolerance of {rtol:.2g} m: bodies and markers at a single "
    "point have no size that it could follow",
    "set atol",
)


def senseless(
    dynamics: Dynamics, rows: OutputRows, on_constraints: bool, otherwise: tuple[Note, ...] = ()
) -> Iterator[Note]:
    """Yield a note on each impossible property of a motion; the state of `dynamics`, of the whole model, is changed.

    Drift is shown if states are not projected onto the constraints (`on_constraints`). `otherwise`: notes if there is no
    such property, on what it would explain.
    """
    with np.errstate(all="ignore"):
        yield from (*_grown(dynamics.system, rows), *_open_joint(dynamics, rows, on_constraints)) or otherwise


def _grown(system: System, rows: OutputRows) -> Iterator[Note]:
    if not system.bodies:
        return
    of_places, of_rates = reaches(system), system.per_velocity(1.0, system.size)
    limit, resolved = DIVERGENCE.unbounded * system.size, RUN_CHECKS.coarse * system.size / float(np.finfo(float).eps)
    if (
        np.ptp(rows.q) * of_places.max() <= min(limit, resolved)
        and np.abs(rows.u).max() * of_rates.max() <= SPEED_OF_LIGHT
    ):
        return
    far, speed = np.empty(len(rows.t)), np.empty(len(rows.t))
    for block in blocks(len(rows.t)):
        far[block] = np.max(np.abs(rows.q[block] - rows.q[0]) * of_places, axis=1)
        speed[block] = np.max(np.abs(rows.u[block]) * of_rates, axis=1)
        release(rows.q, rows.u)
    farthest, fastest = (
        lambda row: (np.abs(rows.q[row] - rows.q[0]) * of_places)[..., : system.n_pose],
        lambda row: np.abs(rows.u[row]) * of_rates,
    )
    if np.nanmax(far) > limit and exponential(rows.t, np.fmax.accumulate(far)):
        what = f"{DIVERGENCE.unbounded:.0e} times the mechanism's size of {system.size:.3g} m"
        yield _growth(system, rows, far, limit, what, farthest)
    elif np.nanmax(speed) > SPEED_OF_LIGHT:
        yield _growth(system, rows, speed, SPEED_OF_LIGHT, "the speed of light", fastest)
    elif np.nanmax(far) > resolved and _connected(system):
        what = f"the distance where rounding is {RUN_CHECKS.coarse:.0e} of the mechanism's size of {system.size:.3g} m"
        yield _growth(system, rows, far, resolved, what, farthest)


def _connected(system: System) -> bool:
    """Return True if an element connects bodies, as its deformation is a difference of coordinates."""
    ground = len(system.bodies)
    return any(
        group.kind.element.kind
        and bool(np.any(np.sum(group.bodies < ground, axis=1) >= 1 + (not group.record.n_equations)))
        for group in system.groups
    )


def _growth(
    system: System, rows: OutputRows, values: np.ndarray, limit: float, what: str, sizes: Callable[[Any], np.ndarray]
) -> Note:
    """Return the note on values beyond a limit, and on the body that has the largest of them.

    `sizes` returns their components at a row or at all rows: those of the first body, of the second, ...
    """
    largest = sizes(int(np.nanargmax(values))).reshape(len(system.bodies), -1)
    body = int(np.argmax(np.nanmax(largest, axis=1)))
    width = largest.shape[1]
    first = int(np.argmax(np.max(sizes(slice(None))[:, body * width : (body + 1) * width], axis=1) > limit))
    unit = "m/s" if limit == SPEED_OF_LIGHT else "m"
    strongest = _strongest(system, rows, first)
    return DIVERGES(
        system.bodies[body], t=rows.t[first], what=what, value=np.nanmax(values), unit=unit, strongest=strongest
    )


def _strongest(system: System, rows: OutputRows, row: int) -> str:
    """Return a clause on the force element, or else the joint, with the largest reaction at a row."""
    joints = {joint for joint, _ in system.equations}
    acting = {
        name: abs(float(values[0]))
        for name, values in reactions(system, rows.values[row : row + 1]).items()
        if np.isfinite(values[0])
    }
    forces = {name: value for name, value in acting.items() if name.rpartition(".")[0] not in joints and value > 0}
    name = max(forces or acting, key=lambda each: acting[each], default="")
    if not name:
        return ""
    unit = "N" if ".f" in name else "N m"
    return f" ('{name.rpartition('.')[0]}' acts with {acting[name]:.3g} {unit} there)"


def _open_joint(dynamics: Dynamics, rows: OutputRows, on_constraints: bool) -> Iterator[Note]:
    system, violation = dynamics.system, rows.position_violation
    if not system.n_c or np.isnan(violation).all():
        return
    allowed = (RUN_CHECKS.open if on_constraints else RUN_CHECKS.drifted) * max(system.size, 1e-3)
    worst = int(np.nanargmax(violation))
    if violation[worst] <= allowed:
        return
    state = dynamics.state
    state.q[:], state.u[:] = rows.q[worst], rows.u[worst]
    _, joint, equation = most_violated(dynamics, rows.t[worst], np.ones(system.n_c))
    first = int(np.argmax(violation > allowed))
    yield OPEN_JOINT(
        joint, equation=equation, violation=violation[worst], t=rows.t[worst], allowed=allowed, first=rows.t[first]
    )


def motion_within_tolerance(system: System, settings: RunSettings, trajectory: Trajectory) -> Iterator[Note]:
    """Yield a note if bodies that are all described at one point move by less than the absolute tolerance.

    The tolerance is relative to the size of a mechanism; a single point has none, and counts as 1 m.
    """
    first = trajectory.q[:1, : system.n_pose].reshape(len(system.bodies), -1)[:, : system.of_body.linear]
    if system.size != 1.0 or not len(first) or np.ptp(first, axis=0).any():
        return
    places = trajectory.q[:, : system.n_pose].reshape(len(trajectory.q), *first.shape[:1], -1)
    travel = float(np.ptp(places[:, :, : system.of_body.linear], axis=0).max())
    if np.finfo(float).eps < travel < settings.rtol:
        yield WITHOUT_SIZE(travel=travel, rtol=settings.rtol)
