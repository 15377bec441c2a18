"""Redundant equations that contradict each other, so that no motion satisfies them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..compile.gaps import Gap, position_gap, velocity_gap
from ..compile.state import State
from .drop_first import Redundant, redundant_rows
from .loop_equations import LoopEquations, Pose
from .loop_rank import LoopRank, loop_rank
from .loops import Loop
from .parameters import REDUNDANCY
from .uniqueness import Indeterminate, forces_change, indeterminate


class Inconsistency(NamedTuple):
    """Redundant equation that contradicts the equations on which it depends.

    - `row`: number of the redundant equation in its loop.
    - `joints`: its joint and the joints that it contradicts; only those that depend on time, if there are any.
    - `t`: time, s.
    - `level`: ``position`` or ``velocity``.
    - `gap`: violation of the equation if the others hold.
    """

    row: int
    joints: tuple[str, ...]
    t: float
    level: str
    gap: Gap


def time_dependent(equations: LoopEquations, pose: Pose, duration: float) -> np.ndarray:
    """Return a mask of the rows that depend on time or prescribe velocities, evaluated at times of the run."""
    rates = [equations.pose(pose.q, pose.t + part * duration).rates for part in (0.0, *REDUNDANCY.instants)]
    return equations.timed | np.any(np.array(rates) != 0.0, axis=0)


def inconsistencies(found: LoopRank, redundant: list[Redundant], duration: float) -> list[Inconsistency]:
    """Return the redundant equations of a loop that contradict others, at the first time at which they do.

    Each redundant equation must hold if the others do: in position at the assembled pose, and in velocity (J u + C_t =
    0 for the u of the others).
    """
    if not redundant and not REDUNDANCY.agrees < found.start.gap < REDUNDANCY.nearly:
        return []
    equations = found.equations
    driven = time_dependent(equations, found.start, duration)
    for pose in _followed(equations, found.start, duration if redundant and driven.any() else 0.0):
        asked = redundant if pose is found.start else [r for r in redundant if driven[[r.row, *r.others]].any()]
        level, gaps = _disagreement(equations, redundant, pose)
        if pose is found.start and pose.gap > REDUNDANCY.agrees and not gaps:
            gaps = _nearby(equations, redundant, pose)
            asked = _blamed(pose, gaps)
        if against := [r for r in asked if r.row in gaps]:
            off = _gaps(equations, pose, level, {r.row: gaps[r.row] for r in against}, list(gaps))
            return [Inconsistency(r.row, _joints(equations, r, driven), pose.t, level, off[r.row]) for r in against]
    return []


def _gaps(equations: LoopEquations, pose: Pose, level: str, off: dict[int, float], every: list[int]) -> dict[int, Gap]:
    """Return violations as lengths and angles, for positions at the pose that satisfies the other rows."""
    kept = np.ones(len(pose.C), dtype=bool)
    kept[every] = False
    if level == "position":
        pose = equations.assembled(pose.q, pose.t, kept)
    equations.pose(pose.q, pose.t)
    rows, state = equations.loop.rows, equations.state
    if level == "position":
        return {row: position_gap(state, pose.t, rows[row]) for row in off}
    return {row: velocity_gap(state, pose.t, rows[row], violation) for row, violation in off.items()}


def _followed(equations: LoopEquations, start: Pose, duration: float) -> Iterator[Pose]:
    """Yield the start and poses along a motion that the equations allow, up to the first that cannot be assembled."""
    yield start
    pose, strides = start, 0
    for part in REDUNDANCY.instants:
        end = start.t + part * duration
        while pose.t < end and pose.gap <= REDUNDANCY.agrees:
            u = np.linalg.lstsq(pose.J.dense(), -pose.rates)[0]
            h = min(end - pose.t, REDUNDANCY.stride / max(float(np.linalg.norm(u)), 1e-300))
            while True:
                strides += 1
                t = end if h >= end - pose.t else pose.t + h
                there = equations.assembled(equations.moved(pose.q, h * u), t)
                if strides > REDUNDANCY.most_strides or not there.J.finite:
                    return
                if equations.distance(pose, there) <= 2 * REDUNDANCY.stride:
                    break
                h /= 2
            pose = there
            yield pose


def _disagreement(equations: LoopEquations, redundant: list[Redundant], pose: Pose) -> tuple[str, dict[int, float]]:
    """Return the level, and the violations of rows that do not hold if the others do."""
    kept = np.ones(len(pose.C), dtype=bool)
    kept[[r.row for r in redundant]] = False
    if not pose.J.finite:
        return "", {}
    if pose.gap <= REDUNDANCY.agrees:
        return "velocity", _off(
            equations, _velocity_violations(pose, kept), REDUNDANCY.agrees * np.abs(pose.rates).max()
        )
    return "position", _off(equations, _position_violations(equations, pose, kept), REDUNDANCY.agrees)


def _nearby(equations: LoopEquations, redundant: list[Redundant], pose: Pose) -> dict[int, float]:
    """Return the violations of rows that do not hold if clearly independent rows do."""
    first = np.ones(len(pose.C), dtype=bool)
    first[[r.row for r in redundant]] = False
    return _off(equations, _position_violations(equations, pose, _clearly_independent(pose, first)), REDUNDANCY.agrees)


def _off(equations: LoopEquations, gaps: np.ndarray, most: float) -> dict[int, float]:
    """Return the rows with violations above a bound, the largest first, in their own units."""
    worst = sorted(np.flatnonzero(gaps > most).tolist(), key=lambda row: -gaps[row])
    return {row: float(gaps[row] / equations.row_scale[row]) for row in worst}


def _velocity_violations(pose: Pose, kept: np.ndarray) -> np.ndarray:
    """Return the violations of the omitted rows at the velocities of the kept ones; zero if all rates are zero."""
    if not np.any(pose.rates):
        return np.zeros(len(pose.rates))
    u, _, _, values = np.linalg.lstsq(pose.J.of_rows(kept).dense(), -pose.rates[kept])
    gaps: np.ndarray = np.abs(pose.J.times(u) + pose.rates) * ~kept * (values[-1] >= REDUNDANCY.sound)
    return gaps


def _position_violations(equations: LoopEquations, pose: Pose, kept: np.ndarray) -> np.ndarray:
    """Return the violations of omitted rows at the nearest pose of the kept ones; zero if there is none."""
    alone = equations.assembled(pose.q, pose.t, kept)
    closes = (
        np.abs(alone.C[kept]).max(initial=0.0) <= REDUNDANCY.closed
        and equations.distance(pose, alone) < REDUNDANCY.longest_move * pose.gap
    )
    gaps: np.ndarray = np.abs(alone.C) * ~kept * closes
    return gaps


def _clearly_independent(pose: Pose, first: np.ndarray) -> np.ndarray:
    """Return a mask of clearly independent rows, with preferred ones first."""
    J, kept = pose.J.dense(), np.zeros(len(first), dtype=bool)
    basis = np.zeros((0, J.shape[1]))
    for row in np.argsort(~first, kind="stable"):
        rest = J[row] - basis.T @ (basis @ J[row])
        rest -= basis.T @ (basis @ rest)
        length = float(np.linalg.norm(rest))
        if length > REDUNDANCY.independent_row * np.linalg.norm(J[row]) > 0:
            basis, kept[row] = np.vstack([basis, rest / length]), True
    return kept


def _blamed(pose: Pose, gaps: dict[int, float]) -> list[Redundant]:
    """Return the row with the largest violation, with those that it nearly depends on."""
    if not gaps:
        return []
    row, J = next(iter(gaps)), pose.J.dense()
    others = np.delete(np.arange(len(J)), row)
    share = np.abs(np.linalg.lstsq(J[others].T, J[row])[0])
    return [Redundant(row, tuple(others[share > REDUNDANCY.independent_row * share.max()].tolist()))]


def _joints(equations: LoopEquations, redundant: Redundant, driven: np.ndarray) -> tuple[str, ...]:
    names = equations.loop.joint_of
    rows = [redundant.row, *redundant.others]
    of_time = [row for row in rows if driven[row]]
    return tuple(dict.fromkeys(names[row] for row in (of_time if len(of_time) > 1 else rows)))


class LoopRankResult(NamedTuple):
    """Results on a loop with dependent equations at the start.

    `redundant`: dropped equations. `driven`: mask of the loop's rows that depend on time. `motion_unique`: false if
    friction depends on reactions that are not unique.
    """

    rank: LoopRank
    redundant: list[Redundant]
    indeterminate: list[Indeterminate]
    inconsistencies: list[Inconsistency]
    driven: np.ndarray
    motion_unique: bool

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general: positive at a singular pose."""
        return self.rank.rank - self.rank.start_rank

    @property
    def nearly_dependent(self) -> bool:
        """True if equations are so nearly dependent that the motion depends on rounding."""
        return not self.extra_freedoms and self.rank.least < REDUNDANCY.sound


def rank_result_of(
    loop: Loop, state: State, start: float, duration: float, order: Sequence[str]
) -> LoopRankResult | None:
    """Examine one loop near the described pose.

    `state`: working memory. `start`, `duration`: of the run, s. `order`: names of all joints; the last is dropped
    first. Returns None if all equations are independent, or undefined (initial value assembly then names the element).
    """
    equations = LoopEquations(loop, state, start)
    pose = equations.pose(state.system.q[loop.coordinates], start)
    if not (pose.J.finite and np.all(np.isfinite(pose.C))):
        return None
    rank = loop_rank(equations, pose.q, start)
    if not rank.null_spaces:
        return None
    redundant = redundant_rows(rank, order, state.system.holonomic[loop.rows])
    spaces = rank.null_spaces if redundant else []
    return LoopRankResult(
        rank, redundant, indeterminate(rank, spaces) if redundant else [], inconsistencies(rank, redundant, duration),
        time_dependent(rank.equations, rank.start, duration), not forces_change(rank, spaces),
    )  # fmt: skip
