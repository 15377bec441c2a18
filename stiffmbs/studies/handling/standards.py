"""Handling tests of the standards: each states its manoeuvres and returns its metrics from their runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
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
from .vibration import total_vibration, weighted_rms

G = 9.81
SPEED = 80 / 3.6
"""Test speed of ISO 7401, ISO 4138 (constant speed) and ISO 19365, m/s."""
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
        Slow ramp at `SPEED`.
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
        """Return the steering for a steady lateral acceleration at `SPEED`, from the ramp.

        Raises
        ------
        InputError
            If the ramp did not reach it.
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


def ramp(car: Car, per_curvature: float) -> Manoeuvre:
    """Return a slow ramp of steering to about 10 m/s^2 at the test speed, to the left."""
    most = float(per_curvature * (1 + 1.5e-3 * SPEED**2) * 10 / SPEED**2)
    return Manoeuvre(SPEED, 31.0, f"({most!r})*max(t - 1, 0)/30", output=0.05)


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


def constant_speed(known: Known) -> list[Manoeuvre]:
    """Return no manoeuvre: the ramp of the preliminary runs is evaluated."""
    return []


def of_constant_speed(known: Known, runs: list[Run]) -> Metrics:
    """Return gradients, characteristic speed and rollover threshold from the slow ramp."""
    run = known.ramp
    ay = run["vehicle.ay"]
    steady = {name: values[ay > BEGUN] for name, values in run.items()}
    found = _steady(ay[ay > BEGUN], steady, known, wheelbase=known.car.wheelbase, speed=SPEED)
    gradient = found["understeer gradient"][0] / 1e3
    if gradient > 0:
        found["characteristic speed"] = float(np.sqrt(known.car.wheelbase / gradient)), "m/s"
    inner = np.stack([run[f"{known.car.tyres[f'{axle}_left']}.load"] for axle in ("front", "rear")], axis=1)
    return found | {
        "largest lateral acceleration": (float(np.max(ay)), "m/s^2"),
        "rollover threshold": (rollover_threshold(ay, inner), "m/s^2"),
        "static stability factor": (static_stability_factor(known.car.track, known.car.height), "g"),
    }


RADIUS = 100.0


def constant_radius(known: Known) -> list[Manoeuvre]:
    """Return a circle of 100 m with slowly growing speed, from 0.25 to 4 m/s^2."""
    first, last, rate = 5.0, 20.0, 0.3
    path = {"circle": RADIUS, "entry": 10.0, "transition": 30.0}
    driver = {**known.driver(), "acceleration": rate, "accelerates": 9}
    return [Manoeuvre(first, 10 + (last - first) / rate, driver=driver, path=path, output=0.05)]


def of_constant_radius(known: Known, runs: list[Run]) -> Metrics:
    """Return the gradients of the method at constant radius."""
    run = {name: values[runs[0]["time"] > 10] for name, values in runs[0].items()}
    found = _steady(run["vehicle.ay"], run, known)
    return found | {"largest lateral error": (float(np.max(np.abs(run["handling_driver.lateral_error"]))), "m")}


STEP_BEGIN = 1.0


def step_steer(known: Known) -> list[Manoeuvre]:
    """Return a step of steering within 0.15 s to 4 m/s^2."""
    steer = known.steer_for(4.0)
    return [Manoeuvre(SPEED, 6.0, f"step5(t, {STEP_BEGIN}, 0, {STEP_BEGIN} + 0.15, {steer!r})", output=0.005)]


def of_step_steer(known: Known, runs: list[Run]) -> Metrics:
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


def frequency(known: Known) -> list[Manoeuvre]:
    """Return a sweep of steering from 0.2 to 3 Hz at 2 m/s^2 of the quasi-steady turn."""
    steer, first, rate = known.steer_for(2.0), 0.2, 0.07
    phase = f"2*pi*({first}*(t - 1) + {rate}*(t - 1)^2/2)"
    return [Manoeuvre(SPEED, 41.0, f"step5(t, 1, 0, 2, {steer!r})*sin({phase})", output=0.01)]


def of_frequency(known: Known, runs: list[Run]) -> Metrics:
    """Return gain, resonance and delay of the yaw rate, and delay of the lateral acceleration."""
    run = runs[0]
    yaw, lateral = (
        frequency_response(run["time"], run[STEER + "_seen"] * known.ratio, run[f"vehicle.{channel}"])
        for channel in ("yaw_rate", "ay")
    )
    band = (yaw.frequency >= 0.3) & (yaw.frequency <= 2.5)
    peak = int(np.argmax(np.where(band, yaw.gain, 0)))
    return {
        "yaw rate, gain at 0.4 Hz": (yaw.at(0.4)[0], "1/s"),
        "yaw rate, largest gain over that": (yaw.gain[peak] / yaw.at(0.4)[0], ""),
        "yaw rate, frequency of the largest gain": (float(yaw.frequency[peak]), "Hz"),
        "yaw rate, phase at 1 Hz": (float(np.degrees(yaw.at(1.0)[1])), "deg"),
        "lateral acceleration, phase at 1 Hz": (float(np.degrees(lateral.at(1.0)[1])), "deg"),
    }


