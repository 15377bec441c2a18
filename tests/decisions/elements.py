"""Decisions on elements: roads, tyres, joints, friction, orientations, bodies without mass."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import sympy as sp

from stiffmbs.elements import initial_pose, loads
from stiffmbs.elements.forces import friction
from stiffmbs.elements.joints import point_on_curve
from stiffmbs.elements.roads import crg, crg_grid, grid, iso8608, reference_line, rolling_filter
from stiffmbs.elements.spatial import body, branches, massless, orientation, relaxation
from stiffmbs.elements.spatial.forces import capsule_impact, plane_impact, solid_impact, sphere_impact
from stiffmbs.elements.tyres import fiala, file_fields, passivity, steady_state
from stiffmbs.errors import InputError
from tests.decisions.common import BELOW, Record, executed, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def same(expression):
    """Return an expression without a name."""
    return expression


def naming(place):
    """Return a function that ends at the expression of a place in the sequence of named ones."""
    count = []

    def named(expression):
        count.append(expression)
        return reach(float(expression)) if len(count) == place else expression

    return named


def slowest_sliding():
    equations = Record(stiction_velocity=1.0, named=lambda speed: reach(float(speed)))
    return reached(lambda: friction.Friction.per_speed.__func__(friction.Friction, equations, sp.Integer(0)))


def largest_distance_at_one_place():
    pose = Record(model=Record(point=lambda x: (x, 0.0)), _size=1.0)
    return count_while(lambda x: initial_pose.InitialPose.at_one_place(pose, 0.0, 1e-15 * x), DOUBLES)


def largest_gap_of_a_cam():
    def is_closed(gap):
        with patch.object(point_on_curve, "formula_value", lambda _, angle: 1.0 + gap * (angle > 0)):
            return not refused(lambda: point_on_curve._refuse_open(Record(text="")))

    return count_while(lambda gap: is_closed(1e-11 * gap), DOUBLES)


def most_heights():
    def accepts(count):
        road = Record(file=Record(u=range(round(count))), _columns=[1], _reference_line=nothing)
        return not refused(lambda: crg.CrgRoad._of_bounded_size(road))

    return count_while(lambda count: accepts(1e4 * count), DOUBLES)


def largest_departure_of_a_straight_line():
    """Return the departure, in quarter octaves of 1e-11 m, of a line that is straight."""

    def is_straight(across):
        road = Record(
            _at_its_place=lambda: (np.arange(3.0), np.array([0.0, across, 0.0]), None), _direction=lambda: (1.0, 0.0),
            file=Record(u=None, v=None, path=None),
        )  # fmt: skip
        with patch.object(crg, "reference_line", lambda *_: "curved"):
            return crg.CrgRoad._reference_line(road) is None

    return count_while(lambda across: is_straight(1e-11 * across), DOUBLES)


def points_beyond_a_section():
    with patch.object(crg, "table_of", lambda at, _: len(at)):
        return crg._section(np.arange(10.0), np.zeros(10)) - 10


def largest_difference_of_headings():
    def accepts(heading):
        numbers = {"REFERENCE_LINE_END_X": 1.0, "REFERENCE_LINE_END_Y": 0.0, "REFERENCE_LINE_START_PHI": heading}
        return not refused(lambda: crg_grid._heading(numbers, "road"))

    return count_while(lambda heading: accepts(1e-5 * heading), DOUBLES)


def most_lines():
    def accepts(count):
        with patch.multiple(
            grid, file_text=lambda *_, **__: "", _rows=lambda *_: [(1, range(count)), (2, ()), (3, ())],
            _refuse_disorder=lambda *_: reach(True),
        ):  # fmt: skip
            try:
                return reached(lambda: grid.read_grid(None))
            except InputError:
                return False

    return count_while(accepts, range(2, 200))


def points_of_the_shortest_wave():
    with patch.object(iso8608, "_table", lambda _amplitude, _k, count, _length: reach(count / 10)):
        return reached(lambda: iso8608._tables(0, 0, 1.0, 10.0, 10.0, 1.0, "none"))


def iterations_of_the_nearest_point(frozen):
    """Return the number of Newton iterations before derivatives are frozen, or thereafter."""
    counts = [0]

    def step(*args):
        counts[-1] += 1
        return args[2]

    equations = Record(named=same, meanings=[], derivatives=Record(define=lambda *_: counts.append(0)))
    line = Record(guess=same, direction=(1.0, 0.0))
    with patch.multiple(reference_line, _newton=step, _at=lambda *_: reach(counts)):
        return reached(lambda: reference_line.nearest(line, equations, 0.0, 0.0))[0 if frozen else 1]


def largest_distance_from_a_spline():
    """Return the distance, in quarter octaves of 1e-9 m, of points that a spline through some of them passes."""
    u = np.arange(65.0)

    def is_simplified(away):
        return len(reference_line._chosen(u, u, away * (-1.0) ** np.arange(65))) < 65

    return count_while(lambda away: is_simplified(0.5e-8 * away), DOUBLES)


class Straight:
    """Position along a straight line, which begins at a distance from its spline."""

    def __init__(self, slope, away=0.0):
        self._slope, self._away = slope, away

    def __call__(self, at, order=0):
        at = np.asarray(at)
        return np.full(at.shape, self._slope) if order else self._slope * (at + self._away * (at.ndim == 1))

    def derivative(self, order=1):
        return lambda at: np.full(np.shape(at), self._slope if order == 1 else 0.0)


def tried_line(away=0.0, guess=None):
    """Search the nearest points of a straight line."""
    table = Record(table=[(0.0, 0.0), (10.0, 10.0)])
    line = Record(x=table, y=table, guess=table, direction=(1.0, 0.0))
    splines = iter([Straight(1.0, away), Straight(0.0), guess or Straight(1.0)])
    with patch.object(reference_line, "_spline", lambda *_: next(splines)):
        reference_line._try_it(line, np.arange(1.0, 9.0), np.array([-1.0, 1.0]), "road")


def steepest_line():
    def accepts(angle):
        x, y = np.array([0.0, np.cos(angle), 10.0]), np.array([0.0, np.sin(angle), 0.0])
        with patch.object(reference_line, "_chosen", lambda *_: reach(True)):
            try:
                return reached(lambda: reference_line.reference_line(np.arange(3.0), x, y, None, "road"))
            except InputError:
                return False

    return count_while(accepts, np.arange(0.1, 3.1, 0.05))


def samples_of_a_profile():
    """Return the number of heights of a road of 10 radii that a filter reads."""
    with patch.object(rolling_filter, "_reach", lambda _: 1.0):
        return reached(lambda: rolling_filter._centres(lambda x: reach(len(x)), (0.0, 10.0), None))


def longest_filtered_road():
    def accepts(radii):
        with patch.object(rolling_filter, "_reach", lambda _: 1.0):
            try:
                return reached(lambda: rolling_filter._centres(lambda _: reach(True), (0.0, radii), None))
            except InputError:
                return False

    return count_while(lambda radii: accepts(100.0 * radii), DOUBLES[:60])


def margin_of_a_filter():
    with patch.multiple(
        rolling_filter, _reach=lambda _: 1.0, _centres=lambda _heights, extent, _shape: reach(extent[1])
    ):
        return reached(lambda: rolling_filter.rolled_profile(None, (0.0, 0.0), None))


def largest_asymmetry_of_moments():
    def accepts(apart):
        tensor = ((1.0, apart, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        return not refused(lambda: body.Body._of_a_body(tensor, Record(data={})))

    return count_while(lambda apart: accepts(1e-11 * apart), DOUBLES)


def sine_of_an_upright_axis():
    one = Record(dot=lambda _: sp.Integer(1))
    equations = Record(i=Record(z=one), j=Record(z=one), named=naming(2))
    cylinder = plane_impact.CylinderPlaneImpact
    return reached(lambda: cylinder.touches.__func__(cylinder, equations))


def distance_along_parallel_axes():
    first, second = (Record(point=sp.Integer(0), z=Record(dot=lambda _, k=k: sp.Integer(k))) for k in (1, 2))
    equations = Record(i=first, j=second, length=sp.Integer(10) ** 20, named=naming(5))
    capsules = capsule_impact.CapsuleImpact
    return reached(lambda: capsules.nearest.__func__(capsules, equations))


def edge_of_a_box():
    with patch.object(solid_impact, "RoundSolid", lambda rows, _: rows):
        square = solid_impact.round_solid(Record(named=same), "box", (sp.Integer(2),) * 3)[0][1]
    return float(sp.sqrt(square))


def parts_of_a_quaternion_as_given():
    """Return the largest excess of a quaternion's length, in roundings of 1, that is not normalised."""
    return count_while(lambda k: orientation.unit_quaternion((1 + k * 2.0**-52, 0.0, 0.0, 0.0))[0] != 1.0, range(1, 40))


