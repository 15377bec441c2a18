"""Choice of a loop's redundant equations to drop, and of the equations on which they depend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .loop_rank import LoopRank
from .parameters import REDUNDANCY


class Redundant(NamedTuple):
    """A redundant equation. `row`: number of the dropped equation in its loop. `others`: rows on which it depends."""

    row: int
    others: tuple[int, ...]


def redundant_rows(found: LoopRank, order: Sequence[str], holonomic: np.ndarray) -> list[Redundant]:
    """Choose the rows to leave out.

    Leaving out rows loses no constraint if the null space of J^T, restricted to them, is regular. Rows are taken from
    the last joint in `order` backwards, nonholonomic equations first; within a joint, those with the largest share
    first. `order`: names of all joints; the last is dropped first. `holonomic`: mask of the loop's rows that have a
    position form.
    """
    if not found.redundancy:
        return []
    spaces = [space for _, space in found.null_spaces]
    rests, chosen = list(spaces), list[int]()
    preference, shares = _preference(found, order, holonomic), _least_shares(rests)
    for least in (REDUNDANCY.well_chosen, REDUNDANCY.takes_part):
        for row in preference:
            if len(chosen) < found.redundancy and shares[row] > least:
                chosen.append(row)
                rests = [_without(rest, row) for rest in rests]
                shares = _least_shares(rests)
    circuits = [np.abs(space @ np.linalg.inv(space[chosen])) for space in spaces]
    part = np.any([REDUNDANCY.takes_part * Z.max(axis=0) < Z for Z in circuits], axis=0)
    return [
        Redundant(row, tuple(int(other) for other in np.flatnonzero(part[:, k]) if other not in chosen))
        for k, row in enumerate(chosen)
    ]


def rank_of(rows: np.ndarray) -> int:
    """Return the rank of some rows of null vectors."""
    return int(np.linalg.matrix_rank(rows, tol=REDUNDANCY.takes_part)) if rows.size else 0


def _preference(found: LoopRank, order: Sequence[str], holonomic: np.ndarray) -> list[int]:
    """Return the loop's rows in the order in which they are dropped."""
    rank = {name: k for k, name in enumerate(order)}
    joint_of = [rank[name] for name in found.equations.loop.joint_of]
    shares = _least_shares([space for _, space in found.null_spaces]).round(6)
    return sorted(range(len(joint_of)), key=lambda row: (holonomic[row], -joint_of[row], -shares[row], -row))


def _least_shares(spaces: Sequence[np.ndarray]) -> np.ndarray:
    """Return each row's smallest share in the null spaces, relative to the largest in each."""
    norms = [np.linalg.norm(space, axis=1) for space in spaces]
    least: np.ndarray = np.min([each / max(each.max(), REDUNDANCY.takes_part) for each in norms], axis=0)
    return least


def _without(space: np.ndarray, row: int) -> np.ndarray:
    """Return the null space without combinations that contain a row."""
    direction = space[row] / np.linalg.norm(space[row])
    return space - np.outer(space @ direction, direction)
