"""Decisions on compilation: inputs of time, tables, geometry of solids, factors, series, shared parts of expressions."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import sympy as sp

from stiffmbs.compile import active_dampers, callbacks, gaps, law_intervals, table_values, written_values
from stiffmbs.compile.inputs import ends, features, pieces, table_ranges, zeros
from stiffmbs.compile.symbolic import shared_parts, symbols, variation
from stiffmbs.results.joint_angles import JointAngles
from stiffmbs.solve import suspect
from tests.decisions.common import BELOW, Record, executed, nothing, reach, reached
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def step_at_zero():
    call = Record(_method="differences", _value=lambda moved, _: reach(moved[0]))
    return reached(lambda: callbacks.Callback._by(call, np.zeros(1), 0, 1))


def moves_of_a_body():
    """Return the number of Newton steps that leave an equation unchanged."""
    values = []
    system = Record(of_body=Record(n_u=1, moved=lambda q, _: q), bodies=["a"], n_pose=1)
    state = Record(
        system=system, q=np.zeros(1), evaluate=lambda *_: values.append(1), vector=lambda *_: [1.0], matrix=lambda *_: np.ones((1, 1))
    )  # fmt: skip
    with patch.object(gaps, "_moved_body", lambda *_: (np.array([0]), "m")):
        gaps.position_gap(state, 0.0, 0)
    return len(values) - 1


def smallest_slope_of_a_gap():
    def moves(slope):
        system = Record(of_body=Record(n_u=1), bodies=["a"], per_velocity=lambda *_: np.ones(1))
        return gaps._moved_body(Record(system=system, matrix=lambda *_: np.array([[slope]])), 0)[1] == "m"

    return count_while(moves, BELOW)


def divisions_without_a_bound():
    divided = []
    with patch.object(
        ends, "_is_bounded", lambda _given, _node, low, _high: divided.append(1) or np.zeros(len(low), bool)
    ):
        [*ends._without_bound(None, None, 0.0, 1.0)]
    return len(divided)


def distances_from_a_pole():
    """Return the distances at which values on one side of a time are compared."""
    times = []
    ends._is_pole(lambda t: times.append(abs(t)), 0.0, 0.0, 1.0)
    return times[:2]


def smallest_growth_at_a_pole():
    def grows(ratio):
        found = iter([1.0, ratio, *[None] * 4])
        return ends._is_pole(lambda _: next(found), 0.0, 0.0, 1.0)

    return count_while(lambda ratio: not grows(ratio), 1.1 * DOUBLES[:40])


def largest_growth():
    def is_followed(growth):
        found = iter([1.0, *[growth] * 20])
        return ends._pole_distance(lambda _: next(found), 0.0, 1.0) == ends.FARTHER_SIDE

    return count_while(lambda growth: is_followed(1e4 * growth), DOUBLES)


def longest_step():
    bounds = pieces.Bounds(np.zeros(1), np.array([0.01]))
    return features._together([bounds], np.empty(0), 0.0, 1.0)[1][0]


def instants_of_an_interval():
    none = np.empty(0)
    found = Record(longest=none, starts=none, ends=none, breakpoints=none)
    return len(features.InputFeatures.instants(found, 0.0, 1.0, 2.0, 1000)) - 1


class Wide(list):
    """Ranges of an input and its Taylor coefficients."""

    value = np.array([[0.0], [1.0]])


def longest_piece(change=0.0, whole=0.0, size=0.0):
    """Return the longest part of a piece of unit slope, for a change there and in the whole run, and a size."""
    wide = [np.array([[0.0], [width]]) for width in (1.0, 1.0, 1e60, 1e60)]
    found = Record(
        _shortest=0.0, _given=Record(within=lambda *_, **__: Wide(wide)), _rounding=1e-300, change=whole, size=size
    )  # fmt: skip
    one = np.ones(1)
    return pieces.InputPieces._longest(found, Record(length=one, low=0 * one, high=one, change=change * one))[0] / 4


def shortest_piece():
    return pieces.InputPieces(None, np.array([0.0, 1.0]))._shortest


def largest_rounding_of_samples():
    def is_constant(change):
        found = Record(_rounding=1.0, _cut=lambda *_, **__: Record(lengths=np.zeros(1)))
        one = np.ones(1)
        part = Record(change=change * one, where=nothing)
        return np.isinf(pieces.InputPieces._estimated(found, part, 0 * one, one > 0)[0])

    return count_while(is_constant, DOUBLES)


def estimated(cut=None, where=nothing):
    """Return the bounds of 6400 pieces, estimated from a sample."""
    count = np.ones(6400)
    found = Record(_rounding=0.0, _cut=cut)
    return pieces.InputPieces._estimated(found, Record(change=count, where=where), 0 * count, count > 0)


def most_pieces_of_one_pass():
    def is_cut_once(count):
        cuts = []

        def cut(*_, **__):
            cuts.append(1)
            return pieces.Bounds(np.zeros(count), np.zeros(count))

        pieces.InputPieces.bounds(Record(_edges=np.arange(2.0), _cut=cut))
        return len(cuts) == 1

    return count_while(is_cut_once, np.round(10 * DOUBLES[:60]).astype(int))


def is_estimated(count, bound):
    """Return True if the bounds of open pieces of unit length are estimated from a sample."""
    ones = np.ones(count)
    part = Record(low=ones, length=ones, where=lambda _: reach(False))
    found = Record(
        _looked_at=lambda x: x, _longest=lambda _: bound * ones, _shortest=0.0, _estimated=lambda *_: reach(True)
    )  # fmt: skip
    return reached(lambda: pieces.InputPieces._cut(found, part, True))


def flattest_piece():
    def bends(change):
        table = Record(table=[(0, 0.0), (1, change), (2, 1.0), (3, 2.0)], lines=False, repeats=False)
        return len(table_ranges._breakpoints(table, np.arange(4.0))) == 2

    return count_while(bends, BELOW)


def largest_jump_by_rounding():
    """Return the jump of a curvature, in quarter octaves of 1e-8 of the curvature, up to which it is rounding."""

    def is_rounding(jump):
        pieces_of_table = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 1.0 - 1e-8 * jump, 0.0, 0.0]])
        return len(table_ranges._jumps_of_curvature(np.arange(3.0), pieces_of_table)) == 0

    return count_while(is_rounding, DOUBLES)


def stretches(around):
    """Return the sizes of the searches for zeros, of which some stretches have to be divided."""
    sizes = []

    def ranges(low, _high):
        sizes.append(len(low))
        both = np.broadcast_to([[-1.0], [1.0]], (2, len(low)))
        return Record(value=both, slope=both)

    with patch.multiple(
        zeros, _size=lambda _: 1.0, _stays=lambda value, *_: np.zeros(value.shape[1], bool),
        _around=lambda _levels, _found, values, *_: around(len(values)), _stands=lambda _, low, *__: np.zeros(len(low), bool),
    ):  # fmt: skip
        try:
            [*zeros._stretches(lambda t: t, ranges, 0.0, 1.0, np.zeros(1))]
        except zeros.TooMany:
            return sizes
    return sizes


def first_alone(count):
    return np.arange(count) < 1


def every_one(count):
    return np.ones(count, bool)


def largest_period_with_turns():
    def is_limited(count):
        argument = "table", np.zeros(count), np.zeros(count), 1.0
        with patch.multiple(law_intervals, _of_arguments=lambda _: [argument], Intervals=lambda *args: len(args[4])):
            return law_intervals._intervals_of(Record(n_event_functions=0)) > 0

    return count_while(is_limited, range(1, 40))


def overlap_of_a_breakpoint():
    group = Record(
        kind=Record(n_bodies=0), record=Record(laws=[("f", 0)]), index=np.zeros((1, 1), int), numbers=np.zeros(1)
    )
    with patch.multiple(law_intervals, FIXED={"f": np.zeros(1)}, _narrower=lambda *_: 1.0):
        ((_, _, overlap, _),) = law_intervals._of_arguments(Record(groups=[group]))
    return overlap


def largest_departure_from_a_tangent():
    """Return the departure near a breakpoint, in quarter octaves of the change far from it, that is rounding."""
    far = law_intervals.NEARER[0]

    def is_rounding(departure):
        with patch.multiple(
            law_intervals, ends_of=lambda _: (np.zeros(1),) * 4,
            value_of=lambda _, at: np.where(np.abs(at) < far, departure, 1.0),
        ):  # fmt: skip
            return law_intervals._overlaps(np.zeros(1), np.zeros(1, int), np.ones(1))[0] > law_intervals.BARELY

    return len(BELOW) - count_while(lambda x: is_rounding(x), BELOW[::-1])


def largest_open_gap():
    def is_silent(gap):
        system = Record(active=np.ones(1), equations=[("j", "x")])
        state = Record(evaluate=nothing, vector=lambda *_: np.array([gap]))
        return not suspect._open(Record(system=system, state=state), 0.0)

    return count_while(lambda gap: is_silent(1e-7 * gap), DOUBLES)


def largest_written_power():
    graph = Record(_power=lambda *_: True, term=nothing, _call=lambda _: False)
    x = sp.Symbol("x", real=True)
    return count_while(lambda power: shared_parts._Graph._term(graph, x**power) is True, range(2, 40))


def largest_gentle_power():
    x = sp.Symbol("x", real=True)

    def is_gentle(power):
        noted = []
        symbols.Symbols.note_functions(Record(note_law=lambda *_: noted.append(1)), x**power)
        return not noted

    return count_while(is_gentle, range(2, 60))


def most_summands():
    def is_split(count):
        return (
            variation.Variation._sum(Record(_known={}, _apart=lambda _: range(count), _whole=lambda _: None), "x")
            is not None
        )

    return count_while(is_split, range(1, 500))


def largest_number_of_order_one():
    found = Record(_bounded=(), _e=Record(by_q=Record(of=lambda _: ())))
    return count_while(lambda n: variation.Variation._whole(found, sp.Integer(n))[()][1], range(1, 40))


def smallest_departure_from_half_a_turn():
    """Return the angle beyond half a turn back, in quarter octaves, up to which it stays negative."""

    def is_negative(beyond):
        rows = Record(values=np.array([[-np.pi + beyond]]))
        angles = Record(
            places={"j": [0]}, counters={}, followed=["j"], start={}, _changes=lambda _: (np.zeros((0, 1)),) * 3
        )  # fmt: skip
        return JointAngles.continuous(angles, rows)["j"][0] < 0.0

    return count_while(is_negative, BELOW)


def smallest_defined_slope():
    """Return the change of slope, in quarter octaves, up to which the slope at a point is defined by its sides."""

    def is_defined(change):
        slopes = table_values._akima_slopes(np.array([0.0, 0.0, 1.0, 1.0 + change, 1.0 + change, 5.0, 5.0]))
        return np.abs(slopes[2]) < 0.25

    return count_while(is_defined, BELOW)


def largest_overshoot():
    table = Record(interpolation=next(iter(written_values.CURVES)), table=[(0.0, 0.0), (1.0, 1.0)])

    def is_silent(over):
        with patch.object(written_values, "_extrema", lambda _: (np.array([0.5]), np.array([1.0 + over]))):
            return not [*written_values._beyond("", table)]

    return count_while(lambda over: is_silent(1e-3 * over), DOUBLES)


DECISIONS = {
    "compile.active_dampers:ROUNDING": lambda: count_while(
        lambda part: not [*active_dampers._of_matrix(np.array([[1.0, 1.0], [1.0, 1.0 - 2e-12 * part]]))], DOUBLES
    ),
    "compile.callbacks:DIFFERENCE": step_at_zero,
    "compile.callbacks:LEAST_ARGUMENT": step_at_zero,
    "compile.gaps:MOST_MOVES": moves_of_a_body,
    "compile.gaps:CLOSED": smallest_slope_of_a_gap,
    "compile.inputs.ends:MOST_DIVISIONS": divisions_without_a_bound,
    "compile.inputs.ends:FARTHER_SIDE": lambda: distances_from_a_pole()[0],
    "compile.inputs.ends:NEARER_SIDE": lambda: distances_from_a_pole()[1],
    "compile.inputs.ends:GROWS": smallest_growth_at_a_pole,
    "compile.inputs.ends:LARGEST": largest_growth,
    "compile.inputs.features:PIECES_OF_A_STEP": longest_step,
    "compile.inputs.features:ALIKE": lambda: count_while(
        lambda ratio: len(features._merged(np.arange(2.0), np.array([1.0, ratio]))[0]) == 1, 1.1 * DOUBLES
    ),
    "compile.inputs.features:INSTANTS": instants_of_an_interval,
    "compile.inputs.pieces:OF_CHANGE": lambda: longest_piece(change=1.0),
    "compile.inputs.pieces:LEAST_PART": lambda: longest_piece(whole=1.0),
    "compile.inputs.pieces:ALWAYS_ALLOWED": lambda: longest_piece(size=1.0),
    "compile.inputs.pieces:SHORTEST_PIECE": shortest_piece,
    "compile.inputs.pieces:MOST_PIECES": lambda: count_while(
        lambda count: not is_estimated(round(100 * count), 0.0), DOUBLES
    ),
    "compile.inputs.pieces:MANY_PIECES": most_pieces_of_one_pass,
    "compile.inputs.pieces:ROUNDING_OF_SAMPLES": largest_rounding_of_samples,
    "compile.inputs.pieces:SAMPLE": lambda: reached(lambda: estimated(where=lambda sample: reach(int(sample.sum())))),
    "compile.inputs.pieces:QUANTILE": lambda: estimated(cut=lambda *_, **__: Record(lengths=np.arange(101.0)))[0],
    "compile.inputs.pieces:URGENT": lambda: count_while(lambda bound: not is_estimated(20_000, bound), BELOW),
    "compile.inputs.table_ranges:CONTINUOUS": largest_jump_by_rounding,
    "compile.inputs.table_ranges:FLAT": flattest_piece,
    "compile.inputs.zeros:FIRST_STRETCHES": lambda: stretches(first_alone)[0],
    "compile.inputs.zeros:SHORTEST_STRETCH": lambda: len(stretches(first_alone)),
    "compile.inputs.zeros:MOST_STRETCHES": lambda: len(stretches(every_one)),
    "compile.law_intervals:FEW": largest_period_with_turns,
    "compile.record:DERIVED": lambda: executed("compile.record")._terms.cache_info().maxsize,
    "compile.record:RECORDS": lambda: executed("compile.record")._record_of.cache_info().maxsize,
    "compile.law_intervals:CLOSE": overlap_of_a_breakpoint,
    "compile.law_intervals:NOTHING": largest_departure_from_a_tangent,
    "compile.state:LEFT_OPEN": largest_open_gap,
    "compile.symbolic.shared_parts:MOST_FACTORS": largest_written_power,
    "compile.symbolic.symbols:STEEP": largest_gentle_power,
    "compile.symbolic.variation:MOST_SUMMANDS": most_summands,
    "compile.symbolic.variation:ORDER_ONE": largest_number_of_order_one,
    "elements.turns:INITIAL_COUNT": smallest_departure_from_half_a_turn,
    "compile.table_values:UNDEFINED": smallest_defined_slope,
    "compile.written_values:BEYOND": largest_overshoot,
}  # fmt: skip
EXPECTED = {
    "compile.active_dampers:ROUNDING": 40, "compile.callbacks:DIFFERENCE": 6.05545445239334e-09,
    "compile.callbacks:LEAST_ARGUMENT": 6.05545445239334e-09, "compile.gaps:MOST_MOVES": 60, "compile.gaps:CLOSED": 159,
    "compile.inputs.ends:MOST_DIVISIONS": 500, "compile.inputs.ends:FARTHER_SIDE": 1e-06,
    "compile.inputs.ends:NEARER_SIDE": 1e-10, "compile.inputs.ends:GROWS": 6, "compile.inputs.ends:LARGEST": 54,
    "compile.inputs.features:PIECES_OF_A_STEP": 0.07, "compile.inputs.features:ALIKE": 4,
    "compile.inputs.features:INSTANTS": 8, "compile.inputs.pieces:OF_CHANGE": 0.003,
    "compile.inputs.pieces:LEAST_PART": 3.0000000000000004e-07, "compile.inputs.pieces:ALWAYS_ALLOWED": 1e-10,
    "compile.inputs.pieces:SHORTEST_PIECE": 1e-11, "compile.inputs.pieces:MOST_PIECES": 26,
    "compile.inputs.pieces:MANY_PIECES": 23, "compile.inputs.pieces:ROUNDING_OF_SAMPLES": 27,
    "compile.inputs.pieces:SAMPLE": 64, "compile.inputs.pieces:QUANTILE": 10.0, "compile.inputs.pieces:URGENT": 24,
    "compile.inputs.table_ranges:FLAT": 155, "compile.inputs.table_ranges:CONTINUOUS": 27,
    "compile.inputs.zeros:FIRST_STRETCHES": 64, "compile.inputs.zeros:SHORTEST_STRETCH": 35,
    "compile.inputs.zeros:MOST_STRETCHES": 15, "compile.law_intervals:FEW": 8, "compile.law_intervals:CLOSE": 0.001, "compile.record:DERIVED": 16, "compile.record:RECORDS": 512,
    "compile.law_intervals:NOTHING": 119, "compile.state:LEFT_OPEN": 27, "compile.symbolic.shared_parts:MOST_FACTORS": 5,
    "compile.symbolic.symbols:STEEP": 8, "compile.symbolic.variation:MOST_SUMMANDS": 100,
    "compile.symbolic.variation:ORDER_ONE": 8, "elements.turns:INITIAL_COUNT": 119, "compile.table_values:UNDEFINED": 111,
    "compile.written_values:BEYOND": 27,
}  # fmt: skip
