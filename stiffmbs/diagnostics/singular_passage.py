"""A motion that goes through a nearly singular pose: reactions grow as 1/d before it and come back with the other sign.

Beside a pose at which two branches of the motion meet, at a distance d, the multipliers of a motion that is off its branch by
an error e grow as e/d^3.  Where they do, the last digits of the geometry decide which branch follows.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..solve.dynamics import Dynamics, OutputRows
from ..solve.storage import blocks, release
from ..structure.overconstraint import listed

GROWN = 200.0
"""Times its usual value that a multiplier must reach on one side of a change of its sign; on the other one it must reach that value.
Measured: 66 at an output in the flat pose of four-bars that go on as they should, 3e4 where the branch is left to chance."""
SAMPLES = 1000
"""Outputs from which the usual value is taken."""
NOISE = 1e-9
"""Part of the largest usual value below which multipliers are rounding."""


def singular_passage_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """A sentence on the first such pose between two outputs.

    Parameters
    ----------
    dynamics : Dynamics
    rows : OutputRows
    """
    turned = _turned_round(rows.lam)
    if not turned:
        return
    from .singular_poses import PosesOnTheWay

    poses = PosesOnTheWay(dynamics.system, rows.t, rows.q)
    for k in turned:
        pose = poses.nearest(float(rows.t[k]), float(rows.t[k + 1]))
        if pose is not None:
            yield (
                f"passes a singular pose near t = {pose.t:.6g} s, where {listed(list(pose.joints))} nearly depend on each other and their "
                "reactions grow beyond bounds: more than one motion may follow, and the motion depends on the last digits of the "
                f"geometry ({'; '.join(f'{body} at {place}' for body, place in zip(pose.bodies, pose.poses, strict=True))})"
            )
            return


def _turned_round(lam: np.ndarray) -> list[int]:
    """The outputs behind which a multiplier that has grown by far comes back with the other sign."""
    usual = np.median(np.abs(lam[:: 1 + len(lam) // SAMPLES]), axis=0)
    usual = np.maximum(usual, NOISE * usual.max())
    found: list[int] = []
    for block in blocks(len(lam) - 1):
        before, behind = lam[block], lam[block.start + 1 : block.stop + 1]
        size, other = np.abs(before), np.abs(behind)
        grown = (np.minimum(size, other) > usual) & (np.maximum(size, other) > GROWN * usual)
        found.extend(int(k) + block.start for k in np.flatnonzero((grown & (before * behind < 0.0)).any(axis=1)))
        release(lam)
    return found
