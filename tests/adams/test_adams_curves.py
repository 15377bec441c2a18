"""PTCV: a point that stays on a CURVE, against the equation of a bead on the spline through the same points."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams
from stiffmbs.adams.scene.fitted_curves import _plane

from .trials.adams_oracle import euler, rotation

G = 9.80665
BEAD = """a bead
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1, QP=100,200,300, REULER=20D,0,0
MARKER/12, PART=1, FLOATING
PART/2, QG={start}, MASS=2, CM=21, IP=1,1,1
MARKER/21, PART=2
CURVE/7, {sort}, CURVE_POINTS, ORDER=4, MATRIX=8
MATRIX/8, FULL=RORDER, M={m}, N=3, VALUES={values}
PTCV/4, CURVE=7, I=21, JFLOAT=12, RM=11
JPRIM/1, ORIENTATION, I=21, J=11
REQUEST/1, F2=PTCV(4, 0, 1, 0)\\, F3=PTCV(4, 1, 4, 11)
REQUEST/2, FORCE, I=21, J=12
ACCGRAV/KGRAV=-9806.65
END
"""
X = np.linspace(-400, 400, 17)
Z = 300 * (X / 400) ** 2 + 20 * np.sin(X / 60)
TURN = euler(20, 0, 0)


def dataset(points, sort="OPEN", first=None):
    start = [100, 200, 300] + TURN @ np.asarray(points[0] if first is None else first)
    values = "\n, ".join(", ".join(map(repr, map(float, row))) for row in points)
    return BEAD.format(start=", ".join(map(repr, map(float, start))), sort=sort, m=len(points), values=values)


@pytest.mark.long
def test_a_bead_slides_along_an_open_wire():
    points = np.column_stack([X, 0 * X, Z])
    found = stiffmbs.run(read_adams(dataset(points, first=points[2])), duration=0.5, points=26, rtol=1e-10)
    wire = CubicSpline(X / 1000, Z / 1000)  # not-a-knot, as the table of the scene, but over x and z themselves

    def rates(t, y):
        slope, bend = wire(y[0], 1), wire(y[0], 2)
        return [y[1], -slope * (bend * y[1] ** 2 + G) / (1 + slope**2)]

    own = solve_ivp(rates, (0, 0.5), [X[2] / 1000, 0], t_eval=found.time, rtol=1e-12, atol=1e-12).y
    place = (np.column_stack([found[f"PART_2.{axis}"] for axis in "xyz"]) - [0.1, 0.2, 0.3]) @ TURN
    np.testing.assert_allclose(place, np.column_stack([own[0], 0 * own[0], wire(own[0])]), atol=2e-5)
    slope, bend = wire(own[0], 1), wire(own[0], 2)
    pressure = 2 * np.abs(bend * own[1] ** 2 + G) / np.sqrt(1 + slope**2)
    np.testing.assert_allclose(found["REQUEST_1.f2"], pressure, rtol=2e-3)
    np.testing.assert_allclose(found["REQUEST_1.f3"], -found["PTCV_4.fz"], atol=1e-9)
    np.testing.assert_allclose(found["REQUEST_2.fz"], found["PTCV_4.fz"], atol=1e-9)
    assert any("PTCV/4: the curve is a cubic spline through the points" in note for note in found.notes)


def ring(turn):
    angles = turn * np.linspace(0, 2 * np.pi, 25)
    return np.column_stack([300 * np.cos(angles), 0 * angles, 200 * np.sin(angles)])


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("turn", [1, -1])
def test_a_bead_goes_round_a_closed_wire(turn):
    points = ring(turn)
    found = stiffmbs.run(read_adams(dataset(points, "CLOSED", points[5])), duration=0.8, points=17, rtol=1e-9)
    x, z = ((np.column_stack([found[f"PART_2.{axis}"] for axis in "xyz"]) - [0.1, 0.2, 0.3]) @ TURN)[:, [0, 2]].T
    np.testing.assert_allclose((x / 0.3) ** 2 + (z / 0.2) ** 2, 1, atol=2e-4)  # the ellipse that the points are on
    assert np.min(z) < -0.19
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], atol=1e-6)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("turn", [1, -1])
def test_a_bead_goes_round_a_closed_wire_that_leaves_its_plane(turn):
    """Against the energy of a bead on the splines of the angle, about the axis across the wire's plane."""
    points = ring(turn)
    points[:, 1] = 60 * np.sin(2 * turn * np.linspace(0, 2 * np.pi, 25)) + 20 * np.sin(
        turn * np.linspace(0, 2 * np.pi, 25)
    )
    points[-1] = points[0]
    found = stiffmbs.run(read_adams(dataset(points, "CLOSED", points[5])), duration=0.8, points=17, rtol=1e-9)
    place = (np.column_stack([found[f"PART_2.{axis}"] for axis in "xyz"]) - [0.1, 0.2, 0.3]) @ TURN
    angle = np.arctan2(place[:, 2] / 0.2, place[:, 0] / 0.3)
    np.testing.assert_allclose((place[:, 0] / 0.3) ** 2 + (place[:, 2] / 0.2) ** 2, 1, atol=3e-3)
    np.testing.assert_allclose(place[:, 1], 0.06 * np.sin(2 * angle) + 0.02 * np.sin(angle), atol=2e-3)
    assert np.min(place[:, 2]) < -0.18 and np.ptp(place[:, 1]) > 0.05
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], atol=1e-6)


