"""Handling tests of the standards: each states its manoeuvres and returns its metrics from their runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...errors import InputError, SolverError
from ...model.paths.curves import curve_through
from ...model.paths.lanes import STANDARDS, path_through
from .car import STEER, Car, Manoeuvre
from .metrics import (
    frequency_response,
    gradient_at_zero,
    mean_deceleration,
    rollover_threshold,
    sine_with_dwell,
    static_stability_factor,
    step_response,
    understeer_gradient,
    yaw_rate_ratio,
)
from .parameters import (
    SPEED,
    BrakingInATurn,
    ConstantRadius,
    ConstantSpeed,
    FrequencySweep,
    G,
    LaneChange,
    ObstacleAvoidance,
    Ride,
    SineWithDwell,
    StepSteer,
    StraightBraking,
)
from .vibration import total_vibration, weighted_rms

Run = Mapping[str, np.ndarray]
"""Channels of a run with ``time``."""
Metrics = dict[str, tuple[float, str]]
"""Value and unit by name."""


@dataclass(frozen=True)
class Known:
    """Results of the preliminary runs, which scale the other tests.

    Attributes
    ----------
    car : Car
    per_curvature, understeer : float
        Steering per curvature at low speed, and its growth with the squared speed.
    width : float
        Width of the vehicle, m.
    ramp : Run
        Slow ramp at the speed of the test.
    """

    car: Car
    per_curvature: float
    understeer: float
    width: float
    ramp: Run

    @property
    def ratio(self) -> float:
        """Steer angle of the wheels per unit of steering: L over the steering per curvature at low speed."""
        return self.car.wheelbase / self.per_curvature

    def driver(self) -> dict[str, float]:
        """Return the driver's parameters of this car."""
        return {"per_curvature": self.per_curvature, "understeer": self.understeer}

    def steer_for(self, acceleration: float) -> float:
        """Return the steering for a steady lateral acceleration, from the ramp.

        Raises InputError if the ramp did not reach it.
        """
        ay = np.maximum.accumulate(self.ramp["vehicle.ay"])
        if ay[-1] < acceleration:
            raise InputError(f"found a largest lateral acceleration of {ay[-1]:.3g} m/s^2, expected {acceleration:.3g}")
        return float(self.ramp[STEER + "_seen"][np.argmax(ay >= acceleration)])


PROBE = 10.0
"""Speed of the first run, m/s."""


def probe(car: Car) -> Manoeuvre:
    """Return a small step at low speed, from which steering per curvature follows."""
    return Manoeuvre(PROBE, 5.0, f"step5(t, 0.5, 0, 1.5, {0.3 if car.angular else 0.005})", output=0.02)


def curvature_of(run: Run) -> float:
    """Return the curvature at the end, 1/m."""
    return float(run["vehicle.yaw_rate"][-1] / run["vehicle.speed"][-1])


def ramp(car: Car, per_curvature: float, speed: float = SPEED) -> Manoeuvre:
    """Return a slow ramp of steering to about 10 m/s^2 at a speed, m/s, to the left."""
    most = float(per_curvature * (1 + 1.5e-3 * speed**2) * 10 / speed**2)
    return Manoeuvre(speed, 31.0, f"({most!r})*max(t - 1, 0)/30", output=0.05)


SPUN = 0.25
"""Sideslip or roll beyond which a car no longer turns quasi-steadily, rad."""
DROP = 0.9
"""Part of the largest lateral acceleration so far below which the limit is passed."""


def up_to_the_limit(run: Run) -> Run:
    """Return a ramp up to its largest lateral acceleration before the car slides, spins or tips over."""
    ay = run["vehicle.ay"]
    lost = (np.abs(run["vehicle.sideslip"]) > SPUN) | (np.abs(run["vehicle.roll"]) > SPUN)
    lost |= (ay < DROP * np.maximum.accumulate(ay)) & (np.maximum.accumulate(ay) > 1.0)
    end = int(np.argmax(lost)) if lost.any() else len(ay)
    last = int(np.argmax(ay[:end])) + 1
    return {name: values[:last] for name, values in run.items()}


