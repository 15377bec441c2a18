"""Decisions on studies: cases, fits, sensitivities, co-simulation."""

from __future__ import annotations

from contextlib import nullcontext
from unittest.mock import Mock, patch

import numpy as np
import pytest

from stiffmbs.compile.inputs.features import NO_FEATURES
from stiffmbs.errors import SolverError
from stiffmbs.solve.trajectory import Grid, Outcome
from stiffmbs.studies import case_solver, executors, joint_pose, measured, optimise, simulation, stepping, varied_input
from stiffmbs.studies.fmu import build
from stiffmbs.studies.sensitivities import formulas
from tests.decisions.common import Record, executed, module, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

fit, follow, sweep = (module(f"studies.{name}") for name in ("fit", "follow", "sweep"))
sensitivities, of_parameters = (
    module(f"studies.sensitivities.{name}") for name in ("sensitivities", "parameters")
)  # fmt: skip


def raise_error(*_):
    raise SolverError(5000 * "a")


def kept_structures():
    solver = Record(_jobs=[Record(settings=None)] * 100, _settings=nothing)
    prepared = Record(settings=None, dynamics=Record(take_input_features=nothing))
    with patch.multiple(case_solver, prepare=lambda *_: prepared):
        for known in solver._jobs:
            known.dynamics = None
        case_solver.CaseSolver.job(solver, Record(run=None), 1)
    return len(solver._jobs)


def length_of_a_message():
    solver = Record(scene=nothing, job=raise_error, _task=Record(outputs=()), _files={})
    return len(case_solver.CaseSolver.row(solver, 0, ()).message)


def chunks_under_way():
    executor = Record(submit=lambda *_: Mock())
    with patch.object(executors, "wait", lambda under_way, **_: reach(len(under_way))):
        return reached(lambda: executors.rows_of(b"", iter(range(100)), executor, 1, nothing))


def attempts():
    submitted = []

    def submit(*_):
        submitted.append(Mock(result=Mock(side_effect=OSError)))
        return submitted[-1]

    with patch.multiple(
        executors, wait=lambda under_way, **_: (list(under_way), None), _ended=lambda _: SolverError("")
    ):
        assert refused(lambda: executors.rows_of(b"", iter(range(1)), Record(submit=submit), 1, nothing))
    return len(submitted)


def half_of_a_confidence_interval():
    """Return half of the confidence interval of a parameter with a standard error of 1 and many values."""
    one = np.ones((2, 1))
    model = Record(
        jacobian=lambda *_: one, residuals=lambda *_: np.ones(2), residual_rms=nothing, solution=nothing, runs=0
    )
    ranges = Record(names=("p",), values=lambda point: point, slopes=np.ones_like)
    result = Record(success=True, message="", active_mask=None)
    found = Record(covariance=np.eye(1), freedom=1e9)
    with patch.multiple(
        fit, of_common_noise=lambda *_: found, Fit=lambda *args: args[1]["p"][1], _at_bounds=lambda *_: ()
    ):
        return fit._concluded(model, ranges, np.zeros(1), {}, result, False)


def fitted(searched):
    """Fit two channels, with a function that searches the parameters."""
    model = Record(check=nothing, searched=searched, residual_rms=lambda _: {})
    with patch.multiple(
        fit, measured=lambda _: Record(channels=["a", "b"]), written_scene=nothing, _Model=lambda *_: model, _weights=nothing,
        parameter_ranges=lambda *_: Record(point=lambda _: np.zeros(1)), _concluded=lambda *_, **__: None,
    ):  # fmt: skip
        fit.fit(None, None, {})


def fits_with_other_weights():
    points = []
    fitted(lambda point, _: points.append(point) or Record(x=point))
    return len(points)


def residual_without_a_solution():
    model = Record(_data=Record(channels={"a": np.ones(1)}), differences=lambda _: None)
    return fit._Model.residuals(model, np.zeros(1), {})[0]


def largest_difference_of_times():
    slave = pytest.importorskip("stiffmbs.studies.fmu.slave")

    def accepts(apart):
        running = Record(t=1.0, step=nothing)
        return slave.SceneSlave.do_step(Record(_running=lambda: running, log=nothing, _inputs=None), 1.0 + apart, 0.1)

    return count_while(lambda apart: accepts(1e-11 * apart), DOUBLES)


