"""Independent coordinates, and relations of the others to them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from .system import System

FIXED: Final = -1


@dataclass(frozen=True, eq=False)  # array comparison has no single truth value: compare by identity
class Coordinates:
    """Independent coordinates, coordinates in a constant ratio with one, and fixed coordinates.

    q_k = offset_k + ratio_k q_l with l = leader_k; the offsets are those of any pose that satisfies the constraints.
    Velocities likewise.

    - `independent_of` of shape (n_q,): leader of each coordinate, itself if independent; `FIXED` for fixed
      coordinates.
    - `ratio` of shape (n_q,).
    - `u_independent_of`, `u_ratio` of shape (n_u,): leaders and ratios of velocities.
    - `satisfied` of shape (n_c,): equations satisfied for any values of the independent coordinates.
    """

    independent_of: np.ndarray
    ratio: np.ndarray
    u_independent_of: np.ndarray
    u_ratio: np.ndarray
    satisfied: np.ndarray

    @cached_property
    def independent(self) -> np.ndarray:
        """Mask of the independent coordinates, shape (n_q,)."""
        return self.independent_of == np.arange(len(self.independent_of))

    @cached_property
    def count(self) -> int:
        """Number of independent coordinates."""
        return int(self.independent.sum())

    @cached_property
    def independent_u(self) -> np.ndarray:
        """Mask of the independent velocities, shape (n_u,)."""
        return self.u_independent_of == np.arange(len(self.u_independent_of))

    def relation(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return leaders and ratios of the coordinates (``q``) or velocities (``u``)."""
        return (self.independent_of, self.ratio) if name == "q" else (self.u_independent_of, self.u_ratio)

    def state(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the independent coordinates followed by the independent velocities."""
        return np.concatenate([q[self.independent], u[self.independent_u]])

    def offset(self, q: np.ndarray) -> np.ndarray:
        """Return the offsets of all coordinates from a pose."""
        return q - self.ratio * q[self.independent_of]  # the ratio of a fixed coordinate is zero


def all_independent(system: System) -> Coordinates:
    """Return coordinates without relations: constraint equations hold them together."""
    q, u = np.arange(system.n_q), np.arange(system.n_u)
    return Coordinates(q, np.ones(len(q)), u, np.ones(len(u)), np.zeros(system.n_c, dtype=bool))
