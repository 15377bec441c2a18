"""Redundant equations that say not the same but something else: no motion satisfies them all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .give_way import Redundant
from .loop_equations import CLOSED, LoopEquations, Pose
from .loop_rank import LoopRank

INSTANTS = (0.0137, 0.0931, 0.2113, 0.3719, 0.6131, 0.8677, 0.9941)
"""Parts of the run at which scenes that depend on time are looked at again, and as often in between as they move."""
OPEN = 1e-8
"""Violation, in parts of the loop's size, that contradicts the other equations."""
DISAGREES = 1e-7
"""Part of the largest prescribed velocity by which two equations may differ."""
NEAR = 20.0
"""Length of the move that satisfies the other equations, in gaps, up to which the gap is put down to a contradiction."""
STRIDE, MOST_STRIDES = 0.2, 150
"""Longest move (arms, rad) between two instants, so that no other branch is met, and how many are made at the most."""
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
    equations = found.equations
    driven = time_dependent(equations, found.start, duration)
    for pose in _followed(equations, found.start, duration if driven.any() else 0.0):
        asked = redundant if pose is found.start else [r for r in redundant if driven[[r.row, *r.others]].any()]
        level, rows = _disagreement(equations, redundant, pose)
        if against := [r for r in asked if r.row in rows]:
            return [Contradiction(r.row, _joints(equations, r, driven), pose.t, level) for r in against]
    return []


def _followed(equations: LoopEquations, start: Pose, duration: float) -> Iterator[Pose]:
    """The start, and poses along one motion that the equations allow, up to the first that cannot be assembled."""
    yield start
    pose, strides = start, 0
    for part in INSTANTS:
        end = start.t + part * duration
        while pose.t < end and pose.gap <= CLOSED:
            u = np.linalg.lstsq(pose.J, -pose.rates)[0]
            h = min(end - pose.t, STRIDE / max(float(np.linalg.norm(u)), 1e-300))
            while True:
                strides += 1
                t = end if h >= end - pose.t else pose.t + h
                there = equations.assembled(equations.moved(pose.q, h * u), t)
                if strides > MOST_STRIDES or not np.all(np.isfinite(there.J)):
                    return
                if equations.distance(pose, there) <= 2 * STRIDE:
                    break
                h /= 2
            pose = there
            yield pose


def _disagreement(equations: LoopEquations, redundant: list[Redundant], pose: Pose) -> tuple[str, list[int]]:
    """The level and the rows of the redundant equations that do not hold."""
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
