"""What no step has seen, found where the forces at output instants contradict the steps that lead over them.

Within a step an integrator has a polynomial, and at every output instant the block system gives accelerations anyway.
Their difference from the polynomial's own derivative, times the step, is an error that the velocities may have.  Along
smooth motions and stiff forces it stays within some thousand tolerances, and steps that cross the knots of a table differ by
a small part of the accelerations (measured).  A force that has begun and ended within the step differs by far more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..analyse.reactions import reactions
from ..compile.laws import has_law
from ..compile.system import System
from ..describe.settings import RunSettings
from ..solve.mechanics import OutputRows
from ..solve.tolerances import absolute_tolerances
from ..solve.trajectory import Trajectory

TOLERANCES = 1e5
"""Times the tolerance of a velocity that the difference makes in a step, beyond which something was overlooked."""
PART = 0.1
"""Part of the accelerations, weighted with masses, by which they must differ from what the steps have followed."""

ROUNDING = 1e-9
"""Part of a step within which an instant counts for its end."""


@dataclass(frozen=True)
class Overlooked:
    """What the steps of a run passed over.

    Attributes
    ----------
    times : ndarray
        In each step that passed over something, the first output instant that shows it, s.
    step : float
        Length of the first of these steps, s.
    velocity : str
        The velocity that would have changed most there.
    element : str
        The law with the largest force there; empty for none.
    """

    times: np.ndarray
    step: float
    velocity: str
    element: str

    def sentence(self) -> str:
        """Where it was."""
        more = f" and in {len(self.times) - 1} more steps" if len(self.times) > 1 else ""
        law = f"'{self.element}'" if self.element else "a law"
        return (
            f"a step of {self.step:.2g} s passed over {law} at t = {self.times[0]:.6g} s{more}: "
            f"forces there accelerate {self.velocity} otherwise than the step has followed"
        )


def overlooked(system: System, trajectory: Trajectory, rows: OutputRows, settings: RunSettings) -> Overlooked | None:
    """What the steps of a run passed over; None for nothing.

    Parameters
    ----------
    system : System
        Of the whole.
    trajectory : Trajectory
    rows : OutputRows
        At its instants.
    settings : RunSettings
    """
    if not trajectory.slope.size or not len(trajectory.step_times):
        return None
    last, step = _steps(trajectory, rows.t)
    off = np.abs(trajectory.slope[: len(rows.t)] - rows.acceleration)
    tolerance = absolute_tolerances(system, settings)[system.n_q :] + settings.rtol * np.abs(rows.u)
    far = np.flatnonzero((off * step[:, None] > TOLERANCES * tolerance).any(axis=1))
    different, followed, there = (_sizes(system, each[far]) for each in (off, trajectory.slope, rows.acceleration))
    far = far[different > PART * np.fmax(followed, there)]
    if not len(far):
        return None
    _, first = np.unique(last[far], return_index=True)
    k = int(far[0])
    velocity = system.name_of(int(np.nanargmax(off[k] / tolerance[k])), system.of_body.velocities)
    return Overlooked(rows.t[far[first]], float(step[k]), velocity, _acting(system, rows, k))


def _steps(trajectory: Trajectory, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The number and length, s, of the step that each instant lies in; of no length where steps meet, as they see the forces there."""
    ends = np.append(trajectory.t[0], trajectory.step_times)
    last = np.clip(np.searchsorted(ends, t), 1, len(ends) - 1)
    step = ends[last] - ends[last - 1]
    return last, np.where(np.minimum(t - ends[last - 1], ends[last] - t) > ROUNDING * step, step, 0.0)


def _sizes(system: System, accelerations: np.ndarray) -> np.ndarray:
    """Norms of accelerations in the mass matrix; of those alone that are known."""
    return np.sqrt(np.nansum(system.mass * accelerations**2, axis=1))


def _acting(system: System, rows: OutputRows, k: int) -> str:
    """The law with the largest force or torque at an instant."""
    laws = {name for group in system.groups if has_law(group) for name in group.names}
    found = reactions(system, rows.values[k : k + 1])
    of_laws = {name: abs(float(value[0])) for name, value in found.items() if name.rpartition(".")[0] in laws}
    return max(of_laws, key=lambda name: of_laws[name], default="").rpartition(".")[0]
