"""Decisions of the search for equilibria, and of the balance of forces."""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from unittest.mock import patch

import numpy as np

import stiffmbs
from stiffmbs.analyses import steady
from stiffmbs.analyses.job import prepare
from stiffmbs.equilibria import equilibrium
from stiffmbs.equilibria.force_balance import balance_at
from stiffmbs.equilibria.matrices import _solves
from stiffmbs.equilibria.steady_motion import at_rest
from stiffmbs.errors import SolverError
from tests.decisions.common import Reached, Record, nothing
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def noted_speed(speed):
    """Return True if a note states a speed that forces determine, for a description of 1 m/s."""
    described, motion = Record(speed="found", velocity=(1.0, 0.0)), Record(velocity=np.array([0.0, speed]))
    return bool(steady._speed(described, motion))


class Balanced(Record):
    """Balance of two forces; `left` is their residual."""

    def __init__(self, left=1.0, balanced=False):
        super().__init__(
            left=np.array([left, 0.0]), largest=1.0, speeds=None, balanced=balanced, motion=Record(put=nothing, n_found=0)
        )  # fmt: skip


def dynamics():
    """Return a body of size 1 m with a displacement and a rotation."""
    system = Record(
        of_body=Record(dimensions=2), state_scales=np.zeros(0), first_state=2, states=[], size=1.0, n_u=2, mass=np.ones(2),
        per_velocity=lambda *each: np.array(each),
    )  # fmt: skip
    return Record(system=system, state=Record(q=np.zeros(2)))


def step(*moves):
    """Return the result of an implicit step with given Newton's moves, of which the last one is repeated."""
    given = [np.broadcast_to(np.asarray(move, dtype=float), 2) for move in moves]
    count = []

    def newton_move(*_):
        count.append(1)
        return given[min(len(count), len(given)) - 1]

    def moved_on(dynamics, t, known, q, move):
        dynamics.state.q = q + move
        return known

    replaced = {
        "newton_move": newton_move, "moved_on": moved_on, "_passes_a_pole": lambda *_: False,
        "displacement": lambda system, start, there: there - start,
    }  # fmt: skip
    with patch.multiple(equilibrium, **replaced):
        return equilibrium._step(dynamics(), 0.0, 1.0, Balanced())


def longest_move(direction):
    """Return the move, in quarter octaves of 1 mm or 1 mrad, up to which a step is not rejected at once."""
    return count_while(lambda size: step(1e-3 * size * np.array(direction), (0.0, 0.0)).known, DOUBLES)


def second_move(holds):
    """Return the second move, in quarter octaves of the first one, up to which a step has a property."""
    first = 1e-3
    return count_while(lambda part: holds(step(first, 1e-3 * part * first, 0.0)), DOUBLES)


def steps(factor, moves=1):
    """Return the values of sqrt(s) of a search whose steps fail, with a given factor on sqrt(s)."""
    shifts = []

    def taken(dynamics, t, shift, known):
        shifts.append(shift)
        return equilibrium._Step(None, factor, moves)

    replaced = {"_step": taken, "balance_at": lambda *_: Balanced(), "unbalanced": lambda *_: ""}
    with patch.multiple(equilibrium, **replaced), suppress(SolverError):
        equilibrium.find_equilibrium(dynamics(), 0.0)
    return shifts


def polishing_moves(*left):
    """Return the number of moves after an equilibrium, if they leave given residuals; the last one is repeated."""
    count = []

    def moved_on(*_):
        count.append(1)
        return Balanced(left[min(len(count), len(left)) - 1])

    with patch.multiple(equilibrium, newton_move=lambda *_: np.zeros(2), moved_on=moved_on):
        equilibrium._polished(dynamics(), 0.0, Balanced())
    return len(count)


def nearest_moves():
    count = []
    replaced = {
        "balance_at": lambda *_: Balanced(), "newton_move": lambda *_: np.zeros(2), "unbalanced": lambda *_: "",
        "_along": lambda *_: count.append(1) or Balanced(),
    }  # fmt: skip
    with patch.multiple(equilibrium, **replaced), suppress(SolverError):
        equilibrium.nearest_equilibrium(dynamics(), 0.0, None)
    return len(count)


def halved_moves():
    count = []
    with patch.multiple(equilibrium, moved_on=lambda *_: count.append(1)):
        equilibrium._along(dynamics(), 0.0, Balanced(), np.ones(2))
    return len(count)


def pole(peak, largest=1.0):
    """Return the poses at which the force of a step is computed, and whether the step is rejected; it is `peak` within."""
    poses = []
    tested = dynamics()

    def moved(system, start, move):
        poses.append(move[0])
        return move

    tested.state = Record(q=np.zeros(2), evaluate=nothing, vector=lambda *_: np.array([peak]))
    with patch.multiple(equilibrium, moved=moved):
        rejected = equilibrium._passes_a_pole(tested, 0.0, np.zeros(2), np.ones(2), largest)
    return poses, rejected


@cache
def scene(text):
    found = prepare(stiffmbs.read_scene(text), presolve=False)
    return found.dynamics, found.start.q


