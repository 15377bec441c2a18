"""Point masses between springs and drags, by equations of their own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from stiffmbs.elements.body import Body
from stiffmbs.elements.spatial.body import Body as SpatialBody
from stiffmbs.model import model as plane
from stiffmbs.model import spatial_model as space
from stiffmbs.model.model_builder import ModelBuilder

GROUND = -1
AXES = "xyz"
WIDTH = 1e-7
"""Half the width of differences, m and m/s."""


@dataclass(frozen=True)
class Spring:
    """A linear spring between two masses, or a mass and the origin (`GROUND`): N/m and m."""

    i: int
    j: int
    stiffness: float
    length: float


@dataclass(frozen=True)
class Network:
    """Point masses, springs between them, and what resists the motion of each.

    Attributes
    ----------
    masses : tuple of float
        kg.
    positions, velocities : tuples of tuple of float
        m and m/s, with two or three components.
    springs : tuple of Spring
    drags : tuple of float
        N s/m; the force on each mass is -c v, or -c |v| v where `quadratic`.
    quadratic : bool
    """

    masses: tuple[float, ...]
    positions: tuple[tuple[float, ...], ...]
    velocities: tuple[tuple[float, ...], ...]
    springs: tuple[Spring, ...]
    drags: tuple[float, ...]
    quadratic: bool = False

    @property
    def dimensions(self) -> int:
        """2 or 3."""
        return len(self.positions[0])

    def model(self) -> ModelBuilder:
        """The network as bodies and force elements, named m0, m1, ..."""
        planar = self.dimensions == 2
        kinds: Any = plane if planar else space
        model: ModelBuilder = kinds.Model("Network")
        for k, (mass, x, v) in enumerate(zip(self.masses, self.positions, self.velocities, strict=True)):
            body: Any = Body(mass=mass, inertia=1, position=x, velocity=v) if planar else SpatialBody(
                mass=mass, inertia=(1, 1, 1), position=x, velocity=v
            )  # fmt: skip
            model.add(f"m{k}", body)
        for k, spring in enumerate(self.springs):
            ends = [f"m{end}" if end != GROUND else "ground" for end in (spring.i, spring.j)]
            model.add(
                f"s{k}",
                kinds.FORCES["spring_damper"](
                    i=ends[0], j=ends[1], stiffness=spring.stiffness, free_length=spring.length
                ),
            )
        for k, drag in enumerate(self.drags):
            if drag:
                model.add(f"d{k}", kinds.FORCES["force"](i=f"m{k}", force=self._drag(k, drag)))
        return model

    def _drag(self, k: int, drag: float) -> tuple[str, ...]:
        speeds = [f"m{k}.v{axis}" for axis in AXES[: self.dimensions]]
        size = f"sqrt({' + '.join(f'{speed}^2' for speed in speeds)} + 1e-20)*" if self.quadratic else ""
        return tuple(f"-{drag!r}*{size}{speed}" for speed in speeds)

    def rates(self, t: float, state: np.ndarray) -> np.ndarray:
        """Derivatives of positions and velocities."""
        x, v = state.reshape(2, len(self.masses), self.dimensions)
        drags = np.array(self.drags)[:, None]
        force = -drags * v * (np.sqrt((v**2).sum(axis=1, keepdims=True) + 1e-20) if self.quadratic else 1.0)
        for spring in self.springs:
            along = x[spring.i] - (x[spring.j] if spring.j != GROUND else 0.0)
            length = float(np.linalg.norm(along))
            pull = spring.stiffness * (length - spring.length) * along / length
            force[spring.i] -= pull
            if spring.j != GROUND:
                force[spring.j] += pull
        return np.concatenate([v.ravel(), (force / np.array(self.masses)[:, None]).ravel()])

    def _tangent(self, t: float, state: np.ndarray) -> np.ndarray:
        """Derivatives of the rates by central differences: one-sided ones are too coarse for light masses."""
        shifts = WIDTH * np.eye(state.size)
        return np.stack([(self.rates(t, state + d) - self.rates(t, state - d)) / (2 * WIDTH) for d in shifts], axis=1)

    @cache  # noqa: B019
    def solved(self, duration: float, rtol: float, method: str) -> tuple[np.ndarray, int]:
        """Positions at the end, shape (masses, dimensions), and steps, by an integrator of SciPy."""
        start = np.concatenate([np.ravel(self.positions), np.ravel(self.velocities)])
        found = solve_ivp(self.rates, (0.0, duration), start, method=method, rtol=rtol, atol=rtol, jac=self._tangent)
        end: np.ndarray = found.y[: start.size // 2, -1]
        return end.reshape(len(self.masses), self.dimensions), len(found.t) - 1
