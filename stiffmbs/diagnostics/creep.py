"""How far the relaxed velocity constraints of SI2 have let velocities creep, as the projection of the reported states shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..describe.settings import RunSettings
from ..solve.dynamics import OutputRows
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.storage import blocks, release
from ..solve.trajectory import Trajectory


@dataclass(frozen=True)
class Creep:
    """What the projection takes off the velocities of a run, in tolerances of each.

    Attributes
    ----------
    mean : float
        Over the reported instants, of the largest at each: what reaches the motion grows with it.  A singular pose that is
        passed raises it for an instant alone.
    velocity : str
        The velocity that creeps most.
    joint : str
        The joint with the largest multiplier there.
    """

    mean: float
    velocity: str
    joint: str


def creep_of(system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings) -> Creep:
    """The creep of a run whose reported states were brought back to the constraints.

    Parameters
    ----------
    system : System
    rows : OutputRows
    trajectory : Trajectory
        As integrated, at the instants of the rows and maybe later.
    settings : RunSettings
    """
    count = len(rows.t)
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    largest, total, row, velocity = 0.0, 0.0, 0, 0
    for block in blocks(count):
        after, before = rows.u[block], trajectory.u[:count][block]
        off = np.abs(after - before) / (absolute + settings.rtol * np.abs(after))
        of_rows = off.max(axis=1)
        total += float(of_rows.sum())
        k = int(of_rows.argmax())
        if of_rows[k] > largest:
            largest, row, velocity = float(of_rows[k]), block.start + k, int(off[k].argmax())
        release(rows.u, trajectory.u)
    joint = system.equations[int(np.abs(rows.lam[row]).argmax())][0]
    return Creep(total / count, system.name_of(velocity, system.of_body.velocities), joint)
