"""Decisions on scenes: beams, flexible bodies, parts, paths, settings."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.model import flexible, tuning, wheels
from stiffmbs.model.beams import axis, discretise, drawn_section, interpolation, rigid_motion, section
from stiffmbs.model.files import expand, scenes_read_before
from stiffmbs.model.parts import changes, frame, hard_points, instances
from stiffmbs.model.paths import curves, lanes
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import settings as grids
from tests.decisions.common import BELOW, Reached, Record, executed, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def accepted(call):
    """Return True if a call reaches its decision, and False if it is refused before."""
    try:
        call()
    except Reached:
        return True
    except (InputError, ValueError):
        return False
    raise AssertionError("the decision was not made")


def steepest_piece():
    def is_upright(sine):
        piece = Record(length=1.0, at=lambda _: (None, np.array([sine, 0.0, np.sqrt(1 - sine**2)])))
        return axis.upward(piece)[2] == 0.0

    return count_while(lambda sine: is_upright(1e-3 * sine), DOUBLES[:40])


def largest_rotation_of_an_element():
    def accepts(angle):
        with patch.object(discretise, "element_stiffness", lambda *_: reach(angle)):
            call = discretise._Interval._single
            return accepted(
                lambda: call(Record(_stiffness=None), [], None, (0.0, 1.0), np.array([1.0, 0.0, 0.0, angle, 0.0, 0.0]))
            )

    return count_while(accepts, np.arange(0.0, 10.0, 0.1))


def nearest_station_to_the_end():
    return count_while(lambda x: not refused(lambda: [*discretise._intervals([], {"a": 1.0 - x}, 1.0)]), BELOW)


def discretised(place=0.5):
    """Return the nodes and the tolerance of a beam of two elements, and a name at a place relative to its length."""
    wanted = Record(counts=(2,), names={"b": place}, tolerance=0.0)
    beam = Record(
        pieces=lambda: [Record(length=1.0)], dimensions=2, stations={}, elements=wanted, interpolation="pairs", section=None
    )  # fmt: skip

    def interval(*args):
        return Record(group=lambda *_: args[5].extend(Record(s=s) for s in (0.0, 0.5, 0.8, 1.0)))

    with patch.multiple(
        discretise, _intervals=lambda *_: [(beam.pieces()[0], 0.0, 0.0, 1.0)], _Interval=interval,
        Divided=lambda _total, _counts, tolerance, _names: tolerance, Line=lambda nodes, _, tolerance, _spans: (nodes, tolerance),
    ):  # fmt: skip
        return discretise.discretise(beam)


def decimals_of_a_place():
    return count_while(lambda k: discretised(0.5 + 10.0**-k)[0][1].name != "b", range(1, 16))


def triangles_of_a_section():
    pytest.importorskip("sectionproperties")

    def geometry(outline):
        return Record(create_mesh=lambda mesh_sizes: reach(outline.area / mesh_sizes[0]))

    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    with patch("sectionproperties.pre.geometry.Geometry", geometry):
        return reached(lambda: drawn_section.constants_of(square, ()))


def largest_group(turn=0.0):
    return max(size for *_, size in interpolation.group_sizes(0.0, 1.0, 24, turn))


def points_of_a_quadrature():
    places = []
    group = Record(sections=[(0.5, 1.0)])
    interpolation.Group.compliances(group, lambda place: places.append(place) or np.eye(2))
    return len(places)


def terms_of_an_exponential():
    with patch.object(rigid_motion, "_series", lambda _matrix, _coefficient, terms: terms):
        return rigid_motion.exponential(np.eye(2))


def moves_in_plane(product=0.0, offset=0.0):
    constants = Record(I23=product, I2=1.0, I3=0.5, A=1.0, shear_centre=(offset, 0.0))
    return not section.Properties.leaves_plane(constants)


def most_repeats():
    return count_while(lambda n: not refused(lambda: expand._loop("", f"k in 0..{round(1000 * n)}", {})), DOUBLES)


def read(elements=0, size=0):
    """Return True if a scene with a number of elements, and with a size in bytes, is cached."""
    scene = Record(bodies=range(elements), joints=(), forces=())
    with (
        patch("stiffmbs.model.read_scene.read_scene", lambda *_: scene),
        patch.multiple(
            scenes_read_before, _pickled=lambda _: bytes(size), _reader=str, _unpickled=nothing, entries=Record(digest=str, write=lambda *_: reach(True))
        ),
    ):  # fmt: skip
        try:
            scenes_read_before._read("", (), "", None, "name")
        except Reached:
            return True
    return False


def interface():
    """Return the mass and the radius of gyration of the body of an interface of a body of unit mass and moments."""
    reduced = Record(mass=1.0, inertia=np.eye(3), frequencies=())
    parts = flexible._Parts("a", Record(orientation=(1.0, 0.0, 0.0, 0.0)), reduced, None)
    return parts._share, np.sqrt(parts._moment / parts._share)


def largest_offset_on_an_axle():
    axis_of_both = np.array([0.0, 1.0, 0.0])

    def is_on_axle(offset):
        left, right = (Record(centre=np.array(at), axis=axis_of_both) for at in ((offset, 1.0, 0.0), (0.0, 0.0, 0.0)))
        return wheels.Wheel.to_the_left_of(left, right) != 0.0

    return count_while(lambda offset: is_on_axle(0.01 * offset), DOUBLES)


def coefficients_of_a_note():
    mounted = Record(mounted_side=lambda: ("data", 1, ["p"] * 20))
    found = [
        Record(tyre=name, to_the_left_of=lambda _, place=place: place) for name, place in (("l", 1.0), ("r", -1.0))
    ]
    with patch.multiple(wheels, tyres_of=lambda _: {"l": mounted, "r": mounted}, wheels_of=lambda _: found):
        (note,) = wheels.mounted_alike(None)
    return note.count("p,") + note.count("p and others")


def largest_oblique_entry():
    def is_straight(entry):
        angle = np.arcsin(entry) / 2
        c, s = np.cos(angle), np.sin(angle)
        found = frame.Frame.ground_signs
        whole = Record(rotation=np.array([[c, -s], [s, c]]), signs=(1.0, -1.0))
        return (found.fget if isinstance(found, property) else found)(whole) is not None

    return count_while(lambda entry: is_straight(1e-8 * entry), DOUBLES[:80])


def largest_shift_to_the_right():
    def accepts(shift):
        places = {"a": (-shift,), "b": (0.0,)}
        return not refused(
            lambda: hard_points.check_left_and_right("", {"left": "a", "right": "b"}, places.__getitem__, (1.0,))
        )

    return count_while(lambda shift: accepts(1e-5 * shift), DOUBLES)


def farthest_hard_point():
    def accepts(distance):
        points = {hard_points.WHEEL: (0.0, 1.0, 0.0), "a": (distance, 1.0, 0.0)}
        default = {f"{hard_points.WHEEL}_y": Record(value=1.0)}
        with patch.object(hard_points, "_points", lambda *_: points):
            return not refused(
                lambda: hard_points.check_hard_points(Record(part="", parameters={}), "", None, {}, default)
            )

    return count_while(lambda distance: accepts(0.1 * distance), DOUBLES)


def deepest_parts():
    def accepts(depth):
        definitions = Record(use=lambda *_: (Record(part="a"), {}))
        found = Record(definitions=definitions, words={}, later=changes.Later(), _add=nothing)
        with patch.multiple(instances, repeat_entries=lambda _where, used, _: used, _check_name=nothing):
            return not refused(lambda: instances.Instances.read(found, {"a": {}}, {}, None, depth))

    return count_while(accepts, range(100))


def most_instances():
    def accepts(count):
        found = Record(found=range(round(100 * count)), definitions=Record(of=reach))
        return accepted(lambda: instances.Instances._add(found, "a", Record(part=""), {}, "", {}, None, 0))

    return count_while(accepts, DOUBLES)


def most_values_of_parts():
    def accepts(count):
        with patch.object(instances, "_size", lambda *_: round(count)):
            return not refused(lambda: instances.Instances._count(Record(values=0), "", None))

    return count_while(lambda count: accepts(1e4 * count), DOUBLES)


def samples_between_stations():
    curve = curves.circle(100.0, 100.0, 0.0, 0.0)
    with patch("scipy.spatial.cKDTree", lambda points: reach(len(points) / len(curve.s))):
        return reached(lambda: curve.nearest(np.zeros(1), np.zeros(1)))


def smoothest_path():
    """Return the weights of curvature and anchor, the part of a lane that is used, and numbers of stations and limits."""
    lane = lanes.Lane(start=0.0, end=50.0, left=1.0, right=-1.0)

    def solved(rows, _right, within, least):
        reach(
            (
                np.max(np.abs(rows)) * lanes.CURVES.spacing**3 / 3,
                np.max(np.abs(rows[-40:])),
                np.max(np.abs(least)),
                rows.shape[1],
            )
        )

    with patch.object(lanes, "_least_squares_within", solved):
        return reached(lambda: lanes.path_through((lane,), 0.0, 10.0, 100.0))


def limits_of_a_path():
    """Return the number of limits of a path for a vehicle of the default length."""
    lane = lanes.Lane(start=0.0, end=50.0, left=1.0, right=-1.0)
    with patch.object(lanes, "_least_squares_within", lambda _rows, _right, within, _least: reach(len(within))):
        return reached(lambda: lanes.path_through((lane,), 0.0, 9.0, 100.0))


def farthest_limit():
    one = np.eye(1)

    def accepts(least):
        return lanes._least_squares_within(one, np.zeros(1), one, np.array([least])) is not None

    return count_while(accepts, DOUBLES)


def latest_distinguished_run():
    """Return the start of a run of 1 s, in quarter octaves of 1e6 s, whose times are distinguished."""

    def accepts(start):
        run = Record(duration=1.0, points=None, output=None, start=start)
        return not refused(lambda: RunSettings._one_grid(run))

    return count_while(lambda start: accepts(1e6 * start), DOUBLES)


DECISIONS = {
    "model.beams.axis:NEARLY": lambda: count_while(
        lambda sine: not refused(lambda: axis.frame(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, sine]))), BELOW
    ),
    "model.beams.axis:ACROSS": steepest_piece,
    "model.beams.discretise:LARGEST_ROTATION": largest_rotation_of_an_element,
    "model.beams.discretise:SAME": nearest_station_to_the_end,
    "model.beams.discretise:PLACES": decimals_of_a_place,
    "model.beams.division:MOST_ELEMENTS": lambda: executed("model.beams.division")._NUMBER.at_most,
    "model.beams.division:FIRST": lambda: executed("model.beams.division").Elements().number,
    "model.beams.division:AUTOMATIC": lambda: discretised()[1],
    "model.beams.drawn_section:ELEMENTS": triangles_of_a_section,
    "model.beams.drawn_section:SYMMETRIC": lambda: count_while(
        lambda length: drawn_section._without_error(length, 1.0) > 0.0, BELOW
    ),
    "model.beams.interpolation:LARGEST": largest_group,
    "model.beams.interpolation:LARGEST_TURN": lambda: count_while(
        lambda turn: largest_group(turn) > 1, np.arange(0.0, 100.0, 1.0)
    ),
    "model.beams.interpolation:QUADRATURE": points_of_a_quadrature,
    "model.beams.rigid_motion:TERMS": terms_of_an_exponential,
    "model.beams.section:PRINCIPAL": lambda: count_while(lambda x: moves_in_plane(product=1e-8 * x), DOUBLES),
    "model.beams.section:CENTRED": lambda: count_while(lambda x: moves_in_plane(offset=1e-4 * x), DOUBLES),
    "model.files.expand:MOST_REPEATS": most_repeats,
    "model.files.scenes_read_before:MOST_ELEMENTS": lambda: count_while(
        lambda count: read(elements=round(100 * count)), DOUBLES
    ),
    "model.files.scenes_read_before:LARGEST": lambda: count_while(lambda size: read(size=round(1e6 * size)), DOUBLES),
    "model.flexible:SHARE": lambda: interface()[0],
    "model.flexible:SMALL": lambda: interface()[1],
    "model.flexible:SAME_SHAPES": lambda: count_while(
        lambda size: not refused(lambda: flexible._nearest(np.eye(2), np.diag([1.0, size]), "a")), 1.1 * BELOW
    ),
    "model.wheels:ALONG": largest_offset_on_an_axle,
    "model.wheels:NAMED": coefficients_of_a_note,
    "model.wheels:ON_MIDDLE_PLANE": lambda: count_while(
        lambda y: wheels.side_of(np.array([0.0, y, 0.0])) == "left", BELOW
    ),
    "model.parts.frame:STRAIGHT": largest_oblique_entry,
    "model.parts.hard_points:SAME_PLACE": largest_shift_to_the_right,
    "model.parts.hard_points:FARTHEST": farthest_hard_point,
    "model.parts.instances:MOST_NESTED": deepest_parts,
    "model.parts.instances:MOST_INSTANCES": most_instances,
    "model.parts.instances:MOST_VALUES": most_values_of_parts,
    "model.paths.curves:Stations.spacing": lambda: len(curves.circle(100.0, 1000.0, 0.0, 0.0).s),
    "model.paths.curves:Stations.outlet": lambda: -curves.straightened(curves.circle(100.0, 1000.0, 0.0, 0.0)).s[0],
    "model.paths.curves:Stations.most_stations": lambda: len(curves.circle(100.0, 1e6, 0.0, 0.0).s),
    "model.paths.curves:Stations.samples": samples_between_stations,
    "model.paths.lanes:ROUGHNESS": lambda: smoothest_path()[0],
    "model.paths.lanes:ANCHOR": lambda: smoothest_path()[1],
    "model.paths.lanes:USED": lambda: smoothest_path()[2],
    "model.paths.lanes:STRAIGHT": lambda: smoothest_path()[3],
    "model.paths.lanes:LENGTH": limits_of_a_path,
    "model.paths.lanes:MARGIN": farthest_limit,
    "model.settings:DEFAULT_RTOL": lambda: executed("model.settings").RunSettings.model_fields["rtol"].default,
    "model.settings:DEFAULT_POINTS": lambda: len(
        grids.output_grid(Record(points=None, output=None, start=0.0, duration=1.0)).times
    ),
    "model.settings:FEWEST_APART": latest_distinguished_run,
    "model.settings:ROUNDINGS_APART": latest_distinguished_run,
    "model.tuning:MOST": lambda: count_while(
        lambda value: not refused(lambda: tuning._checked("", round(10 * value), 1, round)), DOUBLES
    ),
}  # fmt: skip
EXPECTED = {
    "model.beams.axis:NEARLY": 119, "model.beams.axis:ACROSS": 27, "model.beams.discretise:LARGEST_ROTATION": 31,
    "model.beams.discretise:SAME": 159, "model.beams.discretise:PLACES": 10, "model.beams.division:MOST_ELEMENTS": 10000,
    "model.beams.division:FIRST": 4, "model.beams.division:AUTOMATIC": 0.001, "model.beams.drawn_section:ELEMENTS": 300.0,
    "model.beams.drawn_section:SYMMETRIC": 40, "model.beams.interpolation:LARGEST": 4, "model.beams.interpolation:LARGEST_TURN": 31,
    "model.beams.interpolation:QUADRATURE": 8, "model.beams.rigid_motion:TERMS": 30, "model.beams.section:PRINCIPAL": 27,
    "model.beams.section:CENTRED": 27, "model.files.expand:MOST_REPEATS": 27, "model.files.scenes_read_before:MOST_ELEMENTS": 23,
    "model.files.scenes_read_before:LARGEST": 10, "model.flexible:SHARE": 0.001, "model.flexible:SMALL": 0.001, "model.flexible:SAME_SHAPES": 1,
    "model.wheels:ALONG": 14, "model.wheels:NAMED": 3, "model.wheels:ON_MIDDLE_PLANE": 80,
    "model.parts.frame:STRAIGHT": 27, "model.parts.hard_points:SAME_PLACE": 27,
    "model.parts.hard_points:FARTHEST": 23, "model.parts.instances:MOST_NESTED": 10, "model.parts.instances:MOST_INSTANCES": 27,
    "model.parts.instances:MOST_VALUES": 27, "model.paths.curves:Stations.spacing": 401, "model.paths.curves:Stations.outlet": 20.0, "model.paths.curves:Stations.most_stations": 2001,
    "model.paths.curves:Stations.samples": 8.0, "model.paths.lanes:ROUGHNESS": 30.0, "model.paths.lanes:ANCHOR": 0.001,
    "model.paths.lanes:USED": 0.5, "model.paths.lanes:STRAIGHT": 34, "model.paths.lanes:LENGTH": 156, "model.paths.lanes:MARGIN": 60, "model.settings:DEFAULT_RTOL": 1e-06, "model.settings:DEFAULT_POINTS": 1001,
    "model.settings:FEWEST_APART": 63, "model.settings:ROUNDINGS_APART": 63, "model.tuning:MOST": 27,
}  # fmt: skip
