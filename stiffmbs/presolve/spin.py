"""The orientation of a body whose quaternion doesn't follow its spin, from that and the angle of the spin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compile.quaternions import CONJUGATE, rotated, times


class Spin(NamedTuple):
    """A body of a part whose quaternion doesn't follow its spin.

    Attributes
    ----------
    body : int
        Its number in the part.
    axis : int
        The principal axis of the spin.
    angle : int
        The coordinate of the part that holds the angle.
    """

    body: int
    axis: int
    angle: int

    def turned(self, q: np.ndarray, u: np.ndarray, angle: np.ndarray) -> None:
        """Turn the body, in arrays of shapes (rows, bodies, n_q) and (rows, bodies, n_u), by the angle; shape (rows,)."""
        turn = np.zeros((len(angle), 4))
        turn[:, 0], turn[:, 1 + self.axis] = np.cos(angle / 2), np.sin(angle / 2)
        q[:, self.body, 3:] = times(q[:, self.body, 3:], turn)
        u[:, self.body, 3:] = rotated(CONJUGATE * turn, u[:, self.body, 3:])
