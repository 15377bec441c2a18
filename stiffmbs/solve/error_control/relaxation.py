"""How far the relaxed formulation, J u + C_t = E_lam lam, lets constraints creep: what is set for a run, and what a run shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...compile.system import System
from ...describe.settings import RunSettings
from ..dynamics import Dynamics, OutputRows
from ..events.restart import INDISTINCT
from ..storage import blocks, release
from ..trajectory import Trajectory
from .tolerances import absolute_tolerances

POSITION_CREEP, VELOCITY_CREEP = 1e-9, 1e-12
"""Seconds; measured on mechanisms of 1 kg and 1 m, where lam is 10 to 100 N: no effect on steps and errors."""
SHORT = 100
"""Bodies beyond which joints creep less, by the square of their number: in a long chain each holds more, and their creep adds up.
(A chain of 1000 rods at rtol 1e-6: off by 4e-4 m without this, by the tolerance's own 1e-5 with it.)"""
TIGHTEST, LOOSEST = 1e-3, 1e3
"""Bounds of the factor by which a tolerance other than 1e-8 changes the creep."""


class Creep(NamedTuple):
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
        seen = self.mean >= self.at_end
        return (
            f"under the forces in '{self.joint}' relaxed constraints (formulation SI2) let "
            f"{self.velocity if seen else 'velocities'} creep by {max(self.mean, self.at_end):.2g} tolerances"
        )


def relax(dynamics: Dynamics, settings: RunSettings, t: float) -> None:
    """Set the relaxations of all rows for the state at hand.

    E_mu = eps C_q C_q^T and E_lam = eps J M^-1 J^T, by their diagonals, so that lengths, angles, masses and forces of
    any size creep alike; in proportion to the tolerance.  M is that of the heaviest body, at an arm as long as
    the mechanism: what it weighs may hang on light bodies and small moments of inertia, which by their own measure
    would let their joints creep far beyond the tolerance.
    """
    state, system = dynamics.state, dynamics.system
    if not system.n_c:
        return
    state.evaluate("motion", t)
    positions, velocities = system.term("motion", "C_q"), system.term("motion", "J")
    C_q, J = state.values["motion"][positions.source], state.values["motion"][velocities.source]
    of_positions = np.bincount(positions.row, C_q * C_q, minlength=system.n_c)
    of_velocities = np.bincount(velocities.row, J * J * lightness(dynamics)[velocities.column], minlength=system.n_c)
    creep = creep_of_positions(settings), creep_of_velocities(settings, system)
    state.relax(creep[0] * of_positions, creep[1] * of_velocities)


def creep_of_positions(settings: RunSettings) -> float:
    """E_mu for an entry 1 in a row of C_q."""
    return POSITION_CREEP * _factor(settings)


def creep_of_velocities(settings: RunSettings, system: System) -> float:
    """E_lam for an entry 1 in a row of J, of a velocity of lightness 1."""
    return VELOCITY_CREEP * _factor(settings) * min(1.0, (SHORT / len(system.bodies)) ** 2)


def lightness(dynamics: Dynamics) -> np.ndarray:
    """One over the mass and moment of inertia that velocities are taken for, shape (n_u,)."""
    return dynamics.kept("relaxation", None, lambda: 1 / _heaviest(dynamics.system))


def _factor(settings: RunSettings) -> float:
    return min(max(settings.rtol / 1e-8, TIGHTEST), LOOSEST)


def _heaviest(system: System) -> np.ndarray:
    """For every body the largest mass, and the largest moment of inertia, as seen from across the mechanism."""
    of_body = system.of_body
    largest = system.mass.reshape(-1, of_body.n_u).max(axis=0)
    mass, inertia = largest[0], largest[of_body.linear :].max()
    return system.per_velocity(mass, inertia + mass * system.size**2)


def creeps(system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings, limit: float) -> bool:
    """Whether anything of a run may creep by more tolerances than a limit: a bound at a tenth of the cost of `creep_of`."""
    least = float(absolute_tolerances(system, settings)[system.n_q :].min())
    off = max(float(np.abs(trajectory.u[: len(rows.t)][block] - rows.u[block]).max()) for block in blocks(len(rows.t)))
    return not max(off, _slip(system, rows, settings)) <= limit * least


def creep_of(
    system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings, breakpoints: np.ndarray
) -> Creep:
    """The creep of a run whose reported states were brought back to the constraints.

    Parameters
    ----------
    system : System
    rows : OutputRows
    trajectory : Trajectory
        As integrated, at the instants of the rows and maybe later.
    settings : RunSettings
    breakpoints : ndarray
        Instants at which prescribed velocities may jump, s: the rows there show that and no creep.
    """
    count = len(rows.t)
    jump = _at_one_of(rows.t, breakpoints)
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    largest, total, row, velocity = 0.0, 0.0, 0, 0
    for block in blocks(count):
        off = _in_tolerances(trajectory.u[:count][block], rows.u[block], absolute, settings.rtol)
        of_rows = np.where(jump[block], 0.0, np.nan_to_num(off.max(axis=1)))
        total += float(of_rows.sum())
        k = int(of_rows.argmax())
        if of_rows[k] > largest:
            largest, row, velocity = float(of_rows[k]), block.start + k, int(off[k].argmax())
        release(rows.u, trajectory.u)
    joint = system.equations[int(np.abs(rows.lam[row]).argmax())][0]
    at_end = _slip(system, rows, settings) / float(absolute.min())
    return Creep(total / count, at_end, system.name_of(velocity, system.of_body.velocities), joint)


def _slip(system: System, rows: OutputRows, settings: RunSettings) -> float:
    """What the multipliers of the last instant let velocities creep by, by their size."""
    return creep_of_velocities(settings, system) * float(np.abs(rows.lam[-1]).max()) / float(system.mass.max())


def creep_at(dynamics: Dynamics, t: float, u: np.ndarray, settings: RunSettings) -> float:
    """What the projection takes off velocities u, in tolerances, at a state of the dynamics that it leaves on the constraints."""
    state, system = dynamics.state, dynamics.system
    state.u[:] = u
    if dynamics.correct_velocities(t) < 0:
        return 0.0
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    return float(_in_tolerances(u, state.u, absolute, settings.rtol).max())


def _at_one_of(t: np.ndarray, instants: np.ndarray) -> np.ndarray:
    """Whether each time is one of some increasing instants, but for rounding."""
    if not len(instants):
        return np.zeros(len(t), dtype=bool)
    following = np.searchsorted(instants, t)
    before, after = instants[np.maximum(following - 1, 0)], instants[np.minimum(following, len(instants) - 1)]
    near: np.ndarray = np.minimum(np.abs(t - before), np.abs(t - after)) <= INDISTINCT * np.abs(t)
    return near


def _in_tolerances(before: np.ndarray, after: np.ndarray, absolute: np.ndarray, rtol: float) -> np.ndarray:
    size: np.ndarray = np.abs(after - before) / (absolute + rtol * np.abs(after))
    return size
