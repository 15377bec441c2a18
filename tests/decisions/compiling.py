"""Decisions on compilation: inputs of time, tables, geometry of solids, factors, series, shared parts of expressions."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import sympy as sp

from stiffmbs.compile import active_dampers, callbacks, gaps, law_intervals, table_values, written_values
from stiffmbs.compile.inputs import ends, features, pieces, table_ranges, zeros
from stiffmbs.compile.machine import compiler
from stiffmbs.compile.machine.geometry import common_normal, ellipsoids
from stiffmbs.compile.machine.native import evaluate, factors, rotation_vector
from stiffmbs.compile.machine.native.beams import along, screws
from stiffmbs.compile.symbolic import shared_parts, symbols, variation
from stiffmbs.results.joint_angles import JointAngles
from stiffmbs.solve import suspect
from tests.decisions.common import BELOW, Reached, Record, executed, nothing, reach, reached
from tests.interpreted import interpreted
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
        found = iter([1.0, ratio, None, None])
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


def inlined_instructions():
    source = Record(namespace=dict, signatures=[], level=compiler.SHORT, text="")
    with patch("stiffmbs.compile.machine.translate.unit.assembly", lambda *args: reach(args[-1])):
        return reached(lambda: compiler._object_code(source, ""))


def normal(part=nothing, grow=nothing):
    """Find a common normal of solids, with functions for the solids and their cores."""
    with interpreted(
        common_normal, room=np.zeros, along=lambda *_: 1.0, take_unit_length=nothing, across=nothing, thinnest=lambda _: 1e-9,
        ellipsoids=nothing, _part=part, _grow=grow,
    ):  # fmt: skip
        common_normal.find_normal(np.ones(3), np.ones(3))


def calls_of(name):
    """Return the number of calls of a function by an iteration that never ends."""
    calls = []
    with interpreted(
        common_normal, room=lambda n: np.ones(n), along=lambda *_: 0.0, take_unit_length=nothing, across=nothing, made_definite=nothing,
        curvature=nothing, solved=nothing, reach=lambda *_: 1e9, **{"support": nothing, "moved": nothing, name: lambda *_: calls.append(1)},
    ):  # fmt: skip
        common_normal._part(np.ones(54), np.ones(3), np.ones(3), -1e9, 0)
    return len(calls)


def halvings_of_a_step():
    return calls_of("moved") / calls_of("support")


def parts_of_a_normal():
    """Return the tolerances and the numbers of last steps of each stage."""
    found = []
    normal(part=lambda *args: found.append(args[-2:]))
    return found


def stages_of_growth():
    found = []
    normal(grow=lambda *_: found.append(1))
    return len(found)


def thickness_of_a_core():
    """Return the thickness that is removed from a sphere of radius 1 to form its core."""
    pose, m = np.zeros(100), np.zeros(54)
    with interpreted(ellipsoids, least=lambda _: 1.0):
        pose[ellipsoids.SQUARES : ellipsoids.SQUARES + 3] = 1.0
        pose[ellipsoids.TURN] = 1.0
        ellipsoids.ellipsoids(pose, 0.0, 1.0, m)
    return 1.0 - m[0]


def relative_step():
    with interpreted(along, law=lambda *_: np.ones(1)):
        return along.step_size(0, 0, 0, 1, np.ones(1), None, np.ones(1), None)


def terms_of(x):
    """Return the number of terms of a series."""
    sizes = []
    with (
        interpreted(screws, room=np.zeros, clear=nothing),
        patch.object(screws, "abs", lambda value: sizes.append(1) or abs(value), create=True),
    ):
        screws.series(x, 0, 0, np.zeros(4))
    return len(sizes)


def largest_angle_of_a_quad():
    def is_accepted(angle):
        with interpreted(evaluate, quad_of=lambda *_: reach(True)):
            try:
                return evaluate.share_four(np.full(3, angle), np.zeros(4, int), None)
            except Reached:
                return True

    return count_while(lambda angle: is_accepted(1e3 * angle), DOUBLES)


def smallest_diagonal_pivot():
    """Return the diagonal entry of a column, in quarter octaves of its largest, up to which it is the pivot."""

    def is_kept(entry):
        f = Record(
            n=2, capacity=100, order=[0, 1], pivot=np.zeros(2, int), work=np.zeros(2), stack=np.array([0, 1, 0, 0, 0, 0]), ready=0,
            a=np.array([entry, 1.0, 1.0, 0.0]), a_row=[0, 1, 0, 1], a_start=[0, 2, 4], l=np.zeros(9), u=np.zeros(9),
            l_row=np.zeros(9, int), u_row=np.zeros(9, int), l_start=np.zeros(3, int), u_start=np.zeros(3, int),
        )  # fmt: skip
        with interpreted(factors, _reach=lambda *_: 0):
            factors._factored_within(f)
        return f.pivot[0] == 0

    return count_while(is_kept, BELOW)


def smallest_previous_pivot():
    def is_accepted(entry):
        f = Record(
            n=2, order=[0, 1], pivot=[0, 1], work=np.zeros(2), a=np.array([entry, 1.0, 1.0, 0.0]), a_row=[0, 1, 0, 1], a_start=[0, 2, 4],
            l=np.zeros(9), u=np.zeros(9), l_row=[0, 1, 1], u_row=[0, 0, 1], l_start=[0, 2, 3], u_start=[0, 1, 3],
        )  # fmt: skip
        with interpreted(factors):
            return factors.refactor(f) == factors.DONE

    return count_while(is_accepted, BELOW)


def lightest_body(inertia=1.0, entry=1.0):
    """Return the inertia of a body that an equation couples to one of unit inertia."""
    f = Record(a_start=[0, 2], a=np.array([entry, 1.0]), a_row=[0, 1], work=np.array([1.0, inertia]))
    factors._spread(f, 0)
    return f.work[1]


def spreads_of_inertia():
    spread = []
    with interpreted(factors, _spread=lambda *_: spread.append(1)):
        factors.spread_inertia(Record(n=1, work=np.zeros(1)))
    return len(spread)


def farthest_rotation_by_series():
    def is_near(away):
        with interpreted(rotation_vector, _near_one=lambda *_: -1.0):
            return rotation_vector.rotation_vector(1.0 - away, 0) == -1.0

    return count_while(lambda away: not is_near(away), BELOW)


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
            places={"j": [0]}, counters={}, followed=["j"], start={}, _changes=lambda _: (np.zeros((0, 1)), np.zeros((0, 1)))
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
    "compile.law_intervals:CLOSE": overlap_of_a_breakpoint,
    "compile.law_intervals:NOTHING": largest_departure_from_a_tangent,
    "compile.machine.compiler:_INLINED": inlined_instructions,
    "compile.machine.geometry.common_normal:THINNER": stages_of_growth,
    "compile.machine.geometry.common_normal:STAGES": lambda: len(parts_of_a_normal()) - 1,
    "compile.machine.geometry.common_normal:MOST_STEPS": lambda: calls_of("support"),
    "compile.machine.geometry.common_normal:MOST_HALVINGS": halvings_of_a_step,
    "compile.machine.geometry.common_normal:POLISHES": lambda: parts_of_a_normal()[-1][1],
    "compile.machine.geometry.common_normal:FLAT": lambda: parts_of_a_normal()[-1][0],
    "compile.machine.geometry.common_normal:ROUGHLY": lambda: parts_of_a_normal()[0][0],
    "compile.machine.geometry.ellipsoids:CORE": thickness_of_a_core,
    "compile.machine.native.beams.along:STEP": relative_step,
    "compile.machine.native.beams.screws:TERMS": lambda: terms_of(1e3),
    "compile.machine.native.beams.screws:NEGLIGIBLE": lambda: count_while(lambda x: terms_of(x) > 1, BELOW),
    "compile.machine.native.beams.section:MOST": lambda: executed("compile.machine.native.beams.section").NODES,
    "compile.machine.native.evaluate:FARTHEST": largest_angle_of_a_quad,
    "compile.machine.native.factors:KEEP_DIAGONAL": smallest_diagonal_pivot,
    "compile.machine.native.factors:TOO_SMALL": smallest_previous_pivot,
    "compile.machine.native.factors:LIGHT": lambda: count_while(
        lambda inertia: lightest_body(inertia=inertia) == inertia, BELOW
    ),
    "compile.machine.native.factors:COUPLES": lambda: count_while(
        lambda entry: lightest_body(inertia=1e-30, entry=entry) > 1e-30, BELOW
    ),
    "compile.machine.native.factors:SPREAD_OVER": spreads_of_inertia,
    "compile.machine.native.rotation_vector:NEAR": farthest_rotation_by_series,
    "compile.machine.native.rotation_vector:TERMS": lambda: rotation_vector._near_one(3.0, 0),
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
    "compile.active_dampers:ROUNDING": 40,
    "compile.callbacks:DIFFERENCE": 6.05545445239334e-09, "compile.callbacks:LEAST_ARGUMENT": 6.05545445239334e-09,
    "compile.gaps:MOST_MOVES": 60, "compile.gaps:CLOSED": 159, "compile.inputs.ends:MOST_DIVISIONS": 500,
    "compile.inputs.ends:FARTHER_SIDE": 1e-06, "compile.inputs.ends:NEARER_SIDE": 1e-10, "compile.inputs.ends:GROWS": 6,
    "compile.inputs.ends:LARGEST": 54, "compile.inputs.features:PIECES_OF_A_STEP": 0.07, "compile.inputs.features:ALIKE": 4,
    "compile.inputs.features:INSTANTS": 8, "compile.inputs.pieces:OF_CHANGE": 0.003, "compile.inputs.pieces:LEAST_PART": 3.0000000000000004e-07,
    "compile.inputs.pieces:ALWAYS_ALLOWED": 1e-10, "compile.inputs.pieces:SHORTEST_PIECE": 1e-11, "compile.inputs.pieces:MOST_PIECES": 26,
    "compile.inputs.pieces:MANY_PIECES": 23, "compile.inputs.pieces:ROUNDING_OF_SAMPLES": 27, "compile.inputs.pieces:SAMPLE": 64,
    "compile.inputs.pieces:QUANTILE": 10.0, "compile.inputs.pieces:URGENT": 24, "compile.inputs.table_ranges:FLAT": 155,
    "compile.inputs.table_ranges:CONTINUOUS": 27,
    "compile.inputs.zeros:FIRST_STRETCHES": 64, "compile.inputs.zeros:SHORTEST_STRETCH": 35, "compile.inputs.zeros:MOST_STRETCHES": 15,
    "compile.law_intervals:FEW": 8, "compile.law_intervals:CLOSE": 0.001, "compile.law_intervals:NOTHING": 119,
    "compile.machine.compiler:_INLINED": 40, "compile.machine.geometry.common_normal:THINNER": 13,
    "compile.machine.geometry.common_normal:STAGES": 16, "compile.machine.geometry.common_normal:MOST_STEPS": 60,
    "compile.machine.geometry.common_normal:MOST_HALVINGS": 30.0, "compile.machine.geometry.common_normal:POLISHES": 4,
    "compile.machine.geometry.common_normal:FLAT": 1e-14, "compile.machine.geometry.common_normal:ROUGHLY": 1e-08,
    "compile.machine.geometry.ellipsoids:CORE": 0.5, "compile.machine.native.beams.along:STEP": 0.001,
    "compile.machine.native.beams.screws:TERMS": 17, "compile.machine.native.beams.screws:NEGLIGIBLE": 274,
    "compile.machine.native.beams.section:MOST": 690, "compile.machine.native.evaluate:FARTHEST": 27,
    "compile.machine.native.factors:KEEP_DIAGONAL": 13, "compile.machine.native.factors:TOO_SMALL": 40,
    "compile.machine.native.factors:LIGHT": 80, "compile.machine.native.factors:COUPLES": 13, "compile.machine.native.factors:SPREAD_OVER": 4,
    "compile.machine.native.rotation_vector:NEAR": 13, "compile.machine.native.rotation_vector:TERMS": 308.33391674417925,
    "compile.state:LEFT_OPEN": 27, "compile.symbolic.shared_parts:MOST_FACTORS": 5, "compile.symbolic.symbols:STEEP": 8,
    "compile.symbolic.variation:MOST_SUMMANDS": 100, "compile.symbolic.variation:ORDER_ONE": 8, "elements.turns:INITIAL_COUNT": 119,
    "compile.table_values:UNDEFINED": 111, "compile.written_values:BEYOND": 27,
}  # fmt: skip
