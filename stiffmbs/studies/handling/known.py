"""Results that the tests of a car share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from .car import STEER, Car

SEEN = STEER + "_seen"
"""Request of the angle or displacement of the steering joint."""
Run = Mapping[str, np.ndarray]
"""Channels of a run with ``time``."""
Metrics = dict[str, tuple[float, str]]
"""Value and unit by name."""


@dataclass(frozen=True)
class Known:
    """Results of the preliminary runs, which scale the other tests."""

    car: Car
    # per_curvature, understeer: steering per curvature at low speed, and its growth with the squared speed
    per_curvature: float
    understeer: float
    width: float  # width of the vehicle, m
    ramp: Run  # slow ramp at the speed of the test
    lag: float = 0.12  # delay from steering to lateral acceleration at 80 km/h, s

    @property
    def ratio(self) -> float:
        """Steer angle of the wheels per unit of steering: L over the steering per curvature at low speed."""
        return self.car.wheelbase / self.per_curvature

    def driver(self) -> dict[str, float]:
        """Return the driver's parameters of this car."""
        return {"per_curvature": self.per_curvature, "understeer": self.understeer, "anticipation": self.lag}

    def steer_for(self, acceleration: float) -> float:
        """Return the steering for a steady lateral acceleration, by interpolation in the ramp from straight ahead on.

        Raises InputError if the ramp did not reach it.
        """
        ay = np.maximum.accumulate(self.ramp["vehicle.ay"])
        if ay[-1] < acceleration:
            raise InputError(f"found a largest lateral acceleration of {ay[-1]:.3g} m/s^2, expected {acceleration:.3g}")
        return float(np.interp(acceleration, np.append(0.0, ay), np.append(0.0, self.ramp[SEEN])))
