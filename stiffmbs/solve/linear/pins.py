"""J M^-1 J^T of planar pins: the lists along which it is formed and eliminated (`stiffmbs.solve.native.elimination.by_pins`)."""

from __future__ import annotations

from itertools import accumulate, combinations
from typing import Any, NamedTuple

import numpy as np

from ...compile.machine.layout import arrays_of
from ...compile.system import System
from ..native.tables.linear import PIN_ELIMINATION
from .joint_blocks import Joints

FIRST, SECOND = (0, 2), (1, 2)
"""The velocities of a body that a pin's first and second equation act on."""
NOTHING = np.zeros(3)


class Side(NamedTuple):
    """A body at a pin, and where the entries of J of both equations begin among the values."""

    body: int
    first: int
    second: int


def pin_lists(joints: Joints, system: System, kept: np.ndarray) -> dict[str, Any] | None:
    """What the table holds of pins (`stiffmbs.solve.native.tables.linear.PIN_ELIMINATION`); None where a joint is no pin.

    Parameters
    ----------
    joints : Joints
    system : System
    kept : ndarray of int
        The entries of J in equations that are solved for.
    """
    gamma, pins = system.term("acceleration", "gamma"), _pins(joints, system, kept)
    if not pins or sum(joints.sizes) < system.n_c or not np.array_equal(np.sort(gamma.row), np.arange(system.n_c)):
        return None
    beside = [(k, later) for k, below in enumerate(joints.below) for later in below]
    meeting = [_shared(pins[k], pins[later]) for k, later in beside]
    if max(map(len, meeting), default=0) > 1:
        return None
    mass, number = system.mass.reshape(-1, 3), {both: m for m, both in enumerate(beside)}
    starts = list(accumulate(map(len, joints.below), initial=0))
    lists = {
        "pin": _rows(joints, pins, gamma.source[np.argsort(gamma.row)], len(mass)),
        "inverse": [1.0 / mass[side.body] if side else NOTHING for sides in pins for side in _both(sides)],
        "product": [
            (8 * k + 4 * own, 8 * later + 4 * other)
            for (k, later), found in zip(beside, meeting, strict=True)
            for own, other in found or [(0, 0)]
        ],
        "mass": [
            mass[pins[k][found[0][0]].body] if found else NOTHING for (k, _), found in zip(beside, meeting, strict=True)
        ],
        "start": starts, "later": [later for _, later in beside],
        "update": [number[pair] for below in joints.below for pair in combinations(below, 2)],
        **{name: np.zeros(4 * len(beside)) for name in ("beside", "scaled")},
        **{name: np.zeros(width * len(pins)) for name, width in (("w", 8), ("block", 4), ("diagonal", 2), ("x", 2))},
    }  # fmt: skip
    return {**arrays_of(PIN_ELIMINATION, lists), "n": len(pins), "n_beside": len(beside)}


def _pins(joints: Joints, system: System, kept: np.ndarray) -> list[list[Side]]:
    """The bodies of each pin; none at all if a joint is no pin."""
    jacobian, found = system.term("acceleration", "J"), dict[tuple[int, int], dict[int, int]]()
    columns = (part[kept].tolist() for part in (jacobian.row, jacobian.column, jacobian.source))
    for row, column, source in zip(*columns, strict=True):
        found.setdefault((row, column // 3), {})[column % 3] = source
    pins = []
    for rows, bodies in zip(joints.rows, joints.bodies, strict=True):
        sides = [_side(body, *(found.get((row, body), {}) for row in rows.tolist())) for body in bodies]
        if None in sides or not 0 < len(sides) <= 2:
            return []
        pins.append([side for side in sides if side])
    return pins


def _side(body: int, *equations: dict[int, int]) -> Side | None:
    """A body at a joint, if that is a pin: for each equation, the sources of its entries by velocity."""
    if [tuple(entries) for entries in equations] != [FIRST, SECOND]:
        return None
    (first, after_first), (second, after_second) = (entries.values() for entries in equations)
    return Side(body, first, second) if (after_first, after_second) == (first + 1, second + 1) else None


def _shared(pin: list[Side], other: list[Side]) -> list[tuple[int, int]]:
    """Which bodies of two pins are the same."""
    return [(a, b) for a, own in enumerate(pin) for b, side in enumerate(other) if own.body == side.body]


def _both(sides: list[Side]) -> tuple[Side, Side | None]:
    """Two sides; none where the ground is the second."""
    return sides[0], sides[1] if len(sides) == 2 else None


def _rows(joints: Joints, pins: list[list[Side]], gamma: np.ndarray, ground: int) -> list[tuple[int, ...]]:
    """The rows of ``pin``; the ground, whose inverse mass is 0, stands behind all bodies."""
    found: list[tuple[int, ...]] = []
    for rows, sides in zip(joints.rows, pins, strict=True):
        one, other = sides[0], sides[-1]
        row = int(rows[0])
        places = one.first, one.second, other.first, other.second, int(gamma[row]), int(gamma[row + 1])
        found.append((*places, 3 * one.body, 3 * (other.body if len(sides) == 2 else ground), row))
    return found