def _steady(ay: np.ndarray, run: Run, known: Known, **speed: float) -> Metrics:
    gradient = understeer_gradient(ay, run[STEER + "_seen"], known.ratio, **speed)
    return {
        "understeer gradient": (1e3 * gradient, "mrad/(m/s^2)"),
        "understeer gradient per g": (np.degrees(gradient) * G, "deg/g"),
        "sideslip gradient": (1e3 * gradient_at_zero(ay, run["vehicle.sideslip"]), "mrad/(m/s^2)"),
        "roll gradient": (1e3 * gradient_at_zero(ay, run["vehicle.roll"]), "mrad/(m/s^2)"),
    }


BEGUN = 0.3
"""Lateral acceleration from which a ramp is quasi-steady, m/s^2."""


def constant_speed(known: Known, test: ConstantSpeed) -> list[Manoeuvre]:
    """Return no manoeuvre: the ramp of the preliminary runs is evaluated."""
    return []


def of_constant_speed(known: Known, test: ConstantSpeed, runs: list[Run]) -> Metrics:
    """Return gradients, characteristic speed and rollover threshold from the slow ramp."""
    run = known.ramp
    ay = run["vehicle.ay"]
    steady = {name: values[ay > BEGUN] for name, values in run.items()}
    found = _steady(ay[ay > BEGUN], steady, known, wheelbase=known.car.wheelbase, speed=test.speed)
    gradient = found["understeer gradient"][0] / 1e3
    if gradient > 0:
        found["characteristic speed"] = float(np.sqrt(known.car.wheelbase / gradient)), "m/s"
    inner = np.stack([run[f"{known.car.tyres[f'{axle}_left']}.load"] for axle in ("front", "rear")], axis=1)
    return found | {
        "largest lateral acceleration": (float(np.max(ay)), "m/s^2"),
        "rollover threshold": (rollover_threshold(ay, inner), "m/s^2"),
        "static stability factor": (static_stability_factor(known.car.track, known.car.height), "g"),
    }


SETTLED = 45.0
"""Way after which a car has settled on the circle, m."""


def constant_radius(known: Known, test: ConstantRadius) -> list[Manoeuvre]:
    """Return a circle with slowly growing speed."""
    settled = SETTLED / test.first
    path = {"circle": test.radius, "entry": 10.0, "transition": 30.0}
    driver = {**known.driver(), "acceleration": test.acceleration, "accelerates": settled}
    duration = settled + 1 + (test.last - test.first) / test.acceleration
    return [Manoeuvre(test.first, duration, driver=driver, path=path, output=0.05)]


def of_constant_radius(known: Known, test: ConstantRadius, runs: list[Run]) -> Metrics:
    """Return the gradients of the method at constant radius."""
    run = {name: values[runs[0]["time"] > SETTLED / test.first + 1] for name, values in runs[0].items()}
    found = _steady(run["vehicle.ay"], run, known)
    return found | {"largest lateral error": (float(np.max(np.abs(run["handling_driver.lateral_error"]))), "m")}


STEER_BEGIN = 1.0


def step_steer(known: Known, test: StepSteer) -> list[Manoeuvre]:
    """Return a step of steering to a lateral acceleration."""
    steer, end = known.steer_for(test.lateral_acceleration), STEER_BEGIN + test.rise
    return [Manoeuvre(test.speed, end + 4.85, f"step5(t, {STEER_BEGIN}, 0, {end!r}, {steer!r})", output=0.005)]


def of_step_steer(known: Known, test: StepSteer, runs: list[Run]) -> Metrics:
    """Return response times, overshoot and gains of yaw rate and lateral acceleration."""
    run, found = runs[0], Metrics()
    for label, channel, unit in (("yaw rate", "yaw_rate", "1/s"), ("lateral acceleration", "ay", "m/s^2")):
        one = step_response(run["time"], run[STEER + "_seen"] * known.ratio, run[f"vehicle.{channel}"])
        found |= {
            f"{label}, steady": (one.steady, "rad/s" if channel == "yaw_rate" else unit),
            f"{label}, gain per steer angle of the wheels": (one.gain, unit),
            f"{label}, response time": (one.response_time, "s"),
            f"{label}, peak response time": (one.peak_time, "s"),
            f"{label}, overshoot": (100 * one.overshoot, "%"),
        }
        if channel == "yaw_rate":
            sideslip = float(np.mean(run["vehicle.sideslip"][-100:]))
            found["TB factor"] = one.peak_time * abs(np.degrees(sideslip)), "s deg"
    return found


