"""Verification of a run by reruns, whose differences yield error bars and diagnostics.

1. The same solver at a hundredth of the tolerance (half the step of fixed-step schemes), with output at the first run's
   steps too.
2. The other integrator at a hundredth of the tolerance, as the errors of bdf and explicit steps are independent.
3. The same solver at an intermediate tolerance (a quarter of the step), if the other integrator gives no result or the
   first two differ. It shows the order of convergence.

All of these may miss events within one step. If the scene has force laws or events in the state, the run is therefore
searched for them (`stiffmbs.verification.missed_events`), and solved again with another longest step:

4. As 1, with several times as many steps, or with steps that resolve the events found by the search.

A scene with beams is solved once more with coarser beams, which shows the error of the discretisation
(`stiffmbs.analyses.beam_elements`).

The first rerun uses a hundredth, as at a tenth of the tolerance bdf's error may decrease only slightly. The effort is
counted in evaluations of the equations, independent of the load of the machine. Reruns that were not made are reported.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Unpack

import numpy as np

from ..analyses.errors import recording, to_accuracy
from ..analyses.job import Job, Runnable, data_of, prepare, with_elements
from ..analyses.run import run as simulated
from ..analyses.run import solved
from ..analyses.start_from import StartFrom
from ..compile.machine.routines import fully_compiled
from ..model.scene import Scene
from ..model.settings import RunSettings, Settings, takes_settings
from ..results.error_bars import UNKNOWN, error_bar
from ..results.scales import scales
from ..results.solution import Solution
from ..results.verification_words import INTERRUPTED, KINEMATIC, RERUN
from ..solve.settings import changed, traits_of
from ..solve.trajectory import Outcome, ProgressCallback
from ..tuning import in_use
from .diagnostics import STEPPED_OVER, STEPS_MISS, Comparison, diagnostics, distance, divergence, step_diagnostics
from .missed_events import Along, DenseSamples, dense_samples, looked_along, more_instants
from .parameters import VERIFICATION
from .solve_again import Again, levels_of, other_integrators, shorter_step, solve_again, tolerances


@takes_settings
@fully_compiled()
def verify(
    model: Runnable,
    settings: RunSettings | None = None,
    watch: ProgressCallback | None = None,
    start_from: StartFrom | None = None,
    **changes: Unpack[Settings],
) -> Solution:
    """Solve a model, and verify the results by reruns; parameters and errors as for `run`.

    Returns
    -------
    Solution
        As returned by `run`, with `errors` (the bars of each channel), `verification` (the reruns) and further `notes`
        on doubtful results.
    """
    data = with_elements(data_of(model), lambda scene: simulated(scene, settings, None, start_from, **changes))
    job = prepare(data, settings, start_from, **changes)
    job, first = to_accuracy(recording(job), watch) if job.settings.accuracy else (job, solved(job, watch))
    if len(first.time) < 2:
        return replace(first, verification=("not verified: the run has no results",))
    if first.outcome is Outcome.INTERRUPTED:
        return replace(first, verification=("not verified: interrupted by the user",))
    try:
        with in_use(job.settings.tuning):
            system = job.dynamics.system
            least = VERIFICATION.effort_allowed / (system.n_q + system.n_u + system.n_c)
            found = verified(job, first, max(least, VERIFICATION.most_effort * job.evaluations()))
        return with_discretisation(job, found)
    except KeyboardInterrupt:
        return replace(first, verification=(INTERRUPTED,))


def with_discretisation(job: Job, found: Solution) -> Solution:
    """Return the results of a job with the estimated discretisation errors of its beams."""
    if not isinstance(job.data, Scene) or not job.data.beams.divided:
        return found
    from ..analyses.beam_elements import discretisation

    def solve(scene: Scene) -> Solution:
        other = prepare(scene, job.settings, job.start_from)
        return solved(other.varied(times=found.time))

    errors, sentence = discretisation(job.data, found, solve)
    return replace(found, discretisation=errors, verification=(*found.verification, sentence))


@np.errstate(all="ignore")  # as for `solved`
def verified(job: Job, first: Solution, allowed: float) -> Solution:
    """Return the result of `verify` for a job that was solved already.

    `first`: of the job, with at least two output times. `allowed`: evaluations of the job's equations for all reruns.
    """
    with in_use(job.settings.tuning):
        return _Verification(job, first, allowed).result()


def _sizes(job: Job, first: Solution) -> dict[str, float]:
    """Return the sizes of the channels; that of a rate of a state is at least a part of the state over the duration."""
    gravity, time = float(np.linalg.norm(job.data.gravity)), float(np.ptp(first.time))
    found = scales(first.channels, job.dynamics.system.size, first.requested, gravity)
    for state in job.dynamics.system.states:
        if f"{state}.rate" in found:
            least = VERIFICATION.of_state * float(np.nanmax(np.abs(first[state]), initial=0.0)) / time
            found[f"{state}.rate"] = max(found[f"{state}.rate"], least)
    return found


class _Verification:
    """Reruns with which one run is compared."""

    def __init__(self, job: Job, first: Solution, allowed: float) -> None:
        self._job, self._first = job, first
        self._begun, self._allowed = job.evaluations(), allowed
        self._sizes = _sizes(job, first)
        self._traits = traits_of(job.settings)
        self._exact = self._traits.exact
        self._dense: DenseSamples | None = None
        self._tighter: dict[int, Again] = {}
        self._other: Again | None = None
        self._other_settings: dict[str, object] = {}
        self._along = Along()
        self._shorter: Again | None = None
        self._max_steps: list[float] = []
        self._skipped: list[str] = []

    def result(self) -> Solution:
        """Return the first run with error bars, notes and a list of reruns.

        Raises KeyboardInterrupt before the end of the first rerun: the run is then not verified.
        """
        try:
            self._solve()
        except KeyboardInterrupt:
            if not self._completed():
                raise
            self._skipped.append(INTERRUPTED)
        comparison = self._comparison()
        of_steps = tuple(step_diagnostics(comparison, self._along, self._shorter))
        steps_decide = any(note.kind in (STEPPED_OVER.name, STEPS_MISS.name) for note in of_steps)
        messages = () if steps_decide else diagnostics(comparison)  # their only remedy is the tolerance
        return replace(
            self._first, errors=comparison.bars, verification=tuple(self._messages()),
            notes=(*self._first.notes, *messages, *of_steps),
        )  # fmt: skip

    def _solve(self) -> None:
        self._sample_densely()
        if self._exact:
            return
        self._ask_the_other()
        if self._other is None or not self._other.whole or self._comparison().suspicious:
            self._tighten()
        self._look_along()

    def _look_along(self) -> None:
        """Search the first run for missed events, and rerun with shorter steps, if there may be some."""
        if self._traits.fixed_steps or not self._job.dynamics.system.has_laws:
            return
        spare = self._allowed / 2
        self._along = looked_along(self._job, self._first, spare)
        self._max_steps.append(self._along.max_step)
        if self._along.obstacle:
            self._skipped.append(self._along.obstacle)
        elif not self._along.missed:
            self._look_along_others(spare)
        longest = min(shorter_step(self._first), *self._max_steps)
        name, changes = self._tighter_settings(self._levels()[0])
        name = f"{name} with steps of at most {longest:.3g} s"
        self._shorter = self._again(name, {**changes, "max_step": longest}, spare)

    def _look_along_others(self, allowed: float) -> None:
        """Search runs that diverge from the first, to exclude those that missed events."""
        for level, run in self._tighter.items():
            self._tighter[level] = self._looked_along(run, self._tighter_settings(level)[1], allowed)
        if self._other is not None and self._other.usable:
            self._other = self._looked_along(self._other, self._other_settings, allowed)
        if self._dense is not None and any(run.blind for run in self._tighter.values()):
            self._dense = None

    def _looked_along(self, run: Again, changes: dict[str, object], allowed: float) -> Again:
        """Return a run with a note on an event that its steps missed."""
        if run.solution is None or run.obstacle:
            return run
        if divergence(self._first.time, distance(self._first.channels, run.channels, self._sizes)) is None:
            return run
        found = looked_along(self._job.varied(changes), run.solution, allowed)
        self._max_steps.append(found.max_step)
        if not found.missed:
            return run
        whose = f"'{found.missed.element}'" if found.missed.element else "something"
        return replace(
            run, blind=f"its steps missed {whose} at t = {found.missed.times[0]:.6g} s, which this run located"
        )

    def _sample_densely(self) -> None:
        """Make the first tighter run, with times between those of the output; the next one if it stops early."""
        start, end = float(self._first.time[0]), float(self._first.time[-1])
        times = more_instants(self._first, self._job.dynamics.input_features(start, end))
        for level in self._levels():
            run = self._run(level, times)
            self._dense = dense_samples(self._job, run, self._sizes)
            if not run.obstacle:
                return

    def _tighten(self) -> None:
        """Make the next tighter run."""
        for level in self._levels():
            if level not in self._tighter:
                self._run(level)
                return

    def _again(self, name: str, changes: dict[str, object], allowed: float, times: np.ndarray | None = None) -> Again:
        """Return a rerun with the output times of the first run, or with more."""
        times = self._first.time if times is None else times
        return solve_again(self._job, name, changes, times, np.searchsorted(times, self._first.time), allowed)

    def _run(self, level: int, times: np.ndarray | None = None) -> Again:
        """Make a tighter run, with the output times of the first run or with more."""
        name, changes = self._tighter_settings(level)
        run = self._again(name, changes, self._left(), times)
        if not self._exact:
            self._tighter[level] = run
        return run

    def _levels(self) -> tuple[int, ...]:
        """Return the levels of tighter runs, in powers of ten of the tolerance or two of the step, in order of use."""
        settings = self._job.settings
        if self._exact:
            return (1,)
        return (1, 2) if self._traits.fixed_steps else levels_of(settings.rtol)

    def _tighter_settings(self, level: int) -> tuple[str, dict[str, object]]:
        settings = self._job.settings
        if self._exact:
            return "kinematic between the output times", {}
        if self._traits.fixed_steps:
            step = settings.step / 2**level
            return f"{self._traits.name} with steps of {step:.3g} s", {"step": step}
        changes = tolerances(settings, level)
        return f"{self._traits.name} at rtol {changes['rtol']:.3g}", changes

    def _ask_the_other(self) -> None:
        settings = self._job.settings
        tighter = {"rtol": VERIFICATION.other_of_fixed} if self._traits.fixed_steps else tolerances(settings, 2)
        for integrator in other_integrators(self._first, settings):
            changes = self._other_settings = {**integrator, **tighter}
            name = f"{traits_of(changed(settings, changes)).name} at rtol {changes['rtol']:.3g}"
            self._other = self._again(name, changes, self._left())
            if self._other.whole:
                return

    def _left(self) -> float:
        return self._allowed - (self._job.evaluations() - self._begun)

    def _comparison(self) -> Comparison:
        levels = [self._tighter[level] for level in sorted(self._tighter)]
        tighter = tuple(run for run in levels if run.solution is not None and not run.blind)
        other, shorter = (run if run and run.usable else None for run in (self._other, self._shorter))
        lost = self._along.missed and not (shorter and shorter.whole)
        runs = [run for run in (*tighter, other, shorter) if run]
        bars = {}
        for name, values in self._first.items():
            if name not in self._first.not_unique and not name.startswith("constraint."):
                others, fine = [run.reported(name) for run in runs], self._dense.fine(name) if self._dense else None
                rounding = VERIFICATION.tightest_rtol * self._sizes[name]
                bars[name] = UNKNOWN if lost else error_bar(values, others, fine, rounding)
        return Comparison(self._job, self._first, tighter, other, self._dense, bars, self._sizes)

    def _reruns(self) -> list[Again]:
        return [run for run in (*self._tighter.values(), self._other, self._shorter) if run is not None]

    def _completed(self) -> list[str]:
        """Return the names of the completed reruns."""
        return [
            run.name
            for run in self._reruns()
            if not run.obstacle and not run.blind and (run is not self._other or run.usable)
        ]

    def _messages(self) -> list[str]:
        runs, done = self._reruns(), self._completed()
        found = [f"{RERUN} {' and '.join(done)}"] if done else []
        if self._exact:
            found = [KINEMATIC]
        found += [f"{run.name}: {run.obstacle}" for run in runs if run.obstacle]
        found += [f"{run.name}, not counted: {run.blind}" for run in runs if run.blind]
        if self._other is not None and self._other.remark:
            found.append(f"{self._other.name}, not counted: {self._other.remark}")
        if self._dense is None:
            found.append("peaks between the output times are unknown")
        elif self._dense.singular:
            found.append(
                f"at t = {self._dense.singular[0]:.6g} s the pose is singular: accelerations and reactions have no value "
                "there, and their peaks are those of other times"
            )
        return [*found, *self._skipped]