@pytest.mark.long
def test_a_bead_slides_along_a_wire_that_is_bent_in_space():
    points = np.column_stack([X, 60 * np.sin(X / 150), Z])
    found = stiffmbs.run(read_adams(dataset(points, first=points[2])), duration=0.5, points=26, rtol=1e-10)
    wire = CubicSpline(X / 1000, points[:, 1:] / 1000)

    def rates(t, y):
        slope, bend = wire(y[0], 1), wire(y[0], 2)
        return [y[1], -(slope @ bend * y[1] ** 2 + G * slope[1]) / (1 + slope @ slope)]

    own = solve_ivp(rates, (0, 0.5), [X[2] / 1000, 0], t_eval=found.time, rtol=1e-12, atol=1e-12).y[0]
    place = (np.column_stack([found[f"PART_2.{axis}"] for axis in "xyz"]) - [0.1, 0.2, 0.3]) @ TURN
    np.testing.assert_allclose(place, np.column_stack([own, wire(own)]), atol=1e-4)


@pytest.mark.parametrize("scale", [1.0, 25.4, 1 / 304.8, 7e-3])
@pytest.mark.parametrize("sort", ["OPEN", "CLOSED"])
def test_the_axes_of_a_curve_do_not_depend_on_rounding(sort, scale):
    """Singular vectors gave them: the reported displacements had other signs in other units."""
    points = scale * (np.column_stack([X, 0 * X, Z]) if sort == "OPEN" else ring(1))
    scene = read_adams(dataset(points, sort))
    (place,) = (joint.j.orientation for joint in scene.joints.values() if "curve" in joint.kind)
    seen = rotation(place)
    x = points[-1] - points[0] if sort == "OPEN" else points[0]
    np.testing.assert_allclose(seen[:, 0], TURN @ x / np.linalg.norm(x), atol=1e-12)
    np.testing.assert_allclose(seen[:, 2], TURN[:, 1], atol=1e-12)
    assert not any("not used" in note for note in scene.notes)


@pytest.mark.parametrize("towards", [(1, 1), (1, -1)])
def test_the_side_of_a_plane_at_45_degrees_does_not_depend_on_rounding(towards):
    """Of two equal components of its normal, rounding chose the one that is positive."""
    generator = np.random.default_rng(1)
    points = np.column_stack([towards[0] * X, towards[1] * X, Z])
    sides = [_plane(points + generator.normal(0, 1e-13, points.shape), False).axes[:, 2] for _ in range(20)]
    np.testing.assert_allclose(sides, np.tile([np.sqrt(0.5), -towards[1] * np.sqrt(0.5), 0], (20, 1)), atol=1e-9)


def test_the_axes_of_a_straight_curve_do_not_depend_on_rounding():
    generator = np.random.default_rng(1)
    points = np.column_stack([0 * X, 0 * X, X - X[0]])
    axes = [_plane(points + generator.normal(0, 1e-16, points.shape), False).axes for _ in range(20)]
    np.testing.assert_allclose(axes, np.tile(axes[0], (20, 1, 1)), atol=1e-9)


@pytest.mark.parametrize(
    ("points", "sort", "message"),
    [
        (np.column_stack([X[[0, 5, 3, 8, 9]], 0 * X[:5], X[:5]]), "OPEN", "found an open curve that turns back"),
        (ring(1)[:-1], "CLOSED", "found a first and a last point .* m apart in the closed CURVE/7, expected one point"),
        (np.column_stack([np.sin(2 * X), 0 * X, np.sin(X)])[[8, *range(16), 8]], "CLOSED", "found a closed curve that a ray"),
        (ring(1)[:3], "OPEN", "found MATRIX = 8 of CURVE/7, expected 4 rows or more of x, y and z"),
    ],
)  # fmt: skip
def test_a_curve_that_cannot_be_followed_is_said(points, sort, message):
    with pytest.raises(InputError, match=f"PTCV/4: {message}"):
        read_adams(dataset(points, sort))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CURVE=7", "CURVE=6", "found CURVE = 6, expected the number of a CURVE"),
        ("CURVE_POINTS, ORDER=4", "CONTROL_POINTS", "CURVE/7: found CONTROL_POINTS; expected CURVE_POINTS of order 4"),
        ("ORDER=4", "ORDER=2", "CURVE/7: found ORDER = 2; expected CURVE_POINTS of order 4"),
        ("ORDER=4", "SORT=4", "PTCV/4: CURVE/7: found 'SORT=4', expected one of CLOSED, .*; expected CURVE_POINTS of order 4"),
        ("RM=11", "RM=11, DISP=-300,0,200", r"found DISPLACEMENT 0\.1\d+ m from where marker I is drawn"),
        ("RM=11", "RM=11, VELOCITY=3", "found VELOCITY, expected the velocities of the parts instead"),
    ],
)  # fmt: skip
def test_a_wrong_statement_is_said(old, new, message):
    with pytest.raises(InputError, match=message):
        read_adams(dataset(np.column_stack([X, 0 * X, Z])).replace(old, new))


def test_a_curve_that_is_only_drawn_may_be_of_any_kind():
    text = dataset(np.column_stack([X, 0 * X, Z])).replace("PTCV/4, CURVE=7, I=21, JFLOAT=12, RM=11\n", "")
    scene = read_adams(
        text.replace("ORDER=4", "SORT=4").replace("PTCV(4, 0, 1, 0)", "1").replace("PTCV(4, 1, 4, 11)", "2")
    )
    assert "PTCV_4" not in scene.joints and "JPRIM_1" in scene.joints
