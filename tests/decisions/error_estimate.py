"""Decisions of the estimate of the errors of a run."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np

from stiffmbs.analyses import errors as of_runs
from stiffmbs.analyses.job import prepare
from stiffmbs.error_estimate import along_run, defects, estimate, grazed, kinks, restarts, transport
from stiffmbs.error_estimate.accuracy import Accuracy
from stiffmbs.error_estimate.evaluated import evaluated
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.settings import RunSettings
from stiffmbs.results.error_bars import ErrorBar, bars_by_difference
from stiffmbs.solve.radau.collocation import radau
from stiffmbs.solve.recorded_steps import Piece, StepRecorder
from stiffmbs.tuning import changed_values
from tests.decisions.common import Record
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

SCENE = "{bodies: {a: {mass: 1, inertia: 1}}}"


def shift_of_time():
    """Return the shift of time by which a motion is seen to depend on time itself."""
    dynamics = prepare(read_scene(SCENE)).dynamics
    at, times = evaluated(dynamics, np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3))), []

    def noted(_, t, *states):
        times.append(t[0])
        return evaluated(dynamics, t, *states)

    with patch.object(restarts, "evaluated", noted):
        restarts.autonomous(dynamics, at)
    return max(times)


def piece(h):
    """Return a piece with one coordinate and steps of given lengths, the last of which is judged."""
    t = np.append(0.0, np.cumsum(h))
    zeros = np.zeros((len(t), 1))
    return Piece(t, zeros, zeros, 1, ())


def points(h):
    """Return the points of a free body at rest and steps of given lengths."""
    t = np.append(0.0, np.cumsum(h))
    zeros, system = np.zeros((len(t), 6)), prepare(read_scene(SCENE)).dynamics.system
    return defects.Points(system, 1, t, zeros, zeros, np.ones(6))


def degree(h):
    """Return the degree of the curve through recorded states in the last step, 3 of its ends alone."""
    states = np.random.default_rng(0).random((len(h) + 1, 6))
    curve, _ = defects.curve_of_bdf(replace(points(h), states=states), np.arange(len(h) + 1))
    return np.flatnonzero(curve.coefficients[-1].any(axis=1))[-1]


def transport_of(count):
    """Return the number of steps in memory at once, and the tolerance, of a transport over a number of points."""
    dynamics, given = prepare(read_scene(SCENE)).dynamics, []
    at = evaluated(dynamics, np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)))
    with patch.object(transport, "Stages", lambda *of: given.append(of[-1])):
        found = transport.Transport(dynamics, at)
        found._of(count)
    return found._parts(np.zeros((1, count, 6)))[0].stop, given[0]


def is_smooth(error, kinks_of_100=1):
    """Return True if points serve to integrate rates whose coefficients do not decay in some of 100 steps, next to defects of 1."""
    rates = (
        np.polynomial.legendre.legval(2.0 * radau(9).nodes - 1.0, [error] * 9)
        * (np.arange(100) < kinks_of_100)[:, None]
    )
    return not kinks.not_smooth(rates[..., None], np.ones(100), np.ones((100, 9, 1)))[0].any()


def intervals():
    """Return the number of intervals into which a step is divided for rates that are not smooth anywhere."""
    calls = []

    def noise(t, q, u):
        calls.append(len(t))
        return 1e9 * np.sin(1e9 * t)[:, None] * np.ones(6)

    rates, of = np.zeros((16, 3, 6)), replace(points(np.ones(48)), points=3)
    rates[10] = 1.0
    along_run._with_large_errors(
        of,
        rates,
        lambda _, rates: rates,
        lambda ends: ends[:, None],
        lambda steps: (rates[steps], np.zeros(len(steps), dtype=bool)),
        noise,
    )
    return calls[-1] // len(kinks.GAUSS_NODES)


def is_missed(distance):
    """Return True if a run that stays at a distance from a stop may miss its force, for errors of 1."""
    scene = "{bodies: {a: {mass: 1, inertia: 1}}, forces: {stop: {type: force, i: a, force: ['max(-a.x, 0)', 0]}}}"
    dynamics, t, fixed = prepare(read_scene(scene)).dynamics, np.linspace(-1.0, 1.0, 5), np.zeros((5, 2))
    q, u = np.column_stack([distance + t**2, fixed]), np.column_stack([2.0 * t, fixed])
    errors = np.zeros((5, 6))
    errors[:, 0] = 1.0
    return len(grazed.missed_forces(dynamics, evaluated(dynamics, t, q, u), errors)[0]) > 0


def is_lost(error):
    system = Record(n_pose=1, of_body=Record(dimensions=2), size=1.0, per_velocity=lambda *_: np.ones(1))
    return along_run._are_lost(system, np.zeros((1, 1)), np.array([[error]])).any()


def noted(group, error):
    known = Record(relative=lambda _: {"a.x": error}, group={"a.x": group}, sizes={"a.x": np.inf})
    solution = Record(errors={"a.x": ErrorBar(error, 0.0, 0.0, 0.0, 0.0)}, unit=lambda _: "m")
    return bool(list(estimate._large_errors(solution, known, RunSettings(), 1.0)))


def runs_for_an_accuracy():
    """Return the number of runs for an accuracy that none reaches."""
    job = replace(prepare(read_scene(SCENE)), settings=RunSettings(accuracy={"forces": "1 %"}))
    made = []
    outcome = Record(success=True, estimate=Record(sentence="", status="estimated"), notes=())

    def solved(job, watch):
        made.append(job)
        return outcome

    judging = Record(
        first_rtol=lambda size: 1e-3,
        judged=lambda solution, rtol: Record(reached=False, next_rtol=0.5 * rtol, sentence=""),
    )
    with (
        patch("stiffmbs.analyses.run.solved", solved),
        patch("stiffmbs.error_estimate.accuracy.Accuracy", lambda asked: judging),
        patch.object(of_runs, "replace", lambda thing, **changes: thing),
    ):
        of_runs.to_accuracy(job, None)
    return len(made)


def next_rtol(excess, rtol=1e-4):
    return Accuracy({"forces": "1 %"})._following(rtol, excess)


def restarts_that_are_kept():
    """Return the number of restarts after which the recorded steps are too much work."""
    job = of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values()))
    recorder, restarts = StepRecorder(job.grid.recorded._replace(most=5e5)), 0
    while not recorder.full:
        recorder.begin(np.zeros(4))
        restarts += 1
    return restarts


def events_that_are_free():
    """Return the number of restarts after events that add no work."""
    recorder = StepRecorder(of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded)
    recorder.begin(np.zeros(4))
    work, restarts = recorder._work, 0
    while recorder._work == work:
        recorder.extend(np.empty((0, 4)), (0,))
        recorder.begin(np.zeros(4))
        restarts += 1
    return restarts


def step_at_an_event(length):
    """Return True if the jump in a step of this length between steps of 1 s is that of an event, and no error."""
    t, own, other = np.array([0.0, 1.0, 1.0 + length, 2.0 + length]), [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]
    channels = [{"f": np.array(values)} for values in (own, other)]
    bars = bars_by_difference(t, np.arange(4), *channels, 0.0, np.empty(0), 1000, of_runs.ESTIMATE.close)
    return bars["f"].over_time < 0.5


def part_in_shared_steps():
    """Return the steps of 10000, taken by a second run too, up to which that gives the errors."""
    ends = np.linspace(0.0, 1.0, 10_001)

    def gives_errors(count):
        own, shared = ends[1:], ends[1 : count + 1]
        others = np.concatenate([shared, np.linspace(ends[count], 1.0, 20_001)[1:]])
        runs = [Record(t=np.zeros(1), step_times=each, statistics={"steps": len(each)}) for each in (own, others)]
        return of_runs._takes_other_steps(*runs, 0.1, of_runs._shared(*runs))

    return count_while(gives_errors, range(100, 2000, 100))


DECISIONS = {
    "error_estimate.events": events_that_are_free,
    "error_estimate.work": lambda: of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded.most,
    "error_estimate.difference": shift_of_time,
    "error_estimate.beside": lambda: along_run._away_from_events(np.arange(10_001.0), piece(np.ones(10_000)), True)[0],
    "error_estimate.close": lambda: count_while(lambda length: step_at_an_event(1e-5 * length), DOUBLES),
    "error_estimate.points": lambda: 1 + degree(np.ones(20)),
    "error_estimate.uneven": lambda: count_while(lambda ratio: degree(np.append(np.ones(20), ratio)) > 3, DOUBLES),
    "error_estimate.smooth": lambda: count_while(lambda part: is_smooth(1e-3 * part), DOUBLES),
    "error_estimate.intervals": intervals,
    "error_estimate.isolated": lambda: count_while(lambda count: not is_smooth(1.0, count), range(1, 101)),
    "error_estimate.row": lambda: of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded.row,
    "error_estimate.uncertain": lambda: count_while(lambda part: is_missed(1.0 + 1e-3 * part), DOUBLES),
    "error_estimate.lost": lambda: count_while(lambda error: not is_lost(1e-3 * error), DOUBLES),
    "error_estimate.tolerances": lambda: count_while(lambda error: not noted("positions", 1e-6 * error), DOUBLES),
    "error_estimate.large": lambda: count_while(lambda error: not noted("forces", 1e-4 * error), DOUBLES),
    "error_estimate.part": lambda: Accuracy({"forces": "1 %"}).first_rtol(1.0),
    "error_estimate.smallest_rtol": lambda: Accuracy({"forces": "1e-20 %"}).first_rtol(1.0),
    "error_estimate.aim": lambda: next_rtol(100.0),
    "error_estimate.slope": lambda: next_rtol(100.0),
    "error_estimate.numbers_at_once": lambda: transport_of(3)[0],
    "error_estimate.converged": lambda: transport_of(3)[1],
    "error_estimate.solution": lambda: of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded.solution,
    "error_estimate.second": lambda: of_runs._part_of_second(1e-6),
    "error_estimate.shared": part_in_shared_steps,
    "error_estimate.restart": restarts_that_are_kept,
    "analyses.errors:MOST_REPEATS": runs_for_an_accuracy,
}  # fmt: skip
EXPECTED = {
    "error_estimate.events": 101, "error_estimate.work": 1e6,
    "error_estimate.difference": 1e-07,
    "error_estimate.beside": 10, "error_estimate.close": 40, "error_estimate.points": 6,
    "error_estimate.uneven": 14,
    "error_estimate.uncertain": 20,
    "error_estimate.lost": 23,
    "error_estimate.tolerances": 27,
    "error_estimate.large": 27,
    "error_estimate.part": 0.0001,
    "error_estimate.smallest_rtol": 1e-13,
    "error_estimate.aim": 8.549879733383488e-08,
    "error_estimate.slope": 8.549879733383488e-08,
    "error_estimate.numbers_at_once": 111111,
    "error_estimate.converged": 1e-04,
    "error_estimate.solution": 2.0,
    "error_estimate.second": 0.1,
    "error_estimate.shared": 5, "error_estimate.restart": 21,
    "error_estimate.row": 50.0,
    "error_estimate.smooth": 27,
    "error_estimate.intervals": 48,
    "error_estimate.isolated": 25,
    "analyses.errors:MOST_REPEATS": 3,
}  # fmt: skip
