"""Forces on both sides of the zero of an event function: discontinuities and sliding modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...compile.law_intervals import intervals_of
from ...compile.machine.layout import address, addresses
from ...compile.machine.object_code import SHORT
from ...compile.machine.routines import together
from ...dynamics.dynamics import Dynamics
from ...model.settings import RunSettings
from ...reading.files.quoted import MOST_LISTED
from ...tuning import tuned
from ..error_control.tolerances import absolute_tolerances
from .native.parameters import BISECTIONS, SEARCH


@dataclass(frozen=True)
class JumpParameters:
    """Parameters of the comparison of both sides of a state."""

    larger_move: float = 1e-6
    """Size of the larger move to both sides, relative to the state and to at least 1 m, rad, m/s or rad/s. The smaller one is
    the rounding `EventSearchParameters.noise`, which is the least jump too, m/s^2 or rad/s^2."""
    jumps: float = 0.1
    """Least jump of accelerations over the smaller move, relative to that over the larger one."""
    rate_interval: float = 1e-4
    """Time over which the rate of an event function is computed, s."""


JUMP = tuned("jumps", JumpParameters())

SWITCHES, NOISE, OF_STATES, CROSSED, SIDE = together(
    "stiffmbs.solve.events.native.sign_changes",
    SHORT,
    switches="void(float64, float64, float64*, float64*, float64*, float64*, int64, float64*, int64*)",
    noise="void(float64, float64, float64, float64*, float64*, float64*, float64*, float64*, int64, float64*, float64*, float64*, float64*, float64*, int64*)",
    of_states="void(int64, float64*, float64*, float64*, int64, float64*, int64*)",
    crossed="int64(float64, float64, float64*, float64*, float64*, float64*, int64, int64*, float64*, float64*, int64*)",
    side="int64(float64, float64, float64, float64*, float64*, float64*, float64*, float64*, int64, float64*, float64*, float64*, int64*)",
)


def event_functions(dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return all values of the set ``event_function`` at many states, shape (n, values); the last state is that of `dynamics` then."""
    dynamics.state.load("event_function")
    found = np.empty((len(t), dynamics.system.n_values("event_function")))
    kept = [np.ascontiguousarray(each, dtype=float) for each in (t, q, u)]
    OF_STATES.call(len(t), *addresses(*kept), found.shape[1], address(found), dynamics.table.ctypes.data)
    return found