def frequency(known: Known, test: FrequencySweep) -> list[Manoeuvre]:
    """Return a sweep of steering with an amplitude of a lateral acceleration of the quasi-steady turn."""
    steer, rate = known.steer_for(test.lateral_acceleration), (test.last - test.first) / test.duration
    phase = f"2*pi*({test.first!r}*(t - 1) + {rate!r}*(t - 1)^2/2)"
    return [Manoeuvre(test.speed, test.duration + 1, f"step5(t, 1, 0, 2, {steer!r})*sin({phase})", output=0.01)]


def of_frequency(known: Known, test: FrequencySweep, runs: list[Run]) -> Metrics:
    """Return gain, resonance and delay of the yaw rate, and delay of the lateral acceleration."""
    run = runs[0]
    yaw, lateral = (
        frequency_response(run["time"], run[STEER + "_seen"] * known.ratio, run[f"vehicle.{channel}"])
        for channel in ("yaw_rate", "ay")
    )
    band = (yaw.frequency >= 1.5 * test.first) & (yaw.frequency <= test.last / 1.2)
    peak = int(np.argmax(np.where(band, yaw.gain, 0)))
    low, at_1 = (1.0 if test.first <= each <= test.last else np.nan for each in (0.4, 1.0))  # not outside of the sweep
    return {
        "yaw rate, gain at 0.4 Hz": (low * yaw.at(0.4)[0], "1/s"),
        "yaw rate, largest gain over that": (low * yaw.gain[peak] / yaw.at(0.4)[0], ""),
        "yaw rate, frequency of the largest gain": (float(yaw.frequency[peak]) if band.any() else np.nan, "Hz"),
        "yaw rate, phase at 1 Hz": (at_1 * float(np.degrees(yaw.at(1.0)[1])), "deg"),
        "lateral acceleration, phase at 1 Hz": (at_1 * float(np.degrees(lateral.at(1.0)[1])), "deg"),
    }


def dwell_end(test: SineWithDwell) -> float:
    """Return the end of steering, s."""
    return STEER_BEGIN + 1 / test.frequency + test.dwell


def dwell_formula(amplitude: float, test: SineWithDwell) -> str:
    """Return the steering of ISO 19365: a sine with a dwell at its second peak."""
    first, third = 0.75 / test.frequency, 0.75 / test.frequency + test.dwell
    time = f"min(t - {STEER_BEGIN}, {first!r}) + max(t - {STEER_BEGIN + third!r}, 0)"
    return f"({amplitude!r})*sin(2*pi*{test.frequency!r}*min(max({time}, 0), {1 / test.frequency!r}))"


def dwell(known: Known, test: SineWithDwell) -> list[Manoeuvre]:
    """Return the series of amplitudes with the throttle released."""
    unit, lifted = known.steer_for(test.lateral_acceleration), {"releases": STEER_BEGIN}
    formulas = [dwell_formula(factor * unit, test) for factor in test.factors]
    return [Manoeuvre(test.speed, dwell_end(test) + 2.2, formula, lifted) for formula in formulas]


