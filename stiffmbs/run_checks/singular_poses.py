"""Singular poses in a motion: joints lose rank there, and several motions may follow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from ..compile.system import System
from ..dynamics.dynamics import Dynamics, OutputRows
from ..notes import Note, NoteKind
from ..redundancy.listed import listed
from ..redundancy.loops import loops
from .parameters import RUN_CHECKS

SEVERAL = "more than one motion may follow"
"""Words of the notes on poses after which the results are one of several motions."""
_AT = "near t = {t:.6g} s, where the equations of {joints} are nearly dependent: "
BRANCHES = NoteKind(
    "singular-pose",
    "passes a singular pose " + _AT + f"{SEVERAL}, and the motion depends on the last digits of the "
    "geometry ({where})",
)
MAGNIFIES = NoteKind(
    "nearly-singular-pose",
    "passes near a singular pose " + _AT + "{decided}errors grow by a factor of about {factor:.1g}; {remedy} ({where})",
    "use a smaller rtol",
)
NOT_EXAMINED = NoteKind(
    "singular-pose-not-examined",
    "may pass a singular pose near t = {t:.6g} s or later, where "
    + SEVERAL
    + "; the rerun that examines it was aborted",
)


def some_instants(count: int, most: int | None = None) -> np.ndarray:
    """Return the numbers of evenly spaced ones of `count` output times, with the first and the last; 400 at most by default."""
    return np.linspace(0, count - 1, min(count, most or RUN_CHECKS.most_instants)).astype(int)


class SingularPose(NamedTuple):
    """Nearly singular pose at a time, s: joints with nearly dependent equations, bodies of loops, and their poses in words."""

    t: float
    joints: tuple[str, ...]
    bodies: tuple[str, ...]
    poses: tuple[str, ...]


class PosesBetween:
    """Poses of a motion and their distances from singular ones.

    The distance is the smallest singular value of J, relative to the largest such value in the motion. Its rows are those of
    the joints in loops, and of equations that nearly vanish at a pose. Rows of J are normalised, with arms in units of the system's size.
    Those that nearly vanish remain small. `system`: without redundant equations. `t` of shape (n,). `q` of shape (n, n_q).
    `suspects`: poses that may be singular.
    """

    def __init__(self, system: System, t: np.ndarray, q: np.ndarray, suspects: Sequence[int] = ()) -> None:
        self._system, self._t, self._q = system, t, q
        self._state = State(system)
        self._scale = system.per_velocity(1.0, system.size)
        norms = np.array([self._norms(k) for k in (*some_instants(len(t), RUN_CHECKS.usual_poses), *suspects, 0)])
        self._least_norm = np.sqrt(RUN_CHECKS.dip) * norms.max(axis=0)
        in_loops = loops(system, self._state)
        inside = np.zeros(system.n_c, dtype=bool)
        for loop in in_loops:
            inside[loop.rows] = True
        vanishing = norms.min(axis=0) < self._least_norm
        self._rows = np.flatnonzero((inside | vanishing) & system.active)
        J = system.term("motion", "J")
        columns = J.column[np.isin(J.row, np.flatnonzero(vanishing & system.active))] // system.of_body.n_u
        self._bodies = sorted({*columns.tolist(), *(body for loop in in_loops for body in loop.bodies)})
        self._known: dict[int, float] = {}

    def _norms(self, k: int) -> np.ndarray:
        """Return the norms of the rows of J of pose k, with arms in units of the size."""
        J = self._system.term("motion", "J")
        self._state.q[:] = self._q[k]
        self._state.evaluate("motion", float(self._t[k]))
        parts = self._state.values["motion"][J.source] / self._scale[J.column]
        return np.sqrt(np.bincount(J.row, parts * parts, minlength=self._system.n_c))

    def at(self, t: np.ndarray, q: np.ndarray) -> PosesBetween:
        """Return other poses of the same motion, with its usual singular value."""
        others = copy(self)
        others.usual = self.usual
        others._t, others._q, others._known = t, q, {}
        return others

    @cached_property
    def usual(self) -> float:
        """Largest smallest singular value at a few poses of the motion; 0 without equations that may be dependent."""
        return (
            max(self._least(k)[0] for k in some_instants(len(self._t), RUN_CHECKS.usual_poses))
            if len(self._rows)
            else 0.0
        )

    @property
    def products(self) -> float:
        """Approximate number of multiplications in all decompositions so far."""
        return float(len(self._known) * len(self._rows) ** 2 * self._system.n_u)

    def distance(self, k: int) -> float:
        """Return the distance of pose k from a singular one: 0 at one, about 1 at most, and 1 where none may be."""
        if not len(self._rows):
            return 1.0
        if k not in self._known:
            self._known[k] = self._least(k)[0] / self.usual
        return self._known[k]

    def at_singular(self, k: int) -> slice:
        """Return poses around k without meaningful accelerations and reactions; empty if k is regular."""
        if self.distance(k) >= RUN_CHECKS.nearly_singular:
            return slice(k, k)
        return slice(self._sound_from(k, -1) + 1, self._sound_from(k, 1))

    def _sound_from(self, k: int, sense: int) -> int:
        """Return the first regular pose after k in strides that double."""
        stride = 1
        while 0 <= k < len(self._t) and self.distance(k) < RUN_CHECKS.nearly_singular:
            k, stride = k + sense * stride, 2 * stride
        return max(-1, min(k, len(self._t)))

    def nearest(self, start: float, end: float) -> SingularPose | None:
        """Return the most nearly singular pose between two times, s, or None."""
        inside = np.flatnonzero((self._t >= start) & (self._t <= end))
        effort = max(1, len(self._rows) ** 2 * self._system.n_u)
        most = int(np.clip(RUN_CHECKS.effort / effort, RUN_CHECKS.usual_poses, RUN_CHECKS.most_instants))
        inside = inside[:: max(1, len(inside) // most)]
        distances = [self.distance(int(k)) for k in inside]
        if not distances or min(distances) > RUN_CHECKS.nearly_singular:
            return None
        k = int(inside[int(np.argmin(distances))])
        _, weights = self._least(k)
        equations = self._rows[weights > RUN_CHECKS.takes_part * weights.max()]
        joints = tuple(dict.fromkeys(self._system.equations[row][0] for row in equations))
        of_body = self._system.of_body
        poses = tuple(of_body.pose(self._q[k], body) for body in self._bodies)
        return SingularPose(float(self._t[k]), joints, tuple(self._system.bodies[body] for body in self._bodies), poses)

    def _least(self, k: int) -> tuple[float, np.ndarray]:
        """Return the smallest singular value of the scaled J, and the weight of each equation in its vector."""
        return _smallest(self._scaled(k))

    def _scaled(self, k: int) -> np.ndarray:
        """Return J of pose k with normalised rows and arms in units of the size; rows that nearly vanish remain small."""
        norms = np.maximum(self._norms(k), self._least_norm)[self._rows]
        J = self._state.matrix("motion", "J")[self._rows]
        J /= self._scale
        J /= norms[:, None]
        return J


def _smallest(J: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the smallest singular value of J and the weights of its left vector, of many rows by inverse iteration."""
    if len(J) <= RUN_CHECKS.few_rows:
        vectors, values, _ = np.linalg.svd(J, full_matrices=False)
        squares = values**2 + RUN_CHECKS.floor
        # reduction by inverse iteration; several equally small values all count
        share = (squares[-1] / squares) ** RUN_CHECKS.iterations
        return float(np.sqrt(squares[-1])), np.sqrt(vectors**2 @ share**2)
    from scipy.sparse import csc_matrix, identity
    from scipy.sparse.linalg import splu

    rows = csc_matrix(J)
    factors = splu((rows @ rows.T + RUN_CHECKS.floor * identity(len(J))).tocsc())
    vector = np.random.default_rng(1).standard_normal(len(J))
    growth = 1.0
    for _ in range(RUN_CHECKS.iterations):
        vector = factors.solve(vector / np.linalg.norm(vector))
        growth = float(np.linalg.norm(vector))
    return 1 / np.sqrt(growth), np.abs(vector)


