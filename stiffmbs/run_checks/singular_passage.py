"""Note on a motion through a nearly singular pose, which magnifies errors or decides the branch of the motion.

Two branches of the motion meet at a singular pose and separate near it: at a distance d (the smallest singular value of
the joints' J, relative to its usual value) within a displacement of d. Errors e of a motion that passes there become
about e/d^2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..dynamics.dynamics import Dynamics, OutputRows
from ..redundancy.overconstraint import listed
from .parameters import RUN_CHECKS
from .singular_poses import PosesOnTheWay, SingularPose


def singular_passage_sentence(
    dynamics: Dynamics, rows: OutputRows, rtol: float, again: Callable[[np.ndarray], OutputRows]
) -> Iterator[str]:
    """Yield a sentence on the first checked passage if chance decides it, else on the worst one.

    `again` is a rerun up to the last of other times, s, with rows at these.
    """
    dips = deepest_dips(rows.log_determinant)
    if not dips:
        return
    poses = PosesOnTheWay(dynamics.system, rows.t, rows.q)
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
        yield (
            f"may pass a singular pose near t = {rows.t[min(dips)]:.6g} s or later, where more than one motion may follow: "
            "a second run that looks at it was cut short"
        )
    elif pose is not None:
        yield from _sentence(pose, d, rtol)


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


def _nearest(poses: PosesOnTheWay, dense: OutputRows, stretches: list[np.ndarray]) -> tuple[float, SingularPose | None]:
    """Return the smallest distance from a singular pose within some intervals, and the pose."""
    within = poses.at(dense.t, dense.q)
    return min((_nearest_within(within, dense, stretch) for stretch in stretches), key=lambda found: found[0])


def _nearest_within(poses: PosesOnTheWay, dense: OutputRows, stretch: np.ndarray) -> tuple[float, SingularPose | None]:
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


def _sentence(pose: SingularPose, d: float, rtol: float) -> Iterator[str]:
    magnified = _magnified(d)
    where = "; ".join(f"{body} at {place}" for body, place in zip(pose.bodies, pose.poses, strict=True))
    at = f"near t = {pose.t:.6g} s, where {listed(list(pose.joints))} nearly depend on each other"
    if _decided_by_chance(d):
        yield (
            f"passes a singular pose {at}: more than one motion may follow, and the motion depends on the last digits of the geometry "
            f"({where})"
        )
    elif magnified * rtol >= RUN_CHECKS.worth_telling:
        decided = "more than one motion may follow, and " if magnified * rtol >= RUN_CHECKS.decided else ""
        yield (
            f"passes near a singular pose {at}: {decided}errors come back about {magnified:.1g} times as large; set a smaller rtol "
            f"({where})"
        )
