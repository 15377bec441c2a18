"""Orientation of a body from a quaternion without its spin, and the spin angle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times


class Spin(NamedTuple):
    """Body of a part whose quaternion excludes its spin.

    Attributes
    ----------
    body : int
        Its number in the part.
    axis : int
        Principal axis of the spin.
    angle : int
        Coordinate of the part that holds the angle.
    """

    body: int
    axis: int
    angle: int

    def turned(self, q: np.ndarray, u: np.ndarray, angle: np.ndarray) -> None:
        """Rotate the body by the angle (rows,), in arrays of shapes (rows, bodies, n_q) and (rows, bodies, n_u)."""
        turn = np.zeros((len(angle), 4))
        turn[:, 0], turn[:, 1 + self.axis] = np.cos(angle / 2), np.sin(angle / 2)
        q[:, self.body, 3:] = times(q[:, self.body, 3:], turn)
        u[:, self.body, 3:] = rotated(CONJUGATE * turn, u[:, self.body, 3:])
