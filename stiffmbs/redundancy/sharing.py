"""Joints that must be elastic for stiffness to determine reactions that rigid bodies leave indeterminate.

With compliances c of some joints' rows, all multipliers lam + N w cause the same motion. The elastic mechanism has
those with the least complementary energy, 1/2 sum c_k (lam_k + (N w)_k)^2 (Castigliano's second theorem). A single
elastic joint parallel to rigid ones is unloaded, as w makes its energy zero at any stiffness. Stiffness determines the
reactions if w is determined without any one of the elastic joints.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .drop_first import rank_of
from .loops import LoopJoint
from .parameters import REDUNDANCY


def elastic_joints(joints: Sequence[LoopJoint], shares: Sequence[np.ndarray]) -> tuple[LoopJoint, ...]:
    """Return the joints to make elastic together; of those on one load path, if there are others, the last.

    Parameters
    ----------
    joints : sequence of LoopJoint
        All joints involved.
    shares : sequence of ndarray, shape (rows, redundant equations)
        The rows of each joint in the null space N of J^T.

    Returns
    -------
    tuple of LoopJoint
        Empty if too few joints can be replaced by elastic elements.
    """
    usable = [
        k for k, share in enumerate(shares) if joints[k].element.elastic and np.abs(share).max() > REDUNDANCY.takes_part
    ]
    for chosen in (_last_of_each_path(joints, usable), usable):
        if _decides([shares[k] for k in chosen]):
            return tuple(joints[k] for k in chosen)
    return ()


def _decides(shares: Sequence[np.ndarray]) -> bool:
    """Return True if stiffness determines the reactions: w is determined without any one of the elastic joints."""
    if len(shares) < 2:
        return False
    count = shares[0].shape[1]
    return all(rank_of(np.vstack([*shares[:k], *shares[k + 1 :]])) == count for k in range(len(shares)))


def _last_of_each_path(joints: Sequence[LoopJoint], usable: Sequence[int]) -> list[int]:
    """Return the last joint of each load path through bodies with two joints."""
    path = list(range(len(joints)))
    for body in {body for joint in joints for body in joint.bodies}:
        around = [k for k, joint in enumerate(joints) if body in joint.bodies]
        if len(around) == 2:
            one, other = (path[k] for k in around)
            path = [one if p == other else p for p in path]
    return list({path[k]: k for k in usable}.values())
