"""Decisions of the estimate of the errors of a run."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np

from stiffmbs.analyses import errors as of_runs
from stiffmbs.analyses.job import prepare
from stiffmbs.error_estimate import along_run, defects, estimate, interpolated, kinks, linearised, transport, vibrations
from stiffmbs.error_estimate.accuracy import Accuracy
from stiffmbs.error_estimate.along_run import _Prepared
from stiffmbs.error_estimate.evaluated import evaluated
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.settings import RunSettings
from stiffmbs.results.error_bars import ErrorBar
from stiffmbs.solve.radau.collocation import radau
from stiffmbs.solve.recorded_steps import Piece, StepRecorder
from stiffmbs.tuning import changed_values
from tests.decisions.common import Record
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

SCENE = "{bodies: {a: {mass: 1, inertia: 1}}}"


def largest_displacement():
    """Return the displacement by which a free body is linearised."""
    dynamics = prepare(read_scene(SCENE)).dynamics
    at = evaluated(dynamics, np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3)))
    moved = []

    def noted(*states):
        moved.append(np.abs(states[2]).max())
        return evaluated(*states)

    with patch.object(linearised, "evaluated", noted):
        linearised.linearised(dynamics, at, 0.0)
    return moved[0]


def piece(h):
    """Return a piece with one coordinate and steps of given lengths, the last of which is judged."""
    t = np.append(0.0, np.cumsum(h))
    zeros = np.zeros((len(t), 1))
    return Piece(t, zeros, zeros, zeros, zeros, np.ones(len(t), dtype=int), 1, ())


def row_beside_an_event():
    """Return the row of 10,000 equal steps after an event at which the first state is linearised."""
    prepared = _Prepared(piece(np.ones(10_000)), None, None, None, [], np.zeros(0), True)
    return prepared.within(np.zeros(1, dtype=int))[0]


def windows(h):
    """Return the numbers of points of the polynomials, and the steps whose formulas give the defects."""
    widths, by_formula = [], []

    def noted(nodes, at):
        widths.append(nodes.shape[1])
        return np.zeros(nodes.shape)

    rates = Record(
        states=np.zeros((len(h) + 1, 2)), width=2, changes=lambda change: change, defects=lambda change, _: change
    )
    with (
        patch.object(defects, "slope_weights", noted),
        patch.object(defects, "_of_formula", lambda *asked: by_formula.append(asked[2]) or np.zeros(2)),
    ):
        defects.of_bdf(piece(h), rates, False)
    return widths, by_formula


def turning(rate):
    """Return the tangent spaces of 100 states of a vibration of a given angular frequency."""
    one = np.broadcast_to(np.eye(2), (100, 2, 2))
    return linearised.Linearised(one, rate * one @ np.array([[0.0, 1.0], [-1.0, 0.0]]), one)


def is_resolved(rate):
    t = np.arange(100.0)
    block = transport.Block(np.array([0, 99]), np.zeros(0), np.array([99.0]))
    return vibrations.are_resolved(turning(rate), t, np.arange(100), [block]).all()


def spectra():
    made = []
    with patch.object(np.linalg, "eigvals", lambda m: made.append(len(m)) or np.zeros(m.shape[:2])):
        is_resolved(1.0)
    return made[0]


def is_interpolated(curvature):
    """Return True if a matrix M of a' = M a, zero at the ends of an interval of 1 s and small in its middle, is interpolated."""
    one, rates = np.ones((3, 1, 1, 1)), np.zeros((3, 1, 1, 1))
    rates[1] = -curvature
    return interpolated._are_on_a_line(one, rates, one[0], np.array([[0.0], [0.5], [1.0]]), 0)[0]


def linearised_nodes():
    """Return the number of states, of 97 with the same matrices, at which equations are linearised."""
    at = Record(t=np.arange(97.0), at=lambda chosen: chosen)

    def constant(dynamics, chosen, reach):
        return linearised.Linearised(*3 * [np.ones((len(chosen), 1, 1))])

    with patch.object(interpolated, "linearised", constant):
        dynamics = Record(system=Record(n_pose=1))
        return interpolated.linearised_along(dynamics, at, np.zeros(1, dtype=int), 0.0).computed.sum()


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
        return np.sin(1e9 * t)[:, None]

    t, zeros = np.arange(17.0), np.zeros((17, 1))
    rates = Record(states=zeros, exact=zeros, typical=np.ones(1), changes_in=lambda rows: np.zeros((1, 1, 1)))
    defects = np.append(np.zeros(10), np.append(1.0, np.zeros(6)))[:, None]
    piece = Piece(t, zeros, zeros, zeros, zeros, t, 1, ())
    along_run._resolve_kinks(piece, rates, defects, defects.copy(), noise)
    return calls[-1] // len(kinks.GAUSS_NODES)


