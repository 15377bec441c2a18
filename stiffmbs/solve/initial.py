"""Initial values: positions assembled, velocities corrected, accelerations and multipliers solved for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..errors import AssemblyError
from .failures import FAILURES
from .mechanics import POSITION_TOLERANCE, Mechanics
from .native.statuses import NO_BALANCE, NO_CONVERGENCE, NOT_FINITE, SINGULAR
from .nearest_turns import take_nearest_turns

PLACES, RATES = ("m", "rad"), ("m/s", "rad/s")
"""Units of centres of mass and of turns, on the level of positions and on that of velocities."""
WORTH_TELLING = 1e-9
"""Moves of a coordinate (m, rad, m/s, rad/s) below this are not mentioned."""
MUCH_LESS = 1e-3
"""Part of the largest move below which one of another unit is not mentioned."""


@dataclass(frozen=True)
class Move:
    """A change that assembly made.

    Attributes
    ----------
    body, coordinate : str
        Such as ``bar`` and ``vx``; a turn in space is an ``angle``, a change of its rate one of ``omega``.
    unit : str
    change : float
    """

    body: str
    coordinate: str
    unit: str
    change: float

    def __str__(self) -> str:
        return f"{self.body}.{self.coordinate} by {self.change:.3g} {self.unit}"


@dataclass(frozen=True)
class InitialValues:
    """A consistent start.

    Attributes
    ----------
    q, u, acceleration, lam : ndarrays
        Coordinates, velocities, accelerations and multipliers that satisfy the constraints on every level.
    moved : tuple of Move
        Of every coordinate or velocity that had to be changed noticeably.
    """

    q: np.ndarray
    u: np.ndarray
    acceleration: np.ndarray
    lam: np.ndarray
    moved: tuple[Move, ...]

    def sentence(self) -> str:
        """What was moved, in words: the largest moves of points and turns, and of their rates; empty where nothing was."""
        levels = [list(_largest(self.moved, units)) for units in (PLACES, RATES)]
        told = [move for level in levels for move in level]
        if not told:
            return ""
        words = " and ".join(", ".join(map(str, level)) for level in levels if level)
        others = len({move.body for move in self.moved} - {move.body for move in told})
        less = f" ({others} other {'bodies' if others > 1 else 'body'} by less)" if others else ""
        return f"to satisfy the joints at the start, assembly changed {words}{less}"


def _largest(moves: Sequence[Move], units: tuple[str, str]) -> Iterator[Move]:
    """Of both units the largest move, that which is far smaller in numbers than the other left out."""
    own = [max((m for m in moves if m.unit == unit), key=lambda m: abs(m.change), default=None) for unit in units]
    largest = max((abs(move.change) for move in own if move), default=0.0)
    yield from (move for move in own if move and abs(move.change) >= MUCH_LESS * largest)


def initial_values(mechanics: Mechanics, t: float) -> InitialValues:
    """Make the described start consistent.

    Positions by Newton's smallest moves, velocities by the smallest correction in the mass matrix (of those that are not
    given before those that are), accelerations
    and multipliers from [M J^T; J 0][u'; lam] = [f; gamma].

    Raises
    ------
    AssemblyError
        When no assembled position is found (names the joint with the largest gap), the equations are dependent, or
        friction and reactions find no balance.
    """
    system, state = mechanics.system, mechanics.state
    q0, u0 = system.q.copy(), system.u.copy()
    take_nearest_turns(mechanics, t)
    status = mechanics.assemble(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, NO_CONVERGENCE if status == SINGULAR else status, t))
    _close_open_rates(mechanics, t)
    status = mechanics.correct_velocities(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, status, t))
    state.count_anew(t)
    status, acceleration = mechanics.accelerate(t)
    if status < 0:
        raise AssemblyError(_sentence(mechanics, status, t))
    of_body = system.of_body
    of_position = _moves(system, system.move(q0, state.q), (*of_body.positions[: of_body.linear], "angle"), PLACES)
    of_velocity = _moves(
        system, np.where(system.open_rates, 0.0, state.u - u0), (*of_body.velocities[: of_body.linear], "omega"), RATES
    )
    moved = (*of_position, *of_velocity)
    return InitialValues(state.q.copy(), state.u.copy(), acceleration, state.lam[: system.n_c].copy(), moved)


def _close_open_rates(mechanics: Mechanics, t: float) -> None:
    """Have velocities that are not given follow those that are: their smallest change that satisfies J u + C_t = 0 best."""
    system, state = mechanics.system, mechanics.state
    ways = np.flatnonzero(system.open_rates)
    if not len(ways):
        return
    state.evaluate("motion", t)
    rows = np.flatnonzero(system.active)
    by_energy = state.matrix("motion", "J")[np.ix_(rows, ways)] / np.sqrt(system.mass[ways])
    follow, *_ = np.linalg.lstsq(by_energy, -state.vector("motion", "V")[rows], rcond=None)
    state.u[ways] += follow / np.sqrt(system.mass[ways])


def _moves(system: System, change: np.ndarray, labels: tuple[str, ...], units: tuple[str, str]) -> Iterator[Move]:
    """The changes that are worth telling, from all, shape (n_u,); a turn in space is told by its angle."""
    straight = system.of_body.linear
    for body, own in zip(system.bodies, change.reshape(-1, system.of_body.n_u), strict=True):
        turn = float(own[-1]) if len(own) == straight + 1 else float(np.linalg.norm(own[straight:]))
        for label, much in zip(labels, (*own[:straight].tolist(), turn), strict=True):
            if abs(much) > WORTH_TELLING:
                yield Move(body, label, units[label == labels[-1]], much)


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
