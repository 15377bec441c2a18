"""Redundant equations that say not the same but something else: no motion satisfies them all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .give_way import Redundant
from .loop_equations import CLOSED, LoopEquations, Pose
from .loop_rank import LoopRank

INSTANTS = (0.0137, 0.0931, 0.2113, 0.3719, 0.6131, 0.8677, 1.0)
"""Parts of the run at which scenes that depend on time are looked at again."""
OPEN = 1e-8
"""Violation, in parts of the loop's size, that contradicts the other equations."""
DISAGREES = 1e-7
"""Part of the largest prescribed velocity by which two equations may differ."""
NEAR = 20.0
"""Length of the move that satisfies the other equations, in gaps, up to which the gap is put down to a contradiction."""
REGULAR = 1e-5
"""Least singular value for a velocity to be computed from the equations kept."""


@dataclass(frozen=True)
class Contradiction:
    """Redundant equations that disagree with those that hold the same.

    Attributes
    ----------
    row : int
        The redundant equation, counted in its loop.
    joints : tuple of str
        Its joint and those it disagrees with; of these the ones that depend on time, where there are such.
    t : float
        When, s.
    level : str
        ``position`` or ``velocity``.
    """

    row: int
    joints: tuple[str, ...]
    t: float
    level: str


def time_dependent(equations: LoopEquations, pose: Pose, duration: float) -> np.ndarray:
    """Which rows depend on time, as seen at instants of the run."""
    rates = [equations.pose(pose.q, pose.t + part * duration).rates for part in (0.0, *INSTANTS)]
    return np.any(np.array(rates) != 0.0, axis=0)


def contradictions(found: LoopRank, redundant: list[Redundant], duration: float) -> list[Contradiction]:
    """Redundant equations of a loop that cannot hold together with the others, at the first instant where that shows.

    Each redundant equation must hold where the others do: in position at the assembled pose, and in velocity
    (J u + C_t = 0 for the u of the others).
    """
    if not redundant:
        return []
    equations, start = found.equations, found.start
    driven = time_dependent(equations, start, duration)
    pose = start
    for part in (0.0, *(INSTANTS if driven.any() else ())):
        pose = equations.assembled(pose.q, start.t + part * duration) if part else start
        level, rows = _disagreement(found, redundant, pose)
        if rows:
            return [
                Contradiction(r.row, _joints(equations, r, driven), pose.t, level) for r in redundant if r.row in rows
            ]
    return []


def _disagreement(found: LoopRank, redundant: list[Redundant], pose: Pose) -> tuple[str, list[int]]:
    """The level and the rows of the redundant equations that do not hold."""
    equations = found.equations
    kept = np.ones(len(pose.C), dtype=bool)
    kept[[r.row for r in redundant]] = False
    if not np.all(np.isfinite(pose.J)):
        return "", []
    if pose.gap > CLOSED:
        alone = equations.assembled(pose.q, pose.t, kept)
        closes = np.abs(alone.C[kept]).max(initial=0.0) <= CLOSED and equations.distance(pose, alone) < NEAR * pose.gap
        return "position", [r.row for r in redundant if closes and abs(alone.C[r.row]) > OPEN]
    u, _, _, values = np.linalg.lstsq(pose.J[kept], -pose.rates[kept])
    if values[-1] < REGULAR:
        return "", []
    left = np.abs(pose.J @ u + pose.rates)
    return "velocity", [r.row for r in redundant if left[r.row] > DISAGREES * np.abs(pose.rates).max()]


def _joints(equations: LoopEquations, redundant: Redundant, driven: np.ndarray) -> tuple[str, ...]:
    names = [joint.name for joint in equations.loop.joints for _ in joint.rows]
    rows = [redundant.row, *redundant.others]
    of_time = [row for row in rows if driven[row]]
    return tuple(dict.fromkeys(names[row] for row in (of_time if len(of_time) > 1 else rows)))
