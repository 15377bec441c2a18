"""Run time against error of solvers, schemes and formulations, for any model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

from ..analyses.job import Runnable, data_of
from ..compile.machine.routines import fully_compiled
from ..errors import InputError
from ..model.settings import RunSettings, Settings, takes_settings
from .at_error import AtError, Row, decades, times_at
from .plan import LONGER_REFERENCE, LONGEST_RUN, REPEATS, TOLERANCES, USUAL, Entry, Plan, Values, base_settings, plan_of
from .reference import Reference, Tell, reference
from .sweep import Point, Sweep, take_turns

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


@dataclass(frozen=True, repr=False)
class Comparison:
    """Comparison of solvers on a model.

    Attributes
    ----------
    name : str
    measure : str
        Measure of errors: ``positions`` (m, rad), ``velocities`` or ``forces``.
    rows : tuple of Row
        Measurements for each solver entry and each setting.
    at_errors : tuple of AtError
        Times at equal errors, powers of ten from the largest on.
    reference : Reference
    entries : tuple of Entry
        Compared solvers, with schemes and formulations.
    interrupted : bool
        True if the user ended it early.
    """

    name: str
    measure: str
    rows: tuple[Row, ...]
    at_errors: tuple[AtError, ...]
    reference: Reference
    entries: tuple[Entry, ...]
    interrupted: bool

    @property
    def conclusion(self) -> str:
        """Return a sentence on the fastest solver at each error."""
        from .words import conclusion

        return conclusion(self)

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs compare --json``; `scene` is the file or name of the scene."""
        return {
            "scene": scene, "measure": self.measure, "rows": [row.as_dict(self.measure) for row in self.rows],
            "errors": {name: [row.errors.get(name) for row in self.rows] for name in self.reference.agreement},
            "at_errors": [at.as_dict() for at in self.at_errors],
            "reference": {"by": list(self.reference.names), "agreement": dict(self.reference.agreement)},
            "not_compared": list(self.reference.left_out), "conclusion": self.conclusion, "interrupted": self.interrupted,
        }  # fmt: skip

    def plot(self) -> Sheet:
        """Plot time against error, both logarithmic, as a figure of matplotlib."""
        from .figure import work_precision

        return work_precision(self)

    def __repr__(self) -> str:
        from .table import text

        return text(self)


@takes_settings
@fully_compiled()
def compare(
    model: Runnable,
    solvers: Sequence[str] = USUAL,
    formulations: Sequence[str] = (),
    tolerances: Values = TOLERANCES,
    steps: Values | None = None,
    measure: str = "positions",
    repeats: int = REPEATS,
    longest: float = LONGEST_RUN,
    settings: RunSettings | None = None,
    tell: Tell | None = None,
    **changes: Unpack[Settings],
) -> Comparison:
    """Measure run time against error of solvers on a model.

    The reference is a motion on which bdf and dop853, both at a relative tolerance of 1e-12, agree.  Times are medians
    of the processor time of the integration alone; all solvers take turns.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    solvers : sequence of str
        ``bdf``, ``auto``, ``kinematic``, ``dop853``, ``dopri5``, ``rk4``, ``euler_cromer``, or ``all``.
    formulations : sequence of str
        Formulations of bdf to compare: ``SI2``, ``SI1``, ``I3``, ...
    tolerances : sequence of float, Range or str
        Relative tolerances, such as ``"1e-3:1e-8:11:log"``; without a count there are four per decade.
    steps : sequence of float, Range or str, optional
        Steps of the schemes with fixed steps, s; by default parts of the duration.
    measure : str
        Measure of the error, the largest over all output instants: ``positions`` (m or rad, of all bodies),
        ``velocities`` (m/s or rad/s), or ``forces`` (N or N m, of joints and forces that are unique).
    repeats : int
        Number of timings of each run; runs longer than 0.2 s are timed once.
    longest : float
        Time limit of a run, s; each run of the reference may take ten times as long.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    tell : callable, optional
        Called with a line of text on the progress.
    **changes
        Fields of the settings to change.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        If there is no reference: the two integrators disagree, or one does not reach the end.
    """
    data = data_of(model)
    plan = plan_of(solvers, formulations, tolerances, steps, measure, repeats, longest)
    base = base_settings(data, settings, changes)
    entries = plan.entries(base)
    tell = tell or (lambda line: None)
    exact = reference(data, base, LONGER_REFERENCE * plan.longest, tell)
    refuse_unmeasured(plan, exact)
    sweep = Sweep(data, base, exact, plan.longest, tell)
    swept = (point for entry in entries for point in sweep.points(entry, plan.values(entry, base)))
    points, interrupted = measured(swept, plan, tell)
    rows = tuple(point.row() for point in points)
    resolved = exact.resolved(measure)
    found = list(times_at(rows, measure, resolved, decades(rows, measure, resolved)))
    at_errors = [at for at in found if len(at.better) < len(at.seconds)] or found[:1]
    return Comparison(data.name, measure, rows, tuple(at_errors), exact, entries, interrupted)


def measured(swept: Iterator[Point], plan: Plan, tell: Tell) -> tuple[list[Point], bool]:
    """Return points with their times, and True if the user ended this early.

    Raises KeyboardInterrupt if the user ends it before there is any point.
    """
    points: list[Point] = []
    try:
        points.extend(swept)
        take_turns(points, _reported(plan.repeats, tell))
    except KeyboardInterrupt:
        if not points:
            raise
        return points, True
    return points, False


def _reported(repeats: int, tell: Tell) -> Iterator[int]:
    for k in range(repeats):
        tell(f"timing, round {k + 1} of {repeats}")
        yield k


def refuse_unmeasured(plan: Plan, exact: Reference) -> None:
    """Reject a measure without values to compare."""
    if plan.measure not in exact.agreement:
        raise InputError(
            f"measure: found '{plan.measure}', of which nothing can be compared, expected one of {', '.join(exact.agreement)}"
            + "".join(f"; {note}" for note in exact.notes)
        )