def of_dwell(known: Known, test: SineWithDwell, runs: list[Run]) -> Metrics:
    """Return the yaw-rate ratios of all amplitudes, the least displacement from 5 times on, and the verdict."""
    found, stable = Metrics(), True
    displacements = []
    for factor, run in zip(test.factors, runs, strict=True):
        one = sine_with_dwell(
            run["time"],
            run[STEER + "_seen"] * known.ratio,
            run["vehicle.yaw_rate"],
            run["vehicle.y"],
            STEER_BEGIN,
            dwell_end(test),
        )
        found[f"yaw rate ratio after 1 s, {factor:g} A"] = 100 * one.ratio_1, "%"
        found[f"yaw rate ratio after 1.75 s, {factor:g} A"] = 100 * one.ratio_1_75, "%"
        stable = stable and one.stable
        displacements += [one.displacement] if factor >= 5 else []
    found["lateral displacement, 5 A and more"] = min(displacements, default=np.nan), "m"
    return found | {"stable (1 yes, 0 no)": (float(stable), "")}


BEFORE = 30.0
PART_1, PART_2 = "iso3888-1", "iso3888-2"


def _lanes(standard: str) -> Callable[[Known, Any], list[Manoeuvre]]:
    def manoeuvres(known: Known, test: LaneChange | ObstacleAvoidance) -> list[Manoeuvre]:
        """Return the course of the standard at the speed of the test."""
        path = {"lanes": standard, "width": known.width, "start": BEFORE}
        length = STANDARDS[standard](known.width)[-1].end + BEFORE + 30
        return [Manoeuvre(test.speed, length / test.speed, driver=known.driver(), path=path)]

    return manoeuvres


def _of_lanes(standard: str) -> Callable[[Known, Any, list[Run]], Metrics]:
    def metrics(known: Known, test: LaneChange | ObstacleAvoidance, runs: list[Run]) -> Metrics:
        """Return lateral error, clearance of the cones, and peaks."""
        run, lanes = runs[0], tuple(lane.shifted(BEFORE) for lane in STANDARDS[standard](known.width))
        course = curve_through(path_through(lanes, known.width, BEFORE, 100.0))
        x, y = run["vehicle.x"], run["vehicle.y"]
        clearance = np.inf
        for lane in lanes:
            inside = (x >= lane.start) & (x <= lane.end)
            for side, sign in ((lane.left, 1.0), (lane.right, -1.0)):
                free = sign * (side - y[inside]) - known.width / 2
                clearance = min(clearance, float(np.min(free, initial=np.inf)))
        return {
            "largest lateral error": (float(np.max(np.abs(course.nearest(x, y)[1]))), "m"),
            "least distance to a cone": (clearance, "m"),
            "passed (1 yes, 0 no)": (float(clearance > 0 and x[-1] > lanes[-1].end), ""),
            "largest lateral acceleration": (float(np.max(np.abs(run["vehicle.ay"]))), "m/s^2"),
            "largest yaw rate": (float(np.max(np.abs(run["vehicle.yaw_rate"]))), "rad/s"),
            "largest steering": (float(np.max(np.abs(run[STEER + "_seen"]))), "rad" if known.car.angular else "m"),
            "speed at the end": (float(run["vehicle.speed"][-1]), "m/s"),
        }

    return metrics


def highest_entry_speed(known: Known, test: ObstacleAvoidance, solve: Callable[[Manoeuvre], Run]) -> Metrics:
    """Return the highest entry speed at which no cone is hit, by bisection to the resolution of the test.

    All lower speeds are taken to pass, too. A run that stops early does not pass. The value is NaN if the slowest
    speed does not pass, and infinite if the fastest one does.
    """

    def passes(speed: float) -> bool:
        one = replace(test, speed=speed)
        try:
            runs = [solve(each) for each in _lanes(PART_2)(known, one)]
        except SolverError:
            return False
        return _of_lanes(PART_2)(known, one, runs)["passed (1 yes, 0 no)"][0] == 1

    found = highest(passes, test.slowest, test.fastest, test.resolution)
    return {"highest entry speed without a cone hit": (found, "m/s")}


def highest(passes: Callable[[float], bool], low: float, high: float, resolution: float) -> float:
    """Return the highest value that passes, at most a resolution below the first that does not, by bisection.

    NaN if `low` does not pass, infinity if `high` does.
    """
    if not passes(low):
        return float("nan")
    if passes(high):
        return float("inf")
    while high - low > resolution:
        middle = (low + high) / 2
        low, high = (middle, high) if passes(middle) else (low, middle)
    return low


