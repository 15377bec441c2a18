"""Tables that a scene names and formulas call, by splines, straight lines and Akima's cubics."""

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

import stiffmbs
from stiffmbs import InputError
from stiffmbs.compile.inputs.features import breakpoint_times
from stiffmbs.compile.inputs.of_time import inputs_of
from stiffmbs.compile.table_values import curve
from stiffmbs.reading.table import Table

POINTS = [[0, 0], [0.5, 1], [1, 0.5], [2, 3], [3, 1]]
SCENE = """
parameters: {{scale: 2}}
tables:
  push: {{table: {points}{how}}}
bodies: {{sled: {{mass: 2, inertia: 1, velocity: [0.3, 0]}}}}
joints: {{rail: {{type: prismatic, i: sled, j: ground}}}}
forces: {{pusher: {{type: force, i: sled, force: [{force}, 0]}}}}
requests: {{felt: {request}}}
run: {{duration: 2.5, rtol: 1e-10, output: 0.5}}
"""


def scene(force="scale*push(t)", how="", request="1"):
    return stiffmbs.read_scene(SCENE.format(points=POINTS, how=how, force=force, request=request))


@pytest.mark.parametrize(
    "how, made",
    [
        ("", PchipInterpolator),
        (", spline: true", lambda x, y: CubicSpline(x, y, bc_type="natural")),
        (", ends: natural", lambda x, y: CubicSpline(x, y, bc_type="natural")),
        (", spline: true, ends: clamped", lambda x, y: CubicSpline(x, y, bc_type="clamped")),
        (", ends: not-a-knot", lambda x, y: CubicSpline(x, y, bc_type="not-a-knot")),
        (", akima: true", Akima1DInterpolator),
        (", lines: true", None),
    ],
)
def test_a_force_by_a_named_table_of_time(how, made):
    solution = stiffmbs.run(scene(how=how))
    x, y = np.array(POINTS, dtype=float).T
    fine = np.linspace(0, 2.5, 200_001)
    values = np.interp(fine, x, y) if made is None else made(x, y)(fine)
    gained = np.concatenate([[0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(fine))])
    expected = 0.3 + np.interp(solution.t, fine, gained)
    np.testing.assert_allclose(solution["sled.vx"], expected, atol=1e-8)


def test_a_table_of_the_state_keeps_energy_as_its_integral_does():
    """A force -push(x): half m v^2 plus the area under the table stays."""
    solution = stiffmbs.run(scene("-push(sled.x + 1)"))
    way = np.linspace(0, 1, 2001)
    monotone = PchipInterpolator(*np.array(POINTS, dtype=float).T)
    areas = [np.trapezoid(monotone(1 + x * way) * x, way) for x in solution["sled.x"]]
    np.testing.assert_allclose(solution["sled.vx"] ** 2 + areas, 0.09, atol=1e-6)


def test_requests_read_named_tables_in_space():
    text = """
dimensions: 3
tables: {curve: {table: [[0, 0], [1, 1], [2, 4], [3, 9]], akima: true}}
bodies: {stone: {mass: 1, inertia: [1, 1, 1], velocity: [1, 0, 0]}}
requests: {r: "curve(stone.x) + curve(5)"}
run: {duration: 2, points: 9}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    inside = Akima1DInterpolator([0, 1, 2, 3], [0, 1, 4, 9])
    beyond = 9 + 2 * float(inside.derivative()(3))
    np.testing.assert_allclose(solution["r"], inside(solution.t) + beyond, atol=1e-8)


@pytest.mark.parametrize("periodic", [False, True])
def test_curves_are_what_kernels_compute(periodic):
    points = [*POINTS[:-1], [3, 0]] if periodic else POINTS
    table = Table(table=points, ends="periodic" if periodic else None)
    text = f"""
tables: {{push: {{table: {points}{", ends: periodic" if periodic else ""}}}}}
bodies: {{sled: {{mass: 1, inertia: 1}}}}
requests: {{r: push(6*t - 5)}}
run: {{duration: 2, points: 41}}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    np.testing.assert_allclose(curve(table)(6 * solution.t - 5), solution["r"], atol=1e-12)


