"""Decisions on studies: cases, fits, sensitivities, co-simulation, handling, suspensions, tyre curves."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from unittest.mock import Mock, patch

import numpy as np
import pytest

from stiffmbs.compile.inputs.features import NO_FEATURES
from stiffmbs.errors import SolverError
from stiffmbs.model.settings import SteadyMotion
from stiffmbs.solve.trajectory import Grid, Outcome
from stiffmbs.studies import (
    case_solver,
    executors,
    input_numbers,
    measured,
    optimise,
    simulation,
    stepping,
    tyre_curves,
)
from stiffmbs.studies.fmu import build
from stiffmbs.studies.handling import braking, car, lane_changes, metrics, steady_state_cornering, steering_inputs
from stiffmbs.studies.handling.known import Known
from stiffmbs.studies.handling.parameters import SPEED, SineWithDwell
from stiffmbs.studies.handling.vibration import Weighting
from stiffmbs.studies.sensitivities import formulas
from stiffmbs.studies.suspension import axle, characteristics, kinematics_and_compliance, steering_axis, tangent
from tests.decisions.common import BELOW, Record, executed, module, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

fit, follow, study, sweep = (
    module(f"studies.{name}") for name in ("fit", "follow", "handling.study", "sweep")
)  # fmt: skip
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
        follow, stepper_of=lambda *_: found, _so_far=lambda *_: after(1.0), time=Record(monotonic=lambda: clock[0])
    ):
        return len([*follow._followed(job, 0.5)])


def largest_misplacement():
    scene = Record(initial_marker=lambda _: Record(axes=np.eye(3)), forces={"a": Record(i=None), "b": Record(i=None)})

    def accepts(y):
        places = {"a": np.array([0.0, y, 0.0]), "b": np.array([1.0, y, 0.0])}
        return not refused(lambda: car._check_place(scene, "car", places))

    return count_while(lambda y: accepts(1e-4 * y), DOUBLES)


def start_of_lanes():
    with patch.object(lane_changes, "STANDARDS", {"s": lambda _: [Record(end=1.0)]}):
        known = Record(width=1.0, length=1.0, driver=lambda _: {})
        return lane_changes.in_lanes("s")(known, Record(speed=1.0))[0].path["start"]


def coasting():
    """Return the time at which the throttle is released, and the duration of the run, s."""
    with patch.object(lane_changes, "STANDARDS", {lane_changes.PART_2: lambda _: [Record(end=1.0)]}):
        known = Record(width=1.0, length=1.0, driver=lambda _: {})
        (found,) = lane_changes.in_lanes(lane_changes.PART_2)(known, Record(speed=1.0))
        return found.driver["releases"], found.duration


AT_THE_MIDDLE = Record(centre=None, behind=lambda _: 0.0)
"""Car whose centre of mass is above its rear axle."""


def lag_of_an_oversteering_car():
    return Known(AT_THE_MIDDLE, 1.0, -1.0, 1.8, {}, lag=-1.0).lag_at(22.0)


def largest_difference_of_the_end():
    """Return in how many quarter octaves of 1e-6 a record ends at rest."""
    time = np.arange(0.0, 40, 0.1)

    def accepts(apart):
        response = np.append(np.exp(-((time[:-1] - 5) ** 2)), 1e-6 * apart)
        with patch.object(metrics, "_local_fit", lambda *arguments: reach(arguments[-1])):
            return reached(lambda: metrics.frequency_response(time, response, response))

    return count_while(accepts, DOUBLES)


def ratios_of_a_stable_car():
    """Return in how many quarter octaves of 1 % each yaw rate ratio is that of a stable car."""
    first = count_while(lambda part: metrics.SineWithDwell(part / 100, 0.0, 0.0).stable, DOUBLES)
    return first * count_while(lambda part: metrics.SineWithDwell(0.0, part / 100, 0.0).stable, DOUBLES)


def amplitudes_of_a_dwell():
    """Return the amplitude of the last run, and from which on the displacement counts, over the unit A."""
    test = SineWithDwell(factors=tuple(np.arange(1.0, 9, 0.5)), final=1e-9, largest=1e9)
    known = Record(car=Record(angular=True), steer_for=lambda _: 1.0, ratio=1.0)
    last = list(steering_inputs.amplitudes(known, replace(test, factors=(1.0,))).values())[-1]
    run = {"time": np.zeros(1), steering_inputs.SEEN: np.ones(1), "vehicle.yaw_rate": None, "vehicle.y": None}
    with patch.object(steering_inputs, "sine_with_dwell", lambda *_: metrics.SineWithDwell(0.0, 0.0, 1.0)):
        runs = [run] * 2 * len(steering_inputs.amplitudes(known, test))
        found = steering_inputs.of_dwell(known, test, runs)
    counted = [name for name in found if name.startswith("lateral displacement, ") and name.endswith("left")]
    return last, len(counted)


def duration_of_a_sweep():
    known = Record(steer_for=lambda _: 1.0)
    return (
        steering_inputs.frequency(
            known, Record(lateral_acceleration=1.0, speed=1.0, first=0.0, last=0.0, duration=1e-6)
        )[0].duration
        - 1
    )


def largest_difference_of_steps():
    def accepts(apart):
        time = np.append(np.arange(100.0), 100.0 + apart)
        response = np.sin(time)
        return not refused(lambda: metrics.frequency_response(time, response, response))

    return count_while(lambda apart: accepts(3e-7 * apart), DOUBLES[:40])


def length_of_a_ramp(ay):
    """Return the number of quasi-steady values of a lateral acceleration."""
    with patch.object(steady_state_cornering, "at_zero", lambda *_: (0.0, 0.0)):
        run = {"vehicle.ay": ay, steady_state_cornering.SEEN: ay}
        try:
            return len(steady_state_cornering.quasi_steady(run)["vehicle.ay"])
        except ValueError:  # the first value is beyond the limit
            return 0


def turns_at_a_gradient():
    """Return the time from which a circle is evaluated, without the way of its entry."""
    run = {"time": np.arange(0.0, 20, 0.01), "vehicle.ay": np.arange(2000)}
    with patch.object(steady_state_cornering, "_steady", lambda run, *_: reach(run["time"][0])):
        return reached(lambda: steady_state_cornering.of_constant_radius(None, Record(first=1e9, radius=1.0), [run]))


def time_on_a_circle():
    test = Record(first=1.0, last=1.0, radius=1.0, acceleration=1.0)
    return steady_state_cornering.constant_radius(Record(driver=lambda _: {}), test)[0].driver["accelerates"]


def slowest_start():
    """Return the number of percents by which a start may be slower."""
    scene = Record(start=SteadyMotion(velocity=(1.0, 0.0, 0.0)))

    class Slower(dict):
        success, time = True, (0.0,)

    def accepts(percents):
        with patch.object(study, "run", lambda _: Slower({"vehicle.speed": [1 - percents / 100 + 1e-9]})):
            return not refused(lambda: study.solved(scene))

    return count_while(accepts, range(20))


def size_beyond_the_wheels():
    with patch.multiple(
        study, load_scene=nothing, with_changes=nothing, car_of=lambda *_: Record(track=0.0, wheelbase=1.0),
        _preliminary=lambda _scene, _car, width, length: reach((width, length - 1.0)),
    ):  # fmt: skip
        return reached(lambda: study.handling("car", [], workers=1))


def weighting(frequency):
    """Return the amplitude of a weighting with band limits alone at a frequency in Hz."""
    return abs(Weighting(np.inf, np.inf, 1.0).response(np.array([frequency]))[0])


def states_before_angles():
    turns = Record(_states=[], angles=lambda: reach(len(turns._states)))

    def note_all():
        while True:
            input_numbers.FollowedTurns.note(turns, 0.0, np.zeros(1), np.zeros(1))

    return reached(note_all)


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


def tolerance_of_sensitivities():
    with patch.multiple(
        sensitivities,
        with_weights=lambda scenes, _: scenes,
        changed=lambda _, change: reach(change["rtol"]),
        prepare=nothing,
    ):
        return reached(lambda: sensitivities.differentiated(Record(known=None), (), Record(rtol=1e-3)))


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
        t=0.0, _steps=0, _job=Record(settings=Record(tuning={})), _relaxed=True, _bounded=False, _turns=Record(any=False), _forget=nothing,
        _advance=nothing, _advance_without_drift=checks.append,
    )  # fmt: skip
    for _ in range(1000):
        simulation.Simulation.step(running, 1.0)
    return len(checks)


def tolerance_of_restarts(rtol):
    with patch.object(stepping, "changed", lambda _, change: change["rtol"]):
        return stepping._finer(Record(rtol=rtol, atol=None))


def least_component_along_y():
    def accepts(y):
        wheel = Record(axis=[np.sqrt(max(1 - y**2, 0.0)), y, 0.0], side="wheel", carrier="a")
        return not refused(lambda: axle._check([wheel], ""))

    return count_while(accepts, 1.5 * BELOW)


def largest_offset_on_an_axle():
    """Return the offset along x, in quarter octaves of 0.01 m, of two wheels on an axle."""

    def has_both(offset):
        tyres = {name: Record(i=Record(body=name)) for name in ("a", "b")}
        model = Record(forces=tyres, bodies={}, point=lambda i: [10.0 - offset * (i.body == "b")])
        with patch.multiple(axle, Tyre=Record, _of_body=lambda *_: 1):
            return len(axle._with_tyres(model, "front", None)) == 2

    return count_while(lambda offset: has_both(0.01 * offset), DOUBLES[:40])


def largest_angle_of_roll_paths():
    def meet(sine):
        hubs = [
            Record(contact=np.array([0.0, y, 0.0]), path=path) for y, path in ((1.0, (1.0, 0.0)), (-1.0, (1.0, sine)))
        ]
        pose = Record(hubs=hubs, contact_velocity=lambda hub, _: np.array([0.0, *hub.path]), setup=Record(plane=0.0))
        return np.isfinite(characteristics._roll_centre(pose, None)["roll_centre_height"])

    return count_while(meet, BELOW)


def amplitude_of_a_rotated_joint():
    with patch.object(kinematics_and_compliance, "replace", lambda _, **changes: changes["amplitude"]):
        return kinematics_and_compliance._case(Record(name="steer"), True)


def largest_compared_value():
    def is_compared(value):
        channels = {"left.a": np.array([value]), "right.a": np.zeros(1)}
        found = Record(sweeps={"s": Record(case=Record(opposite=False), channels=channels)})
        asymmetry = kinematics_and_compliance.KinematicsAndCompliance.asymmetry
        return (asymmetry.fget if isinstance(asymmetry, property) else asymmetry)(found) > 0.0

    return count_while(lambda value: is_compared(1e3 * value), DOUBLES)


def has_an_axis(*omega):
    twist = Record(omega=np.array(omega), v=np.zeros(3))
    return steering_axis.steering_axis(twist, None, None) is not None


def least_stiffness():
    eye = np.eye(1)
    found = Record(_scale=np.ones(1), _jacobian=eye, _reactions=eye, _stiffness=eye)
    with patch.multiple(tangent, Constraints=lambda _: Record(null_space=eye), _inverse=lambda _, least: reach(least)):
        return reached(lambda: tangent.Changes(found, np.array([0]), np.zeros((0, 1))))


def largest_violation():
    def accepts(violation):
        found = Record(_jacobian=np.eye(1), _scale=np.ones(1), row=lambda _: 0, size=1)
        changes = Record(
            _tangent=found, _rows=np.array([0]), _locked=np.zeros((0, 1)), _with_free=nothing,
            _constraints=Record(smallest=lambda right: right + violation),
        )  # fmt: skip
        return not refused(lambda: tangent.Changes.moved(changes, "j"))

    return count_while(lambda violation: accepts(1e-9 * violation), DOUBLES)


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


def loads_of_a_tyre():
    tyre = Record(has_pressure=False, nominal_load=1.0, nominal_pressure=None)
    with patch.object(tyre_curves, "_curve", lambda _tyre, load, *_: load):
        return sum(tyre_curves.tyre_curves(tyre, Record(pressure=None, load=None)))


def ends_of_curves(function):
    """Return the ends of slip and slip angle of curves of a tyre."""
    ends = []

    def within(_tyre, _name, end):
        ends.append(end)
        return -end, end

    tyre = Record(steady_state=lambda *_: reach(ends))
    with patch.object(tyre_curves, "_within", within):
        return reached(lambda: function(tyre, 1.0, None, Record(points=3, camber=0.0, speed=1.0)))


def directions_of_an_ellipse():
    tyre = Record(steady_state=lambda _load, kappa, *_: reach(len(kappa)))
    with patch.object(tyre_curves, "_within", lambda *_: (-1.0, 1.0)):
        return reached(lambda: tyre_curves._ellipse(tyre, 1.0, None, Record(points=3, camber=0.0, speed=1.0)))


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
    "studies.handling.braking:BEFORE_BRAKING": lambda: braking._turn(Record(lateral_acceleration=1.0, radius=1.0))[1],
    "studies.handling.car:MISPLACED": largest_misplacement,
    "studies.handling.car:Manoeuvre.output": lambda: car.Manoeuvre(1.0, 1.0).output,
    "studies.handling.lane_changes:BEFORE": start_of_lanes,
    "studies.handling.metrics:LINEAR": lambda: metrics.at_zero(np.arange(-10.0, 11), np.arange(-10.0, 11) ** 7)[1],
    "studies.handling.metrics:UNEQUAL": largest_difference_of_steps,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.probe": lambda: steady_state_cornering.probe(Record(angular=False)).speed,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.spun": lambda: steady_state_cornering.ramp(None, 1.0).spun,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.drop": lambda: count_while(
        lambda part: length_of_a_ramp(np.array([2.0, 2.0 * part, 3.0])) == 3, 1.1 * BELOW
    ),
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.begun": lambda: 1000 - length_of_a_ramp(0.01 * np.arange(1000.0)),
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.follows": turns_at_a_gradient,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.ramp_begin": lambda: steady_state_cornering.lag_of(
        {"time": np.array([5.0, 6.0]), steady_state_cornering.SEEN: np.array([1.0, 2.0])}
    ),
    "studies.handling.known:Known.lag": lambda: Known(AT_THE_MIDDLE, 1.0, 0.0, 1.8, {}).driver(SPEED)["anticipation"],
    "studies.handling.known:STEERING_LAG": lambda: Known(AT_THE_MIDDLE, 1.0, 0.0, 1.8, {}, lag=0.0).driver(SPEED)["shaping"],
    "studies.handling.known:Known.length": lambda: Known(None, 1.0, 0.0, 1.8, {}).length,
    "studies.handling.known:LEAST_GROWTH": lag_of_an_oversteering_car,
    "studies.handling.lane_changes:RELEASED": lambda: coasting()[0] - lane_changes.BEFORE,
    "studies.handling.lane_changes:COASTING": lambda: coasting()[1],
    "studies.handling.metrics:AT_REST": largest_difference_of_the_end,
    "studies.handling.metrics:STABLE": ratios_of_a_stable_car,
    "studies.handling.steering_inputs:LAST": lambda: amplitudes_of_a_dwell()[0],
    "studies.handling.steering_inputs:RESPONSIVE": lambda: amplitudes_of_a_dwell()[1],
    "studies.handling.steering_inputs:SETTLING": duration_of_a_sweep,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.settled": time_on_a_circle,
    "studies.handling.steering_inputs:STEER_BEGIN": lambda: steering_inputs.dwell_end(Record(frequency=1.0, dwell=0.0)),
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.slower": slowest_start,
    "studies.handling.study:WIDER": lambda: size_beyond_the_wheels()[0],
    "studies.handling.study:OVERHANGS": lambda: size_beyond_the_wheels()[1],
    "studies.handling.vibration:Weighting.f1": lambda: weighting(0.4),
    "studies.handling.vibration:Weighting.f2": lambda: weighting(100.0),
    "studies.input_numbers:MOST_KEPT": states_before_angles,
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
    "studies.stepping:PART": lambda: tolerance_of_restarts(1e-3),
    "studies.stepping:FINEST": lambda: tolerance_of_restarts(1e-11),
    "studies.suspension.axle:AXIS_ALONG_Y": least_component_along_y,
    "studies.suspension.axle:SAME_AXLE": largest_offset_on_an_axle,
    "studies.suspension.axle:ON_MIDDLE_PLANE": lambda: count_while(
        lambda y: axle._side(np.array([0.0, y, 0.0])) == "left", BELOW
    ),
    "studies.suspension.characteristics:STRAIGHT": lambda: count_while(
        lambda angle: np.isfinite(characteristics._ackermann([angle, angle], 0.5, 2.0)["turning_radius"]), BELOW
    ),
    "studies.suspension.characteristics:PARALLEL": largest_angle_of_roll_paths,
    "studies.suspension.kinematics_and_compliance:STEER_ANGLE": amplitude_of_a_rotated_joint,
    "studies.suspension.kinematics_and_compliance:NEARLY_STRAIGHT": largest_compared_value,
    "studies.suspension.steering_axis:STILL": lambda: count_while(lambda rate: has_an_axis(0.0, 0.0, rate), BELOW),
    "studies.suspension.steering_axis:LEVEL": lambda: count_while(lambda up: has_an_axis(1.0, 0.0, up), BELOW),
    "studies.suspension.tangent:IDLE": least_stiffness,
    "studies.suspension.tangent:UNMET": largest_violation,
    "studies.sweep:LARGEST_CHUNK": lambda: cases_of_a_chunk(10**6),
    "studies.sweep:CHUNKS_PER_WORKER": lambda: cases_of_a_chunk(32),
    "studies.tyre_curves:PARTS_OF_LOAD": loads_of_a_tyre,
    "studies.tyre_curves:SLIP": lambda: ends_of_curves(tyre_curves._curve)[0],
    "studies.tyre_curves:ANGLE": lambda: ends_of_curves(tyre_curves._curve)[1],
    "studies.tyre_curves:FAR_SLIP": lambda: ends_of_curves(tyre_curves._ellipse)[0],
    "studies.tyre_curves:FAR_ANGLE": lambda: ends_of_curves(tyre_curves._ellipse)[1],
    "studies.tyre_curves:DIRECTIONS": directions_of_an_ellipse,
}  # fmt: skip
EXPECTED = {
    "studies.case_solver:MOST_STRUCTURES": 8, "studies.case_solver:MOST_WORDS": 1000, "studies.executors:STUDIES": 2,
    "studies.executors:AHEAD": 3, "studies.executors:TRIES": 3, "studies.fit:CONFIDENCE": 1.959963986912325, "studies.fit:ROUNDS": 3,
    "studies.fit:INSIDE": 1e-06, "studies.fit:FAR": 1000.0, "studies.fmu.build:LONGEST_NAME": 60, "studies.fmu.slave:AT_ONE_TIME": 27,
    "studies.follow:SHARE": 21, "studies.handling.braking:BEFORE_BRAKING": 201.0, "studies.handling.car:MISPLACED": 27,
    "studies.handling.car:Manoeuvre.output": 0.01, "studies.handling.lane_changes:BEFORE": 30.0,
    "studies.handling.metrics:LINEAR": 334.4055944055936, "studies.handling.metrics:UNEQUAL": 7,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.probe": 5.0, "studies.handling.steady_state_cornering:QuasiSteadyTurns.spun": 0.25,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.drop": 1, "studies.handling.steady_state_cornering:QuasiSteadyTurns.begun": 31,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.follows": 4.01,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.ramp_begin": 3.0, "studies.handling.known:Known.lag": 0.12,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.settled": 45.0, "studies.handling.steering_inputs:STEER_BEGIN": 2.0,
    "studies.handling.known:STEERING_LAG": -0.00125, "studies.handling.known:Known.length": 4.3, "studies.handling.known:LEAST_GROWTH": 2439.4944444444445, "studies.handling.lane_changes:RELEASED": 2.0,
    "studies.handling.lane_changes:COASTING": 91.5, "studies.handling.metrics:AT_REST": 40, "studies.handling.metrics:STABLE": 378,
    "studies.handling.steering_inputs:LAST": 6.5, "studies.handling.steering_inputs:RESPONSIVE": 8, "studies.handling.steering_inputs:SETTLING": 4.000001,
    "studies.handling.study:OVERHANGS": 0.6,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.slower": 6, "studies.handling.study:WIDER": 0.2, "studies.handling.vibration:Weighting.f1": 0.7071067810960379,
    "studies.handling.vibration:Weighting.f2": 0.7071067810960378, "studies.input_numbers:MOST_KEPT": 1001, "studies.measured:ROUNDS": 4,
    "studies.optimise:STEP": 0.001, "studies.sensitivities.formulas:SAME": 1e-12, "studies.sensitivities.formulas:ZERO": 1e-14,
    "studies.sensitivities.formulas:ALIKE": 27, "studies.sensitivities.parameters:STEP": 0.0001,
    "studies.sensitivities.parameters:ALMOST_ZERO": 1e-300, "studies.sensitivities.sensitivities:TIGHTER": 1e-09,
    "studies.sensitivities.sensitivities:FEWEST": 0.005, "studies.sensitivities.sensitivities:AT_THE_LIMIT": 26,
    "studies.simulation:DRIFT_CHECK_INTERVAL": 21, "studies.stepping:PART": 1e-05, "studies.stepping:FINEST": 1e-12,
    "studies.suspension.axle:AXIS_ALONG_Y": 4, "studies.suspension.axle:SAME_AXLE": 20, "studies.suspension.axle:ON_MIDDLE_PLANE": 80,
    "studies.suspension.characteristics:STRAIGHT": 26, "studies.suspension.characteristics:PARALLEL": 159,
    "studies.suspension.kinematics_and_compliance:STEER_ANGLE": 10.0, "studies.suspension.kinematics_and_compliance:NEARLY_STRAIGHT": 27,
    "studies.suspension.steering_axis:STILL": 119, "studies.suspension.steering_axis:LEVEL": 80, "studies.suspension.tangent:IDLE": 1e-12,
    "studies.suspension.tangent:UNMET": 27, "studies.sweep:LARGEST_CHUNK": 8, "studies.sweep:CHUNKS_PER_WORKER": 4,
    "studies.tyre_curves:PARTS_OF_LOAD": 3.0, "studies.tyre_curves:SLIP": 0.3, "studies.tyre_curves:ANGLE": 0.2617993877991494,
    "studies.tyre_curves:FAR_SLIP": 1.0, "studies.tyre_curves:FAR_ANGLE": 0.6981317007977318, "studies.tyre_curves:DIRECTIONS": 73,
}  # fmt: skip
