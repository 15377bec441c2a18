"""Constraint drift of the relaxed formulation, J u + C_t = E_lam lam: relaxations of a run, and its measured drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...compile.system import System
from ...dynamics.dynamics import Dynamics, OutputRows
from ...dynamics.storage import STORAGE, blocks, release
from ...errors import SolverError
from ...model.settings import RunSettings
from ...notes import Note, NoteKind
from ...tuning import tuned
from ..events.native.parameters import INDISTINCT
from ..reasons import Reason
from ..suspect import suspect
from ..trajectory import Trajectory
from .tolerances import absolute_tolerances


@dataclass(frozen=True)
class RelaxationParameters:
    """Parameters of the relaxed constraints.

    Source: ``tests/solve/ida/test_relaxation.py`` and ``docs/formulations.md``.
    """

    of_positions: float = 1e-9
    """Relaxation time of position constraints at rtol 1e-8, s."""
    of_velocities: float = 1e-12
    """Relaxation time of velocity constraints at rtol 1e-8, s."""
    short_chain: int = 100
    """Number of bodies beyond which relaxations decrease with the square of that number: drift accumulates along
    chains."""
    largest_factor: float = 1e3
    """Largest factor by which a tolerance other than 1e-8 scales the relaxations, or its inverse."""
    check_interval: int = 1000
    """Steps before the constraint drift is checked during a run, and between checks of the elimination in explicit ones."""
    refused: float = 1e6
    """Drift, in tolerances, at which a run ends: its motion no longer is that of the mechanism."""


RELAXATION = tuned("relaxation", RelaxationParameters())


DRIFT = "the reactions in '{element}' cause constraint drift (formulation SI2): an error of {velocity} of {drift:.2g} tolerances"
"""Text of notes on drift."""


class Drift(NamedTuple):
    """Constraint drift of the velocities of a run, in units of their tolerances.

    - `mean`: mean over the output times of the largest drift at each; a singular pose raises it only briefly.
    - `at_end`: drift expected from the multipliers at the last output time, before the steps have followed them.
    - `velocity`: velocity with the largest drift. `joint`: joint with the largest multiplier at that time.
    """

    mean: float
    at_end: float
    velocity: str
    joint: str

    def note(self, kind: NoteKind, reason: str = "") -> Note:
        """Return a note that describes the drift, whose kind says what was done about it."""
        velocity = self.velocity if self.mean >= self.at_end else "velocities"
        return kind(self.joint, velocity=velocity, drift=max(self.mean, self.at_end), reason=reason)


def drift_of_positions(settings: RunSettings) -> float:
    """Return E_mu of a row of C_q with a single entry 1."""
    return RELAXATION.of_positions * _factor(settings)


def drift_of_velocities(settings: RunSettings, system: System) -> float:
    """Return E_lam of a row of J with a single entry 1, for an inverse mass of 1."""
    return RELAXATION.of_velocities * _factor(settings) * min(1.0, (RELAXATION.short_chain / len(system.bodies)) ** 2)


def inverse_mass(dynamics: Dynamics) -> np.ndarray:
    """Return the inverse masses and moments of inertia that relaxations use, shape (n_u,)."""
    return dynamics.once(_inverse_mass)


def _factor(settings: RunSettings) -> float:
    return min(max(settings.rtol / 1e-8, 1 / RELAXATION.largest_factor), RELAXATION.largest_factor)


def _inverse_mass(dynamics: Dynamics) -> np.ndarray:
    """Return 1 over the largest mass, or largest moment of inertia about a point across the mechanism, for each velocity."""
    system, of_body = dynamics.system, dynamics.system.of_body
    largest = system.mass.reshape(-1, of_body.n_u).max(axis=0)
    mass, inertia = largest[0], largest[of_body.linear :].max()
    return 1 / system.per_velocity(mass, inertia + mass * system.size**2)


def drifts(system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings, limit: float) -> bool:
    """Return True if the drift of a run may exceed `limit` tolerances; an inexpensive bound of `drift_of`."""
    least = float(absolute_tolerances(system, settings)[system.n_q :].min())
    before, block = trajectory.u[: len(rows.t)], STORAGE.block
    firsts = range(0, len(rows.t), block)
    off = max([float(np.abs(before[k : k + block] - rows.u[k : k + block]).max()) for k in firsts])
    return not max(off, _slip(system, rows, settings)) <= limit * least


def drift_of(
    system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings, breakpoints: np.ndarray
) -> Drift:
    """Return the constraint drift of a run whose output states were projected onto the constraints.

    `trajectory`: as integrated, at the times of the rows and possibly later. `breakpoints`: times at which prescribed
    velocities may jump, s; rows at these times are ignored.
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
    return Drift(total / count, at_end, system.name_of(velocity, system.of_body.velocities), joint)


def _slip(system: System, rows: OutputRows, settings: RunSettings) -> float:
    """Return the velocity drift expected from the multipliers of the last output time."""
    return drift_of_velocities(settings, system) * float(np.abs(rows.lam[-1]).max()) / float(system.mass.max())


def drift_at(dynamics: Dynamics, t: float, u: np.ndarray, settings: RunSettings) -> float:
    """Project velocities u onto the constraints at the current positions; return the largest change, in tolerances."""
    state, system = dynamics.state, dynamics.system
    state.u[:] = u
    if dynamics.correct_velocities(t) < 0:
        return 0.0
    absolute = absolute_tolerances(system, settings)[system.n_q :]
    return float(_in_tolerances(u, state.u, absolute, settings.rtol).max())


def refuse_drift(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, settings: RunSettings) -> None:
    """Stop a run whose relaxed constraints have drifted apart; driven velocities are checked at the end of the run.

    Raises SolverError if velocities violate the constraints by more than `RelaxationParameters.refused` tolerances.
    """
    system = dynamics.system
    if settings.formulation == "SI2" and system.n_c and np.all(system.holonomic[system.active]):
        dynamics.state.q[:] = q
        if (drift := drift_at(dynamics, t, u, settings)) > RELAXATION.refused:
            raise SolverError(
                Reason.DRIFTED.of(
                    f"stopped at t = {t:.9g} s: constraint drift: velocities violate the constraints by {drift:.2g} tolerances"
                    f"{suspect(dynamics, t, q, u)}"
                )
            )


def _at_one_of(t: np.ndarray, instants: np.ndarray) -> np.ndarray:
    """Return a mask of the times that equal one of some increasing instants up to rounding."""
    if not len(instants):
        return np.zeros(len(t), dtype=bool)
    following = np.searchsorted(instants, t)
    before, after = instants[np.maximum(following - 1, 0)], instants[np.minimum(following, len(instants) - 1)]
    near: np.ndarray = np.minimum(np.abs(t - before), np.abs(t - after)) <= INDISTINCT * np.abs(t)
    return near


def _in_tolerances(before: np.ndarray, after: np.ndarray, absolute: np.ndarray, rtol: float) -> np.ndarray:
    size: np.ndarray = np.abs(after - before) / (absolute + rtol * np.abs(after))
    return size