def test_corners_of_named_tables_of_time():
    def breakpoints(force, how=", lines: true"):
        return breakpoint_times(inputs_of(stiffmbs.compile_model(scene(force, how))), 0.0, 2.5)

    np.testing.assert_allclose(breakpoints("push(t)"), [0.5, 1, 2])
    np.testing.assert_allclose(breakpoints("push(2*t - 1)"), [0.5, 0.75, 1, 1.5, 2])
    np.testing.assert_allclose(breakpoints("push(2 - t)"), [0, 1, 1.5, 2][1:])
    np.testing.assert_allclose(breakpoints("push(t - 1)", ""), [1])
    assert len(breakpoints("push(sled.x)")) == 0


@pytest.mark.parametrize(
    "before, after, words",
    [
        ("*push(t)", "*shove(t)", "found the unknown function 'shove', expected one of .*push"),
        ("[scale*push(t)", "['push(t, 1)'", r"found 2 arguments in 'push\(t, 1\)', expected 1"),
        ("push:", "sin:", "tables.sin: found the name of a function"),
        ("push:", "two words:", "tables: found the name 'two words'"),
        ("[1, 0.5]", "[0.2, 0.5]", "tables.push: .*found 0.2 after 0.5"),
        ("[3, 1]]", "[3, 1]], akima: true, lines: true", "found akima with lines or ends"),
        ("[3, 1]]", "[3, 1]], spline: true, lines: true", "found lines with a spline or its ends"),
        ("tables:", "tables: 3\nfigure:", "tables: found 3, expected a mapping"),
    ],
)
def test_tables_that_cannot_be_are_told(before, after, words):
    text = SCENE.format(points=POINTS, how="", force="scale*push(t)", request="1")
    assert before in text
    with pytest.raises(InputError, match=words):
        stiffmbs.read_scene(text.replace(before, after))


BUMP = [[-100, 0], [12, 0], [12.3, 0.05], [12.6, 0.05], [12.9, 0], [200, 0]]
STOP = [[-0.1, -2000], [0, 0], [0.05, 0], [0.051, 9000], [0.1, 9100]]
DAMPER = [[-2, -1000], [-0.1, -900], [0, 0], [0.1, 1500], [2, 1600]]


@pytest.mark.parametrize("points", [BUMP, STOP, DAMPER, POINTS])
def test_a_table_stays_between_its_points_by_default(points):
    x, y = np.array(points, dtype=float).T
    values = curve(Table(table=points))(np.linspace(x[0], x[-1], 20_001))
    assert (values.min(), values.max()) == pytest.approx((y.min(), y.max()), rel=1e-6, abs=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("points", "how", "noted"),
    [
        (BUMP, "spline: true", True), (BUMP, "ends: natural", True), (BUMP, "ends: not-a-knot", True), (BUMP, "akima: true", True),
        (BUMP, "lines: true", False), (BUMP, "", False), (STOP, "spline: true", True), (STOP, "", False), (DAMPER, "spline: true", True),
        (DAMPER, "lines: true", False), ([[0, 0], [1, 1], [2, 4], [3, 9]], "spline: true", False),
    ],
)  # fmt: skip
def test_a_spline_that_leaves_the_range_of_its_points_is_noted(points, how, noted):
    table = f"{{table: {points}{', ' if how else ''}{how}}}"
    for law in (f"tables: {{h: {table}}}\nforces: {{f: {{type: force, i: b, force: ['-h(b.x)', 0]}}}}",
                f"forces: {{f: {{type: spring_damper, i: b, j: ground, damper_law: {table}}}}}"):  # fmt: skip
        scene = stiffmbs.read_scene(f"gravity: [0, 0]\nbodies: {{b: {{mass: 1, inertia: 1, position: [1, 0]}}}}\n{law}")
        for notes in (stiffmbs.check(scene).messages, stiffmbs.run(scene, duration=1e-3, points=2).notes):
            assert any("but its points are between" in note and note.startswith("f: ") for note in notes) == noted