def lagged(state=0.0, sliding=0.0, length=0.0):
    """Return the longitudinal slip of a tyre at rest and the rate of its state."""
    equations = Record(named=same, own=(state, 0.0), slow=1.0)
    contact = Record(vx=sp.Integer(0), vy=sp.Integer(0))
    with patch.object(relaxation, "above_zero", lambda x: max(x, 0)):
        slip, _, (rate, _) = relaxation.lagged(equations, contact, sliding, (length, length))
    return float(slip), float(rate)


def force_without_contact():
    slip = Record(alpha=sp.Integer(0), kappa=sp.Integer(0), friction=1, load=0)
    constants = Record(static=1, sliding=1)
    return reached(lambda: fiala.forces(constants, slip, naming(3)))


def second_point_of_a_rim():
    file = Record(entry=lambda *_: True, number=lambda *_: 1.0)
    return file_fields._stiff_rim(file).load.table[1][0]


def accepted_deflections():
    """Return the number of deflections by the nominal load, in quarter octaves, that are plausible."""

    def accepts(deflection):
        found = {
            "FNOMIN": deflection,
            "VERTICAL_STIFFNESS": 1.0,
            "UNLOADED_RADIUS": 1.0,
            "PKX1": 1.0,
            "PKY1": 0.0,
            "PKY2": 1.0,
        }
        with patch.object(file_fields, "_fault", lambda *_: InputError("")):
            return not refused(lambda: file_fields._check_magic(None, None, found))

    return sum(accepts(1e-4 * deflection) for deflection in DOUBLES[:80])