def reports_of_a_run():
    """Return the number of reports of a run of 100 s, in which a report takes 1 s."""
    clock = [0.0]
    start = Record(q=np.zeros(1), u=np.zeros(1))
    dynamics = Record(input_features=lambda *_: NO_FEATURES)
    job = Record(grid=Grid(0.0, 100.0, np.arange(101.0)), start=start, dynamics=dynamics)
    found = Record(advance=lambda _: after(1.0), q=np.zeros(1), u=np.zeros(1), length=0.0)

    def after(seconds):
        clock[0] += seconds

    with patch.multiple(
        follow,
        stepper_of=lambda *_: found,
        solution_of=lambda *_, **__: after(1.0),
        time=Record(monotonic=lambda: clock[0]),
    ):
        return len([*follow._followed(job, 0.5)])


"""Car whose centre of mass is above its rear axle."""


def estimates_of_noise():
    inverses = []

    def inv(matrix):
        inverses.append(matrix)
        return 1 / matrix

    with patch.object(measured.np.linalg, "inv", inv):
        measured.of_separate_noise([np.ones((10, 1)), np.ones((20, 1))], [np.ones(10), np.ones(20)])
    return len(inverses) - 1


def step_of_differences():
    with patch.multiple(optimise, of_whole_time=lambda _: True, central_differences=lambda *args: reach(args[-1])):
        return reached(lambda: optimise._Model._slopes_at(Record(_texts=["x"], outputs=None), None))


def largest_difference_of_slopes():
    def accepts(more):
        formula = Record(text="", _time=np.zeros(2))
        slopes = np.array([[1.0], [1.0 + more]])
        with patch.object(formulas, "SELECTED", {"max": lambda _: [0, 1]}):
            return not refused(lambda: formulas.Formula._at_extreme(formula, "max", np.ones(2), slopes))

    return count_while(lambda more: accepts(1e-8 * more), DOUBLES)


def negligible_value():
    with patch.object(of_parameters, "_replaced", lambda *args: args[-1]):
        return of_parameters.Parameter.almost_zero(Record(_path="", _whole=None, _places=None))[1]


def step_of_a_parameter(value):
    found = of_parameters.Parameter.step
    return (found.fget if isinstance(found, property) else found)(Record(value=value))


def tolerance_of_sensitivities(rtol=1e-3):
    with patch.multiple(
        sensitivities,
        with_weights=lambda scenes, _: scenes,
        changed=lambda _, change: reach(change["rtol"]),
        prepare=nothing,
    ):
        return reached(lambda: sensitivities.differentiated(Record(known=None), (), Record(rtol=rtol)))


def longest_step_with_sensitivities():
    settings = Record(duration=1.0, max_step=None)
    with patch.multiple(sensitivities, changed=lambda _, change: change["max_step"], _solver=nothing):
        return sensitivities.differentiable(settings)


def longest_step_below_the_limit():
    def is_below(step):
        system = Record(sampled=np.zeros(0), states=())
        job = Record(
            dynamics=Record(system=system, forget_pivots=nothing), grid=None, start=None, settings=Record(max_step=1.0, tuning={})
        )  # fmt: skip
        recorder = Record(chatters=False, longest_step=step)
        run = object.__new__(sensitivities.DifferentiatedRun)
        with patch.multiple(
            sensitivities, Recorder=lambda *_: recorder, integrated=lambda *_: Record(outcome=Outcome.DONE)
        ):
            run.__init__(None, (), job)
        return not run.at_the_limit

    return count_while(lambda step: is_below(0.01 * step), DOUBLES)


def checks_of_drift():
    """Return the number of checks in 1000 steps."""
    checks = []
    running = Record(
        _steps=0, _job=Record(settings=Record(tuning={})), _relaxed=True, _bounded=False, _advance=nothing,
        _advance_without_drift=checks.append,
    )  # fmt: skip
    for k in range(1000):
        simulation.Simulation._step_to(running, float(k))
    return len(checks)


def searched_for_features():
    """Return the number of intervals without features that are looked for, and how far the bounds of an input of 1 go beyond it."""
    found = Record(
        _value=1.0, _least=np.inf, _largest=-np.inf, _end=0.0, _job=Record(settings=Record(duration=1.0)), _ranged=lambda *_: ()
    )  # fmt: skip
    with patch.object(varied_input, "CalmTimes", lambda *given: given[-1]):
        varied_input.VariedInput._find(found, 0.0, 1.0)
    return found._calm, found._largest - 1.0


def cases_of_a_chunk(cases):
    """Return the number of cases that one worker is given together."""
    store = Record(close=nothing, done=list)
    planned = Record(task=None, cases=range(cases), parts=None)
    with patch.multiple(
        sweep,
        Store=lambda *_: store,
        executor_of=lambda *_: nullcontext((None, 1)),
        _chunks=lambda *args: reach(args[-1]),
    ):
        return reached(lambda: sweep.Study.solve(planned))