def distances_from_kinks(dynamics: Dynamics, t: np.ndarray, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the event functions at many states, and the distances from all breakpoints of tables with a kink, shape (n, all)."""
    values, intervals = event_functions(dynamics, t, q, u), intervals_of(dynamics.system)
    found = [values[:, : dynamics.system.n_event_functions]]
    for k in np.flatnonzero(intervals.kinks).tolist():
        away = values[:, k, None] - intervals.breakpoints[intervals.first[k] : intervals.first[k + 1]]
        if period := intervals.period[k]:
            away -= period * np.round(away / period)
        found.append(away)
    return np.hstack(found)


class _Side(NamedTuple):
    """Event functions, accelerations, and the resulting rates of the event functions at a nearby state."""

    values: np.ndarray
    acceleration: np.ndarray
    rates: np.ndarray


class _Around:
    """States near one that `at` sets.

    `dynamics`: its state becomes that of the last evaluation. `t`: s. `q`, `u` of shapes (n_q,), (n_u,).
    """

    def __init__(self, dynamics: Dynamics) -> None:
        dynamics.state.load("event_function")
        system, count = dynamics.system, dynamics.system.n_event_functions
        self._dynamics, self.t, self.q, self.u = dynamics, 0.0, np.zeros(system.n_q), np.zeros(system.n_u)
        self._direction, self._count = direction_of(dynamics), count
        self._there, self._found, self._at = (
            np.empty(system.n_q),
            np.empty(count),
            addresses(self.q, self.u, *self._direction),
        )
        self._noise, kept = np.empty((3, count)), np.empty(system.n_q + 2 * (system.n_u + system.n_c))
        self._of_noise, self._crossed = (
            (np.zeros(system.n_q), kept, np.empty((4, count))),
            np.empty(count, dtype=np.int64),
        )
        self._to_found, self._table = address(self._found), dynamics.table.ctypes.data
        still, *memory = addresses(*self._of_noise, *self._noise)
        self._to_noise = (*self._at, still, count, *memory, self._table)
        self._to_crossed = (*self._at, count, address(self._crossed), memory[0], self._to_found, self._table)

    def at(self, t: float, q: np.ndarray, u: np.ndarray) -> _Around:
        """Set the state."""
        self.t, self.q[:], self.u[:] = t, q, u
        return self

    def values(self, size: float) -> np.ndarray:
        """Return the event functions after a move of a size."""
        SWITCHES.short_call(self.t, size, *self._at, self._count, self._to_found, self._table)
        return self._found.copy()

    def noise(self, rtol: float) -> np.ndarray:
        """Return the event functions, their changes by rounding, and by `rtol` of the velocities, one row for each.

        A function that does not change in one direction with the velocities has a negative number in the last row. The state of
        the dynamics stays.
        """
        NOISE.short_call(self.t, SEARCH.precision, rtol, *self._to_noise)
        return self._noise

    def side(self, size: float) -> _Side:
        """Return the event functions, accelerations and rates after a move of a size."""
        values, rates, acceleration = np.empty(self._count), np.full(self._count, np.nan), np.full(len(self.u), np.nan)
        SIDE.short_call(
            self.t, size, JUMP.rate_interval, *self._at, address(self._there), self._count,
            *addresses(values, acceleration, rates), self._table,
        )  # fmt: skip
        return _Side(values, acceleration, rates)  # NaN if accelerations are undetermined: not a jump

    def sides(self, size: float) -> tuple[_Side, _Side]:
        """Return both sides of a move."""
        return self.side(size), self.side(-size)

    def crossed(self, reach: float) -> np.ndarray:
        """Return the event functions of velocities that differ in sign between the two sides of a move.

        The state of the dynamics stays.
        """
        if not CROSSED.short_call(self.t, reach, *self._to_crossed):
            return np.empty(0, dtype=np.int64)
        return self._crossed.nonzero()[0]

    def at_zero(self, reach: float, event_function: int) -> _Around:
        """Return the states near the zero of an event function, by bisection between moves of -reach and reach."""
        low, high = -reach, reach
        above = self.values(high)[event_function] > 0.0
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if (self.values(middle)[event_function] > 0.0) == above:
                high = middle
            else:
                low = middle
        size = 0.5 * (low + high)
        q, u = (
            x + size * np.maximum(1.0, np.abs(x)) * part
            for x, part in zip((self.q, self.u), self._direction, strict=True)
        )
        return _Around(self._dynamics).at(self.t, q, u)


def noise_of(
    dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, rtol: float, farthest: dict[int, float]
) -> dict[int, tuple[float, float]]:
    """Return the values of event functions, and the changes of these values that the precision of a state explains.

    That is rounding. It is the tolerance for functions of reactions, since stiff forces amplify the errors of a state, and the
    tolerance of velocities for functions with continuous rates: their forces have no jump, and the error test resolves a kink.
    `farthest`: values of some event functions beyond which they have left zero anyway.
    """
    around = dynamics.once(_Around).at(t, q, u)
    here, noise, slow = around.noise(rtol).tolist()
    for k, far in farthest.items():
        if noise[k] < far <= slow[k]:
            with dynamics.state.unchanged():
                at_zero = around.at_zero(JUMP.larger_move, k)
                if not _rates_differ([at_zero.sides(size) for size in (JUMP.larger_move, SEARCH.precision)], k):
                    noise[k] = slow[k]
    return {k: (here[k], noise[k]) for k in farthest}


def sliding(dynamics: Dynamics, t: float, q: np.ndarray, u: np.ndarray, reach: float | None = None) -> np.ndarray:
    """Return the event functions whose zero the motion is driven to from both sides by a discontinuous force.

    There is no classical solution then, but a sliding mode, as with sign(v) at rest (Filippov, Differential Equations
    with Discontinuous Righthand Sides, 1988, ch. 2). `reach`: size of the move within which a jump is searched for; by
    default `JumpParameters.larger_move`.
    """
    reach = JUMP.larger_move if reach is None else reach
    around = dynamics.once(_Around).at(t, q, u)
    back = around.crossed(reach)  # the rates of functions of positions do not depend on forces
    if not len(back):
        return back
    with dynamics.state.unchanged():
        for sense in _ahead_first(around, reach, back):
            back = back[_returns(around.side(sense * reach), back)]
            if not len(back):
                return back
        return np.array([k for k in back if _slides(around, reach, k)], dtype=int)


def _ahead_first(around: _Around, reach: float, crossed: np.ndarray) -> tuple[float, float]:
    """Return both signs of a move, first that to the side of the state: a motion through the zero leaves it there."""
    here, there = (around.values(sense * reach)[crossed[0]] for sense in (0.0, 1.0))
    return (1.0, -1.0) if here * there > 0.0 else (-1.0, 1.0)


def _returns(side: _Side, event_functions: np.ndarray) -> np.ndarray:
    """Return a mask of the event functions whose zero the motion returns to from one side."""
    returns: np.ndarray = side.rates[event_functions] * side.values[event_functions] < 0.0
    return returns


def _driven_back(sides: tuple[_Side, _Side], event_functions: np.ndarray) -> np.ndarray:
    return np.logical_and(*(_returns(side, event_functions) for side in sides))


def _slides(around: _Around, reach: float, event_function: int) -> bool:
    """Return True if the motion returns to the zero of an event function from both sides, with discontinuous rates.

    The zero is a sliding surface only if the event function is continuous.  A discontinuous one, such as the load of a
    damper at a kink of its road, changes its sign at a surface of another event function.
    """
    at_zero, k, moves = around.at_zero(reach, event_function), event_function, []
    for size in (JUMP.larger_move, SEARCH.precision):
        moves.append(at_zero.sides(size))
        if not _driven_back(moves[-1], np.array([k]))[0]:
            return False
    large, small = (abs(above.values[k] - below.values[k]) for above, below in moves)
    return bool(small <= JUMP.jumps * large) and _rates_differ(moves, k)


def _rates_differ(moves: Sequence[tuple[_Side, _Side]], event_function: int) -> bool:
    """Return True if the rate of an event function jumps between the sides of a larger and of a smaller move."""
    large, small = (abs(above.rates[event_function] - below.rates[event_function]) for above, below in moves)
    return bool(small > max(JUMP.jumps * large, SEARCH.precision))


def direction_of(dynamics: Dynamics) -> tuple[np.ndarray, np.ndarray]:
    """Return a direction of moves from a state that changes every coordinate and velocity."""
    return dynamics.once(_direction)


def _direction(dynamics: Dynamics) -> tuple[np.ndarray, np.ndarray]:
    rng, sizes = np.random.default_rng(1), (dynamics.system.n_q, dynamics.system.n_u)
    first, second = (rng.choice((-1.0, 1.0), n) * rng.uniform(0.5, 1.0, n) for n in sizes)
    return first, second


@dataclass(frozen=True)
class VelocityJumpParameters:
    """Parameters of the report."""

    least: float = 1e-2
    """Velocity change at a breakpoint, relative to the largest velocity before or after it, above which it is a jump."""


VELOCITY_JUMP = tuned("velocity_jumps", VelocityJumpParameters())


def _scale_and_least(dynamics: Dynamics, settings: RunSettings) -> tuple[np.ndarray, float]:
    system = dynamics.system
    scale = np.ascontiguousarray(system.per_velocity(1.0, system.size))
    tolerances = absolute_tolerances(system, settings)[system.n_q :]
    return scale, float(np.min(scale * tolerances, initial=np.inf))


class Jumps:
    """Jumps of velocities, and of positions, at the breakpoints of one run."""

    def __init__(self, dynamics: Dynamics, settings: RunSettings) -> None:
        self._dynamics, self._settings = dynamics, settings
        self._messages: list[str] = []

    @cached_property
    def resolution(self) -> tuple[np.ndarray, float]:
        """Factors from velocities to m/s, of shape (n_u,), with the mechanism's size for angular ones, and the tolerance of the run.

        A change up to it, m/s or m, is no jump at any velocities.
        """
        return self._dynamics.once(_scale_and_least, self._settings)

    def is_jump(self, change: np.ndarray) -> bool:
        """Return True if a change of velocities to those of the current state is a jump."""
        (scale, least), after = self.resolution, self._dynamics.state.u
        largest = float((scale * np.abs(change)).max(initial=0.0))
        if largest <= least:
            return False
        fastest = np.max(scale * np.maximum(np.abs(after), np.abs(after - change)), initial=0.0)
        return largest > VELOCITY_JUMP.least * float(fastest)

    def note(self, t: float, q: np.ndarray, u: np.ndarray) -> None:
        """Note jumps from a state just before a breakpoint; the state of the dynamics is that just after it."""
        system, state, (scale, least) = self._dynamics.system, self._dynamics.state, self.resolution
        move, change = system.move(q, state.q), state.u - u
        if (scale * np.abs(move)).max(initial=0.0) > least and self._leads_on(t, q) > least:
            k = int(np.argmax(scale * np.abs(move)))
            self._messages.append(
                f"at t = {t:.6g} s a drive makes positions jump ('{system.bodies[k // system.of_body.n_u]}' by {abs(move[k]):.3g}): no "
                "motion leads there, and the results do not contain one; give the drive a continuous position"
            )
        elif self.is_jump(change):
            k = int(np.argmax(scale * np.abs(change)))
            part = abs(change[k]) * scale[k] / np.max(scale * np.maximum(np.abs(u), np.abs(state.u)))
            self._messages.append(
                f"at t = {t:.6g} s a drive makes velocities jump ({system.name_of(k, system.of_body.velocities)} by {change[k]:.3g}, "
                f"{100 * part:.3g} % of the largest velocity there); the reactions do not contain this impulse"
            )

    def _leads_on(self, t: float, q: np.ndarray) -> float:
        """Return the largest jump of a constraint at a time, with the positions before it; drift is no jump.

        The constraints of both sides are extrapolated to that time, which cancels their rates: 2 (C_1 - C_-1) - (C_2 - C_-2).
        """
        state, around = self._dynamics.state, SEARCH.precision * max(abs(t), self._settings.duration)
        jump = np.zeros(len(state.vector("position", "C")))
        with state.unchanged():
            state.q[:] = q
            for place, part in ((1.0, 2.0), (-1.0, -2.0), (2.0, -1.0), (-2.0, 1.0)):
                state.evaluate("position", t + place * around)
                jump += part * state.vector("position", "C")
        return float(np.max(np.abs(jump), initial=0.0))

    def clear(self) -> None:
        """Forget the jumps before another run."""
        self._messages.clear()

    def sentence(self) -> str:
        """Return a sentence on the jumps for the user; empty if there are none."""
        more = len(self._messages) - MOST_LISTED
        return "; ".join([*self._messages[:MOST_LISTED], *([f"and {more} more such jumps"] if more > 0 else [])])
