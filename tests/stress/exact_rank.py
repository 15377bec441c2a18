"""The rank of a mechanism's constraint equations in exact arithmetic, from its geometry alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

Point = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Pin:
    """Two bodies pinned at a point of the ground's axes; -1 is the ground."""

    one: int
    other: int
    point: Point


@dataclass(frozen=True)
class Guide:
    """A body that slides on another along a direction, without turning."""

    one: int
    other: int
    point: Point
    direction: Point


def rank(centres: Sequence[Point], joints: Sequence[Pin | Guide]) -> int:
    """Rank of J at a pose, by Gauss' elimination over the rationals.

    Parameters
    ----------
    centres : sequence of pairs
        Centres of mass of the bodies, m.
    joints : sequence
        With their places at that pose, m.
    """
    rows = [row for joint in joints for row in _rows(centres, joint)]
    found = 0
    for column in range(3 * len(centres)):
        pivot = next((k for k in range(found, len(rows)) if rows[k][column]), None)
        if pivot is None:
            continue
        rows[found], rows[pivot] = rows[pivot], rows[found]
        head = rows[found]
        for k in range(found + 1, len(rows)):
            if factor := rows[k][column] / head[column]:
                rows[k] = [a - factor * b for a, b in zip(rows[k], head, strict=True)]
        found += 1
    return found


def _rows(centres: Sequence[Point], joint: Pin | Guide) -> list[list[Fraction]]:
    """The joint's part of J: how the velocities of both its sides differ, with v = v_c + omega x (p - c)."""
    if isinstance(joint, Pin):
        return [_velocity(centres, joint, axis) for axis in ((1, 0), (0, 1))]
    normal = (-joint.direction[1], joint.direction[0])
    turning = [Fraction(0)] * (3 * len(centres))
    for body, sign in ((joint.one, 1), (joint.other, -1)):
        if body >= 0:
            turning[3 * body + 2] = Fraction(sign)
    return [_velocity(centres, joint, normal), turning]


def _velocity(
    centres: Sequence[Point], joint: Pin | Guide, along: tuple[Fraction | int, Fraction | int]
) -> list[Fraction]:
    row = [Fraction(0)] * (3 * len(centres))
    for body, sign in ((joint.one, 1), (joint.other, -1)):
        if body >= 0:
            arm = (joint.point[0] - centres[body][0], joint.point[1] - centres[body][1])
            row[3 * body : 3 * body + 3] = [
                Fraction(sign * along[0]), Fraction(sign * along[1]),
                Fraction(sign * (along[1] * arm[0] - along[0] * arm[1])),
            ]  # fmt: skip
    return row