def is_near(distance):
    """Return True if the ends of steps are near enough to Radau nodes."""
    ends = transport.RADAU_NODES + np.array([distance, 0.0, 0.0])
    return len(transport._rows(np.append(0.0, ends), 0)) == 4


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


DECISIONS = {
    "error_estimate.work": lambda: of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded.most,
    "error_estimate.difference": largest_displacement,
    "error_estimate.beside": row_beside_an_event,
    "error_estimate.points": lambda: windows(np.ones(20))[0][0],
    "error_estimate.uneven": lambda: count_while(lambda ratio: not windows(np.append(np.ones(20), ratio))[1], DOUBLES),
    "error_estimate.block": lambda: transport._rows(np.arange(100.0), 0)[-1],
    "error_estimate.spectra": spectra,
    "error_estimate.resolved": lambda: count_while(lambda rate: not is_resolved(0.25 * rate), DOUBLES),
    "error_estimate.turn": lambda: count_while(lambda rate: is_resolved(1e-2 * rate), DOUBLES),
    "error_estimate.operations": lambda: count_while(lambda steps: vibrations.are_affordable(1e3 * steps, 10), DOUBLES),
    "error_estimate.apart": linearised_nodes,
    "error_estimate.interpolated": lambda: count_while(lambda part: is_interpolated(1e-4 * part), DOUBLES),
    "error_estimate.smooth": lambda: count_while(lambda part: is_smooth(1e-3 * part), DOUBLES),
    "error_estimate.intervals": intervals,
    "error_estimate.isolated": lambda: count_while(lambda count: not is_smooth(1.0, count), range(1, 101)),
    "error_estimate.row": lambda: of_runs.recording(prepare(read_scene(SCENE), tuning=changed_values())).grid.recorded.row,
    "error_estimate.off_node": lambda: count_while(lambda part: is_near(1e-3 * part), DOUBLES),
    "error_estimate.lost": lambda: count_while(lambda error: not is_lost(1e-3 * error), DOUBLES),
    "error_estimate.tolerances": lambda: count_while(lambda error: not noted("positions", 1e-6 * error), DOUBLES),
    "error_estimate.large": lambda: count_while(lambda error: not noted("forces", 1e-4 * error), DOUBLES),
    "error_estimate.part": lambda: Accuracy({"forces": "1 %"}).first_rtol(1.0),
    "error_estimate.smallest_rtol": lambda: Accuracy({"forces": "1e-20 %"}).first_rtol(1.0),
    "error_estimate.aim": lambda: next_rtol(100.0),
    "error_estimate.slope": lambda: next_rtol(100.0),
    "error_estimate.numbers_at_once": lambda: transport.at_once(100),
    "error_estimate.second": lambda: of_runs._part_of_second(1e-6),
    "error_estimate.restart": restarts_that_are_kept,
    "analyses.errors:MOST_REPEATS": runs_for_an_accuracy,
}  # fmt: skip
EXPECTED = {
    "error_estimate.work": 1e6,
    "error_estimate.difference": 1e-07,
    "error_estimate.beside": 10, "error_estimate.points": 6,
    "error_estimate.uneven": 14,
    "error_estimate.block": 8.0,
    "error_estimate.spectra": 16,
    "error_estimate.resolved": 9,
    "error_estimate.turn": 17,
    "error_estimate.operations": 54,
    "error_estimate.interpolated": 31,
    "error_estimate.off_node": 29,
    "error_estimate.lost": 23,
    "error_estimate.tolerances": 27,
    "error_estimate.large": 27,
    "error_estimate.part": 0.0001,
    "error_estimate.smallest_rtol": 1e-13,
    "error_estimate.aim": 8.549879733383488e-08,
    "error_estimate.slope": 8.549879733383488e-08,
    "error_estimate.numbers_at_once": 400,
    "error_estimate.second": 0.1,
    "error_estimate.restart": 21,
    "error_estimate.row": 500.0,
    "error_estimate.apart": 13,
    "error_estimate.smooth": 27,
    "error_estimate.intervals": 16,
    "error_estimate.isolated": 25,
    "analyses.errors:MOST_REPEATS": 3,
}  # fmt: skip
