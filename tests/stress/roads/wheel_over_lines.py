"""Independent integration of a sprung mass over a piecewise linear road, by smooth phases of its motion.

The equations are smooth within a phase, which is defined by the lines at its two points, contact, and load.  A phase ends when one of
its bounds becomes zero; the next phase is that of the state slightly later.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

GRAVITY = 9.81
AHEAD = 1e-9
"""Time after an event at which the next phase is determined, s."""
LONGEST = 0.01
"""Time step, s."""


class Lines(NamedTuple):
    """Straight lines through points, extrapolated with the end slopes."""

    x: np.ndarray
    z: np.ndarray

    def at(self, x: float) -> int:
        """Return the number of the line at a position."""
        return int(np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2))

    def slope(self, line: int) -> float:
        """Return the slope of a line."""
        return float((self.z[line + 1] - self.z[line]) / (self.x[line + 1] - self.x[line]))

    def height(self, line: int, x: float) -> float:
        """Return the height of a line, extended beyond its ends."""
        return float(self.z[line] + self.slope(line) * (x - self.x[line]))

    def bounds(self, line: int, x: float) -> tuple[float, float]:
        """Return two numbers that are positive on a line."""
        last = len(self.x) - 2
        return (x - self.x[line] if line else 1.0), (self.x[line + 1] - x if line < last else 1.0)


class Regime(NamedTuple):
    """Lines at the centre and at the point of contact, and flags for contact and for positive load."""

    first: int
    second: int
    touches: bool
    carries: bool


@dataclass(frozen=True)
class SprungPoint:
    """Mass on a spring and damper above straight lines, with the state x, z, vx, vz.

    Attributes
    ----------
    lines : Lines
    mass, radius, stiffness, damping : float
        kg, m, N/m, N s/m.
    upright : bool
        True if the force is vertical, from the height below the centre, as in a formula.  Otherwise it acts at a wheel's point of
        contact: on the normal of the line below the centre, then on that of the line at this point (Pacejka, Tire and Vehicle
        Dynamics, 2012, sec. 2.2).
    """

    lines: Lines
    mass: float
    radius: float
    stiffness: float
    damping: float
    upright: bool = False

    def contact(self, y: np.ndarray, first: int) -> float:
        """Return the x coordinate of the contact."""
        s = self.lines.slope(first)
        below = y[1] - self.lines.height(first, y[0])
        return float(y[0] if self.upright else y[0] + below * s / (1 + s * s))

    def deflection(self, y: np.ndarray, regime: Regime) -> tuple[float, float, np.ndarray]:
        """Return the deflection, its rate, and the direction of the force."""
        x, z, vx, vz = y
        if self.upright:
            s = self.lines.slope(regime.first)
            return self.lines.height(regime.first, x) + self.radius - z, s * vx - vz, np.array([0.0, 1.0])
        s, point = self.lines.slope(regime.first), self.contact(y, regime.first)
        below = z - self.lines.height(regime.first, x)
        height = z - below / (1 + s * s)
        s2 = self.lines.slope(regime.second)
        normal = np.array([-s2, 1.0]) / np.hypot(1, s2)
        radius = below / np.hypot(1, s) + (height - self.lines.height(regime.second, point)) / np.hypot(1, s2)
        return self.radius - radius, -float(normal @ (vx, vz)), normal

    def load(self, y: np.ndarray, regime: Regime) -> tuple[float, float, np.ndarray]:
        """Return the deflection, the force before it is limited to positive values, and its direction."""
        deflection, rate, normal = self.deflection(y, regime)
        return deflection, self.stiffness * deflection + self.damping * rate, normal

    def regime(self, y: np.ndarray) -> Regime:
        """Return the phase of a state."""
        first = self.lines.at(y[0])
        regime = Regime(first, self.lines.at(self.contact(y, first)), True, True)
        deflection, load, _ = self.load(y, regime)
        return regime._replace(touches=deflection > 0, carries=load > 0)

    def bounds(self, y: np.ndarray, regime: Regime) -> tuple[float, ...]:
        """Return numbers that are positive within a phase."""
        deflection, load, _ = self.load(y, regime)
        return (
            *self.lines.bounds(regime.first, y[0]),
            *self.lines.bounds(regime.second, self.contact(y, regime.first)),
            deflection if regime.touches else -deflection,
            load if regime.carries else -load,
        )

    def rates(self, y: np.ndarray, regime: Regime) -> np.ndarray:
        """Return the rates of the state."""
        _, load, normal = self.load(y, regime)
        force = load * normal if regime.touches and regime.carries else np.zeros(2)
        return np.array([*y[2:], force[0] / self.mass, force[1] / self.mass - GRAVITY])

    def motion(self, start: Sequence[float], times: np.ndarray) -> np.ndarray:
        """Return x and z at increasing times, shape (n, 2); the first is the start time."""
        from scipy.integrate import solve_ivp

        t, y = float(times[0]), np.array(start, dtype=float)
        found = [y[None, :2]]
        while t < times[-1]:
            regime = self.regime(y + AHEAD * self.rates(y, self.regime(y)))
            events = [_bound(self, regime, k) for k in range(6)]
            wanted = times[times > t]
            part = solve_ivp(
                lambda _, y, now=regime: self.rates(y, now), (t, times[-1]), y, "DOP853", wanted,
                events=events, rtol=1e-12, atol=1e-13, max_step=LONGEST,
            )  # fmt: skip
            if len(part.t):
                found.append(part.y[:2].T)
            ends = [(at[0], state[0]) for at, state in zip(part.t_events, part.y_events, strict=True) if len(at)]
            t, y = min(ends, key=lambda end: float(end[0])) if ends else (times[-1], y)
        return np.concatenate(found)


def _bound(point: SprungPoint, regime: Regime, k: int) -> Callable[[float, np.ndarray], float]:
    def bound(_: float, y: np.ndarray) -> float:
        return point.bounds(y, regime)[k]

    bound.terminal, bound.direction = True, -1.0  # type: ignore[attr-defined]
    return bound
