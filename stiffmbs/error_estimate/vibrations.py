"""Fast motions that a start at rest excites and that the steps do not follow, such as vibrations of stiff springs.

Steps longer than a period damp a vibration at once, however weakly it is damped itself. If its amplitude is below the tolerance of
positions, as that of a stiff spring is, no error test sees that. Its forces then miss in the results. With the linearised equations
z' = A z, the rates at the start, z' = V c, have a part c_i V_i exp(lambda_i t) in each mode, that is a displacement
c_i V_i / lambda_i from the motion that the steps follow. In a start that moves, rates of slow motions have parts in these modes, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from ..dynamics.dynamics import Dynamics
from ..errors import SolverError
from ..solve.error_control.newton import stiffness_at
from .coordinates import pose_rates
from .evaluated import Evaluated
from .parameters import ESTIMATE
from .transport import OF_BDF


@dataclass(frozen=True, eq=False)
class FastMotions:
    """Displacements (dq, du, ds) in modes that steps do not follow.

    - `t`: start, s. `since` of shape (modes,): starts of the first steps that do not follow, s. `phases` of shape (2, modes, full): displacements at the largest deflections, and a quarter of a period later.
    - `decays` of shape (modes,): rates of decay, 1/s.
    """

    t: float
    since: np.ndarray
    phases: np.ndarray
    decays: np.ndarray

    def sizes(self, t: np.ndarray) -> np.ndarray:
        """Return the parts of the displacements that are left at some times, s, shape (modes, n)."""
        left = np.exp(-np.outer(self.decays, np.maximum(t - self.t, 0.0)))
        return np.asarray(np.where(t > self.since[:, None], left, 0.0))


def excited_at_start(dynamics: Dynamics, states: Evaluated, points: int) -> FastMotions | None:
    """Return the motions that the start excites and the steps do not follow; None if there are none.

    `states`: those of the first piece of a run, with `points` states for each step. The errors of motions that the transport
    follows are in the estimate: those with changes of up to |lambda| h in a step for which its Radau method is accurate.
    """
    system, t, followed = dynamics.system, states.t[::points], _followed(points if points > 1 else OF_BDF.stages)
    starts, steps = t[:-1] - t[0], np.diff(t)
    if states.u[0].any():
        return None
    dynamics.state.q[:], dynamics.state.u[:] = states.q[0], states.u[0]
    stiffness = stiffness_at(dynamics, float(t[0]))
    if max(np.sqrt(stiffness.of_positions), stiffness.of_velocities) * steps.max() < followed:
        return None
    from ..linear_analysis.state_space import state_matrix
    from ..linear_analysis.tangent_space import linearised

    scale = system.per_velocity(system.size, 1.0)
    try:
        _, acceleration = dynamics.accelerate(float(t[0]))
        linear = linearised(dynamics, float(t[0]), acceleration)
        matrix = state_matrix(linear, scale)
        values, vectors = np.linalg.eig(matrix.matrix)
    except (SolverError, np.linalg.LinAlgError):
        return None
    decays = -values.real
    unseen = (np.outer(decays, starts) < 1.0) & (np.outer(np.abs(values), steps) > followed)
    chosen = unseen.any(axis=1) & (decays >= 0.0) & (values.imag >= 0.0)
    if not chosen.any():
        return None
    accelerations = (linear.own_axes.T @ acceleration) / scale
    rows = np.vstack([matrix.poses, matrix.velocities]) / np.tile(scale, 2)[:, None]
    z = np.linalg.lstsq(rows, np.concatenate([np.zeros(len(scale)), accelerations]), rcond=None)[0]
    if np.linalg.norm(matrix.velocities @ z / scale - accelerations) > ESTIMATE.large * np.linalg.norm(accelerations):
        return None  # drives accelerate bodies
    weights = np.linalg.lstsq(vectors, z.astype(complex), rcond=None)[0]
    pairs = np.where(values.imag[chosen] > 0.0, 2.0, 1.0)
    modes = vectors[:, chosen] * (weights[chosen] / values[chosen] * pairs)
    phases = [
        _as_rows(dynamics, states, *(linear.own_axes @ (part @ each) for part in (matrix.poses, matrix.velocities)))
        for each in (modes.real, modes.imag)
    ]
    return FastMotions(float(t[0]), t[np.argmax(unseen[chosen], axis=1)], np.array(phases), decays[chosen])


def _followed(stages: int) -> float:
    """Return |lambda| h at which the error of a Radau method in a step, that of a Pade approximation of exp, is `ESTIMATE.smooth`.

    Hairer, Wanner, Solving Ordinary Differential Equations II (1996), section IV.3, theorem 3.11.
    """
    constant = factorial(stages) * factorial(stages - 1) / (factorial(2 * stages - 1) * factorial(2 * stages))
    return float((ESTIMATE.smooth / constant) ** (0.5 / stages))


def _as_rows(dynamics: Dynamics, states: Evaluated, moved: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return rows (dq, du, ds) from displacements and velocities of all bodies in their axes, as columns."""
    system, count = dynamics.system, moved.shape[1]
    of_poses = pose_rates(system, np.tile(states.q[0], (count, 1)), moved.T)
    return np.hstack([of_poses, moving.T, np.zeros((count, len(system.with_rates)))])