def number_of_relaxation_lengths():
    """Return the number of relaxation lengths, in quarter octaves, that are used."""
    formula = Record(home=lambda name: name, vertical="")

    def is_used(length):
        file = Record(entry=lambda *_: Record(text=""), number=lambda *_: length)
        with patch.object(file_fields, "digits", lambda _: (0, 0, 0)):
            found = [*file_fields.relaxation_of(file, formula, {"UNLOADED_RADIUS": 1.0}, 0)]
        return found[0][1] == length

    return sum(is_used(1e-4 * length) for length in DOUBLES[:100])


def widest_tyre():
    found = {"UNLOADED_RADIUS": 1.0, "FNOMIN": 4000.0, "UMIN": 0.0, "UMAX": 1.0, "CALPHA": 5e4, "WIDTH": 1.0}
    with patch.object(file_fields, "_check_range", lambda *args: reach(args[4][1])):
        return reached(lambda: file_fields._check_fiala(None, None, found))


def iterations_without_a_root():
    calls = []
    nan = np.array([np.nan])
    steady_state.falling_root(lambda x: calls.append(1) or x, same, nan, nan)
    return len(calls)


def loaded_radius(root, load=0.0, carried=0.0):
    """Return the loaded radius of a tyre, by a function that finds a root."""
    values = {"load": np.array([carried]), "slope": np.ones(1), "rho": np.zeros(1)}
    numbers = {"formula": "6", "FNOMIN": 0.0}
    with patch.multiple(
        steady_state, VERSIONS={"6": Record(is_6=True)}, _compiled=lambda *_: lambda *_: values, _key=lambda _: (),
        _values=lambda _: (), falling_root=root,
    ):  # fmt: skip
        found = {"free": np.ones(1), "omega": None, "Fx": None, "Fy": None}
        return steady_state._deflected(numbers, np.array([load]), None, None, found)["Rl"]


def least_load_of_a_search():
    return reached(lambda: loaded_radius(lambda function, *_: reach(-function(np.zeros(1))[0])))


def end_of_the_search():
    return reached(lambda: loaded_radius(lambda _function, _slope, _low, high: reach(high[0])))


def largest_error_of_the_load():
    def is_carried(error):
        return np.isfinite(loaded_radius(lambda *_: np.ones(1), 1.0, 1.0 + error))[0]

    return count_while(lambda error: is_carried(1e-11 * error), DOUBLES)


def largest_tracks():
    (limit,) = (
        one.le
        for one in executed("elements.roads.envelope").Envelope.model_fields["tracks"].metadata
        if hasattr(one, "le")
    )
    return limit


