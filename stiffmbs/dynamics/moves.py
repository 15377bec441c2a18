"""Changes of the described start by the assembly, body by body, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from ..compile.system import System
from .native.parameters import CONSISTENCY

DEGREES = math.radians(1.0)
"""Smallest rotation that is also reported in degrees."""


class Move(NamedTuple):
    """Change of one body by the assembly.

    - `shift`: of the centre of mass, m.
    - `turn`: rotation, rad; in space its angle.
    - `velocity`: change of the centre's velocity, m/s.
    - `omega`: change of the angular velocity, rad/s; in space its norm.
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
        return self.distance > CONSISTENCY.large_shift * size or abs(math.degrees(self.turn)) > CONSISTENCY.large_turn


def moves(system: System, q: np.ndarray, u: np.ndarray) -> tuple[Move, ...]:
    """Return the reportable changes of each body.

    `q`, `u` of shape (n_u,): displacements and velocity changes of all bodies.
    """
    if max(np.abs(q).max(initial=0.0), np.abs(u).max(initial=0.0)) <= CONSISTENCY.worth_telling:
        return ()
    straight, width = system.of_body.linear, system.of_body.n_u
    found = []
    for body, of_q, of_u in zip(system.bodies, q.reshape(-1, width), u.reshape(-1, width), strict=True):
        if max(np.abs(of_q).max(), np.abs(of_u).max()) > CONSISTENCY.worth_telling:
            (turn, omega) = (
                float(v[-1] if width == straight + 1 else np.linalg.norm(v[straight:])) for v in (of_q, of_u)
            )
            found.append(Move(body, tuple(of_q[:straight].tolist()), turn, tuple(of_u[:straight].tolist()), omega))
    return tuple(found)


def position_words(moved: Sequence[Move], size: float, most: int) -> str:
    """List the bodies that were moved, the largest moves first; those beyond the first `most` are counted."""

    def turning(body: str, turn: float) -> str:
        degrees = f" ({math.degrees(turn):.3g} deg)" if abs(turn) > DEGREES else ""
        return f"{body}.angle by {turn:.3g} rad{degrees}"

    return _listed([(move.body, move.shift, move.turn) for move in moved], size, most, _shift, turning)


def velocity_words(moved: Sequence[Move], size: float, most: int) -> str:
    """List the bodies whose velocities were changed, the largest changes first, as `position_words` does."""
    return _listed(
        [(move.body, move.velocity, move.omega) for move in moved], size, most,
        partial(_shift, prefix="v", unit="m/s", of="'s velocity"), lambda body, omega: f"{body}.omega by {omega:.3g} rad/s",
    )  # fmt: skip


def _listed(
    changes: Sequence[tuple[str, tuple[float, ...], float]], size: float, most: int,
    shifting: Callable[[str, tuple[float, ...]], str], turning: Callable[[str, float], str],
) -> str:  # fmt: skip
    """List changes by size, without rounding and parts far smaller than the other."""
    found = []
    for body, shift, turn in changes:
        sizes = math.hypot(*shift) / size, abs(turn)
        least = CONSISTENCY.much_less * max(sizes)
        words = [shifting(body, shift)] if math.hypot(*shift) > CONSISTENCY.worth_telling and sizes[0] >= least else []
        words += [turning(body, turn)] if abs(turn) > CONSISTENCY.worth_telling and sizes[1] >= least else []
        if words:
            found.append((max(sizes), words))
    found.sort(key=lambda change: -change[0])
    more = len(found) - most
    less = f" ({more} more {'bodies' if more > 1 else 'body'} by less)" if more > 0 else ""
    return ", ".join(part for _, words in found[:most] for part in words) + less


def _shift(body: str, shift: tuple[float, ...], prefix: str = "", unit: str = "m", of: str = "") -> str:
    """Describe a translation by its coordinate if it is along one, else by its length."""
    k = max(range(len(shift)), key=lambda n: abs(shift[n]))
    length = math.hypot(*shift)
    if abs(shift[k]) >= (1.0 - CONSISTENCY.much_less) * length:
        return f"{body}.{prefix}{'xyz'[k]} by {shift[k]:.3g} {unit}"
    return f"{body}{of} by {length:.3g} {unit}"
