"""Looking along a run for what its steps went over: between two ends of a step an integrator knows nothing but a polynomial.

The run is made once more and reported at many instants, within its steps too.  There the block system tells the
accelerations that the forces give along that very way.  Their integral is the change of the velocities (the momentum
balance) but where something acts that the step has not seen.  Stiff forces magnify every error of the tolerance, so an
open balance alone proves nothing: such a stretch is solved again by itself, with steps far shorter than it.  Where it
then ends elsewhere, but not with a tighter tolerance alone, something was stepped over for certain.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..analyses.job import Job
from ..compile.reactions import reactions
from ..compile.system import System
from ..errors import StiffmbsError
from ..results.energy_balance import Balance, energy_balance
from ..results.energy_balance_notes import may_be_missing
from ..results.solution import Solution
from ..run_checks.singular_poses import PosesOnTheWay
from ..solve.dynamics import OutputRows
from ..solve.events.restart import restarted
from ..solve.missing_rows import reported
from ..solve.settings import changed, near_constraints, traits_of
from ..solve.trajectory import Grid, Outcome
from .dense_sampling import apart
from .settings_again import EXPLICIT
from .solve_again import Deadline

SAMPLES, COUNTED = 20_000, 20
"""Instants at the most, and those of which the evaluations for one are counted."""
OF_EFFORT_LEFT = 0.25
"""Part of the evaluations left that looking may take."""
OPEN_BALANCE = 1e-3
"""Part of the largest velocity, weighted with masses, by which the momentum balance of an interval must be open."""
ELSEWHERE = 1e-2
"""The same for the velocities at the end of a stretch that is solved again."""
SHARE = 1e-3
"""Part of the largest change of a reaction that a law's own must have for the law to be what was stepped over."""
MUCH = 0.05
"""The same for a difference that no error of a tolerance makes in one step."""
SAME_ENERGY = 1e-2
"""Part of the largest kinetic energy by which two runs may differ that saw the same; impacts magnify every difference."""
STRETCHES = 4
"""Stretches that are solved again at the most."""
SHORTER = 50
"""Steps in an interval whose balance is open, when its stretch is solved again; a quarter of an interval should do."""
FEWEST_STEPS = 4
STRETCH_TOLERANCE, TIGHTEST_STRETCH = 1e-2, 1e-13
"""Of the tolerance with which a stretch is solved without short steps; the tightest that rounding allows."""


@dataclass(frozen=True)
class SteppedOver:
    """A stretch of a run in which something was stepped over.

    Attributes
    ----------
    begin, end : float
        Of the stretch, s.
    at : float
        Where the momentum balance is open the most, s.
    width : float
        How long it is open there, s.
    element : str
        What acts there; empty where nothing has a name.
    missed : float
        Change of the velocities that is missing, relative to the largest, weighted with masses.
    """

    begin: float
    end: float
    at: float
    width: float
    element: str
    missed: float

    @property
    def max_step(self) -> float:
        """Steps that see it, s."""
        return float(f"{self.width / FEWEST_STEPS:.1g}")


@dataclass(frozen=True)
class Along:
    """What is found along a run.

    Attributes
    ----------
    balance : Balance or None
        Of energy and work at all these instants; None where the run did not come to its end again, or took another way.
    missing : float
        What may be missing in it before it is told, J.
    stretches : tuple of SteppedOver
        Of the run.
    elsewhere : tuple of SteppedOver
        Of the same where it took another way when it was reported at more instants.
    obstacle : str
        Why nothing was looked at; empty where it was.
    """

    balance: Balance | None
    missing: float = 0.0
    stretches: tuple[SteppedOver, ...] = ()
    elsewhere: tuple[SteppedOver, ...] = ()
    obstacle: str = ""


def looked_along(job: Job, first: Solution, allowed: float) -> Along:
    """Look along a run at many instants, with limited effort.

    Parameters
    ----------
    job : Job
    first : Solution
        Of the job.
    allowed : float
        Evaluations of the job's equations.
    """
    begun = job.evaluations()
    times = _instants(job, first, OF_EFFORT_LEFT * allowed)
    grid = Grid(job.grid.start, float(times[-1]), times)
    try:
        trajectory = replace(job, grid=grid).integrate(Deadline(grid.start, grid.end, allowed, job.evaluations))
    except StiffmbsError as error:
        return Along(None, obstacle=str(error))
    if trajectory.outcome is Outcome.INTERRUPTED:
        return Along(None, obstacle="not looked along: no effort was left")
    rows, _ = reported(job.dynamics, trajectory, near_constraints(job.settings))
    system = job.dynamics.system
    balance = energy_balance(system, rows, trajectory.step_times)
    left = allowed - (job.evaluations() - begun)
    stretches = tuple(_stepped_over(job, rows, trajectory.step_times, left))
    if not _same_way(first, rows.t, rows.kinetic):
        return Along(None, elsewhere=stretches)
    return Along(balance, may_be_missing(system, balance, rows, job.settings), stretches)


def _same_way(first: Solution, t: np.ndarray, kinetic: np.ndarray) -> bool:
    """Whether a run at more instants has the kinetic energies of the run itself, as it has unless output decides what steps see."""
    at = np.minimum(np.searchsorted(t, first.time), len(t) - 1)
    own = first["energy.kinetic"]
    return bool(np.nanmax(np.abs(own - kinetic[at])) <= SAME_ENERGY * np.nanmax(own, initial=0.0))


