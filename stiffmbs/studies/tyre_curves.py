"""Curves of a tyre of a property file: forces over slips, and friction ellipses, at several loads and pressures."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from ..elements.tyres.coefficients import TyreProperties
from ..reading.fields import Described
from ..reading.units import si

PARTS_OF_LOAD = (0.5, 1.0, 1.5)
"""Loads by default, in nominal loads."""
SLIP, ANGLE = 0.3, math.radians(15)
"""Ends of the curves over slip and slip angle, unless the valid ranges of the file are narrower."""
FAR_SLIP, FAR_ANGLE = 1.0, math.radians(40)
"""Ends of the slips for friction ellipses."""
DIRECTIONS = 73
"""Directions of slip of a friction ellipse, both ends included."""
STATE = ("Fz", "kappa", "alpha", "gamma", "p", "Vx", "phit")
"""Columns of a state that is evaluated by itself."""
CONSTANTS = ("Kxk", "Kya", "mux", "muy", "Re", "rho", "Rl", "sigma_x", "sigma_y")
"""Values at zero slip that are listed for each load."""


class TyreSweep(Described):
    """Loads, pressures, camber and speed of the curves, and the number of points of each."""

    load: tuple[si.PositiveForce, ...] = Field(
        (), description="N; half, all and one and a half of the nominal load by default"
    )
    pressure: tuple[si.PositivePressure, ...] = Field(
        (), description="Pa, of 6.1, 6.2 and PAC2002; that of the file by default"
    )
    camber: si.Angle = Field(0.0, description="rad")
    speed: si.PositiveVelocity | None = Field(None, description="m/s; LONGVL by default")
    points: int = Field(61, ge=3, le=10001, description="of each curve")


@dataclass(frozen=True)
class TyreCurve:
    """Curves at one load and pressure; arrays in SI units and ISO axes."""

    load: float
    pressure: float | None
    # kappa, fx: longitudinal slip, and Fx without slip angle
    kappa: np.ndarray
    fx: np.ndarray
    # alpha, fy, mz: slip angle, and Fy and Mz without longitudinal slip
    alpha: np.ndarray
    fy: np.ndarray
    mz: np.ndarray
    ellipse: tuple[np.ndarray, np.ndarray]  # fx and Fy of largest magnitude in each direction of slip
    constants: dict[str, float]  # stiffnesses, friction, radii and relaxation lengths at zero slip

    def as_dict(self) -> dict[str, object]:
        """Return the numbers for JSON."""
        names = {"kappa": self.kappa, "Fx": self.fx, "alpha": self.alpha, "Fy": self.fy, "Mz": self.mz}
        ellipse = {name: x.tolist() for name, x in zip(("Fx", "Fy"), self.ellipse, strict=True)}
        curves = {name: x.tolist() for name, x in names.items()}
        return {"load": self.load, "pressure": self.pressure, **finite(self.constants), **curves, "ellipse": ellipse}


def finite(found: Mapping[str, float]) -> dict[str, float | None]:
    """Return numbers for JSON, None for those that are not known."""
    return {name: x if math.isfinite(x) else None for name, x in found.items()}


def tyre_curves(tyre: TyreProperties, sweep: TyreSweep) -> list[TyreCurve]:
    """Return the curves of a tyre, load by load and pressure by pressure.

    Raises InputError for what `TyreProperties.steady_state` refuses.
    """
    loads = sweep.load or tuple(part * tyre.nominal_load for part in PARTS_OF_LOAD)
    pressures = sweep.pressure or (tyre.nominal_pressure,)
    return [_curve(tyre, load, pressure, sweep) for load, pressure in itertools.product(loads, pressures)]


def _curve(tyre: TyreProperties, load: float, pressure: float | None, sweep: TyreSweep) -> TyreCurve:
    kappa = np.linspace(*_within(tyre, "slip", SLIP), sweep.points)
    alpha = np.linspace(*_within(tyre, "slip_angle", ANGLE), sweep.points)
    along, across, still = (
        tyre.steady_state(load, slip, angle, sweep.camber, pressure, sweep.speed)
        for slip, angle in ((kappa, 0.0), (0.0, alpha), (0.0, 0.0))
    )
    constants = {name: float(still[name]) for name in CONSTANTS}
    ellipse = _ellipse(tyre, load, pressure, sweep)
    return TyreCurve(load, pressure, kappa, along["Fx"], alpha, across["Fy"], across["Mz"], ellipse, constants)


def _ellipse(
    tyre: TyreProperties, load: float, pressure: float | None, sweep: TyreSweep
) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces of largest magnitude along each direction of slip."""
    direction = np.linspace(0, 2 * math.pi, DIRECTIONS)[:, None]
    size = np.linspace(0, 1, sweep.points) ** 2  # denser at small slips
    kappa = np.clip(FAR_SLIP * size * np.cos(direction), *_within(tyre, "slip", FAR_SLIP))
    alpha = np.clip(FAR_ANGLE * size * np.sin(direction), *_within(tyre, "slip_angle", FAR_ANGLE))
    found = tyre.steady_state(load, kappa, alpha, sweep.camber, pressure, sweep.speed)
    most = np.argmax(np.hypot(found["Fx"], found["Fy"]), axis=1)
    rows = np.arange(DIRECTIONS)
    return found["Fx"][rows, most], found["Fy"][rows, most]


def _within(tyre: TyreProperties, channel: str, end: float) -> tuple[float, float]:
    low, high = tyre.ranges.get(channel, (-math.inf, math.inf))
    return max(-end, low), min(end, high)


def tyre_states(tyre: TyreProperties, rows: list[tuple[float | None, ...]]) -> list[dict[str, float]]:
    """Return the steady state at single states of Fz, kappa, alpha, gamma, p, Vx and phit; those omitted or None have their defaults."""
    found = []
    for row in rows:
        given = {name: x for name, x in zip(STATE, row, strict=False) if x is not None}
        found.append({**given, **{name: float(x) for name, x in tyre.steady_state(**given).items()}})
    return found
