"""Changes of the described start by the assembly, body by body, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..compile.system import System

WORTH_TELLING = 1e-9
"""Smallest change that is reported (m, rad, m/s, rad/s)."""
MUCH_LESS = 1e-3
"""Smallest reported part of a change (translation or rotation), as a fraction of the larger part."""
ALONG = 0.999
"""Fraction of a translation along one axis from which on it is reported by that coordinate."""
DEGREES = math.radians(1.0)
"""Smallest rotation that is also reported in degrees."""
LARGE_SHIFT, LARGE_TURN = 0.25, math.radians(45.0)
"""Translation, in sizes of the mechanism, and rotation beyond which a move is no correction of a drawing."""


class Move(NamedTuple):
    """Change of one body by the assembly.

    Attributes
    ----------
    body : str
    shift : tuple of float
        Of the centre of mass, m.
    turn : float
        Rotation, rad; in space its angle.
    velocity : tuple of float
        Change of the centre's velocity, m/s.
    omega : float
        Change of the angular velocity, rad/s; in space its norm.
    """

    body: str
    shift: tuple[float, ...]
    turn: float
    velocity: tuple[float, ...]
    omega: float

    @property
    def distance(self) -> float:
        """Length of the translation, m."""
        return math.hypot(*self.shift)

    def is_large(self, size: float) -> bool:
        """Return True if the move is larger than a correction of a drawing, for a mechanism of a size in m."""
        return self.distance > LARGE_SHIFT * size or abs(self.turn) > LARGE_TURN

    def of_position(self, size: float) -> tuple[float, float]:
        """Return the translation in sizes of the mechanism, and the rotation."""
        return self.distance / size, abs(self.turn)

    def of_velocity(self, size: float) -> tuple[float, float]:
        """Return the velocity change in sizes of the mechanism, 1/s, and the angular velocity change."""
        return math.hypot(*self.velocity) / size, abs(self.omega)


def moves(system: System, q: np.ndarray, u: np.ndarray) -> tuple[Move, ...]:
    """Return the reportable changes of each body.

    Parameters
    ----------
    q, u : ndarrays, shape (n_u,)
        Displacements and velocity changes of all bodies.
    """
    if max(np.abs(q).max(initial=0.0), np.abs(u).max(initial=0.0)) <= WORTH_TELLING:
        return ()
    straight, width = system.of_body.linear, system.of_body.n_u
    found = []
    for body, of_q, of_u in zip(system.bodies, q.reshape(-1, width), u.reshape(-1, width), strict=True):
        if max(np.abs(of_q).max(), np.abs(of_u).max()) > WORTH_TELLING:
            (turn, omega) = (
                float(v[-1] if width == straight + 1 else np.linalg.norm(v[straight:])) for v in (of_q, of_u)
            )
            found.append(Move(body, tuple(of_q[:straight].tolist()), turn, tuple(of_u[:straight].tolist()), omega))
    return tuple(found)


def position_words(moved: Sequence[Move], size: float, most: int) -> str:
    """List the bodies that were moved, the largest moves first; those beyond the first `most` are counted."""
    return _listed(moved, lambda move: move.of_position(size), _position, most)


def velocity_words(moved: Sequence[Move], size: float, most: int) -> str:
    """List the bodies whose velocities were changed, the largest changes first, as `position_words` does."""
    return _listed(moved, lambda move: move.of_velocity(size), _velocity, most)


def _listed(
    moved: Sequence[Move], sizes: Callable[[Move], tuple[float, float]],
    words: Callable[[Move, tuple[float, float]], list[str]], most: int,
) -> str:  # fmt: skip
    order = sorted(moved, key=lambda move: -max(sizes(move)))
    told = [(move, parts) for move in order if (parts := words(move, sizes(move)))]
    more = len(told) - most
    less = f" (and {more} more {'bodies' if more > 1 else 'body'} by less)" if more > 0 else ""
    return ", ".join(part for _, parts in told[:most] for part in parts) + less


def _position(move: Move, sizes: tuple[float, float]) -> list[str]:
    degrees = f" ({math.degrees(move.turn):.3g} deg)" if abs(move.turn) > DEGREES else ""
    return _both(
        sizes,
        move.shift,
        _shift(move.body, move.shift, "", "m"),
        move.turn,
        f"{move.body}.angle by {move.turn:.3g} rad{degrees}",
    )


def _velocity(move: Move, sizes: tuple[float, float]) -> list[str]:
    turning = f"{move.body}.omega by {move.omega:.3g} rad/s"
    return _both(sizes, move.velocity, _shift(move.body, move.velocity, "v", "m/s"), move.omega, turning)


def _both(sizes: tuple[float, float], shift: tuple[float, ...], of_shift: str, turn: float, of_turn: str) -> list[str]:
    """Return the reported parts of a move, without rounding and parts far smaller than the other."""
    least = MUCH_LESS * max(sizes)
    straight = [of_shift] if math.hypot(*shift) > WORTH_TELLING and sizes[0] >= least else []
    return straight + ([of_turn] if abs(turn) > WORTH_TELLING and sizes[1] >= least else [])


def _shift(body: str, shift: tuple[float, ...], prefix: str, unit: str) -> str:
    """Describe a translation by its coordinate if it is along one, else by its length."""
    k = max(range(len(shift)), key=lambda n: abs(shift[n]))
    length = math.hypot(*shift)
    if abs(shift[k]) >= ALONG * length:
        return f"{body}.{prefix}{'xyz'[k]} by {shift[k]:.3g} {unit}"
    return f"{body} by {length:.3g} {unit}" if not prefix else f"{body}'s velocity by {length:.3g} {unit}"
