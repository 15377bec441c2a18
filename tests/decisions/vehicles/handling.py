"""Decisions of handling tests."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np

from stiffmbs.model.settings import SteadyMotion
from stiffmbs.studies.handling import braking, car, lane_changes, metrics, steady_state_cornering, steering_inputs
from stiffmbs.studies.handling.known import Known
from stiffmbs.studies.handling.parameters import SPEED, SineWithDwell
from stiffmbs.studies.handling.vibration import Weighting
from tests.decisions.common import BELOW, Record, module, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

study = module("studies.handling.study")


def largest_misplacement():
    def accepts(y):
        wheels = [Record(centre=np.array([x, y, 0.0]), axis=np.array([0.0, 1.0, 0.0])) for x in (0.0, 1.0)]
        return not refused(lambda: car._check_place("car", wheels))

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


AT_THE_MIDDLE = Record(centre=None, measured=None, behind=lambda _: 0.0)


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
        with patch.object(study, "run", lambda _, errors: Slower({"vehicle.speed": [1 - percents / 100 + 1e-9]})):
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


DECISIONS = {
    "studies.handling.braking:BEFORE_BRAKING": lambda: braking._turn(Record(lateral_acceleration=1.0, radius=1.0))[1],
    "studies.handling.car:MISPLACED": largest_misplacement,
    "studies.handling.car:Manoeuvre.output": lambda: car.Manoeuvre(1.0, 1.0).output,
    "studies.handling.lane_changes:BEFORE": start_of_lanes,
    "studies.handling.metrics:LINEAR": lambda: metrics.at_zero(np.arange(-20.0, 21), np.arange(-20.0, 21) ** 7)[1],
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
}  # fmt: skip
EXPECTED = {
    "studies.handling.braking:BEFORE_BRAKING": 201.0, "studies.handling.car:MISPLACED": 27,
    "studies.handling.car:Manoeuvre.output": 0.01, "studies.handling.lane_changes:BEFORE": 30.0,
    "studies.handling.metrics:LINEAR": -1560.0, "studies.handling.metrics:UNEQUAL": 7,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.probe": 5.0,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.spun": 0.25,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.drop": 1,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.begun": 31,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.follows": 4.01,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.ramp_begin": 3.0, "studies.handling.known:Known.lag": 0.12,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.settled": 45.0,
    "studies.handling.steering_inputs:STEER_BEGIN": 2.0, "studies.handling.known:STEERING_LAG": -0.00125,
    "studies.handling.known:Known.length": 4.3, "studies.handling.known:LEAST_GROWTH": 2439.4944444444445,
    "studies.handling.lane_changes:RELEASED": 2.0, "studies.handling.lane_changes:COASTING": 91.5,
    "studies.handling.metrics:AT_REST": 40, "studies.handling.metrics:STABLE": 378,
    "studies.handling.steering_inputs:LAST": 6.5, "studies.handling.steering_inputs:RESPONSIVE": 8,
    "studies.handling.steering_inputs:SETTLING": 4.000001, "studies.handling.study:OVERHANGS": 0.6,
    "studies.handling.steady_state_cornering:QuasiSteadyTurns.slower": 6, "studies.handling.study:WIDER": 0.2,
    "studies.handling.vibration:Weighting.f1": 0.7071067810960379,
    "studies.handling.vibration:Weighting.f2": 0.7071067810960378,
}  # fmt: skip
