"""Steady-state cornering, ISO 4138: slow ramp of steering and circle."""

from __future__ import annotations

import numpy as np

from .car import Car, Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .metrics import gradient_at_zero, rollover_threshold, static_stability_factor, understeer_gradient
from .parameters import SPEED, ConstantRadius, ConstantSpeed, G

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
    gradient = understeer_gradient(ay, run[SEEN], known.ratio, **speed)
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
