"""Index lists of J M^-1 J^T of planar revolute joints (`stiffmbs.dynamics.elimination.native.by_pins`)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate, combinations
from typing import Any, NamedTuple

import numpy as np

from ...compile.machine.layout import arrays_of
from ...compile.system import System
from .joint_blocks import Joints
from .native.layouts import PIN_ELIMINATION, Pin, PinProduct

NOTHING = np.zeros(3)


class Side(NamedTuple):
    """Body at a revolute joint, and the starts of the entries of J of both equations among the values."""

    body: int
    first: int
    second: int


def pin_lists(joints: Joints, system: System, kept: np.ndarray) -> dict[str, Any] | None:
    """Return the lists of `stiffmbs.dynamics.elimination.native.layouts.PIN_ELIMINATION`; None if a joint is not revolute.

    `kept`: entries of J in solved equations.
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
        "pin": [*_rows(joints, pins, gamma.source[np.argsort(gamma.row)], len(mass))],
        "inverse": [1.0 / mass[side.body] if side else NOTHING for sides in pins for side in (*sides, None)[:2]],
        "product": [
            PinProduct(8 * k + 4 * own, 8 * later + 4 * other)
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
    """Return the bodies of each revolute joint; an empty list if any joint is of another kind."""
    jacobian, found = system.term("acceleration", "J"), dict[tuple[int, int], dict[int, int]]()
    columns = (part[kept].tolist() for part in (jacobian.row, jacobian.column, jacobian.source))
    for row, column, source in zip(*columns, strict=True):
        found.setdefault((row, column // 3), {})[column % 3] = source
    pins = []
    for rows, bodies in zip(joints.nodes, joints.bodies, strict=True):
        sides = [_side(body, *(found.get((row, body), {}) for row in rows.tolist())) for body in bodies]
        if None in sides or not 0 < len(sides) <= 2:
            return []
        pins.append([side for side in sides if side])
    return pins


def _side(body: int, *equations: dict[int, int]) -> Side | None:
    """Return a body at a joint, given the sources by velocity for each equation, x and angle, y and angle; None if it differs."""
    if [tuple(entries) for entries in equations] != [(k, 2) for k in range(2)]:
        return None
    (first, after_first), (second, after_second) = (entries.values() for entries in equations)
    return Side(body, first, second) if (after_first, after_second) == (first + 1, second + 1) else None


def _shared(pin: list[Side], other: list[Side]) -> list[tuple[int, int]]:
    return [(a, b) for a, own in enumerate(pin) for b, side in enumerate(other) if own.body == side.body]


def _rows(joints: Joints, pins: list[list[Side]], gamma: np.ndarray, ground: int) -> Iterator[Pin]:
    """Yield the rows of ``pin``; the ground, with inverse mass 0, follows all bodies."""
    for rows, sides in zip(joints.nodes, pins, strict=True):
        i, j, row = sides[0], sides[-1], int(rows[0])
        velocities = 3 * i.body, 3 * (j.body if len(sides) == 2 else ground)
        yield Pin(i.first, i.second, j.first, j.second, int(gamma[row]), int(gamma[row + 1]), *velocities, row)
