"""Steady-state cornering, ISO 4138: slow ramp of steering and circle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .car import Car, Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .metrics import at_zero, rollover_threshold, static_stability_factor, understeer_gradient
from .parameters import SPEED, ConstantRadius, ConstantSpeed, G


@dataclass(frozen=True)
class QuasiSteadyTurns:
    """Parameters of quasi-steady turns and starts. Source: tests/studies/handling, with the ramps of the example cars."""

    probe: float = 5.0
    """Speed of the first run, m/s."""
    spun: float = 0.25
    """Sideslip of the rear axle and roll, root of the sum of squares, beyond which a car no longer turns quasi-steadily, rad."""
    begun: float = 0.3
    """Lateral acceleration from which a ramp is quasi-steady, m/s^2."""
    drop: float = 0.9
    """Part of the largest lateral acceleration so far below which the limit is passed."""
    ramp_begin: float = 1.0
    """Begin of the slow ramp, s."""
    settled: float = 45.0
    """Way after which a car has settled on the circle, m."""
    follows: float = 4.0
    """Time after which the driver follows the growing speed steadily, s."""
    slower: float = 0.05
    """Largest difference of the speed at the start from that of a test, relative: a braking distance differs by twice it."""


TURNS = QuasiSteadyTurns()


def probe(car: Car) -> Manoeuvre:
    """Return a small step at low speed, from which steering per curvature follows."""
    return Manoeuvre(TURNS.probe, 5.0, f"step5(t, 0.5, 0, 1.5, {0.3 if car.angular else 0.005})", output=0.02)


def ramp(car: Car, per_curvature: float, speed: float = SPEED) -> Manoeuvre:
    """Return a slow ramp of steering to the left at a speed, m/s: to about 20 m/s^2, were there no limit of the tyres."""
    most = float(per_curvature * (1 + 1.5e-3 * speed**2) * 20 / speed**2)
    return Manoeuvre(speed, 46.0, f"({most!r})*max(t - {TURNS.ramp_begin}, 0)/45", spun=TURNS.spun, output=0.05)


def up_to_the_limit(run: Run) -> Run:
    """Return a turn up to its largest lateral acceleration before the car slides."""
    ay = run["vehicle.ay"]
    largest = np.maximum.accumulate(ay)
    slides = (ay < TURNS.drop * largest) & (largest > 1.0)
    end = int(np.argmax(slides)) if slides.any() else len(ay)
    last = int(np.argmax(ay[:end])) if end else 0
    return {name: values[: last + 1] for name, values in run.items()}


def quasi_steady(run: Run) -> Run:
    """Return the quasi-steady part of a ramp, up to its limit.

    The response follows the ramp after a constant delay: the steering at zero lateral acceleration is subtracted from
    its channel, which is that of steady turns then.
    """
    turn = up_to_the_limit(run)
    kept = {name: values[turn["vehicle.ay"] > TURNS.begun] for name, values in turn.items()}
    return {**kept, SEEN: kept[SEEN] - at_zero(kept["vehicle.ay"], kept[SEEN])[0]}


def lag_of(slow: Run) -> float:
    """Return the delay from the steering of a quasi-steady ramp to its lateral acceleration, s."""
    time, steer = slow["time"], slow[SEEN]
    rate = (steer[-1] - steer[0]) / (time[-1] - time[0])
    return max(float(time[0] - TURNS.ramp_begin - steer[0] / rate), 0.0)


def _steady(run: Run, known: Known) -> Metrics:
    ay, curvature = run["vehicle.ay"], run["vehicle.yaw_rate"] / run["vehicle.speed"]
    gradient = understeer_gradient(ay, run[SEEN], known.ratio, known.car.wheelbase, curvature)
    return {
        "understeer gradient": (1e3 * gradient, "mrad/(m/s^2)"),
        "understeer gradient per g": (np.degrees(gradient) * G, "deg/g"),
        "sideslip gradient": (1e3 * at_zero(ay, run["vehicle.sideslip"])[1], "mrad/(m/s^2)"),
        "roll gradient": (1e3 * at_zero(ay, run["vehicle.roll"])[1], "mrad/(m/s^2)"),
    }


def constant_speed(known: Known, test: ConstantSpeed) -> list[Manoeuvre]:
    """Return no manoeuvre: the ramp of the preliminary runs is evaluated."""
    return []


def of_constant_speed(known: Known, test: ConstantSpeed, runs: list[Run]) -> Metrics:
    """Return gradients, characteristic speed and rollover threshold from the slow ramp."""
    run = known.ramp
    ay = run["vehicle.ay"]
    found = _steady(run, known)
    gradient = found["understeer gradient"][0] / 1e3
    if gradient > 0:
        found["characteristic speed"] = float(np.sqrt(known.car.wheelbase / gradient)), "m/s"
    inner = np.stack([run[f"{known.car.wheels[f'{axle}_left'].tyre}.load"] for axle in ("front", "rear")], axis=1)
    return found | {
        "largest lateral acceleration": (float(np.max(ay)), "m/s^2"),
        "rollover threshold": (rollover_threshold(ay, inner), "m/s^2"),
        "static stability factor": (static_stability_factor(known.car.track, known.car.centre[2]), "g"),
    }


def circle(radius: float, transition: float, length: float) -> dict[str, object]:
    """Return the section ``path`` of a circle with its transition, m, that does not end within a length, m."""
    turns = float(np.ceil(length / (2 * np.pi * radius)))
    return {"circle": radius, "entry": 10.0, "transition": transition, "turns": turns}


def constant_radius(known: Known, test: ConstantRadius) -> list[Manoeuvre]:
    """Return a circle with slowly growing speed."""
    settled = TURNS.settled / test.first
    duration = settled + 1 + (test.last - test.first) / test.acceleration
    path = circle(test.radius, 30.0, test.last * duration)
    driver = {**known.driver((test.first + test.last) / 2), "acceleration": test.acceleration, "accelerates": settled}
    return [Manoeuvre(test.first, duration, driver=driver, path=path, output=0.05)]


def of_constant_radius(known: Known, test: ConstantRadius, runs: list[Run]) -> Metrics:
    """Return the gradients of the method at constant radius, up to the limit."""
    follows = runs[0]["time"] > TURNS.settled / test.first + TURNS.follows
    run = up_to_the_limit({name: values[follows] for name, values in runs[0].items()})
    found = _steady(run, known)
    return found | {"largest lateral error": (float(np.max(np.abs(run["handling_driver.lateral_error"]))), "m")}