def _instants(job: Job, first: Solution, allowed: float) -> np.ndarray:
    """Output instants, ends of steps, and as many evenly spread besides as there is effort for."""
    reported_at, steps = first.time, first.step_times
    start, end = float(reported_at[0]), float(reported_at[-1])
    begun = job.evaluations()
    q, u = np.tile(job.start.q, (COUNTED, 1)), np.tile(job.start.u, (COUNTED, 1))
    job.dynamics.report(np.full(COUNTED, start), q, u, True)
    each = (job.evaluations() - begun) / COUNTED
    most = int(np.clip(allowed / each, 2, SAMPLES))
    found = np.union1d(reported_at, apart(steps[(steps > start) & (steps < end)], reported_at))
    spread = np.linspace(start, end, most)[1:-1]
    return np.union1d(found, apart(spread, found)) if most > 2 else found


def _stepped_over(job: Job, rows: OutputRows, steps: np.ndarray, allowed: float) -> Iterator[SteppedOver]:
    """The stretches that end elsewhere when they are solved again, the worst first."""
    system = job.dynamics.system
    poses = PosesOnTheWay(system, rows.t, rows.q)
    missing, speed = _momentum(system, rows)
    end, looked = job.evaluations() + allowed, np.zeros(len(missing), dtype=bool)
    for _ in range(STRETCHES):
        worst = int(np.argmax(np.where(looked, 0.0, missing), axis=0)) if len(missing) else 0
        if not len(missing) or looked[worst] or not missing[worst] > OPEN_BALANCE * speed:
            return
        left = end - job.evaluations()
        if left <= 0:
            return
        first, last = _stretch(rows.t, steps, worst)
        looked[first:last] = True
        width, element = float(rows.t[worst + 1] - rows.t[worst]), _acting(system, rows, worst)
        if not element or poses.nearest(float(rows.t[first]), float(rows.t[last])) is not None:
            continue  # where joints hold less than elsewhere, the way on is left to any difference
        off = _parted(job, rows, first, last, width, left / 2, MUCH * speed) / speed
        if off > ELSEWHERE:
            ends = float(rows.t[first]), float(rows.t[last])
            yield SteppedOver(*ends, float(rows.t[worst]), width, element, off)


def _momentum(system: System, rows: OutputRows) -> tuple[np.ndarray, float]:
    """By how much the velocities fail to change as the accelerations say, in each interval, and the largest velocity.

    Both as norms in the mass matrix; accelerations are integrated by the trapezoidal rule with end corrections.
    """
    t, u, a = rows.t, rows.u, rows.acceleration
    roots = np.sqrt(system.mass)
    speed = float(np.sqrt(2 * np.nanmax(rows.kinetic, initial=0.0)))
    if len(t) < 3 or not speed:
        return np.zeros(max(len(t) - 1, 0)), speed
    h = np.diff(t)[:, None]
    slope = np.gradient(a, t, axis=0)
    gained = h * (a[1:] + a[:-1]) / 2 + h**2 * (slope[:-1] - slope[1:]) / 12
    return np.nan_to_num(np.linalg.norm((np.diff(u, axis=0) - gained) * roots, axis=1)), speed


def _stretch(t: np.ndarray, steps: np.ndarray, k: int) -> tuple[int, int]:
    """From the last end of a step before an interval to the first after it, as places among the instants."""
    before, after = steps[steps < t[k]], steps[steps > t[k + 1]]
    first = int(np.searchsorted(t, before[-1])) if len(before) else 0
    last = int(np.searchsorted(t, after[0])) if len(after) else len(t) - 1
    return min(first, k), min(max(last, k + 1), len(t) - 1)


def _parted(job: Job, rows: OutputRows, first: int, last: int, width: float, allowed: float, much: float) -> float:
    """How far from the run's own velocities a stretch ends with short steps, as a norm in the mass matrix.

    0 where it does not end, or ends a little elsewhere with a tighter tolerance alone: then that is what it lacks.
    """
    roots = np.sqrt(job.dynamics.system.mass)
    short = _solved_again(job, rows, first, last, {"max_step": width / SHORTER}, allowed)
    if short is None:
        return 0.0
    off = float(np.linalg.norm((short - rows.u[last]) * roots))
    if off > much:
        return off
    tight = _solved_again(
        job, rows, first, last, {"rtol": max(STRETCH_TOLERANCE * job.settings.rtol, TIGHTEST_STRETCH)}, allowed
    )
    return off if tight is not None and np.linalg.norm((tight - short) * roots) > off / 2 else 0.0


def _solved_again(
    job: Job, rows: OutputRows, first: int, last: int, how: dict[str, Any], allowed: float
) -> np.ndarray | None:
    """The velocities at the end of a stretch that is solved in another way; None where it does not come to its end."""
    begin, end = float(rows.t[first]), float(rows.t[last])
    how |= EXPLICIT if traits_of(job.settings).switches else {}
    try:
        start = restarted(job.dynamics, begin, rows.q[first], rows.u[first])
        grid = Grid(begin, end, np.array([begin, end]))
        stretch = replace(job, settings=changed(job.settings, how), grid=grid, start=start, subsystems=())
        found = stretch.integrate(Deadline(begin, end, allowed, job.evaluations))
    except StiffmbsError:
        return None
    return found.u[-1] if found.outcome is Outcome.DONE else None


def _acting(system: System, rows: OutputRows, k: int) -> str:
    """The force, or the joint with a law, whose reaction changes most in an interval; empty where others change far more."""
    around = slice(max(k - 1, 0), k + 3)
    changes = {
        name: float(np.ptp(values))
        for name, values in reactions(system, rows.values[around]).items()
        if np.isfinite(values).all()
    }
    laws = {name for group in system.groups if not group.record.n_equations or group.has_law for name in group.names}
    of_laws = {name: much for name, much in changes.items() if name.rpartition(".")[0] in laws}
    name = max(of_laws, key=lambda each: of_laws[each], default="")
    return name.rpartition(".")[0] if name and of_laws[name] > SHARE * max(changes.values()) else ""
