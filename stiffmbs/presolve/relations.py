"""Linear relations between coordinates, accumulated from equations with constant coefficients."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ..compile.coordinates import FIXED, Coordinates
from ..compile.system import System

NEGLIGIBLE = 1e-13
"""Coefficient that counts as zero, relative to the largest of its row."""
INDEPENDENT = 1e-6
"""Smallest singular value of independent rows, relative to the largest."""


@dataclass
class Relations:
    """Relations found so far: leaders and ratios as in `Coordinates`, and the equations used."""

    independent_of: np.ndarray
    ratio: np.ndarray
    satisfied: np.ndarray
    held: list[int] = field(default_factory=list)
    """Bodies with constant orientation."""

    @classmethod
    def none(cls, system: System) -> Relations:
        return cls(np.arange(system.n_q), np.ones(system.n_q), np.zeros(system.n_c, dtype=bool))

    def coordinates(self, system: System) -> Coordinates:
        """Return the coordinates, with velocities related as the coordinates of which they are the rates."""
        q, u = system.straight
        of_q = np.full(system.n_q, FIXED)
        of_q[q] = u
        independent_of, ratio = np.arange(system.n_u), np.ones(system.n_u)
        led = self.independent_of[q]
        independent_of[u], ratio[u] = np.where(led == FIXED, FIXED, of_q[led]), self.ratio[q]
        for body in self.held:
            turning = slice(system.of_body.n_u * body + system.of_body.linear, system.of_body.n_u * (body + 1))
            independent_of[turning], ratio[turning] = FIXED, 0.0
        return Coordinates(self.independent_of, self.ratio, independent_of, ratio, self.satisfied)

    def extended(self, rows: dict[int, list[tuple[int, float]]]) -> bool:
        """Use rows with one or two leaders, else a set with common leaders; return True if there was any."""
        used = False
        for row, entries in rows.items():
            coefficients = self._by_independent(entries)
            match sorted(coefficients, key=lambda independent_of: abs(coefficients[independent_of])):
                case [only]:
                    self._follow(only, FIXED, 0.0)
                case [other, larger]:
                    self._follow(larger, other, -coefficients[other] / coefficients[larger])
                case _:
                    continue
            self.satisfied[row] = used = True
        return used or self._tied(rows)

    def _tied(self, rows: dict[int, list[tuple[int, float]]]) -> bool:
        """Use rows with common leaders, as many as leaders or one less; return True if there was any."""
        alike: dict[frozenset[int], dict[int, dict[int, float]]] = {}
        for row, entries in rows.items():
            coefficients = self._by_independent(entries)
            alike.setdefault(frozenset(coefficients), {})[row] = coefficients
        for independents, same in alike.items():
            order, free = sorted(independents), len(independents) - len(same)
            if not order or free not in (0, 1):
                continue
            _, values, axes = np.linalg.svd(
                np.array([[part[independent_of] for independent_of in order] for part in same.values()])
            )
            if values[-1] > INDEPENDENT * values[0]:
                self._move_along(order, free * axes[-1])
                self.satisfied[list(same)] = True
                return True
        return False

    def _move_along(self, independents: list[int], direction: np.ndarray) -> None:
        """Let leaders follow the one with the largest component of a direction; fix those with a zero component."""
        chief = int(np.argmax(np.abs(direction)))
        for independent_of, part in zip(independents, direction.tolist(), strict=True):
            if abs(part) <= NEGLIGIBLE:
                self._follow(independent_of, FIXED, 0.0)
            elif independent_of != independents[chief]:
                self._follow(independent_of, independents[chief], part / direction[chief])

    def turned(self, bodies: Iterable[tuple[int, list[int]]], system: System) -> bool:
        """Fix orientations that some rows determine; return True if there was any."""
        used = False
        for body, rows in bodies:
            orientation = slice(system.of_body.n_q * body + system.of_body.linear, system.of_body.n_q * (body + 1))
            self.independent_of[orientation], self.ratio[orientation] = FIXED, 0.0
            self.satisfied[rows] = used = True
            self.held.append(body)
        return used

    def _by_independent(self, entries: list[tuple[int, float]]) -> dict[int, float]:
        """Return the coefficients of a row by the leaders of its coordinates."""
        coefficients: dict[int, float] = {}
        for column, value in entries:
            independent_of = int(self.independent_of[column])
            if independent_of != FIXED:
                coefficients[independent_of] = coefficients.get(independent_of, 0.0) + value * self.ratio[column]
        negligible = NEGLIGIBLE * max(abs(value) for _, value in entries)
        return {independent_of: value for independent_of, value in coefficients.items() if abs(value) > negligible}

    def _follow(self, follower: int, independent_of: int, ratio: float) -> None:
        """Let a leader and its followers follow another leader, or fix them."""
        followers = self.independent_of == follower
        self.independent_of[followers] = independent_of
        self.ratio[followers] *= ratio
