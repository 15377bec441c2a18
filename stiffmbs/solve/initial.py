"""Initial values: positions assembled, velocities corrected, accelerations and multipliers solved for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..compile.system import PLANAR
from ..errors import AssemblyError
from .failures import FAILURES
from .mechanics import POSITION_TOLERANCE, Mechanics
from .native.statuses import NO_BALANCE, NO_CONVERGENCE, NOT_FINITE, SINGULAR

POSITIONS, VELOCITIES = ("x", "y", "angle"), ("vx", "vy", "omega")
"""What a body's coordinates and velocities are called."""
WORTH_TELLING = 1e-9
"""Moves of a coordinate (m, rad, m/s, rad/s) below this are not mentioned."""


@dataclass(frozen=True)
class InitialValues:
    """A consistent start.

    Attributes
    ----------
    q, u, acceleration, lam : ndarrays
        Coordinates, velocities, accelerations and multipliers that satisfy the constraints on every level.
    moved : tuple of (str, str, float)
        Body, coordinate and change, for every coordinate or velocity that had to be changed noticeably.
    """

    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray
    moved: tuple[tuple[str, str, float], ...]

    def sentence(self) -> str:
        """What was moved, in words; empty where nothing was."""
        parts = [_largest(self.moved, POSITIONS), _largest(self.moved, VELOCITIES)]
        told = " and ".join(part for part in parts if part)
        return f"to satisfy the joints at the start, assembly changed {told}" if told else ""


def _largest(moved: tuple[tuple[str, str, float], ...], coordinates: tuple[str, ...]) -> str:
    changes = [move for move in moved if move[1] in coordinates]
    if not changes:
        return ""
    body, coordinate, change = max(changes, key=lambda move: abs(move[2]))
    others = len({name for name, _, _ in changes}) - 1
    return f"{body}.{coordinate} by {change:.3g}" + (f" ({others} other bodies by less)" if others else "")


def initial_values(mechanics: Mechanics, t: float) -> InitialValues:
    """Make the described start consistent.

    Positions by Newton's smallest moves, velocities by the smallest correction in the mass matrix, accelerations
    and multipliers from [M J^T; J 0][u'; lam] = [f; gamma].

    Raises
    ------
    AssemblyError
        When no assembled position is found (names the joint with the largest gap), the equations are dependent, or
        friction and reactions find no balance.
    """
    system, state = mechanics.system, mechanics.state
    q0, u0 = system.q.copy(), system.u.copy()
    status = mechanics.assemble(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, NO_CONVERGENCE if status == SINGULAR else status, t))
    status = mechanics.correct_velocities(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, status, t))
    status, acceleration = mechanics.accelerate(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, status, t))
    changes = ((state.q - q0, POSITIONS), (state.u - u0, VELOCITIES))
    moved = tuple(
        (system.bodies[k // PLANAR], labels[k % PLANAR], float(change[k]))
        for change, labels in changes
        for k in np.flatnonzero(np.abs(change) > WORTH_TELLING)
    )
    return InitialValues(state.q.copy(), state.u.copy(), acceleration, state.lam[: system.n_c].copy(), moved)


def _sentence(mechanics: Mechanics, status: int, t: float) -> str:
    """Why there is no consistent start, with the element that is to blame."""
    if status == NO_CONVERGENCE:
        return _gap_sentence(mechanics, t)
    if status == SINGULAR:
        return _dependent_sentence(mechanics)
    if status == NO_BALANCE:
        return _balance_sentence(mechanics)
    if status == NOT_FINITE:
        return _undefined_sentence(mechanics, t)
    return f"no consistent start was found: {FAILURES[status]}"


def _balance_sentence(mechanics: Mechanics) -> str:
    rubbing = [n for group in mechanics.system.groups if group.record.patterns.get("f_lam") for n in group.names]
    return f"the start has no accelerations: {FAILURES[NO_BALANCE]}, expected less of it in {', '.join(rubbing)}"


def _gap_sentence(mechanics: Mechanics, t: float) -> str:
    system, state = mechanics.system, mechanics.state
    state.evaluate("position", t)
    gaps = np.abs(state.vector("position", "C"))
    if not np.all(np.isfinite(gaps)):
        return _undefined_sentence(mechanics, t)
    joint, equation = system.equations[int(np.argmax(gaps))]
    return (
        f"the scene cannot be assembled: the largest gap is left in joint '{joint}' (equation {equation}, "
        f"{gaps.max():.3g}, expected less than {POSITION_TOLERANCE:g})"
    )


def _dependent_sentence(mechanics: Mechanics) -> str:
    state, system = mechanics.state, mechanics.system
    solved_for = np.flatnonzero(system.active)
    jacobian = state.matrix("motion", "J")[solved_for]
    joint, equation = system.equations[solved_for[_most_dependent_row(jacobian)]]
    return (
        f"the constraint equations depend on each other at the start: joint '{joint}' (equation {equation}) repeats "
        "what other joints already hold, so its reaction has no unique value"
    )


def _most_dependent_row(jacobian: np.ndarray) -> int:
    """The row that QR with pivoting of the transposed matrix leaves for last."""
    from scipy.linalg import qr

    *_, order = qr(jacobian.T, mode="economic", pivoting=True)
    return int(order[-1])


def _undefined_sentence(mechanics: Mechanics, t: float) -> str:
    state, system = mechanics.state, mechanics.system
    for term_set in ("motion", "acceleration"):
        state.evaluate(term_set, t)
        for name in (name for group in system.groups for name in group.names):
            values = system.values_of(state.values[term_set], term_set, name)
            if not all(np.all(np.isfinite(part)) for part in values.values()):
                return f"'{name}' has no finite value at the start, expected equations that are defined there"
    return "the accelerations at the start are not finite, expected forces and masses of ordinary size"