def allowed(text):
    """Return the allowed residuals at the start of a scene."""
    found, start = scene(text)
    found.state.q[:] = start
    return balance_at(found, 0.0, at_rest(2)).allowed


FREE = "{bodies: {a: {mass: 1, inertia: 1}}, forces: {push: {type: force, i: a, force: [%s, 0]}}}"
TWO = """
{bodies: {a: {mass: 1, inertia: 1}, b: {mass: 1e-6, inertia: 1e-6, position: [1, 0]}},
 forces: {push: {type: force, i: a, force: [1000, 0]}, hold: {type: force, i: b, force: ["-1e9*(b.x - 1)", 0]}}}
"""
STATE = "{bodies: {a: {mass: 1, inertia: 1}}, states: {x: {rate: 1}}}"


def straight_moves():
    """Return the limit of moves of the first search of a steady motion that may turn."""
    found = []

    def searched(dynamics, t, start, searches):
        found.append(searches[0].keywords["most"])
        raise Reached

    described = Record(rotation=0.0, model_fields_set=set())
    replaced = {
        "_first_found": searched, "_rotation": lambda *_: None, "replace": lambda *_, **__: None,
        "_motion": lambda *_: Record(spinning=[], velocity=np.ones(2)),
    }  # fmt: skip
    tested = Record(system=Record(has_coupled_inertia=False), state=Record(q=np.zeros(2)))
    with patch.multiple(steady, **replaced), suppress(Reached):
        steady._found(None, tested, Record(q=np.zeros(2)), 0.0, described)
    return found[0]


def worst_solution():
    """Return the residual of a linear system, in quarter octaves, up to which the fixed order serves."""
    one = np.ones((1, 1))
    return count_while(lambda off: _solves(one, np.ones(1), np.array([1.0 + 1e-12 * off])), DOUBLES)


DECISIONS = {
    "equilibria.most_moves": lambda: len(steps(1.0)),
    "equilibria.most_straight_moves": straight_moves,
    "equilibria.other_speed": lambda: count_while(lambda part: not noted_speed(1.0 + 0.01 * part), DOUBLES),
    "equilibria.translation": lambda: longest_move([1.0, 0.0]),
    "equilibria.rotation": lambda: longest_move([0.0, 1.0]),
    "equilibria.least_shift": lambda: min(steps(0.5)),
    "equilibria.largest_shift": lambda: len(steps(1.1)),
    "equilibria.shift_falls": lambda: step(1e-3, 1e-9).factor,
    "equilibria.shift_rises": lambda: step(1e-3, 1e-2).factor,
    "equilibria.wanted_ratio": lambda: step(1e-3, 3e-5).factor,
    "equilibria.last_move": lambda: second_move(lambda found: found.moves == 2),
    "equilibria.diverging_move": lambda: second_move(lambda found: found.known),
    "equilibria.most_corrections": lambda: step(1e-3).moves,
    "equilibria.worth_another_move": lambda: count_while(lambda left: polishing_moves(left, 1.0) == 2, HALVES),
    "equilibria.most_misses": lambda: polishing_moves(1.0),
    "equilibria.balanced": lambda: allowed(FREE % 1000)[0],
    "equilibria.rounding": lambda: allowed(FREE % "-1e12*a.x")[0],
    "equilibria.slowest": lambda: allowed(FREE % 0)[0],
    "equilibria.slow_state": lambda: allowed(STATE)[-1],
    "equilibria.passed_on": lambda: allowed(TWO)[0],
    "equilibria.most_nearest_moves": nearest_moves,
    "equilibria.most_halvings": halved_moves,
    "equilibria.halvings": lambda: min(pole(0.0)[0]),
    "equilibria.sections": lambda: len(pole(10.0)[0]) - len(pole(0.0)[0]),
    "equilibria.pole": lambda: count_while(lambda peak: not pole(peak)[1], DOUBLES),
    "equilibria.no_effect": worst_solution,
}
EXPECTED = {
    "equilibria.most_moves": 2000, "equilibria.other_speed": 23, "equilibria.most_straight_moves": 200, "equilibria.translation": 32,
    "equilibria.rotation": 36, "equilibria.least_shift": 0.001, "equilibria.largest_shift": 363,
    "equilibria.shift_falls": 0.1, "equilibria.shift_rises": 4, "equilibria.wanted_ratio": 0.5477225575,
    "equilibria.last_move": 23, "equilibria.diverging_move": 43, "equilibria.most_corrections": 8,
    "equilibria.worth_another_move": 5, "equilibria.most_misses": 2, "equilibria.balanced": 1e-07,
    "equilibria.rounding": 0.001776356839, "equilibria.slowest": 1e-10, "equilibria.slow_state": 1e-13,
    "equilibria.passed_on": 1e-05, "equilibria.most_nearest_moves": 100, "equilibria.most_halvings": 12,
    "equilibria.halvings": 0.0009765625, "equilibria.sections": 50, "equilibria.pole": 40, "equilibria.no_effect": 44,
}  # fmt: skip