DWELL_BEGIN, DWELL_FREQUENCY, DWELL = 1.0, 0.7, 0.5
DWELL_END = DWELL_BEGIN + 1 / DWELL_FREQUENCY + DWELL
FACTORS = (1.5, 3.0, 4.5, 5.5, 6.5)


def dwell_formula(amplitude: float) -> str:
    """Return the steering of ISO 19365: a sine of 0.7 Hz with a dwell of 0.5 s at its second peak."""
    first, third = 0.75 / DWELL_FREQUENCY, 0.75 / DWELL_FREQUENCY + DWELL
    time = f"min(t - {DWELL_BEGIN}, {first!r}) + max(t - {DWELL_BEGIN + third!r}, 0)"
    return f"({amplitude!r})*sin(2*pi*{DWELL_FREQUENCY}*min(max({time}, 0), {1 / DWELL_FREQUENCY!r}))"


def dwell(known: Known) -> list[Manoeuvre]:
    """Return the series of amplitudes, 1.5 to 6.5 times the steering at 0.3 g, with the throttle released."""
    unit = known.steer_for(0.3 * G)
    lifted = {"releases": DWELL_BEGIN}
    return [Manoeuvre(SPEED, DWELL_END + 2.2, dwell_formula(factor * unit), lifted) for factor in FACTORS]


def of_dwell(known: Known, runs: list[Run]) -> Metrics:
    """Return the yaw-rate ratios of all amplitudes, the least displacement from 5 times on, and the verdict."""
    found, stable = Metrics(), True
    displacements = []
    for factor, run in zip(FACTORS, runs, strict=True):
        one = sine_with_dwell(
            run["time"], run[STEER + "_seen"], run["vehicle.yaw_rate"], run["vehicle.y"], DWELL_BEGIN, DWELL_END
        )
        found[f"yaw rate ratio after 1 s, {factor:g} A"] = 100 * one.ratio_1, "%"
        found[f"yaw rate ratio after 1.75 s, {factor:g} A"] = 100 * one.ratio_1_75, "%"
        stable = stable and one.stable
        displacements += [one.displacement] if factor >= 5 else []
    found["lateral displacement, 5 A and more"] = min(displacements), "m"
    return found | {"stable (1 yes, 0 no)": (float(stable), "")}


BEFORE = 30.0


def _lanes(standard: str, speed: float) -> Callable[[Known], list[Manoeuvre]]:
    def manoeuvres(known: Known) -> list[Manoeuvre]:
        """Return the course of the standard at a speed."""
        path = {"lanes": standard, "width": known.width, "start": BEFORE}
        length = STANDARDS[standard](known.width)[-1].end + BEFORE + 30
        return [Manoeuvre(speed, length / speed, driver=known.driver(), path=path)]

    return manoeuvres


def _of_lanes(standard: str) -> Callable[[Known, list[Run]], Metrics]:
    def metrics(known: Known, runs: list[Run]) -> Metrics:
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


BRAKE_TURN = 9.0


def braking_in_a_turn(known: Known) -> list[Manoeuvre]:
    """Return braking by about 4 m/s^2 on a circle of 100 m at 5 m/s^2, with the steering held."""
    mass_free = {"brakes": BRAKE_TURN, "holds": BRAKE_TURN - 0.2, "pressing": 0.2}
    path = {"circle": RADIUS, "entry": 10.0, "transition": 60.0}
    speed = float(np.sqrt(5.0 * RADIUS))
    return [Manoeuvre(speed, BRAKE_TURN + 3.0, driver={**known.driver(), **mass_free}, path=path)]


