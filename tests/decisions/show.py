"""Decisions on what is shown: sizes of drawings and symbols, numbers of rows, digits, instants of pages."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.analyses.linearised import modes, modes_table
from stiffmbs.notes import Note
from stiffmbs.reading.units.display import SI_UNITS
from stiffmbs.show import (
    curves,
    figure,
    finding,
    flexible_body,
    force_table,
    html,
    loads,
    loads_shown,
    report,
    sections,
    suspension,
    tyre,
)
from stiffmbs.show.drawing import as_json, bodies, deformed, derive, film, painted, picture, poses, solids, surroundings
from stiffmbs.show.drawing.symbols import profiles, shared, spatial
from stiffmbs.show.page import data
from stiffmbs.show.page import modes as page_of_modes
from stiffmbs.show.page import study as page_of_study
from tests.decisions.common import BELOW, Reached, Record, module, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

summary = module("show.summary")


def decimals(number):
    return len(str(number).partition(".")[2])


def largest_difference_of_wheels():
    def is_left_out(more):
        body = Record(geometry=[Record(type="cylinder", radius=1.0 + more)], center_of_mass=(0.0, 0.0, 0.0))
        with patch.object(bodies, "_shape", lambda *_: reach(True)):
            try:
                return not bodies.given_shapes("a", body, 3, 1.0)
            except Reached:
                return False

    return count_while(lambda more: is_left_out(0.01 * more), DOUBLES)


def distance_of_equal_points():
    with patch.object(bodies, "_distinct", lambda _, distance: reach(distance)):
        return reached(lambda: bodies.derived_shape("a", None, 3, (), 1.0, 1.0))


def parts_of_stresses():
    parts = []
    solid = Record(stresses=True, vertices=range(1000))
    motion = Record(time=range(10_000), stresses=lambda _, rows: parts.append(1) or np.zeros(1))
    deformed.largest_stress([Record(solids=[solid])], motion)
    return len(parts) - 1


def derived(elements=(), n_joints=1, own=None):
    """Return the unit of symbols, or half the thickness of a bar, of a mechanism of size 1."""
    model = Record(bodies=own or {}, joints=range(n_joints), forces=(), dimensions=3)
    with patch.multiple(
        derive, described_poses=nothing, _Sites=lambda *_: Record(on_bodies=lambda: {"a": []}), _wheels=lambda _: {}, _first_nodes=lambda _: {},
        interface_bodies=lambda _: {}, modal_bodies=lambda _: (), given_shapes=lambda *_: [], _size=lambda *_: 1.0,
        body_colors=lambda _: {}, _elements=lambda _: elements, _drawn=lambda *args: reach(args[-2]),
        derived_shape=lambda *args: reach(args[-1]),
    ):  # fmt: skip
        return reached(lambda: derive.drawing_of(model))


def distance_of_symbols():
    element = Record(parts=lambda _: [])
    model = Record(joints={}, dimensions=2, gravity=(0.0, -1.0))
    with patch.multiple(derive, _ends=lambda *_: (1, 2), Draft=lambda *args: reach(args[7])):
        return reached(lambda: derive._drawn("e", element, model, None, 1.0, {}, 1.0, ()))


def opacity_of_other_runs():
    with patch.multiple(film, painted=lambda *_: [], paint=lambda _axes, _patches, opacity: reach(opacity)):
        return reached(lambda: film._frame(None, None, [None, None], 0, None, 1.0))


def seen_line(role):
    """Return the distance of a line before the plane of the picture, and before faces there."""
    line = Record(points=np.zeros((1, 3)))
    part = Record(body="a", role=role, owner="a", solids=[], lines=[line])
    drawing = Record(dimensions=3, size=1.0, stress=0.0)
    motion = Record(pose=lambda *_: (np.zeros(3), np.eye(3)))
    with patch.multiple(
        painted,
        face_color=nothing,
        edge_color=nothing,
        _wider=nothing,
        _line=lambda seen, *args: reach((seen[0, 2], args[-1])),
    ):
        return reached(lambda: [*painted._part(drawing, part, motion, 0, Record(seen=lambda x: x))])


def opacity_of_shadows():
    with patch.object(painted, "shadows", lambda *_: [np.zeros((1, 3))]):
        return next(painted._shadows(Record(size=1.0), None, 0, Record(seen=lambda x: x))).opacity


def longest_arrow():
    anchor = Record(body="a", point=np.zeros(3))
    drawing = Record(loads={"f": anchor}, size=1.0, unit=1.0, marks={})
    motion = Record(forces={"f": [np.array([1.0, 0.0, 0.0])]}, pose=lambda *_: (np.zeros(3), np.eye(3)))
    with patch.object(painted, "_arrow", lambda _start, vector, *_: reach(np.linalg.norm(vector))):
        return reached(lambda: [*painted._loads(drawing, motion, 0, Record(seen=lambda x: x), 1.0)])


def longest_head():
    line, _ = painted._arrow(np.zeros(2), np.array([100.0, 0.0]), "", 1.0, 1.0)
    return 100.0 - line.points[1, 0]


def width_of_a_picture():
    with patch.object(picture, "new_sheet", lambda size, _: reach(size[0])):
        return reached(lambda: picture.empty_sheet(np.zeros(2), np.array([1.0, 0.01])))


def written_names(count):
    """Return the sizes of the letters of names of elements."""
    sizes = []
    axes = Record(
        get_figure=lambda: Record(get_figwidth=lambda: 8.0),
        get_xlim=lambda: (0.0, 1.0),
        text=lambda *_, fontsize, **__: sizes.append(fontsize),
    )
    name = Record(role="joint", text="a", anchor=Record(body="a", point=np.zeros(3)))
    motion = Record(pose=lambda *_: (np.zeros(3), np.eye(3)))
    with patch.object(picture, "_free_place", lambda point, *_: point):
        picture.write_names(axes, Record(names=[name] * count, marks={}), motion, 0, Record(seen=lambda x: x))
    return sizes


def farthest_view():
    def is_fixed(distance):
        drawing = Record(heaviest="a", size=1.0)
        with patch.object(poses, "path_of", lambda *_: np.array([[distance, 0.0, 0.0]])):
            return not poses.followed_body(drawing, Record(points={"a": None}))

    return count_while(lambda distance: is_fixed(0.1 * distance), DOUBLES)


def steepest_direction():
    def is_level(cosine):
        return solids.across(np.array([np.sqrt(1 - cosine**2), 0.0, cosine]))[0][1] > 0.0

    return count_while(is_level, np.arange(0.0, 1.0, 0.05))


def most_faces_with_edges():
    def has_edges(count):
        mesh = Record(vertices=np.zeros((1, 3)), faces=range(count))
        shape = Record(type="mesh", file="a", scale=(1.0, 1.0, 1.0))
        with (
            patch.multiple(bodies, read_mesh=lambda *_: mesh, Solid=lambda *_: "bare"),
            patch.object(solids, "edged", lambda _: "edged"),
        ):
            return bodies._shape(shape, 3, "")[0] == ("edged",)

    return count_while(lambda count: has_edges(round(100 * count)), DOUBLES)


def lines_of_a_floor():
    drawing = Record(size=4.0, gravity=np.array([0.0, 0.0, -1.0]))
    with patch.object(surroundings, "_reached", lambda *_: (np.zeros(3), np.zeros(3))):
        return len(surroundings._floor(drawing, None).lines)


def margin_of_a_road():
    motion = Record(points={"a": np.zeros((1, 3))})
    with patch.object(surroundings, "_along", lambda _road, _low, high, _size: reach(high)):
        return reached(lambda: surroundings._road(None, ["a"], Record(size=1.0), motion))


def along(extent=None):
    return len(surroundings._along(Record(level=False, extent=lambda: extent), 0.0, 100.0, 1.0))


def longest_dense_road():
    return count_while(lambda length: along((0.0, length)) > along(), DOUBLES[:40])


def points_across():
    road = Record(heights=lambda x, _: 0 * x)
    drawing = Record(size=1.0)
    with patch.multiple(surroundings, _along=lambda *_: np.arange(3.0), _surface=lambda points: reach(points.shape[1])):
        return reached(lambda: surroundings._road(road, ["a"], drawing, Record(points={"a": np.zeros((1, 3))})))


def instants_of_a_floor():
    seen = []
    motion = Record(time=range(1000), pose=lambda _, k: seen.append(k) or (None, None))
    surroundings._reached(Record(parts=[Record(role="body", body="a", solids=(), lines=())]), motion)
    return len(seen)


def farthest_torque():
    def is_at_its_marker(distance):
        site = Record(point=np.array([distance, 0.0, 0.0]))
        draft = Record(i=site, size=1.0, u=1.0, put=lambda site, *_: reach(site is not None))
        with patch.object(shared, "replace", lambda *_, **__: None):
            return reached(lambda: shared.torque(draft, draft.i, None))

    return count_while(lambda distance: is_at_its_marker(1e-3 * distance), DOUBLES)


def width_of_a_wheel():
    with patch.multiple(
        spatial, radius_of=lambda _: 1.0, coefficient=lambda *_: 0.0,
        lathe=lambda profile, _: reach(np.max(profile[:, 1]) / np.max(spatial.PROFILE[:, 1])),
    ):  # fmt: skip
        return reached(lambda: spatial.wheel(Record(element=None, put=nothing), Record(with_axes=nothing), None))


def spokes_of_a_wheel():
    shapes = []
    draft = Record(
        element=None, i=Record(with_axes=nothing), put=lambda _site, _role, *found, **__: shapes.append(found)
    )
    with patch.multiple(spatial, radius_of=lambda _: 1.0, coefficient=lambda *_: 0.0):
        spatial.wheel(draft, draft.i, None)
    return len(shapes[1]) - 1


def length_of_a_spoke():
    with patch.object(solids, "box", lambda size: reach(size[0])):
        return reached(lambda: spatial._spoke(1.0, 1.0))


def size_of_a_figure():
    with patch.object(figure, "new_sheet", lambda size: reach(sum(size))):
        return reached(lambda: figure.drawn(None, None))


def most_plots():
    def has_plots(count):
        run = Record(unit=lambda channel: channel, display=SI_UNITS)
        sheet = Record(subplots=lambda rows, **_: reach(rows))
        shown = Record(z="", y=[str(k) for k in range(count)])
        return reached(lambda: figure.draw_runs(sheet, {"": run}, shown)) == count

    return count_while(has_plots, range(1, 40))


def largest_condition():
    return count_while(lambda x: not flexible_body._notes(Record(notes=(), dependent=0, condition=1e10 * x)), DOUBLES)


def largest_silent_share():
    """Return the share of the strain energy, in quarter octaves of 1e-4, up to which no note says that it is not represented."""

    def is_silent(share):
        return not flexible_body._notes_on_motion(Record(name="a", unrepresented=lambda: (1e-4 * share, 0.0)))

    return count_while(is_silent, DOUBLES)


def most_loads():
    with patch.multiple(summary, elements_of=lambda _: range(100), force_rows=lambda _, most: reach(most)):
        return reached(lambda: summary._print_loads(Record(display=SI_UNITS), None, str, False))


def most_drawn():
    def is_drawn(count):
        with (
            patch.object(html, "find_spec", lambda _: True),
            patch("stiffmbs.show.drawing.draw.state_drawn", lambda *_, **__: reach(True)),
        ):
            try:
                return html._drawing(None, count) != ""
            except Reached:
                return True

    return count_while(is_drawn, range(1, 1000, 7))


def named_bodies(shares):
    named = modes_table.bodies_of({str(k): share for k, share in enumerate(shares)})
    return named.split(", ") if named else []


def printed_modes():
    found = modes.Modes("", 0.0, 0, (), None, (), None, None)
    with patch.object(modes, "mode_lines", lambda _, most: reach(most)):
        return reached(lambda: str(found))


def poses_of_a_page(n_points):
    motion = Record(points=range(n_points), forces=())
    with patch.multiple(
        data, drawing_json=nothing, largest_force=nothing, _motion=lambda _poses, _packed, most: reach(most)
    ):
        return reached(lambda: data.page_data(Record(size=1.0), {"": motion}))


def poses_of_a_second():
    motion = Record(time=np.array([0.0, 1.0]), resampled=lambda times: reach(len(times)))
    return reached(lambda: data._motion(motion, None, 10_000))


def instants_of_channels(n_channels):
    run = Record(channels={}, time=np.arange(10_000.0), not_unique=())
    return len(data._channels(run, None, (), range(n_channels))["time"])


def shown_mode():
    """Return the amplitude and the number of points of a shown mode."""
    found = Record(modes=[Record(motion=None)], shape=lambda _number, *args: reach(args))
    return reached(lambda: page_of_modes.modes_data(found))


def most_lines():
    def is_drawn(points):
        with patch.object(report, "data_url", lambda _sheet, kind, _: kind):
            return report._embedded(None, points) == "svg"

    return count_while(lambda points: is_drawn(100 * points), DOUBLES)


def differences():
    """Return the numbers of rows and of figures of channels that differ."""
    one = Record(relative=1.0, channel="a")
    run = Record(channels={"a": 0.0}, time=[0.0], unit=lambda _: "N", provenance=None, display=SI_UNITS)
    with patch.multiple(
        sections, differences=lambda *_: [one] * 100, _row=nothing, curve_chart=nothing, changed_values=lambda *_: (),
        _changed_loads=lambda *_: (), Table=lambda _heads, rows: Record(rows=rows),
        Section=lambda _title, _head, tables, drawings: (len(tables[0].rows), len(drawings)),
    ):  # fmt: skip
        return sections.differences_section(run, "b", run, Record())


def steps_of_an_axis():
    return 100.0 / curves.round_step(100.0)


def points_of_a_curve():
    return len(curves._thinned(np.arange(10**4), np.zeros(10**4))[0])


def least_span():
    """Return the span of an axis about 1, in quarter octaves, down to which it is that of the values."""
    return count_while(lambda span: curves._range(np.array([1.0, 1.0 + span]))[1] < 1.05, 0.01 * BELOW)


def width_of_a_label():
    curve = curves.Curve("", np.array([0.0, 1.0]), np.array([-1e9, -0.9e9]))
    drawn = curves.curve_chart([curve], "", "", includes_zero=False)
    return float(drawn.partition('line x1="')[2].partition('"')[0])


def bold_part():
    turned = np.column_stack([np.linspace(0.0, 1.0, 101), np.zeros(101)])
    return curves.polar_chart(turned, 1.0, "", "", "").partition('class="bold"')[2].partition("/>")[0].count(",")


def fewest_digits():
    def is_in_question(digits):
        judged = Record(status="done", headline="", digits={"forces": digits}, to_check=())
        with patch.object(finding, "_few", lambda _: ""):
            return finding.finding(judged, Record(notes=(Note("a"),)), ()).status == "doubt"

    return count_while(is_in_question, range(100))


def finest_bar():
    return float(loads.Column("N", 1.0).words(1.0, 0.0).partition(" \N{PLUS-MINUS SIGN} ")[2])


def rows_and_curves():
    """Return the numbers of loads in a table before it is folded, and in a chart."""
    load = Record(unit="N", peak=1.0, magnitude=0.0, time=0.0, unique=True, display=SI_UNITS)
    with (
        patch.multiple(
            loads_shown, load_rows=lambda found, *_: found, spark_line=nothing, _charts=lambda found, *_: len(found)
        ),
        patch.object(loads_shown, "Group", lambda _title, _unit, rows, _folded, charts, _unique: (len(rows), charts)),
    ):
        return loads_shown._group("N", [load] * 100, {}, None)


def narrowest_picture():
    with patch.object(picture, "new_sheet", lambda size, _: reach(size[0])):
        return reached(lambda: picture.empty_sheet(np.zeros(2), np.array([0.01, 1.0])))


def highest_picture():
    with patch.object(picture, "new_sheet", lambda size, _: reach(size[1] - 0.5)):
        return reached(lambda: picture.empty_sheet(np.zeros(2), np.array([0.01, 1.0])))


def width_of_a_text():
    with patch.multiple(summary, escaping_console=lambda file, width: reach(width)):
        return reached(lambda: summary.summary(Record(name="")))


def cases_of_a_table():
    return len(page_of_study._table_of_cases([{"case": 0, "status": ""}] * 1000, (), ()).tables[0].rows)


def width_of_a_page():
    panels = [Record(case="c")] * 20
    with (
        patch.multiple(suspension, PANELS=panels, curves_of=lambda *_: True),
        patch("matplotlib.figure.Figure", lambda figsize, **_: reach(figsize[0])),
    ):
        return reached(lambda: suspension.kc_figure(Record(sweeps={"c": None})))


def smallest_shown_measure():
    def is_shown(value):
        with patch.object(suspension, "_columns", lambda _: ["c"]):
            return suspension._row(None, "", {"c.n": value}, "n", "")[1] != "0"

    return count_while(is_shown, BELOW)


def size_of_a_tyre_figure():
    with patch.object(tyre, "new_sheet", lambda size: reach(sum(size))):
        return reached(lambda: tyre.tyre_figure("", ()))


DECISIONS = {
    "show.drawing.as_json:DIGITS": lambda: decimals(as_json._numbers(np.array([1 / 3]), 1.0)[0]),
    "show.drawing.bodies:SAME_WHEEL": largest_difference_of_wheels,
    "show.drawing.bodies:SAME_POINT": distance_of_equal_points,
    "show.drawing.deformed:AT_ONCE": parts_of_stresses,
    "show.drawing.derive:UNIT": lambda: derived([("e", None)]),
    "show.drawing.derive:CROWDED": lambda: derived([("e", None)], n_joints=20),
    "show.drawing.derive:THICK": lambda: derived(own={"a": None}),
    "show.drawing.derive:FRONT": distance_of_symbols,
    "show.drawing.film:MOST_FRAMES": lambda: count_while(
        lambda end: not refused(lambda: film.Playback().instants(0.0, end)), DOUBLES
    ),
    "show.drawing.film:SHORTEST_FILM": lambda: len(film.Playback().instants(0.0, 1.0)),
    "show.drawing.film:FAINT": opacity_of_other_runs,
    "show.drawing.film:Playback.rate": lambda: len(film.Playback().instants(0.0, 10.0)),
    "show.drawing.painted:SYMBOLS_BEFORE": lambda: seen_line("joint")[0],
    "show.drawing.painted:FOREMOST": lambda: seen_line("joint")[1],
    "show.drawing.painted:FLOOR_DEPTH": lambda: seen_line("floor")[0],
    "show.drawing.painted:SHADOW": opacity_of_shadows,
    "show.drawing.painted:LONGEST_ARROW": longest_arrow,
    "show.drawing.painted:HEAD": longest_head,
    "show.drawing.picture:WIDTH": width_of_a_picture, "show.drawing.picture:HEIGHT": highest_picture,
    "show.drawing.picture:NARROWEST": narrowest_picture, "show.curves:MOST_STEPS": steps_of_an_axis,
    "show.curves:MOST_POINTS": points_of_a_curve, "show.curves:BOLD": bold_part,
    "show.curves:LEAST_SPAN": least_span, "show.curves:CHARACTER": width_of_a_label, "show.finding:LEAST_DIGITS": fewest_digits,
    "show.loads:FINEST": finest_bar,
    "show.loads_shown:MOST_SHOWN": lambda: rows_and_curves()[0],
    "show.loads_shown:MOST_CURVES": lambda: rows_and_curves()[1],
    "show.drawing.picture:MOST_NAMES": lambda: count_while(lambda count: written_names(count), range(1, 200)),
    "show.drawing.picture:MANY_NAMES": lambda: written_names(20)[0],
    "show.drawing.picture:SMALLEST": lambda: written_names(60)[0],
    "show.drawing.poses:FAR": farthest_view,
    "show.drawing.solids:ALONG": steepest_direction,
    "show.drawing.solids:MOST_FACES": most_faces_with_edges,
    "show.drawing.solids:ROUND": lambda: len(solids.circle(1.0)) - 1,
    "show.drawing.surroundings:SurroundingsParameters.margin": margin_of_a_road,
    "show.drawing.surroundings:SurroundingsParameters.lines": lines_of_a_floor,
    "show.drawing.surroundings:SurroundingsParameters.along": along,
    "show.drawing.surroundings:SurroundingsParameters.dense": lambda: along((1.0, 2.0)) - along(),
    "show.drawing.surroundings:SurroundingsParameters.short": longest_dense_road,
    "show.drawing.surroundings:SurroundingsParameters.across": points_across,
    "show.drawing.surroundings:SurroundingsParameters.instants": instants_of_a_floor,
    "show.drawing.symbols.profiles:TURNS": lambda: len(profiles.zigzag(1.0)),
    "show.drawing.symbols.shared:FAR_OFF": farthest_torque,
    "show.drawing.symbols.spatial:WIDTH": width_of_a_wheel,
    "show.drawing.symbols.spatial:RIM_RADIUS": length_of_a_spoke,
    "show.drawing.symbols.spatial:SPOKES": spokes_of_a_wheel,
    "show.figure:SIZE": size_of_a_figure,
    "show.figure:MOST_PLOTS": most_plots,
    "show.flexible_body:MOST_FREQUENCIES": lambda: flexible_body._listed(np.arange(100.0)).count(" ") - 1,
    "show.flexible_body:UNREPRESENTED": largest_silent_share,
    "show.flexible_body:LARGE_CONDITION": largest_condition,
    "show.force_table:PLENTY": lambda: decimals(force_table.with_bar(1 / 3, 1e-30).partition(" ")[0]),
    "show.force_table:LEAST_WITHOUT_EXPONENT": lambda: count_while(
        lambda value: "e" not in force_table.with_bar(value, 1e-3 * value), BELOW
    ),
    "show.force_table:Loads.most": most_loads,
    "show.html:MOST_ROWS": lambda: html._table(["a"], [["x"]] * 200).count("<td>x"),
    "show.html:MOST_DRAWN": most_drawn,
    "analyses.linearised.modes:ON_A_SCREEN": printed_modes,
    "analyses.linearised.modes_table:MOST_BODIES": lambda: len(named_bodies([0.1] * 20)) - 1,
    "analyses.linearised.modes_table:LEAST_SHARE": lambda: count_while(lambda share: named_bodies([share]), BELOW),
    "show.page.data:MOST_POSES": lambda: poses_of_a_page(1),
    "show.page.data:POSE_VALUES": lambda: poses_of_a_page(100),
    "show.page.data:POSES_A_SECOND": poses_of_a_second,
    "show.page.data:CHANNEL_VALUES": lambda: instants_of_channels(1000),
    "show.page.data:MOST_INSTANTS": lambda: instants_of_channels(1),
    "show.page.modes:POINTS": lambda: shown_mode()[1],
    "show.page.modes:AMPLITUDE": lambda: shown_mode()[0],
    "show.report:MOST_LINES": most_lines,
    "show.sections:MOST_ROWS": lambda: differences()[0],
    "show.sections:MOST_FIGURES": lambda: differences()[1],
    "show.page.study:MOST_CASES": cases_of_a_table,
    "show.summary:UNBROKEN": width_of_a_text,
    "show.suspension:COLUMNS": width_of_a_page,
    "show.suspension:ROUNDING": smallest_shown_measure,
    "show.tyre:SIZE": size_of_a_tyre_figure,
}  # fmt: skip
EXPECTED = {
    "show.drawing.as_json:DIGITS": 6, "show.drawing.bodies:SAME_WHEEL": 18, "show.drawing.bodies:SAME_POINT": 0.001,
    "show.drawing.deformed:AT_ONCE": 10, "show.drawing.derive:UNIT": 0.024, "show.drawing.derive:CROWDED": 0.016970562748477143,
    "show.drawing.derive:THICK": 0.02, "show.drawing.derive:FRONT": 2.0, "show.drawing.film:MOST_FRAMES": 28, "show.drawing.film:FAINT": 0.4,
    "show.drawing.film:SHORTEST_FILM": 101,
    "show.drawing.film:Playback.rate": 251, "show.drawing.painted:SYMBOLS_BEFORE": 0.03, "show.drawing.painted:FOREMOST": 0.004,
    "show.drawing.painted:FLOOR_DEPTH": -1000.0, "show.drawing.painted:SHADOW": 0.07, "show.drawing.painted:LONGEST_ARROW": 0.22,
    "show.drawing.painted:HEAD": 1.25, "show.drawing.picture:WIDTH": 8.0, "show.drawing.picture:HEIGHT": 6.0,
    "show.drawing.picture:NARROWEST": 3.4, "show.curves:MOST_STEPS": 5, "show.curves:MOST_POINTS": 801, "show.curves:BOLD": 11, "show.curves:LEAST_SPAN": 93, "show.curves:CHARACTER": 65,
    "show.finding:LEAST_DIGITS": 2, "show.loads:FINEST": 1e-5, "show.loads_shown:MOST_SHOWN": 20, "show.loads_shown:MOST_CURVES": 4,
    "show.drawing.picture:MOST_NAMES": 60,
    "show.drawing.picture:MANY_NAMES": 6.495190528383289, "show.drawing.picture:SMALLEST": 4.5, "show.drawing.poses:FAR": 18,
    "show.drawing.solids:ALONG": 18, "show.drawing.solids:MOST_FACES": 23, "show.drawing.solids:ROUND": 24,
    "show.drawing.surroundings:SurroundingsParameters.margin": 0.5, "show.drawing.surroundings:SurroundingsParameters.lines": 10,
    "show.drawing.surroundings:SurroundingsParameters.along": 240, "show.drawing.surroundings:SurroundingsParameters.dense": 160,
    "show.drawing.surroundings:SurroundingsParameters.short": 14, "show.drawing.surroundings:SurroundingsParameters.across": 9,
    "show.drawing.surroundings:SurroundingsParameters.instants": 24, "show.drawing.symbols.profiles:TURNS": 16,
    "show.drawing.symbols.shared:FAR_OFF": 27, "show.drawing.symbols.spatial:WIDTH": 0.62, "show.drawing.symbols.spatial:RIM_RADIUS": 0.56,
    "show.drawing.symbols.spatial:SPOKES": 5, "show.figure:SIZE": 13, "show.figure:MOST_PLOTS": 6, "show.flexible_body:MOST_FREQUENCIES": 13,
    "show.flexible_body:UNREPRESENTED": 27, "show.flexible_body:LARGE_CONDITION": 27, "show.force_table:PLENTY": 9, "show.force_table:LEAST_WITHOUT_EXPONENT": 40,
    "show.force_table:Loads.most": 10, "show.html:MOST_ROWS": 40, "show.html:MOST_DRAWN": 29,
    "analyses.linearised.modes:ON_A_SCREEN": 20, "analyses.linearised.modes_table:MOST_BODIES": 4, "analyses.linearised.modes_table:LEAST_SHARE": 26, "show.page.data:MOST_POSES": 1200, "show.page.data:POSE_VALUES": 342,
    "show.page.data:POSES_A_SECOND": 60, "show.page.data:CHANNEL_VALUES": 450, "show.page.data:MOST_INSTANTS": 2000,
    "show.page.modes:POINTS": 31, "show.page.modes:AMPLITUDE": 0.05, "show.report:MOST_LINES": 23, "show.sections:MOST_ROWS": 15,
    "show.sections:MOST_FIGURES": 3, "show.summary:UNBROKEN": 10000, "show.suspension:COLUMNS": 12.0, "show.suspension:ROUNDING": 119,
    "show.page.study:MOST_CASES": 200,
    "show.tyre:SIZE": 16.5,
}  # fmt: skip
