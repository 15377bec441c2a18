"""What no step has seen, found where the forces at output instants contradict the step that leads over them.

Within a step an integrator has a polynomial, and at every output instant the block system gives accelerations anyway.
Between two instants of one step their mean, times the time between, is the change of the velocities.  Along smooth motions
it is so but for a small part, as a step is short beside what it has seen; what stiff forces make of errors within the
tolerance stays within some ten thousand tolerances over a step (measured).  A force that has begun and ended within the
step, and is met by an output instant, is beyond both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..compile.machine.layout import addresses
from ..compile.machine.routines import Routine
from ..compile.reactions import reactions
from ..compile.system import System
from ..describe.settings import RunSettings
from ..solve.dynamics import OutputRows
from ..solve.error_control.tolerances import absolute_tolerances
from ..solve.trajectory import Trajectory

CONTRADICTING_ROWS = Routine(
    "stiffmbs.run_checks.native.contradictions",
    "contradicting_rows",
    "int64(int64, int64, float64*, float64*, float64*, float64*, float64, int64, float64*, int64*)",
)

OVERLOOKED_TOLERANCES = 3e5
"""Times the tolerance of a velocity that the contradiction makes over a step, beyond which something was overlooked."""
OVERLOOKED_PART = 0.3
"""Part of what the larger of two accelerations, weighted with masses, makes in the time between, by which the change differs."""


@dataclass(frozen=True)
class Overlooked:
    """What the steps of a run passed over.

    Attributes
    ----------
    times : ndarray
        Where it is shown, s: in each step the output instant with the largest accelerations of the first pair that does,
        and in long steps the instants with the largest accelerations.
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
        more = f" and at {len(self.times) - 1} more instants" if len(self.times) > 1 else ""
        law = f"'{self.element}'" if self.element else "a law"
        return (
            f"a step of {self.step:.2g} s passed over {law} at t = {self.times[0]:.6g} s{more}: "
            f"forces there accelerate {self.velocity} otherwise than the step has followed"
        )


def together(found: Sequence[Overlooked]) -> Overlooked | None:
    """What was found in several ways as one, told by the earliest; None for nothing."""
    if not found:
        return None
    return replace(
        min(found, key=lambda each: float(each.times[0])),
        times=np.unique(np.concatenate([each.times for each in found])),
    )


def overlooked(system: System, rows: OutputRows, trajectory: Trajectory, settings: RunSettings) -> Overlooked | None:
    """What the steps of a run passed over; None for nothing, and where no law could be.

    Parameters
    ----------
    system : System
        Of the whole.
    rows : OutputRows
    trajectory : Trajectory
        Whose steps are looked at.
    settings : RunSettings
    """
    steps = trajectory.step_times
    if len(steps) < 2 or not system.has_laws:
        return None
    pairs = contradicting_rows(rows, system.mass, steps)
    if not len(pairs):
        return None
    number = np.searchsorted(steps, rows.t[pairs])
    step = steps[number] - steps[number - 1]
    tolerance = absolute_tolerances(system, settings)[system.n_q :] + settings.rtol * np.abs(rows.u[pairs])
    over_step = np.abs(_contradictions(rows, pairs)) * step[:, None] / (OVERLOOKED_TOLERANCES * tolerance)
    found = np.flatnonzero((over_step > 1).any(axis=1))
    if not len(found):
        return None
    _, first = np.unique(number[found], return_index=True)
    first_size, second_size = (rows.acceleration[k] ** 2 @ system.mass for k in (pairs, pairs + 1))
    at, k = (pairs + (second_size > first_size))[found], found[0]
    velocity = system.name_of(int(np.nanargmax(over_step[k])), system.of_body.velocities)
    return Overlooked(rows.t[at[first]], float(step[k]), velocity, acting(system, rows, int(at[0])))


def contradicting_rows(
    rows: OutputRows, mass: np.ndarray, steps: np.ndarray, part: float = OVERLOOKED_PART
) -> np.ndarray:
    """Numbers of the rows that contradict the next one, where both are inside one step.

    Parameters
    ----------
    rows : OutputRows
    mass : ndarray, shape (n_u,)
        Weights.
    steps : ndarray
        Ends of the steps, s.
    part : float
        Of the larger acceleration, beyond which they do.
    """
    found = np.empty(len(rows.t), dtype=np.int64)
    t, u, acceleration, mass, steps = map(np.ascontiguousarray, (rows.t, rows.u, rows.acceleration, mass, steps))
    *of_rows, at_steps, at_found = addresses(t, u, acceleration, mass, steps, found)
    count = CONTRADICTING_ROWS.call(len(t), len(mass), *of_rows, part, len(steps), at_steps, at_found)
    return found[:count]


def _contradictions(rows: OutputRows, pairs: np.ndarray) -> np.ndarray:
    """By how much the change of velocities until the next instant, in a second, differs from the mean of their accelerations."""
    following = pairs + 1
    change = (rows.u[following] - rows.u[pairs]) / (rows.t[following] - rows.t[pairs])[:, None]
    mean: np.ndarray = 0.5 * (rows.acceleration[pairs] + rows.acceleration[following])
    return change - mean


def acting(system: System, rows: OutputRows, k: int) -> str:
    """The law with the largest force or torque at an instant."""
    laws = {name for group in system.groups if group.has_law for name in group.names}
    found = reactions(system, rows.values[k : k + 1])
    of_laws = {name: abs(float(value[0])) for name, value in found.items() if name.rpartition(".")[0] in laws}
    return max(of_laws, key=lambda name: of_laws[name], default="").rpartition(".")[0]
