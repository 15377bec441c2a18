"""Which joints have to be elastic for elasticity to decide how they share what rigid bodies leave undetermined.

With compliances c of the rows of some joints, of all multipliers lam + N w that move the mechanism alike the one with the
least complementary energy, 1/2 sum c_k (lam_k + (N w)_k)^2, is that of the elastic mechanism (Castigliano's second theorem).
A single elastic joint among rigid ones that hold the same is unloaded: w makes its own energy zero, whatever its stiffness,
so that it shows what leaving it out shows.  Stiffness decides where, without any one of the elastic joints, the others
still determine w.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .drop_first import TAKES_PART
from .loops import LoopJoint


def elastic_joints(joints: Sequence[LoopJoint], shares: Sequence[np.ndarray]) -> tuple[LoopJoint, ...]:
    """The joints that have to be elastic together; of those at both ends of one rod, where there are other paths, the last.

    Parameters
    ----------
    joints : sequence of LoopJoint
        All that take part.
    shares : sequence of ndarray, shape (rows, redundant equations)
        The rows of each joint in the null space N of J^T.

    Returns
    -------
    tuple of LoopJoint
        Empty where joints take part that no elastic element can replace, and too few are left.
    """
    usable = [k for k, share in enumerate(shares) if joints[k].element.elastic and np.abs(share).max() > TAKES_PART]
    for chosen in (_last_of_each_path(joints, usable), usable):
        if _decides([shares[k] for k in chosen]):
            return tuple(joints[k] for k in chosen)
    return ()


def _decides(shares: Sequence[np.ndarray]) -> bool:
    """Whether the stiffness of elastic joints decides: w is determined without any one of them too."""
    if len(shares) < 2:
        return False
    count = shares[0].shape[1]
    return all(_rank(np.vstack([*shares[:k], *shares[k + 1 :]])) == count for k in range(len(shares)))


def _last_of_each_path(joints: Sequence[LoopJoint], usable: Sequence[int]) -> list[int]:
    """Of joints that a load passes one after the other, through bodies with two joints, the last one."""
    path = list(range(len(joints)))
    for body in {body for joint in joints for body in joint.bodies}:
        around = [k for k, joint in enumerate(joints) if body in joint.bodies]
        if len(around) == 2:
            one, other = (path[k] for k in around)
            path = [one if p == other else p for p in path]
    return list({path[k]: k for k in usable}.values())


def _rank(rows: np.ndarray) -> int:
    values = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(values > TAKES_PART)) if values.size else 0
