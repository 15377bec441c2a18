"""Ride on a random road, ISO 2631-1."""

from __future__ import annotations

import numpy as np

from .car import Manoeuvre
from .known import Known, Metrics, Run
from .parameters import Ride
from .vibration import total_vibration, weighted_rms


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