def singular_passage_notes(
    dynamics: Dynamics, rows: OutputRows, rtol: float, again: Callable[[np.ndarray], OutputRows]
) -> Iterator[Note]:
    """Yield a note on the first checked passage if chance decides it, else on the worst one.

    `again` is a rerun up to the last of other times, s, with rows at these.
    """
    dips = deepest_dips(rows.log_determinant)
    if not dips:
        return
    poses = PosesBetween(dynamics.system, rows.t, rows.q, dips)
    if not poses.usual:
        return
    first, *others = [np.linspace(rows.t[k - 1], rows.t[k + 1], RUN_CHECKS.dip_instants) for k in sorted(dips)]
    dense = again(first)
    found, reached, asked = _nearest(poses, dense, [first]), dense.t, first[-1]
    if others and not _decided_by_chance(found[0]):
        dense = again(np.unique(np.concatenate(others)))
        found = min(found, _nearest(poses, dense, others), key=lambda each: each[0])
        reached, asked = dense.t, others[-1][-1]
    d, pose = found
    if not _decided_by_chance(d) and not (len(reached) and reached[-1] >= asked):
        yield NOT_EXAMINED(t=rows.t[min(dips)])
    elif pose is not None:
        yield from _notes(pose, d, rtol)


def deepest_dips(log_determinant: np.ndarray) -> list[int]:
    """Return the outputs near which the joints may lose rank: det [M J^T; J 0] falls to a small part of its neighbours."""
    if len(log_determinant) < 3 or np.ptp(log_determinant) < np.log(1.25 / (RUN_CHECKS.dip + 0.25)):
        return []  # a parabola falls below its smallest point by at most a quarter of its second difference
    D = np.nan_to_num(np.exp(log_determinant - np.nanmedian(log_determinant)))
    k = 1 + np.flatnonzero((D[1:-1] <= D[:-2]) & (D[1:-1] < D[2:]))
    part = _least(D[k - 1], D[k], D[k + 1]) / np.maximum(D[k - 1], D[k + 1])
    deepest = np.argsort(part, kind="stable")[: RUN_CHECKS.most_dips]
    return [int(k[i]) for i in deepest if part[i] < RUN_CHECKS.dip]


