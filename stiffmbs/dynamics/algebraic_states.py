"""Algebraic states: their rates, and messages on missing or non-unique values."""

from __future__ import annotations

import numpy as np

from ..compile.machine.native.statuses import NO_BALANCE, NO_STATE
from .dynamics import Dynamics
from .friction_loads import REMEDY
from .native.parameters import CONSISTENCY
from .storage import FAILURES

BEYOND_LAST_STATE = np.geomspace(1e-9, 1e-5, 3)
"""Times after the last state, relative to the time, at which missing values are searched for."""


def rates_by_states(dynamics: Dynamics) -> np.ndarray:
    """Return the Jacobian of the rates of differential states by these states, with algebraic states eliminated.

    The term set ``tangent`` must be up to date. Entries are NaN where the algebraic states are not unique.
    """
    system = dynamics.system
    own = slice(system.first_state, None)
    whole, algebraic = dynamics.state.matrix("tangent", "rate_q")[own, own], system.algebraic
    rates, follow = whole[~algebraic], whole[algebraic]
    try:
        by_others = -np.linalg.solve(follow[:, algebraic], follow[:, ~algebraic])
    except np.linalg.LinAlgError:
        return np.full((len(rates), len(rates)), np.nan)
    found: np.ndarray = rates[:, ~algebraic] + rates[:, algebraic] @ by_others
    return found


def failure(dynamics: Dynamics, status: int, t: float) -> str:
    """Return a clause on why accelerations have no solution; it names an algebraic state without a value, or friction."""
    if status == NO_BALANCE and dynamics.system.forces_by_reactions:
        return f"{FAILURES[status]}: {' and '.join(dynamics.system.forces_by_reactions)}; {REMEDY}"
    return (no_value(dynamics, t) if status == NO_STATE else "") or FAILURES[status]


def no_value_ahead(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray) -> str:
    """Return a clause on the algebraic state or friction without a solution at or just after a state, or an empty string."""
    system, state = dynamics.system, dynamics.state
    if not (system.algebraic.any() or system.forces_by_reactions):
        return ""
    state.q[:], state.u[:] = q, u
    status, acceleration = dynamics.accelerate(t)
    if status >= 0:
        for ahead in BEYOND_LAST_STATE:
            later = ahead * max(1.0, abs(t))
            with state.unchanged():
                rates = dynamics.position_rates(state.q, state.u)
                state.q[:] = system.of_body.moved(state.q, later * state.u)
                state.q[system.n_pose :] += later * rates[system.n_pose :]
                state.u[:] += later * acceleration
                status, _ = dynamics.accelerate(t + later)
                if status in (NO_STATE, NO_BALANCE):
                    return failure(dynamics, status, t + later)
    return no_value(dynamics, t) if system.algebraic.any() else ""


def no_value(dynamics: Dynamics, t: float) -> str:
    """Return a clause on the algebraic state without a regular solution near its current value, or an empty string."""
    system, state = dynamics.system, dynamics.state
    places = system.algebraic_coordinates
    state.evaluate("tangent", t)
    state.evaluate("motion", t)
    slopes = state.matrix("tangent", "rate_q")[np.ix_(places, places)]
    left = state.vector("motion", "rate")[places]
    sizes = np.maximum(np.abs(state.q[places]), system.state_scales[system.algebraic])
    names = [system.states[k] for k in np.flatnonzero(system.algebraic)]
    at = [f"{name} = {value:.6g}" for name, value in zip(names, state.q[places], strict=True)]
    undefined = np.flatnonzero(~np.isfinite(left) | ~np.all(np.isfinite(slopes), axis=1))
    if len(undefined):
        worst = int(undefined[0])
        return f"the equation of the state '{names[worst]}' has no finite value at {at[worst]}"
    values, vectors = np.linalg.eigh((slopes * sizes).T @ (slopes * sizes))
    if not values[0] > CONSISTENCY.zero_slope**2 * max(values[-1], np.finfo(float).tiny):
        worst = int(np.argmax(np.abs(vectors[:, 0])))
        return (
            f"the state '{names[worst]}' has no unique value: the derivative of its equation by the state is zero at {at[worst]}, "
            "expected an equation that depends on the state"
        )
    moves = np.abs(np.linalg.solve(slopes, left)) / sizes
    worst = int(np.argmax(moves))
    if not moves[worst] > CONSISTENCY.zero_slope:
        return ""
    return (
        f"the state '{names[worst]}' has no value: Newton's iteration finds no zero of its equation from {at[worst]}, "
        f"where it is {left[worst]:.3g}; expected a zero near there"
    )
