"""Grouping of independent mechanisms with similar step sizes, which cost less when solved together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..compile.system import System
from ..dynamics.dynamics import Dynamics
from ..dynamics.initial import InitialValues
from .cost import COSTS, ImplicitCost, of_explicit_step

ITERATIONS = 5
"""Iterations of the power method, as in `stiffmbs.solve.explicit.native.fastest_rate`."""
MOVE = 1e-7
"""Largest perturbation of a coordinate or velocity in the difference quotient, m, rad, m/s, rad/s."""
IMPLICIT_STEPS, EXPLICIT_STEPS = 30.0, 2.0
"""Steps of BDF and of DOP853 per radian of the motion, at rtol 1e-6."""


def alike(
    dynamics: Dynamics,
    start: InitialValues,
    during: tuple[float, float],
    implicit: bool,
    mechanisms: Sequence[np.ndarray],
) -> list[list[int]]:
    """Return the sets of mechanisms to solve together that minimize the estimated cost.

    The fastest mechanism of a set determines its number of steps. Each step has a fixed cost and a cost per unknown.
    Mechanisms with formulas, tables, events or states are solved separately, as each of their breakpoints is a restart.

    Parameters
    ----------
    dynamics : Dynamics
        Of the whole system.
    start : InitialValues
    during : tuple of float
        Start and end of the run, s.
    implicit : bool
        Whether BDF solves it.
    mechanisms : sequence of ndarray of int
        Body numbers of each mechanism.
    """
    system = dynamics.system
    width = system.of_body.n_u
    label = np.full(system.n_u, -1)
    for k, bodies in enumerate(mechanisms):
        label[(width * bodies[:, None] + np.arange(width)).ravel()] = k
    alone = _with_laws(system)
    smooth = [k for k, bodies in enumerate(mechanisms) if not alone[bodies].any()]
    sets = [[k] for k in range(len(mechanisms)) if k not in smooth]
    if len(smooth) < 2:
        return sets + [[k] for k in smooth]
    rates = _rates(dynamics, during[0], start, label, len(mechanisms))
    whole = ImplicitCost.of(dynamics).step if implicit else of_explicit_step(dynamics)
    itself = COSTS.step_residuals * COSTS.residual if implicit else COSTS.explicit_step
    share = np.bincount(label[label >= 0], minlength=len(mechanisms)) / np.count_nonzero(label >= 0)
    of_unknowns = (whole - itself) * share
    steps = COSTS.start_steps + (IMPLICIT_STEPS if implicit else EXPLICIT_STEPS) * (during[1] - during[0]) * rates
    current: list[int] = []
    for k in sorted(smooth, key=lambda k: -steps[k]):
        more = (steps[current[0]] - steps[k]) * of_unknowns[k] if current else np.inf
        if more < COSTS.start + steps[k] * itself:
            current.append(k)
        else:
            current = [k]
            sets.append(current)
    return sets


def _with_laws(system: System) -> np.ndarray:
    """Return a mask of the bodies with elements that have breakpoints, formulas, tables or states, shape (bodies,)."""
    found = np.zeros(len(system.bodies) + 1, dtype=bool)
    for group in system.groups:
        if group.has_law or group.states.shape[1]:
            found[group.bodies.ravel()] = True
    return found[:-1]


def _rates(dynamics: Dynamics, t: float, start: InitialValues, label: np.ndarray, count: int) -> np.ndarray:
    """Return a characteristic rate of each mechanism at the start, 1/s; infinite where accelerations have no solution.

    It is the largest of the natural angular frequencies, the decay rates, the angular velocities and the square roots
    of the angular accelerations.
    """
    system, state = dynamics.system, dynamics.state
    q, u = start.q, start.u
    state.q[:], state.u[:] = q, u
    status, at_start = dynamics.accelerate(t)
    if status < 0:
        return np.full(count, np.inf)
    moving = label >= 0
    angular = np.zeros(system.n_u, dtype=bool)
    angular.reshape(-1, system.of_body.n_u)[:, system.of_body.linear :] = True
    of_angles = np.where(angular, np.maximum(np.abs(u), np.sqrt(np.abs(at_start))), 0.0)
    found = np.zeros(count)
    np.maximum.at(found, label[moving], of_angles[moving])
    stiffness = _growth(dynamics, t, (q, u), at_start, label, of_pose=True)
    damping = _growth(dynamics, t, (q, u), at_start, label, of_pose=False)
    state.q[:], state.u[:] = q, u
    dynamics.forget_pivots()
    return np.maximum(found, np.maximum(np.sqrt(stiffness), damping))


def _growth(
    dynamics: Dynamics,
    t: float,
    at: tuple[np.ndarray, np.ndarray],
    at_start: np.ndarray,
    label: np.ndarray,
    of_pose: bool,
) -> np.ndarray:
    """Return the norm of the derivative of accelerations by the pose, or by velocities, of each mechanism.

    The power method treats all mechanisms at once, as the accelerations of each depend on its own motion alone.
    """
    (q, u), state, mass = at, dynamics.state, dynamics.system.mass
    own = np.flatnonzero(label >= 0)
    of = label[own]
    count = int(of.max()) + 1

    def largest(v: np.ndarray) -> np.ndarray:
        found = np.zeros(count)
        np.maximum.at(found, of, np.abs(v[own]))
        return np.maximum(found, np.finfo(float).tiny)

    def size(v: np.ndarray) -> np.ndarray:
        return np.sqrt(np.bincount(of, mass[own] * v[own] ** 2, count))

    v = np.zeros(len(u))
    v[own] = np.sin(1.0 + 3.7 * own) / mass[own]
    growth = np.zeros(count)
    for _ in range(ITERATIONS):
        scale = MOVE / largest(v)
        move = np.zeros(len(u))
        move[own] = scale[of] * v[own]
        state.q[:], state.u[:] = (dynamics.system.of_body.moved(q, move), u) if of_pose else (q, u + move)
        status, acceleration = dynamics.accelerate(t)
        if status < 0:
            return np.full(count, np.inf)
        w = np.zeros(len(u))
        w[own] = (acceleration[own] - at_start[own]) / scale[of]
        before = size(v)
        growth = np.divide(size(w), before, out=np.zeros(count), where=before > 0.0)
        v = w
    return growth