DECISIONS = {
    "studies.case_solver:MOST_STRUCTURES": kept_structures,
    "studies.case_solver:MOST_WORDS": length_of_a_message,
    "studies.executors:STUDIES": lambda: executed("studies.executors")._solvers.cache_info().maxsize,
    "studies.executors:AHEAD": chunks_under_way,
    "studies.executors:TRIES": attempts,
    "studies.fit:CONFIDENCE": half_of_a_confidence_interval,
    "studies.fit:ROUNDS": fits_with_other_weights,
    "studies.fit:INSIDE": lambda: reached(lambda: fitted(lambda point, _: reach(point[0]))),
    "studies.fit:FAR": residual_without_a_solution,
    "studies.fmu.build:LONGEST_NAME": lambda: len(build.model_name(500 * "a")),
    "studies.fmu.slave:AT_ONE_TIME": largest_difference_of_times,
    "studies.follow:SHARE": reports_of_a_run,
    "studies.joint_pose:PART": lambda: joint_pose.parts_of(6.2),
    "studies.joint_pose:MOST_PARTS": lambda: count_while(
        lambda turns: not refused(lambda: joint_pose.parts_of(10.0 * turns)), DOUBLES
    ),
    "studies.joint_pose:KEPT": lambda: joint_pose.weights(2, [0])[1],
    "studies.measured:ROUNDS": estimates_of_noise,
    "studies.optimise:STEP": step_of_differences,
    "studies.sensitivities.formulas:SAME": lambda: formulas._rounding(np.ones(1)),
    "studies.sensitivities.formulas:ZERO": lambda: formulas._rounding(np.zeros(1)),
    "studies.sensitivities.formulas:ALIKE": largest_difference_of_slopes,
    "studies.sensitivities.parameters:STEP": lambda: step_of_a_parameter(1.0),
    "studies.sensitivities.parameters:ALMOST_ZERO": negligible_value,
    "studies.sensitivities.sensitivities:TIGHTER": tolerance_of_sensitivities,
    "studies.sensitivities.sensitivities:FEWEST": longest_step_with_sensitivities,
    "studies.sensitivities.sensitivities:AT_THE_LIMIT": longest_step_below_the_limit,
    "studies.simulation:DRIFT_CHECK_INTERVAL": checks_of_drift,
    "studies.sensitivities.sensitivities:FINEST": lambda: tolerance_of_sensitivities(1e-11),
    "stepping.unchanged": lambda: count_while(
        lambda steps: stepping.ImplicitSteps._starts_soon.fget(Record(_jumped=False, _since_jump=steps)), range(100)
    ),
    "stepping.cells": lambda: searched_for_features()[0],
    "stepping.reach": lambda: searched_for_features()[1],
    "studies.sweep:LARGEST_CHUNK": lambda: cases_of_a_chunk(10**6),
    "studies.sweep:CHUNKS_PER_WORKER": lambda: cases_of_a_chunk(32),
}  # fmt: skip
EXPECTED = {
    "studies.case_solver:MOST_STRUCTURES": 8, "studies.case_solver:MOST_WORDS": 1000, "studies.executors:STUDIES": 2,
    "studies.executors:AHEAD": 3, "studies.executors:TRIES": 3, "studies.fit:CONFIDENCE": 1.959963986912325,
    "studies.fit:ROUNDS": 3, "studies.fit:INSIDE": 1e-06, "studies.fit:FAR": 1000.0, "studies.fmu.build:LONGEST_NAME": 60,
    "studies.fmu.slave:AT_ONE_TIME": 27, "studies.follow:SHARE": 21, "studies.joint_pose:PART": 13, "studies.joint_pose:KEPT": 1e-3,
    "studies.joint_pose:MOST_PARTS": 18,
    "studies.measured:ROUNDS": 4, "studies.optimise:STEP": 0.001, "studies.sensitivities.formulas:SAME": 1e-12,
    "studies.sensitivities.formulas:ZERO": 1e-14, "studies.sensitivities.formulas:ALIKE": 27,
    "studies.sensitivities.parameters:STEP": 0.0001, "studies.sensitivities.parameters:ALMOST_ZERO": 1e-300,
    "studies.sensitivities.sensitivities:TIGHTER": 1e-09, "studies.sensitivities.sensitivities:FEWEST": 0.005,
    "studies.sensitivities.sensitivities:AT_THE_LIMIT": 26, "studies.simulation:DRIFT_CHECK_INTERVAL": 21,
    "studies.sensitivities.sensitivities:FINEST": 1e-12, "stepping.unchanged": 6, "stepping.cells": 1024, "stepping.reach": 0.02,
    "studies.sweep:LARGEST_CHUNK": 8,
    "studies.sweep:CHUNKS_PER_WORKER": 4,
}  # fmt: skip