BEFORE_BRAKING = 201.0
"""Way before braking in a turn, m: entry, transition and a steady part of the circle."""


def _turn(test: BrakingInATurn) -> tuple[float, float]:
    """Return the speed on the circle, m/s, and the time at which braking begins, s."""
    speed = float(np.sqrt(test.lateral_acceleration * test.radius))
    return speed, round(BEFORE_BRAKING / speed, 1)


def _pressed(pedal: float | None) -> dict[str, float]:
    """Return the driver's parameters of a pedal; none where the driver's own apply."""
    return {} if pedal is None else {"pedal": pedal}


def braking_in_a_turn(known: Known, test: BrakingInATurn) -> list[Manoeuvre]:
    """Return braking on a circle with the steering held."""
    speed, brakes = _turn(test)
    driver = {**known.driver(), "brakes": brakes, "holds": brakes - 0.2, "pressing": 0.2, **_pressed(test.pedal)}
    path = {"circle": test.radius, "entry": 10.0, "transition": 60.0}
    return [Manoeuvre(speed, brakes + 3.0, driver=driver, path=path)]


def of_braking_in_a_turn(known: Known, test: BrakingInATurn, runs: list[Run]) -> Metrics:
    """Return the reaction of the yaw rate, deceleration and sideslip after braking begins."""
    run, begin = runs[0], _turn(test)[1]
    after = run["time"] >= begin
    yaw_rate, speed = run["vehicle.yaw_rate"], run["vehicle.speed"]
    one = int(np.searchsorted(run["time"], begin + 1.0))
    return {
        "lateral acceleration before": (float(np.interp(begin - 0.2, run["time"], run["vehicle.ay"])), "m/s^2"),
        "deceleration 1 s after": (float(-run["vehicle.ax"][one]), "m/s^2"),
        "yaw rate ratio 1 s after": (yaw_rate_ratio(run["time"], yaw_rate, speed, begin), ""),
        "largest yaw rate over that before": (
            float(np.max(yaw_rate[after]) / np.interp(begin, run["time"], yaw_rate)),
            "",
        ),
        "largest sideslip": (float(np.degrees(np.max(np.abs(run["vehicle.sideslip"][after])))), "deg"),
    }


def straight_braking(known: Known, test: StraightBraking) -> list[Manoeuvre]:
    """Return braking straight ahead with the pedal pressed."""
    duration = 12.0 * max(1.0, test.speed / (100 / 3.6))
    return [Manoeuvre(test.speed, duration, driver={"brakes": 1.0, **_pressed(test.pedal)})]


def of_straight_braking(known: Known, test: StraightBraking, runs: list[Run]) -> Metrics:
    """Return mean fully developed deceleration, stopping distance and the largest slip."""
    run = runs[0]
    part = run["time"] >= 1.0
    time, speed = run["time"][part], run["vehicle.speed"][part]
    moving = speed > 0.1 * speed[0]  # as in the mean deceleration: anti-lock control ends at a few m/s
    slip = min(float(np.min(run[f"{tyre}.slip"][part][moving])) for tyre in known.car.tyres.values())
    distance = np.sum((speed[1:] + speed[:-1]) / 2 * np.diff(time))
    return {
        "mean fully developed deceleration": (mean_deceleration(time, speed), "m/s^2"),
        "distance": (float(distance), "m"),
        "largest braking slip": (-100 * slip, "%"),
        "lateral deviation": (float(np.max(np.abs(run["vehicle.y"]))), "m"),
    }


def _rough_from(test: Ride) -> float:
    """Return the time from which all wheels are on the rough road, s."""
    return 40.0 / test.speed + 0.2


def ride(known: Known, test: Ride) -> list[Manoeuvre]:
    """Return a random road."""
    road = {
        "type": "iso8608", "roughness": test.roughness, "seed": 1, "start": 20.0, "entry": 20.0, "shortest": 0.3,
        "track": known.car.track,
    }  # fmt: skip
    return [Manoeuvre(test.speed, _rough_from(test) + test.duration, "0", road=road, output=0.005)]