def of_braking_in_a_turn(known: Known, runs: list[Run]) -> Metrics:
    """Return the reaction of the yaw rate, deceleration and sideslip after braking begins."""
    run = runs[0]
    after = run["time"] >= BRAKE_TURN
    yaw_rate, speed = run["vehicle.yaw_rate"], run["vehicle.speed"]
    one = int(np.searchsorted(run["time"], BRAKE_TURN + 1.0))
    return {
        "lateral acceleration before": (float(np.interp(BRAKE_TURN - 0.2, run["time"], run["vehicle.ay"])), "m/s^2"),
        "deceleration 1 s after": (float(-run["vehicle.ax"][one]), "m/s^2"),
        "yaw rate ratio 1 s after": (yaw_rate_ratio(run["time"], yaw_rate, speed, BRAKE_TURN), ""),
        "largest yaw rate over that before": (
            float(np.max(yaw_rate[after]) / np.interp(BRAKE_TURN, run["time"], yaw_rate)),
            "",
        ),
        "largest sideslip": (float(np.degrees(np.max(np.abs(run["vehicle.sideslip"][after])))), "deg"),
    }


def straight_braking(known: Known) -> list[Manoeuvre]:
    """Return braking from 100 km/h with the pedal at the driver's braking force of 6 kN."""
    return [Manoeuvre(100 / 3.6, 12.0, driver={"brakes": 1.0})]


def of_straight_braking(known: Known, runs: list[Run]) -> Metrics:
    """Return mean fully developed deceleration, stopping distance and the largest slip."""
    run = runs[0]
    part = run["time"] >= 1.0
    time, speed = run["time"][part], run["vehicle.speed"][part]
    moving = speed > 0.05 * speed[0]
    slip = min(float(np.min(run[f"{tyre}.slip"][part][moving])) for tyre in known.car.tyres.values())
    distance = np.sum((speed[1:] + speed[:-1]) / 2 * np.diff(time))
    return {
        "mean fully developed deceleration": (mean_deceleration(time, speed), "m/s^2"),
        "distance": (float(distance), "m"),
        "largest braking slip": (-100 * slip, "%"),
        "lateral deviation": (float(np.max(np.abs(run["vehicle.y"]))), "m"),
    }


def ride(known: Known) -> list[Manoeuvre]:
    """Return 20 s on a random road of class B at 80 km/h."""
    road = {
        "type": "iso8608", "roughness": "B", "seed": 1, "start": 20.0, "entry": 20.0, "shortest": 0.3,
        "track": known.car.track,
    }  # fmt: skip
    return [Manoeuvre(SPEED, 22.0, "0", road=road, output=0.005)]


def of_ride(known: Known, runs: list[Run]) -> Metrics:
    """Return weighted accelerations of the reference point and the dynamic wheel load."""
    run = runs[0]
    part = run["time"] >= 2.0
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
    manoeuvres : callable
        Returns the manoeuvres from `Known`.
    metrics : callable
        Returns the metrics from `Known` and the runs of the manoeuvres.
    shown : tuple of (str, str)
        Channels on both axes of the test's figure.
    """

    title: str
    manoeuvres: Callable[[Known], list[Manoeuvre]]
    metrics: Callable[[Known, list[Run]], Metrics]
    shown: tuple[str, str]


SEEN = STEER + "_seen"
TESTS: dict[str, HandlingTest] = {
    "constant_speed": HandlingTest("Slow ramp at 80 km/h, ISO 4138", constant_speed, of_constant_speed, ("vehicle.ay", SEEN)),
    "constant_radius": HandlingTest("Circle of 100 m, ISO 4138", constant_radius, of_constant_radius, ("vehicle.ay", SEEN)),
    "step_steer": HandlingTest("Step of steering at 80 km/h, ISO 7401", step_steer, of_step_steer, ("time", "vehicle.yaw_rate")),
    "frequency_response": HandlingTest("Sweep of steering at 80 km/h, ISO 7401", frequency, of_frequency, ("time", "vehicle.yaw_rate")),
    "sine_with_dwell": HandlingTest("Sine with dwell at 80 km/h, ISO 19365", dwell, of_dwell, ("time", "vehicle.yaw_rate")),
    "lane_change": HandlingTest("Double lane change at 80 km/h, ISO 3888-1", _lanes("iso3888-1", SPEED), _of_lanes("iso3888-1"), ("vehicle.x", "vehicle.y")),
    "obstacle_avoidance": HandlingTest("Obstacle avoidance at 50 km/h, ISO 3888-2", _lanes("iso3888-2", 50 / 3.6), _of_lanes("iso3888-2"), ("vehicle.x", "vehicle.y")),
    "braking_in_a_turn": HandlingTest("Braking on a circle of 100 m, ISO 7975", braking_in_a_turn, of_braking_in_a_turn, ("time", "vehicle.yaw_rate")),
    "straight_braking": HandlingTest("Braking from 100 km/h, ISO 21994", straight_braking, of_straight_braking, ("time", "vehicle.speed")),
    "ride": HandlingTest("Random road of class B at 80 km/h, ISO 2631-1", ride, of_ride, ("time", "vehicle.az")),
}  # fmt: skip
"""All tests by name."""
