"""Results that the tests of a car share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ...model.paths.lanes import LENGTH
from .car import STEER, Car
from .parameters import SPEED

SEEN = STEER + "_seen"
"""Request of the angle or displacement of the steering joint."""
STEERING_LAG = 0.05
"""Own lag of the driver's steering, s: the default of the part `driver`."""
LEAST_GROWTH = 0.2
"""Least 1 + V^2/V_ch^2 of an oversteering car, which is zero at its critical speed."""
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
    lag: float = 0.12  # delay from steering to lateral acceleration of the reference point at 80 km/h, s
    length: float = LENGTH  # length of the vehicle, m

    @property
    def ratio(self) -> float:
        """Steer angle of the wheels per unit of steering: L over the steering per curvature at low speed."""
        return self.car.wheelbase / self.per_curvature

    def driver(self, speed: float) -> dict[str, float]:
        """Return the driver's parameters of this car at a speed, m/s.

        Car and steering respond as two first-order lags a and b, whose inverse is (1 + a s)(1 + b s). Steering ahead by
        both is 1 + (a + b) s + (a + b)^2 s^2/2, which has (a^2 + b^2)/2 more of the second derivative.
        """
        lag = self.lag_at(speed)
        return {
            "per_curvature": self.per_curvature, "understeer": self.understeer, "anticipation": lag,
            "shaping": -(lag**2 + STEERING_LAG**2) / 2,
        }  # fmt: skip

    def lag_at(self, speed: float) -> float:
        """Return the delay from steering to the lateral acceleration of the driver's point, s, negative at low speeds.

        That of the linear bicycle model is c V/(1 + V^2/V_ch^2) - b/V, where b is the distance to the rear axle: a slow
        car turns about its rear axle, so that points ahead of it move aside at once. c follows from `lag`, with the
        distance of the reference point.
        """
        growth = self.understeer / self.per_curvature
        part = (self.lag + self.car.behind(self.car.measured) / SPEED) * (1 + growth * SPEED**2) / SPEED
        return part * speed / max(1 + growth * speed**2, LEAST_GROWTH) - self.car.behind(self.car.centre) / speed

    def steer_for(self, acceleration: float) -> float:
        """Return the steering for a steady lateral acceleration, by interpolation in the ramp from straight ahead on.

        Raises InputError if the ramp did not reach it.
        """
        ay = np.maximum.accumulate(self.ramp["vehicle.ay"])
        if ay[-1] < acceleration:
            raise InputError(f"found a largest lateral acceleration of {ay[-1]:.3g} m/s^2, expected {acceleration:.3g}")
        return float(np.interp(acceleration, np.append(0.0, ay), np.append(0.0, self.ramp[SEEN])))