def checked_loads():
    tyre = Record(numbers={"FNOMIN": 1.0}, coefficients={}, ranges={}, nominal_pressure=None)
    with patch.object(passivity, "_expected_positive", lambda _tyre, _p, loads, *_: reach(loads)):
        return reached(lambda: [*passivity.active_notes(tyre)])


DECISIONS = {
    "elements.loads:TINY": lambda: float(loads.length()),
    "elements.forces.friction:AT_REST": slowest_sliding,
    "elements.initial_pose:SAME_POINT": largest_distance_at_one_place,
    "elements.joints.point_on_curve:CLOSED": largest_gap_of_a_cam,
    "elements.roads.crg:MOST_SECTIONS": lambda: executed("elements.roads.crg").CrgRoad.model_fields["sections"].default,
    "elements.roads.crg:MOST_HEIGHTS": most_heights,
    "elements.roads.crg:STRAIGHT": largest_departure_of_a_straight_line,
    "elements.roads.crg:LEVEL": points_beyond_a_section,
    "elements.roads.crg_grid:SAME_HEADING": largest_difference_of_headings,
    "elements.roads.envelope:MOST_TRACKS": largest_tracks,
    "elements.roads.grid:MOST_LINES": most_lines,
    "elements.roads.iso8608:POINTS": points_of_the_shortest_wave,
    "elements.roads.reference_line:FROZEN": lambda: iterations_of_the_nearest_point(True),
    "elements.roads.reference_line:FOLLOWED": lambda: iterations_of_the_nearest_point(False),
    "elements.roads.reference_line:CLOSE": largest_distance_from_a_spline,
    "elements.roads.reference_line:CONVERGED": lambda: count_while(
        lambda away: not refused(lambda: tried_line(1e-11 * away)), DOUBLES
    ),
    "elements.roads.reference_line:WIDEST": steepest_line,
    "elements.roads.reference_line:SAMPLES_ACROSS": lambda: reached(
        lambda: tried_line(guess=lambda at: reach(at.shape[1]))
    ),
    "elements.roads.rolling_filter:FINE": samples_of_a_profile,
    "elements.roads.rolling_filter:BETWEEN": samples_of_a_profile,
    "elements.roads.rolling_filter:COARSE": longest_filtered_road,
    "elements.roads.rolling_filter:MOST": longest_filtered_road,
    "elements.roads.rolling_filter:MARGIN": margin_of_a_filter,
    "elements.spatial.body:MOMENT_ROUNDING": largest_asymmetry_of_moments,
    "elements.spatial.branches:FARTHEST": lambda: count_while(
        lambda angle: not [*branches._too_far(angle, "", "")], range(180)
    ),
    "elements.spatial.forces.capsule_impact:PARALLEL": distance_along_parallel_axes,
    "elements.spatial.forces.plane_impact:UPRIGHT": sine_of_an_upright_axis,
    "elements.spatial.forces.solid_impact:ROUNDING": edge_of_a_box,
    "elements.spatial.forces.sphere_impact:LEAST_DISTANCE": lambda: float(sphere_impact.length()),
    "elements.spatial.massless:MASSLESS": lambda: massless.massless_moment(1.0, []),
    "elements.spatial.massless:NO_MOMENT": lambda: count_while(
        lambda moment: not massless.lacks_inertia(np.diag([1.0, 1.0, moment])), BELOW
    ),
    "elements.spatial.orientation:ROUGH": lambda: count_while(
        lambda more: not refused(lambda: orientation.unit_quaternion((1.0 + 1e-5 * more, 0.0, 0.0, 0.0))), DOUBLES
    ),
    "elements.spatial.orientation:UNIT": parts_of_a_quaternion_as_given,
    "elements.spatial.relaxation:LEAST_RELAXATION_LENGTH": lambda: lagged(state=1.0)[0],
    "elements.spatial.relaxation:DAMPING": lambda: lagged(sliding=-1.0, length=1.0)[0],
    "elements.spatial.relaxation:RENEWED": lambda: lagged(state=1.0, sliding=-1.0, length=1.0)[1],
    "elements.tyres.fiala:TINY": force_without_contact,
    "elements.tyres.file_fields:DEEP": second_point_of_a_rim,
    "elements.tyres.file_fields:PRESSED": accepted_deflections,
    "elements.tyres.file_fields:RELAXED": number_of_relaxation_lengths,
    "elements.tyres.file_fields:WIDEST": widest_tyre,
    "elements.tyres.file_fields:SLIGHTLY": lambda: file_fields.nominal_load(
        {"UNLOADED_RADIUS": 1.0, "VERTICAL_STIFFNESS": 1.0}
    ),
    "elements.tyres.passivity:WITHOUT_LIMIT": lambda: checked_loads()[-1],
    "elements.tyres.passivity:LOADS": lambda: len(checked_loads()),
    "elements.tyres.property_file:UNLIMITED": lambda: executed("elements.tyres.property_file")._OF_FIALA["FZMAX"],
    "elements.tyres.property_file:NOMINAL_PRESSURE": lambda: executed("elements.tyres.property_file")._OF_6["NOMPRES"],
    "elements.tyres.steady_state:MOST_ITERATIONS": iterations_without_a_root,
    "elements.tyres.steady_state:LEAST_LOAD": least_load_of_a_search,
    "elements.tyres.steady_state:UNCARRIED": largest_error_of_the_load,
    "elements.tyres.steady_state:BEYOND": end_of_the_search,
}  # fmt: skip
EXPECTED = {
    "elements.loads:TINY": 1e-12, "elements.forces.friction:AT_REST": 1e-06, "elements.initial_pose:SAME_POINT": 27,
    "elements.joints.point_on_curve:CLOSED": 27, "elements.roads.crg:MOST_SECTIONS": 32, "elements.roads.crg:MOST_HEIGHTS": 22,
    "elements.roads.crg:STRAIGHT": 27, "elements.roads.crg:LEVEL": 6, "elements.roads.crg_grid:SAME_HEADING": 27,
    "elements.roads.envelope:MOST_TRACKS": 20, "elements.roads.grid:MOST_LINES": 31, "elements.roads.iso8608:POINTS": 4.0,
    "elements.roads.reference_line:FROZEN": 4, "elements.roads.reference_line:FOLLOWED": 2, "elements.roads.reference_line:CLOSE": 27,
    "elements.roads.reference_line:CONVERGED": 27, "elements.roads.reference_line:WIDEST": 26,
    "elements.roads.reference_line:SAMPLES_ACROSS": 11, "elements.roads.rolling_filter:FINE": 4801,
    "elements.roads.rolling_filter:BETWEEN": 4801, "elements.roads.rolling_filter:COARSE": 18, "elements.roads.rolling_filter:MOST": 18,
    "elements.roads.rolling_filter:MARGIN": 1.5, "elements.spatial.body:MOMENT_ROUNDING": 27, "elements.spatial.branches:FARTHEST": 60,
    "elements.spatial.forces.capsule_impact:PARALLEL": 1e8, "elements.spatial.forces.plane_impact:UPRIGHT": 1e-06, "elements.spatial.forces.solid_impact:ROUNDING": 0.0001,
    "elements.spatial.forces.sphere_impact:LEAST_DISTANCE": 1e-09, "elements.spatial.massless:MASSLESS": 1e-08,
    "elements.spatial.massless:NO_MOMENT": 159, "elements.spatial.orientation:ROUGH": 27, "elements.spatial.orientation:UNIT": 4,
    "elements.spatial.relaxation:LEAST_RELAXATION_LENGTH": 100.0, "elements.spatial.relaxation:DAMPING": 0.02,
    "elements.spatial.relaxation:RENEWED": -1.0, "elements.tyres.fiala:TINY": 1e-30, "elements.tyres.file_fields:DEEP": 0.1,
    "elements.tyres.file_fields:PRESSED": 40, "elements.tyres.file_fields:RELAXED": 40, "elements.tyres.file_fields:WIDEST": 5.0,
    "elements.tyres.file_fields:SLIGHTLY": 0.05, "elements.tyres.passivity:WITHOUT_LIMIT": 1.5, "elements.tyres.passivity:LOADS": 401, "elements.tyres.property_file:UNLIMITED": 1000000000000.0,
    "elements.tyres.property_file:NOMINAL_PRESSURE": 200000.0, "elements.tyres.steady_state:MOST_ITERATIONS": 200,
    "elements.tyres.steady_state:LEAST_LOAD": 1e-09, "elements.tyres.steady_state:UNCARRIED": 27, "elements.tyres.steady_state:BEYOND": 1.2,
}  # fmt: skip
