"""Points on curves: slots and cams, by formula and by table, against formulas worked by hand."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Marker, Model, PointOnCurve, Prismatic
from stiffmbs.model.read_scene import read_scene

from .test_joints import RATE, G, reaction, turning_arm

PARABOLA = {
    "formula": {"y": "2*x^2"},
    "table": {"y": {"table": [[x, 2 * x * x] for x in np.linspace(-1, 1, 41)], "ends": "not-a-knot"}},
}


@pytest.mark.long
@pytest.mark.parametrize("curve", PARABOLA.values(), ids=PARABOLA.keys())
def test_bead_on_a_parabola(curve):
    """Energy is kept, and the wire presses with N = m (g cos psi + v^2 curvature) across itself."""
    mass, x0 = 0.4, 0.5
    model = Model(gravity=(0, -G))
    model.add("bead", Body(mass=mass, inertia=0.01, position=(x0 + 1, 2 * x0**2)))
    model.add("wire", PointOnCurve(i="bead", j=Marker(body="ground", point=(1, 0)), **curve))
    solution = stiffmbs.run(model, duration=2, rtol=1e-9)
    x, y = solution["bead.x"] - 1, solution["bead.y"]
    np.testing.assert_allclose(y, 2 * x**2, atol=1e-12)
    assert x.min() == pytest.approx(-x0, abs=1e-4)
    assert solution.energy_drift() < 1e-6
    cosine = 1 / np.sqrt(1 + (4 * x) ** 2)
    square_speed = 2 * G * (2 * x0**2 - y)
    pressure = mass * (G * cosine + square_speed * 4 * cosine**3)
    np.testing.assert_allclose(reaction(solution, "wire"), pressure * cosine * [-4 * x, np.ones_like(x)], atol=1e-4)


E, R, PHASE = 0.02, 0.1, 0.4
ANGLES = np.radians(np.arange(0, 361, 5))
ECCENTRIC = {
    "formula": ({"radius": f"{E}*cos(angle - {PHASE}) + sqrt({R}^2 - {E}^2*sin(angle - {PHASE})^2)"}, 1e-8),
    "table": (
        {"radius": {"table": [[a + PHASE, E * np.cos(a) + np.sqrt(R**2 - (E * np.sin(a)) ** 2)] for a in ANGLES], "ends": "periodic"}},
        2e-3,
    ),
}  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    ("curve", "accuracy"),
    [
        pytest.param(*case, marks=pytest.mark.long if name == "table" else (), id=name)
        for name, case in ECCENTRIC.items()
    ],
)
def test_follower_on_an_eccentric_cam_through_several_turns(curve, accuracy):
    """A round cam on an eccentric shaft is a crank of E with a rod of R: the follower's way and the cam's push."""
    mass = 0.5
    model = turning_arm(angle=0.3)
    model.add("follower", Body(mass=mass, inertia=1, position=(-0.1, 0)))
    model.add("guide", Prismatic(i="follower", j="ground"))
    model.add("cam", PointOnCurve(i="follower", j="arm", **curve))
    solution = stiffmbs.run(model, duration=3 * 2 * np.pi / RATE, rtol=1e-8)
    angle = np.pi - 0.3 - RATE * solution.time - PHASE  # of the follower, seen from the cam's longest radius
    root = np.sqrt(R**2 - (E * np.sin(angle)) ** 2)
    np.testing.assert_allclose(solution["follower.x"], -(E * np.cos(angle) + root), atol=1e-7 + 1e-4 * accuracy)
    bend = E**2 * (np.cos(2 * angle) / root + E**2 * np.sin(2 * angle) ** 2 / 4 / root**3)
    push = mass * RATE**2 * (E * np.cos(angle) + bend)
    np.testing.assert_allclose(solution["cam.fx"], push, atol=accuracy * np.max(np.abs(push)))


def test_curve_turns_with_its_marker():
    """The arm's parabola, upright at a quarter turn, holds the bead where its own axes say."""
    model = turning_arm()
    model.add("bead", Body(mass=1, inertia=1, position=(0.2, 0.04)))
    model.add("slide", PointOnCurve(i="bead", j=Marker(body="arm", point=(0, -0.1), angle="90 deg"), y="0.5 - x^2"))
    solution = stiffmbs.run(model, duration=1, rtol=1e-8)
    turned = np.exp(-1j * RATE * solution.time) * (solution["bead.x"] + 1j * solution["bead.y"])
    x, y = turned.imag + 0.1, -turned.real
    np.testing.assert_allclose(y, 0.5 - x**2, atol=1e-10)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "kinematic"])
def test_a_cam_with_a_narrow_bump_lifts_its_follower_in_every_turn(solver):
    """A formula of the polar angle itself, which lies between -pi and pi however often the cam has turned."""
    scene = read_scene("""
bodies:
  cam: {mass: 1, inertia: 1, omega: 10}
  f: {mass: 1, inertia: 1, position: [0, 1], angle: 90 deg}
joints:
  shaft: {type: revolute, i: cam, j: ground}
  motor: {type: drive, joint: shaft, position: 10*t}
  guide: {type: prismatic, i: f, j: {body: ground, angle: 90 deg}}
  follower: {type: point_on_curve, i: f, j: cam, radius: "1 + 0.1*exp(-((angle - 0.96)/0.01)^2)"}
run: {duration: 2 s, points: 2001, max_step: 0.5 ms}
""")
    solution = stiffmbs.run(scene, solver=solver)
    angle = np.mod(np.pi / 2 - 10 * solution.t + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(solution["f.y"], 1 + 0.1 * np.exp(-(((angle - 0.96) / 0.01) ** 2)), atol=1e-9)


@pytest.mark.long
def test_a_cam_in_space_lifts_its_follower_by_its_height():
    """A barrel cam: a follower at the radius 0.5 is at the height 0.1 sin(2 theta) beside the cam's own."""
    scene = read_scene(
        """
dimensions: 3
bodies: {follower: {mass: 1, inertia: [1, 1, 1], position: [0.5, 0.2, 1.1], velocity: [0, 1, 0]}}
joints:
  cam: {type: point_on_curve, i: follower, j: {body: ground, point: [0, 0.2, 1]}, radius: 0.5, height: 0.1 + 0.1*sin(2*angle)}
"""
    )
    solution = stiffmbs.run(scene, duration=2.0, points=41, rtol=1e-9)
    x, y, z = solution["follower.x"], solution["follower.y"] - 0.2, solution["follower.z"] - 1
    np.testing.assert_allclose(np.hypot(x, y), 0.5, atol=1e-9)
    np.testing.assert_allclose(z, 0.1 + 0.1 * np.sin(2 * np.arctan2(y, x)), atol=1e-9)
    assert np.ptp(z) > 0.1


@pytest.mark.long
@pytest.mark.parametrize(("end", "accepted"), [("6.2831853", False), ("6.283185307", True), ("6.283185312", True)])
def test_a_turn_is_known_by_its_first_nine_digits(end, accepted):
    """A table of a cam's radius over a turn of 2 pi, as a program writes it."""
    scene = (
        "bodies: {a: {mass: 1, inertia: 1, position: [1, 0]}}\n"
        "joints: {cam: {type: point_on_curve, i: a, j: ground, radius: "
        f"{{table: [[0, 1], [2, 1.1], [4, 0.9], [{end}, 1]], ends: periodic}}}}}}\n"
    )
    if accepted:
        assert stiffmbs.check(stiffmbs.read_scene(scene)).degrees_of_freedom == 2
        return
    with pytest.raises(stiffmbs.InputError, match="expected a periodic one over a full turn"):
        stiffmbs.read_scene(scene)
