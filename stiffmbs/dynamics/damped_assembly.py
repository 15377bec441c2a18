"""Assembly from poses that are far from closed."""

from __future__ import annotations

import numpy as np

from .dynamics import Dynamics
from .native.parameters import CONSISTENCY


def damped_assembly(dynamics: Dynamics, t: float, q: np.ndarray) -> bool:
    """Assemble the state from the pose q by the method of Levenberg and Marquardt; return False, with q kept, if it fails.

    Newton's moves may increase the gaps of a mechanism that is drawn far from closed, such as a slack chain on a straight
    line.  Each of these moves reduces the sum of their squares, with lengths in units of the mechanism's size.

    References
    ----------
    J. Nocedal, S. J. Wright, Numerical Optimization, Springer 2006, ch. 10.3.
    """
    system, state = dynamics.system, dynamics.state
    before = state.q.copy()
    rows = np.flatnonzero(system.active & system.holonomic)
    unit = system.per_velocity(system.size, 1.0)

    weights = np.ones(len(rows))

    def gaps_at(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the weighted gaps and their slopes by dimensionless displacements."""
        state.q[:] = pose
        state.evaluate("motion", t)
        gaps, slopes = state.vector("motion", "C")[rows], state.matrix("motion", "J")[rows]
        return weights * gaps, weights[:, None] * slopes * unit

    sizes = np.linalg.norm(gaps_at(q)[1], axis=1)
    if not sizes.all():  # an equation without a direction, such as of a rod between two points at one place
        state.q[:] = before
        return False
    weights, damping = 1.0 / sizes, CONSISTENCY.close
    nudge = CONSISTENCY.nudge * unit * np.cos(np.arange(system.n_u) ** 2)
    gaps, _ = gaps_at(q)
    _, slopes = gaps_at(system.of_body.moved(q, nudge))  # without the zeros of a drawing along the axes
    pose = system.of_body.moved(q, nudge * _in_open_mechanisms(gaps, slopes, system.of_body.n_u))
    gaps, slopes = gaps_at(pose)
    for _ in range(CONSISTENCY.most_damped_moves):
        least = np.linalg.norm(slopes.T @ gaps) <= CONSISTENCY.close * np.linalg.norm(gaps)
        if least or not np.abs(gaps).max() > CONSISTENCY.close:
            break
        gram = slopes @ slopes.T + damping * np.eye(len(rows))
        trial = system.of_body.moved(pose, -unit * (slopes.T @ np.linalg.solve(gram, gaps)))
        trial_gaps, trial_slopes = gaps_at(trial)
        if np.linalg.norm(trial_gaps) < np.linalg.norm(gaps):
            pose, gaps, slopes = trial, trial_gaps, trial_slopes
            damping = max(damping / 4.0, np.finfo(float).eps)
        else:
            damping *= 4.0
    state.q[:] = pose
    if np.abs(gaps).max() <= CONSISTENCY.close and dynamics.assemble(t) >= 0:
        return True
    state.q[:] = before
    return False


def _in_open_mechanisms(gaps: np.ndarray, slopes: np.ndarray, n_u: int) -> np.ndarray:
    """Return True for the velocities, `n_u` of each body, of bodies that joints connect with a gap, directly or not."""
    of_bodies = (slopes != 0.0).reshape(len(gaps), -1, n_u).any(axis=2)
    found, reached = of_bodies[np.abs(gaps) > CONSISTENCY.position_tolerance].any(axis=0), np.zeros(0, dtype=bool)
    while not np.array_equal(found, reached):
        reached = found
        found = of_bodies[(of_bodies & reached).any(axis=1)].any(axis=0)
    return np.repeat(reached, n_u)