def _least(before: np.ndarray, at: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the minimum of the parabola through three equidistant values; the middle one is less than the last."""
    slope, bend = (after - before) / 2, (before - 2 * at + after) / 2
    return at - slope * slope / (4 * bend)


def _nearest(poses: PosesBetween, dense: OutputRows, stretches: list[np.ndarray]) -> tuple[float, SingularPose | None]:
    """Return the smallest distance from a singular pose within some intervals, and the pose."""
    within = poses.at(dense.t, dense.q)
    return min((_nearest_within(within, dense, stretch) for stretch in stretches), key=lambda found: found[0])


def _nearest_within(poses: PosesBetween, dense: OutputRows, stretch: np.ndarray) -> tuple[float, SingularPose | None]:
    """Return the distance from a singular pose within an interval, and the pose."""
    inside = np.flatnonzero((dense.t >= stretch[0]) & (dense.t <= stretch[-1]))
    if not len(inside):
        return 1.0, None
    D = np.nan_to_num(np.exp(dense.log_determinant[inside] - np.nanmax(dense.log_determinant[inside])))
    least = int(np.argmin(D))
    k, d = int(inside[least]), poses.distance(int(inside[least]))
    if d > RUN_CHECKS.nearly_singular:
        return d, None
    if D[least] and 0 < least < len(D) - 1 and D[least] < D[least + 1]:
        d *= float(np.sqrt(max(0.0, _least(*D[least - 1 : least + 2]) / D[least])))
    return d, poses.nearest(float(dense.t[k]), float(dense.t[k]))


def _magnified(d: float) -> float:
    """Return the magnification of errors by a pose at a distance d."""
    return float(RUN_CHECKS.magnified / max(d * d, np.finfo(float).tiny))


def _decided_by_chance(d: float) -> bool:
    """Return True if rounding of the geometry decides the motion after a pose at a distance d."""
    return _magnified(d) * RUN_CHECKS.last_digits >= RUN_CHECKS.decided


def _notes(pose: SingularPose, d: float, rtol: float) -> Iterator[Note]:
    magnified = _magnified(d)
    where = "; ".join(f"{body} at {place}" for body, place in zip(pose.bodies, pose.poses, strict=True))
    joints = listed(list(pose.joints))
    if _decided_by_chance(d):
        yield BRANCHES(pose.joints[0], t=pose.t, joints=joints, where=where)
    elif magnified * rtol >= RUN_CHECKS.worth_telling:
        decided = f"{SEVERAL}, and " if magnified * rtol >= RUN_CHECKS.decided else ""
        yield MAGNIFIES(pose.joints[0], t=pose.t, joints=joints, where=where, decided=decided, factor=magnified)