def of_ride(known: Known, test: Ride, runs: list[Run]) -> Metrics:
    """Return weighted accelerations of the reference point and the dynamic wheel load."""
    run = runs[0]
    part = run["time"] >= _rough_from(test) - 1e-9
    step = float(run["time"][1] - run["time"][0])
    x, y = (weighted_rms(run[f"vehicle.{axis}"][part], step, "Wd") for axis in ("ax", "ay"))
    z = weighted_rms(run["vehicle.az"][part], step, "Wk")
    loads = [run[f"{tyre}.load"][part] for tyre in known.car.tyres.values()]
    return {
        "weighted acceleration x (Wd)": (x, "m/s^2"),
        "weighted acceleration y (Wd)": (y, "m/s^2"),
        "weighted acceleration z (Wk)": (z, "m/s^2"),
        "vibration total value": (total_vibration(x, y, z), "m/s^2"),
        "largest dynamic wheel load over its mean": (max(float(np.std(load) / np.mean(load)) for load in loads), ""),
    }


@dataclass(frozen=True)
class HandlingTest:
    """Test of a standard.

    Attributes
    ----------
    title : str
    parameters : dataclass
        Parameters with their defaults.
    manoeuvres : callable
        Returns the manoeuvres from `Known` and the parameters.
    metrics : callable
        Returns the metrics from `Known`, the parameters and the runs of the manoeuvres.
    shown : tuple of (str, str)
        Channels on both axes of the test's figure.
    ramped : bool
        True if it needs the slow ramp at its own speed.
    search : callable, optional
        Returns further metrics from `Known`, the parameters and a function that solves one manoeuvre after another.
    """

    title: str
    parameters: Any
    manoeuvres: Callable[[Known, Any], list[Manoeuvre]]
    metrics: Callable[[Known, Any, list[Run]], Metrics]
    shown: tuple[str, str]
    ramped: bool = False
    search: Callable[[Known, Any, Callable[[Manoeuvre], Run]], Metrics] | None = None


SEEN = STEER + "_seen"
TESTS: dict[str, HandlingTest] = {
    "constant_speed": HandlingTest("Slow ramp of steering, ISO 4138", ConstantSpeed(), constant_speed, of_constant_speed, ("vehicle.ay", SEEN), ramped=True),
    "constant_radius": HandlingTest("Circle, ISO 4138", ConstantRadius(), constant_radius, of_constant_radius, ("vehicle.ay", SEEN)),
    "step_steer": HandlingTest("Step of steering, ISO 7401", StepSteer(), step_steer, of_step_steer, ("time", "vehicle.yaw_rate"), ramped=True),
    "frequency_response": HandlingTest("Sweep of steering, ISO 7401", FrequencySweep(), frequency, of_frequency, ("time", "vehicle.yaw_rate"), ramped=True),
    "sine_with_dwell": HandlingTest("Sine with dwell, ISO 19365", SineWithDwell(), dwell, of_dwell, ("time", "vehicle.yaw_rate"), ramped=True),
    "lane_change": HandlingTest("Double lane change, ISO 3888-1", LaneChange(), _lanes(PART_1), _of_lanes(PART_1), ("vehicle.x", "vehicle.y")),
    "obstacle_avoidance": HandlingTest("Obstacle avoidance, ISO 3888-2", ObstacleAvoidance(), _lanes(PART_2), _of_lanes(PART_2), ("vehicle.x", "vehicle.y"), search=highest_entry_speed),
    "braking_in_a_turn": HandlingTest("Braking on a circle, ISO 7975", BrakingInATurn(), braking_in_a_turn, of_braking_in_a_turn, ("time", "vehicle.yaw_rate")),
    "straight_braking": HandlingTest("Straight-line braking, ISO 21994", StraightBraking(), straight_braking, of_straight_braking, ("time", "vehicle.speed")),
    "ride": HandlingTest("Random road, ISO 2631-1", Ride(), ride, of_ride, ("time", "vehicle.az")),
}  # fmt: skip
"""All tests by name."""
