"""How far the relaxed velocity constraints of SI2, J u + C_t = E_lam lam, let velocities creep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..describe.settings import RunSettings
from ..solve.dynamics import Dynamics, OutputRows
from ..solve.error_control.relaxation import creep_of_velocities
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
    at_end : float
        What the multipliers of the last instant let creep, by their size: a run may stop before its steps have followed.
    velocity : str
        The velocity that creeps most.
    joint : str
        The joint with the largest multiplier there.
    """

    mean: float
    at_end: float
    velocity: str
    joint: str

    def sentence(self) -> str:
        """A clause on it."""
        return (
            f"under the forces in '{self.joint}' relaxed constraints (formulation SI2) let {self.velocity} creep by "
            f"{max(self.mean, self.at_end):.2g} tolerances"
        )


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
        off = _in_tolerances(trajectory.u[:count][block], rows.u[block], absolute, settings.rtol)
        of_rows = off.max(axis=1)
        total += float(of_rows.sum())
        k = int(of_rows.argmax())
        if of_rows[k] > largest:
            largest, row, velocity = float(of_rows[k]), block.start + k, int(off[k].argmax())
        release(rows.u, trajectory.u)
    joint = system.equations[int(np.abs(rows.lam[row]).argmax())][0]
    slip = creep_of_velocities(settings, system) * float(np.abs(rows.lam[-1]).max()) / float(system.mass.max())
    return Creep(
        total / count, slip / float(absolute.min()), system.name_of(velocity, system.of_body.velocities), joint
    )


def creep_at(dynamics: Dynamics, t: float, u: np.ndarray, settings: RunSettings) -> float:
    """What the projection takes off velocities u, in tolerances, at a state of the dynamics that it leaves on the constraints."""
    state, system = dynamics.state, dynamics.system
    state.u[:] = u
    if dynamics.correct_velocities(t) < 0:
        return 0.0
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    return float(_in_tolerances(u, state.u, absolute, settings.rtol).max())


def _in_tolerances(before: np.ndarray, after: np.ndarray, absolute: np.ndarray, rtol: float) -> np.ndarray:
    size: np.ndarray = np.abs(after - before) / (absolute + rtol * np.abs(after))
    return size
