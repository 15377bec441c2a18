"""Decisions of assembly, of projections, of accelerations, and of their elimination."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics import algebraic_states, damped_assembly, dynamics, friction_loads, stiff_projection, storage
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.dynamics.elimination.eliminated import Eliminated
from stiffmbs.dynamics.elimination.native import digits
from stiffmbs.dynamics.initial import InitialValues
from stiffmbs.dynamics.moves import Move, position_words
from stiffmbs.dynamics.native import block_systems, consistent
from stiffmbs.dynamics.native import dynamics as native
from stiffmbs.dynamics.native import projection as native_projection
from stiffmbs.dynamics.native import stiff_projection as native_stiff_projection
from stiffmbs.solve.ida.native import start
from tests.decisions.common import BELOW, Record, nothing
from tests.interpreted import interpreted
from tests.parameters import EXAMPLES
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while

OCTAVES = DOUBLES[::4]


def another_solution(apart):
    """Return the joints whose multipliers, of size 1, differ in another solution by some numbers."""
    state = Record(q=np.zeros(1), u=np.zeros(1), lam=np.ones(2))

    def accelerate(_):
        state.lam[:] = 1.0 + np.array(apart)
        return 0, None

    terms = Record(column=np.array([0, 1]))
    system = Record(forces_by_reactions=("f",), equations=[("a",), ("b",)], term=lambda *_: terms)
    dynamics_of_two = Record(system=system, state=state, accelerate=accelerate)
    return friction_loads.ambiguous_loads(dynamics_of_two, 0.0, np.zeros(1), np.zeros(1), np.ones(2))


def stuck(gap):
    """Return whether a damped assembly of one equation succeeds whose gap no move changes, and the poses that it tries."""
    poses = []
    values = {"C": np.array([gap]), "J": np.ones((1, 1))}
    state = Record(
        q=np.zeros(1), evaluate=nothing, vector=lambda _, name: values[name], matrix=lambda _, name: values[name]
    )

    def moved(pose, move):
        poses.append(pose + move)
        return poses[-1]

    system = Record(
        active=np.ones(1, dtype=bool), holonomic=np.ones(1, dtype=bool), size=1.0, n_u=1, of_body=Record(moved=moved, n_u=1),
        per_velocity=lambda *_: np.ones(1),
    )  # fmt: skip
    done = damped_assembly.damped_assembly(Record(system=system, state=state, assemble=nothing), 0.0, np.zeros(1))
    return done, poses


def newton_moves():
    """Return the number of moves of a projection that does not converge."""
    solved = []
    s = Record(n_q=0, n_pose=0, n_u=0, n_c=1, q=[], left_open=[0.0])
    replaced = {
        "evaluate": lambda *_: [1.0], "_solved": lambda *_: solved.append(1) or 0, "take_unit_length": nothing,
    }  # fmt: skip
    with interpreted(block_systems, **replaced):
        native_projection.back_to_constraints(
            Record(eliminates=0, tolerance=1e-12), s, Record(positions=0, position_factors=Record(b=[])), 0.0
        )
    return len(solved)


def largest_closed_gap():
    """Return the gap, in quarter octaves, from which on a stiff projection moves positions."""

    def stays(gap):
        moved = []
        s = Record(n_q=1, n_pose=1, n_u=0, n_c=1, q=[0.0], left_open=[0.0])
        replaced = {
            "evaluate": lambda *_: [gap], "add_entries": nothing, "factored": lambda _: native_stiff_projection.DONE,
            "_right_side": nothing, "solve": nothing, "add_rates": lambda *_: moved.append(1), "take_unit_length": nothing,
        }  # fmt: skip
        table = Record(b=[])
        with interpreted(native_stiff_projection, **replaced):
            native_stiff_projection._moved(s, 0.0, table, None, [], 1.0)
        return len(moved) == 2

    return count_while(lambda gap: stays(1e-15 * gap), DOUBLES)


def least_restoring_ratio():
    """Return the ratio, in percent, of successive moves from which on a stiff projection ends."""

    def goes_on(ratio):
        sizes, moved = iter((0.01 * ratio) ** np.arange(100)), []
        s = Record(n_q=1, n_pose=1, n_u=1, n_c=1, q=[0.0], left_open=[0.0])
        replaced = {
            "evaluate": lambda *_: [0.0], "_right_side": nothing, "solve": lambda f, b: b.__setitem__(0, next(sizes)),
            "add_rates": lambda *_: moved.append(1), "take_unit_length": nothing,
        }  # fmt: skip
        with interpreted(native_stiff_projection, **replaced):
            native_stiff_projection._moved(s, 0.0, Record(b=[1.0]), None, [], 1.0)
        return len(moved) > 2

    return count_while(goes_on, range(1, 200))


def moves_of_other_factors(ratio, most=1e300):
    """Return the number of moves that reduce a gap by a ratio, by the factors of another pose."""
    gap, count = [1.0], []

    def move(*_):
        gap[0] *= ratio
        count.append(1)
        return 0

    s = Record(n_q=0, n_pose=0, n_u=0, n_c=1, q=[], u=[], left_open=[0.0], values=[0] * 20)
    m = Record(constraining=None, eliminated=None)
    replaced = {
        "state_view": lambda _: s, "evaluate": lambda *_: [gap[0], 0.0], "add_rates": nothing, "take_unit_length": nothing,
        "floats": lambda _: [gap[0], 0.0],
    }  # fmt: skip
    with interpreted(consistent, **replaced):
        done = consistent._closed(Record(move=move, a=[]), s, m, 0.0, 1e-300)
    return done, len(count)


def worst_contraction():
    """Return the remaining part of a gap, in quarter octaves, from which on moves by other factors end at once."""
    return count_while(lambda part: moves_of_other_factors(1e-4 * part)[1] > 1, DOUBLES)


def largest_move(violation):
    """Return the move of a projection, in quarter octaves of 1e-9, up to which the pose counts as regular."""

    def is_regular(move):
        with interpreted():
            return not native._led_astray(Record(q=[1.0 + move, 1.0], n_q=2), [1.0, 1.0], violation)

    return count_while(lambda move: is_regular(1e-9 * move), DOUBLES)


def assembly_moves():
    """Return the largest number of moves of an assembly."""
    seen = SimpleNamespace(short_call=lambda t, tolerance, most, table: most)
    with patch.object(dynamics, "ASSEMBLE", seen):
        return Dynamics.assemble(Record(_at=None), 0.0)


def part_of_a_step():
    """Return the reciprocal step of the matrix that projects a state within a step of 1 s."""
    found = []
    state = Record(q=np.zeros(1), u=np.zeros(1), table=None)
    projection = Record(_state=state, _tables=(), _work=np.zeros(1), _at_state=0)
    seen = SimpleNamespace(short_call=lambda t, cj, *_: found.append(cj) or 0)
    with patch.object(stiff_projection, "PROJECT", seen):
        stiff_projection.StiffProjection.project(projection, 0.0, 1.0, np.zeros(1), np.zeros(1))
    return found[0]


def iterated(multiplier=lambda k: 1.0, state=lambda k: 1.0):
    """Return the iterations for accelerations, and their status, if solutions are given functions of the iteration."""
    count = []
    s = Record(n_c=1, n_u=0, n_q=1, lam=[0.0], q=[0.0])
    f = Record(previous=[0.0, 0.0], b=[0.0, 0.0])
    e = Record(n_with_y=1, n_plain=0, at_lam=[0], at_x=[1], r_row=[])
    m = Record(
        accelerations=e, acceleration_factors=f, n_algebraic=1, algebraic=[0], algebraic_before=[0.0], algebraic_scale=[1.0],
        by_reactions=0,
    )  # fmt: skip

    def solved(*_):
        f.b[:] = multiplier(len(count)), state(len(count))
        count.append(1)
        return 0

    with interpreted(block_systems, evaluate=lambda *_: [], _solved=solved):
        status = block_systems.to_accelerations(s, m, 0.0)
    return len(count), status


def oscillating(size):
    """Return a function that oscillates about 1."""
    return lambda k: 1.0 + size * (-1) ** k


def accepted_multipliers(first, most):
    """Return the oscillation of multipliers, in quarter octaves, up to which the iteration ends before a number."""

    def accepted(size):
        count, status = iterated(multiplier=oscillating(first * size))
        return status == 0 and count <= most

    return count_while(accepted, DOUBLES)


def accepted_states():
    def accepted(size):
        return iterated(state=oscillating(1e-12 * size))[1] == 0

    return count_while(lambda size: accepted(100.0 * size), DOUBLES)


def slowest_states():
    """Return the ratio of two changes of a state, in steps of 5 % from 0.05 on, up to which the iteration continues."""

    def continues(ratio):
        changes = 1.5e-7 * np.array([0.0, 1.0, ratio, *ratio * 1e-3 ** np.arange(1, 10)])
        values = 1.0 + np.cumsum(changes)
        return iterated(state=lambda k: values[k])[0] > 3

    return count_while(continues, 0.05 * 1.05 ** np.arange(55))


def flattest_slope():
    """Return the slope of one of two algebraic equations, in octaves, down to which their states are unique."""

    def is_unique(slope):
        slopes = np.diag([1.0, slope])
        state = Record(q=np.ones(2), evaluate=nothing, matrix=lambda *_: slopes, vector=lambda *_: np.array([1.0, 0.0]))
        system = Record(
            algebraic_coordinates=np.arange(2), algebraic=np.ones(2, dtype=bool), state_scales=np.ones(2), states=["p", "r"]
        )  # fmt: skip
        return "has no unique value" not in algebraic_states.no_value(Record(state=state, system=system), 0.0)

    return count_while(is_unique, HALVES)


def error_of_a_rate():
    """Return the rate at t = 0 of a state that is t^2."""

    def accelerate(s, m, t):
        s.q[0] = t * t
        return 0

    w = Record(rate=np.zeros(1), kept=np.zeros(1))
    s = Record(q=np.zeros(1), u=np.zeros(0), a=np.zeros(0), lam=np.zeros(0), n_q=1, n_u=0, n_c=0)
    with interpreted(start, consistent_accelerations=accelerate, take_unit_length=nothing):
        start._find_algebraic_rates(w, s, Record(n_algebraic=1, algebraic=[0]), 0.0)
    return w.rate[0]


def changed_by(shift=0.0, turn=0.0, name="b", size=1.0):
    return position_words([Move(name, (shift, 0.0), turn, (0.0, 0.0), 0.0)], size, 3)


def named_bodies():
    moved = [Move(f"b{k}", (1.0, 0.0), 0.0, (0.0, 0.0), 0.0) for k in range(20)]
    nothing_moves = np.zeros(0)
    return InitialValues(*[nothing_moves] * 4, tuple(moved), 1.0).sentence().count(".x by")


@cache
def job():
    return prepare(stiffmbs.load_scene(EXAMPLES / "spatial_slider_crank.yaml"), presolve=False)


def eliminated(updates=10**6, **changes):
    state = job().dynamics.state
    return Eliminated(Record(system=replace(state.system, **changes), table=state.table), updates)


def most_work():
    """Return the multiplications of the LU, in quarter octaves, below which elimination does not serve."""
    return count_while(lambda updates: not eliminated(int(updates)).serves, 20 * DOUBLES)


def most_uneven():
    """Return the ratio of inertias, in quarter octaves, up to which pivots show the distance from a singular pose."""
    system = job().dynamics.system
    even = system.per_velocity(1.0, system.size) ** 2

    def tells(ratio):
        return eliminated(mass=np.append(ratio, np.ones(system.n_u - 1)) * even).pivots_tell

    return count_while(tells, DOUBLES[1:])


def smallest_pivot_of_rows():
    """Return the pivot, in quarter octaves below 1, down to which output rows use the elimination."""

    def serves(kept):
        r = Record(attempt=lambda *_: 1, kept=kept)
        with interpreted():
            return consistent._eliminated(
                Record(), Record(eliminates=1, eliminated=r, acceleration_factors=Record(b=None)), 0.0
            )

    return count_while(serves, HALVES)


def largest_residual(sizes, first):
    """Return the residual of accelerations, in quarter octaves, up to which they satisfy the joints."""
    least = eliminated()._arrays["least"]

    def satisfies(residual):
        r = Record(
            left=[0.0], sizes=[0.0], least=least, n_gamma=1, gamma_source=[0], gamma_row=[0], n_j=1, j_source=[1], j_row=[0],
            j_column=[0],
        )  # fmt: skip
        m = Record(eliminated=r, acceleration_factors=Record(b=[1.0]))
        values = [
            0.5 * (sizes + residual),
            0.5 * (sizes - residual),
        ]  # of gamma and J, with these sizes and this residual
        with interpreted(consistent, floats=lambda _: values):
            return consistent._satisfy_joints(Record(n_c=1, values=[0] * 20), m)

    return count_while(lambda residual: satisfies(first * residual), DOUBLES)


def digits_of(part, kept=1.0, most_kept=0.0, trees=True, by_pins=True):
    """Return whether a pivot keeps digits, and the loss of all so far."""
    r = Record(kept=kept, most_kept=most_kept, trees=trees, by_pins=by_pins)
    return digits.keeps_digits(r, part, 1.0), r.kept


def largest_array():
    """Return the length of an array, in quarter octaves, up to which it is held in memory."""
    return count_while(lambda length: storage._mapped(storage.allocated(int(length))) is None, 2.0**20 * DOUBLES[:60])


DECISIONS = {
    "consistency.most_damped_moves": lambda: len(stuck(1.0)[1]),
    "consistency.nudge": lambda: float(stuck(1e-9)[1][0][0]),
    "consistency.close": lambda: count_while(lambda gap: stuck(1e-9 * gap)[0], DOUBLES),
    "consistency.most_assembly_moves": assembly_moves,
    "consistency.most_moves": newton_moves,
    "consistency.position_tolerance": largest_closed_gap,
    "consistency.most_frozen_moves": lambda: moves_of_other_factors(1e-4)[1],
    "consistency.contraction": worst_contraction,
    "consistency.amplified": lambda: largest_move(1e-10),
    "consistency.moved": lambda: largest_move(0.0),
    "consistency.step_parts": part_of_a_step,
    "consistency.restored": least_restoring_ratio,
    "consistency.most_iterations": lambda: iterated(multiplier=oscillating(0.5))[0],
    "consistency.converged": lambda: accepted_multipliers(1e-15, 2),
    "consistency.rounded_off": lambda: accepted_multipliers(1e-15, 10**6),
    "consistency.state_rounded_off": accepted_states,
    "consistency.slow": slowest_states,
    "consistency.zero_slope": flattest_slope,
    "consistency.rate_interval": error_of_a_rate,
    "consistency.worth_telling": lambda: count_while(lambda shift: not changed_by(1e-10 * shift), DOUBLES),
    "consistency.much_less": lambda: count_while(lambda turn: "angle" in changed_by(1.0, turn, size=1.0), HALVES),
    "consistency.large_shift": lambda: count_while(
        lambda shift: not Move("b", (0.01 * shift, 0.0), 0.0, (0.0, 0.0), 0.0).is_large(1.0), DOUBLES
    ),
    "consistency.large_turn": lambda: count_while(
        lambda turn: not Move("b", (0.0, 0.0), 0.01 * turn, (0.0, 0.0), 0.0).is_large(1.0), DOUBLES
    ),
    "consistency.most_listed": named_bodies,
    "elimination.worth_compiling": lambda: count_while(
        lambda updates: not Dynamics.is_large.fget(
            Record(lu_updates=updates)
        ),
        DOUBLES,
    ),
    "elimination.most_multiplications": most_work,
    "elimination.even": most_uneven,
    "elimination.kept": smallest_pivot_of_rows,
    "elimination.lost": lambda: count_while(lambda part: digits_of(part)[0], HALVES),
    "elimination.small": lambda: count_while(lambda part: digits_of(part)[1] == 1.0, HALVES),
    "elimination.together": lambda: count_while(lambda kept: digits_of(1e-3, kept, trees=False)[0], HALVES),
    "elimination.relative": lambda: count_while(lambda kept: digits_of(1e-3, kept, 1.0, trees=False)[0], HALVES),
    "elimination.residual": lambda: largest_residual(1e6, 1e-6),
    "elimination.least_residual": lambda: largest_residual(0.0, 1e-12),
    "dynamics.friction_loads:ANOTHER": lambda: count_while(lambda apart: another_solution((apart, 0.0)), BELOW),
    "storage.largest_in_memory": largest_array,
    "storage.block": lambda: next(storage.blocks(10**9)).stop,
}  # fmt: skip
EXPECTED = {
    "consistency.most_damped_moves": 202, "consistency.nudge": 0.001, "consistency.close": 40,
    "consistency.most_assembly_moves": 50, "consistency.most_moves": 20, "consistency.position_tolerance": 40,
    "consistency.most_frozen_moves": 3, "consistency.contraction": 27, "consistency.amplified": 67,
    "consistency.moved": 40, "consistency.step_parts": 10, "consistency.restored": 69, "consistency.most_iterations": 40,
    "consistency.converged": 23, "consistency.rounded_off": 76, "consistency.state_rounded_off": 36,
    "consistency.slow": 33, "consistency.zero_slope": 133, "consistency.rate_interval": 1e-06,
    "consistency.worth_telling": 14, "consistency.much_less": 40, "consistency.large_shift": 19,
    "consistency.large_turn": 26, "consistency.most_listed": 3, "elimination.worth_compiling": 54,
    "elimination.most_multiplications": 9, "elimination.even": 53, "elimination.kept": 40, "elimination.lost": 80,
    "elimination.small": 27, "elimination.together": 80, "elimination.relative": 27, "elimination.residual": 27,
    "elimination.least_residual": 33, "storage.largest_in_memory": 5, "storage.block": 100000,
    "dynamics.friction_loads:ANOTHER": 40,
}  # fmt: skip
