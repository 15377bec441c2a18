"""Derivatives by positions of bodies, as derivatives by the velocities that change them: by q, times h Z."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .system import System


class CondensedPositions(NamedTuple):
    """Entries of a matrix by positions of bodies, condensed to columns of velocities.

    - `straight`: row, velocity, source and factor of coordinates whose rate is a velocity.
    - `turned`: place, source and factor of coordinates of quaternions.
    - `turns` of shape (n, 2): row and body of each four places.
    """

    straight: tuple[np.ndarray, ...]
    turned: tuple[np.ndarray, ...]
    turns: np.ndarray

    @classmethod
    def of(
        cls, system: System, row: np.ndarray, column: np.ndarray, source: np.ndarray, factor: np.ndarray
    ) -> CondensedPositions:
        """Sort entries of derivatives by q; those by coordinates after the bodies are left out."""
        width, velocity = system.of_body, np.full(system.n_q, -1)
        of_q, of_u = system.straight
        velocity[of_q] = of_u
        straight = velocity[column] >= 0
        turned = ~straight & (column < system.n_pose)
        pairs = np.stack([row[turned], column[turned] // width.n_q], axis=1)
        turns, of_turn = np.unique(pairs, axis=0, return_inverse=True)
        place = 4 * of_turn.reshape(-1) + column[turned] % width.n_q - 3
        plain = row[straight], velocity[column[straight]], source[straight], factor[straight]
        return cls(plain, (place, source[turned], factor[turned]), turns)

    @property
    def place(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and velocities of the entries: the straight ones, and three for each of `turns`."""
        row, body = np.repeat(self.turns, 3, axis=0).T
        turning = 6 * body + 3 + np.arange(len(body)) % 3
        return np.concatenate([self.straight[0], row]), np.concatenate([self.straight[1], turning])

    def lists(self, slot: np.ndarray) -> dict[str, np.ndarray | int]:
        """Return the columns of `EQUATIONS` with the slots of `place`."""
        first = len(self.straight[0])
        lists = {
            "straight_slot": slot[:first], "straight_source": self.straight[2], "straight_factor": self.straight[3],
            "turned_place": self.turned[0], "turned_source": self.turned[1], "turned_factor": self.turned[2],
            "turn_body": self.turns[:, 1], "turn_slot": slot[first:], "turn_row": np.zeros(4 * len(self.turns)),
        }  # fmt: skip
        floats = ("straight_factor", "turned_factor", "turn_row")
        return {
            "n_straight": first, "n_turned": len(self.turned[0]), "n_turns": len(self.turns),
            **{name: np.ascontiguousarray(part, dtype=float if name in floats else np.int32) for name, part in lists.items()},
        }  # fmt: skip


_NONE = np.empty(0, dtype=np.int64)
NOTHING_CONDENSED = CondensedPositions((_NONE,) * 4, (_NONE,) * 3, np.empty((0, 2), dtype=np.int64)).lists(_NONE)
"""Columns of `EQUATIONS` of a matrix without such entries."""
