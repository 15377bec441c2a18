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
Measured on 810 pairs of runs (bdf and dop853, 60 and 400 outputs) of sliders on turning guides, parallelograms, kites and slider cranks in
the plane and in space, which miss their singular pose by parts d of their size.  From d = 1e-3 on it is resolved, and none is noted
(growth up to 140 from 1e-2 on, 1800 at 1e-3, where no pose is near enough).  At 1e-4 the motion is resolved too; 7 % are noted, where
a change of 1e-9 in a length comes back 1e3 to 1e6 times as large.  Where chance decides (1e-6 and less) 44 of 48 runs of the slider
are noted, 18 of 56 and 18 of 48 of the four-bars and 6 of 32 in space: outputs far from the pose do not show its reactions."""
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
    for block in [*blocks(len(lam) - 1)]:
        before, behind = lam[block], lam[block.start + 1 : block.stop + 1]
        size, other = np.abs(before), np.abs(behind)
        grown = (np.minimum(size, other) > usual) & (np.maximum(size, other) > GROWN * usual)
        found.extend(int(k) + block.start for k in np.flatnonzero((grown & (before * behind < 0.0)).any(axis=1)))
        release(lam)
    return found
