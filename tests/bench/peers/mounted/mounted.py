"""Bodies on bushings and struts as plain numbers: what a user of any tool starts from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

GROUND = -1
Shown = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Solid:
    """A body at rest at the start, its axes being those of ground.

    Attributes
    ----------
    centre, moments : ndarrays, shape (3,)
        Of mass, m, and about the body's axes, kg m^2.
    mass : float
    """

    centre: np.ndarray
    mass: float
    moments: np.ndarray


@dataclass(frozen=True)
class Mount:
    """A bushing with ground axes that resists no rotation: ``f = -stiffness d - damping d'`` on body i.

    Attributes
    ----------
    i, j : int
    point : ndarray, shape (3,)
        At which both are joined at the start, m.
    stiffness, damping : ndarrays, shape (3,)
        N/m, N s/m.
    """

    i: int
    j: int
    point: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray


@dataclass(frozen=True)
class Strut:
    """A spring and damper between two points, without force at the start."""

    i: int
    j: int
    end: np.ndarray
    other: np.ndarray
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Mounted:
    """What is solved; nothing but the shaker does work on it.

    Attributes
    ----------
    solids, mounts, struts : tuples
    shaken : int
        Number of the body whose centre is pushed upwards by ``amplitude sin(rate t)``, N.
    amplitude, rate : float
    times : ndarray
        Of output, s.
    """

    solids: tuple[Solid, ...]
    mounts: tuple[Mount, ...]
    struts: tuple[Strut, ...]
    shaken: int
    amplitude: float
    rate: float
    times: np.ndarray

    def arm(self, body: int, point: np.ndarray) -> np.ndarray:
        """From a body's centre, or from the origin, to a point at the start."""
        return np.asarray(point - (0.0 if body == GROUND else self.solids[body].centre))

    def forces(self, x: np.ndarray, p: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Forces of all mounts, N, from rows of places, Euler parameters, velocities, and angular velocities in body axes.

        All have the shape (times, bodies, 3 or 4).
        """
        rows = []
        for mount in self.mounts:
            (at_i, rate_i), (at_j, rate_j) = (
                _motion(self, body, mount.point, x, p, v, w) for body in (mount.i, mount.j)
            )
            rows.append(-mount.stiffness * (at_i - at_j) - mount.damping * (rate_i - rate_j))
        return np.concatenate(rows, axis=1)


@dataclass(frozen=True)
class Shaken:
    """Bodies, and what of their motion is compared.

    Attributes
    ----------
    mounted : Mounted
    shown : callable
        Rows of it from rows of places, Euler parameters, velocities, and angular velocities in body axes, as `Mounted.forces` has them.
    """

    mounted: Mounted
    shown: Shown


def _motion(mounted: Mounted, body: int, point: np.ndarray, *state: np.ndarray) -> tuple[Any, Any]:
    """Place and velocity of a body's point."""
    if body == GROUND:
        return point, 0.0
    x, p, v, w = (part[:, body] for part in state)
    arm, speed = (
        turned(p, z)
        for z in (np.broadcast_to(mounted.arm(body, point), x.shape), np.cross(w, mounted.arm(body, point)))
    )
    return x + arm, v + speed


def turned(p: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Vectors of body axes in ground axes, by Euler parameters."""
    e0, e = p[:, :1], p[:, 1:]
    across = 2 * np.cross(e, z)
    return np.asarray(z + e0 * across + np.cross(e, across))
