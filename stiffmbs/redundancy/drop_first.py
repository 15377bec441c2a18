"""Which of a loop's redundant equations are dropped, and which others say the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .loop_rank import LoopRank

WELL_CHOSEN = (0.1, 1e-2, 1e-4, 1e-7)
"""Parts of the largest that a row's share in what is redundant must have, at every pose looked at; the next smaller one
is tried where not enough rows have it.  A row with little share leaves equations that nearly depend on each other."""
TAKES_PART = 1e-6
"""Share in a combination, relative to its largest, below which a row has no part in it."""


class Redundant(NamedTuple):
    """One redundant equation.

    Attributes
    ----------
    row : int
        The equation that is dropped, counted in its loop.
    others : tuple of int
        The rows that say the same together.
    """

    row: int
    others: tuple[int, ...]


def redundant_rows(found: LoopRank, order: Sequence[str], holonomic: np.ndarray) -> list[Redundant]:
    """Choose the rows to leave out.

    Leaving out a set of rows loses no constraint where the null space of J^T, restricted to them, is regular.  Rows
    are taken from the last joint in `order` backwards, equations without a position form before all others; within a
    joint first the one with the largest share.

    Parameters
    ----------
    order : sequence of str
        Names of all joints; the last is dropped first.
    holonomic : ndarray of bool
        Which of the loop's rows have a position form.
    """
    if not found.redundancy:
        return []
    spaces = [space for _, space in found.null_spaces]
    rests, chosen = list(spaces), list[int]()
    preference, shares = _preference(found, order, holonomic), _least_shares(rests)
    for least in WELL_CHOSEN:
        for row in preference:
            if len(chosen) < found.redundancy and shares[row] > least:
                chosen.append(row)
                rests = [_without(rest, row) for rest in rests]
                shares = _least_shares(rests)
    circuits = [np.abs(space @ np.linalg.inv(space[chosen])) for space in spaces]
    part = np.any([TAKES_PART * Z.max(axis=0) < Z for Z in circuits], axis=0)
    return [
        Redundant(row, tuple(int(other) for other in np.flatnonzero(part[:, k]) if other not in chosen))
        for k, row in enumerate(chosen)
    ]


def _preference(found: LoopRank, order: Sequence[str], holonomic: np.ndarray) -> list[int]:
    """The loop's rows, with those to drop first in front."""
    rank = {name: k for k, name in enumerate(order)}
    joint_of = [rank[joint.name] for joint in found.equations.loop.joints for _ in joint.rows]
    shares = _least_shares([space for _, space in found.null_spaces]).round(6)
    return sorted(range(len(joint_of)), key=lambda row: (holonomic[row], -joint_of[row], -shares[row], -row))


def _least_shares(spaces: Sequence[np.ndarray]) -> np.ndarray:
    """Each row's least share in null spaces."""
    least: np.ndarray = np.min([_shares(space) for space in spaces], axis=0)
    return least


def _shares(space: np.ndarray) -> np.ndarray:
    """Each row's share in a null space, relative to the largest."""
    norms = np.linalg.norm(space, axis=1)
    return norms / max(norms.max(), TAKES_PART)


def _without(space: np.ndarray, row: int) -> np.ndarray:
    """What is left of a null space when combinations with a row are left out."""
    direction = space[row] / np.linalg.norm(space[row])
    return space - np.outer(space @ direction, direction)
