"""Contact of a sphere with a road: against the contact with a plane, rolling, sliding, and a body in a bowl."""

import numpy as np
import pytest

import stiffmbs

LAW = "stiffness: 5e5, exponent: 1.5, dissipation: 0.3"
BALL = """
dimensions: 3
gravity: [0, 0, -9.81]
roads: {course: {type: formula, z: "%s", friction: %s}}
bodies: {ball: {mass: 3, inertia: [%s, %s, %s], position: [%s], velocity: [%s], omega: [0.3, 0.2, 0.1]}}
forces: {touch: {%s}}
"""


def ball(touch, height="-0.2*x + 0.1*y", position="0, 0, 0.1024", velocity="0, 0, 0", friction="1", inertia=0.012):
    return stiffmbs.read_scene(BALL % (height, friction, *3 * [inertia], position, velocity, touch))


def test_on_a_tilted_road_it_is_the_contact_with_that_plane_and_the_ball_rolls():
    """A ball that rolls without slip accelerates by 5/7 of g along the slope."""
    road = ball(f"type: road_contact, i: ball, road: course, radius: 0.1, friction: 0.6, {LAW}")
    plane = ball(
        f"type: sphere_contact, i: ball, j: {{body: ground, orientation: {{z: [0.2, -0.1, 1]}}}}, radius: 0.1, friction: 0.6, {LAW}"
    )
    found, known = (stiffmbs.run(scene, duration=1.5, output=0.01, rtol=1e-9) for scene in (road, plane))
    for name in ("ball.x", "ball.y", "ball.z", "ball.wx", "touch.fx", "touch.fz", "touch.tx"):
        rounding = (
            1e-5 if name.startswith("touch") else 2e-6
        )  # friction forces change with the slip within the tolerance
        assert found[name] == pytest.approx(known[name], abs=rounding * max(1, np.abs(known[name]).max()))
    slope = np.hypot(0.2, 0.1) / np.sqrt(1 + 0.2**2 + 0.1**2)
    speed = np.sqrt(found["ball.vx"] ** 2 + found["ball.vy"] ** 2 + found["ball.vz"] ** 2)
    assert np.polyfit(found.time[100:], speed[100:], 1)[0] == pytest.approx(5 / 7 * 9.81 * slope, rel=2e-3)


def test_a_sliding_body_is_slowed_by_the_friction_factor_of_the_road():
    scene = ball(
        f"type: road_contact, i: ball, road: course, radius: 0.1, friction: 0.4, {LAW}",
        "0", "0, 0, 0.0995", "5, 0, 0", "0.5 + 0*x", inertia=1e6,
    )  # fmt: skip
    found = stiffmbs.run(scene, duration=1, output=0.01, rtol=1e-8)
    assert np.polyfit(found.time[30:], found["ball.vx"][30:], 1)[0] == pytest.approx(-0.4 * 0.5 * 9.81, rel=2e-3)


@pytest.mark.long
def test_a_ball_swings_in_a_bowl_like_a_pendulum_of_its_radius_less_that_of_the_ball():
    """Without friction: w^2 = g/(R - r), with the curvature 1/R at the bottom, along both axes, apart from (r/R)^2/2."""
    scene = ball(
        "type: road_contact, i: ball, road: course, radius: 0.1, stiffness: 1e8, exponent: 1",
        "x^2/(2*8) + y^2/(2*5)", "0.01, 0.01, 0.1",
    )  # fmt: skip
    frequencies = sorted(
        mode.frequency for mode in stiffmbs.modes(scene, start_from=stiffmbs.equilibrium(scene).solution).modes
    )
    for radius in (8, 5):
        expected = np.sqrt(9.81 / (radius - 0.1)) / (2 * np.pi)
        assert min(abs(f / expected - 1) for f in frequencies) < 0.6 * (0.1 / radius) ** 2


@pytest.mark.long
def test_a_box_that_rolls_over_comes_to_rest_on_a_hill_with_its_weight_on_its_corners():
    corners = [(x, y, z) for x in (-1, 1) for y in (-0.6, 0.6) for z in (-0.4, 0.4)]
    touches = "".join(
        f"  c{k}: {{type: road_contact, i: {{body: box, point: [{x}, {y}, {z}]}}, road: course, radius: 0.05, stiffness: 1e6, "
        f"dissipation: 1, friction: 0.6, stiction_velocity: 0.01}}\n"
        for k, (x, y, z) in enumerate(corners)
    )
    scene = stiffmbs.read_scene(
        "dimensions: 3\ngravity: [0, 0, -9.81]\nroads: {course: {type: formula, z: 0.2*sin(x) + 0.05*y}}\n"
        "bodies: {box: {mass: 1000, inertia: [300, 600, 700], position: [0, 0, 1], velocity: [2, 6, 0], omega: [-5, 0, 0]}}\n"
        f"forces:\n{touches}"
    )
    found = stiffmbs.run(scene, duration=6, output=0.01, rtol=1e-6)
    assert found.success
    rolled = np.abs(np.cumsum(found["box.wx"]) * 0.01)
    assert rolled.max() > 3, "it has rolled onto its roof, or further"
    carried = sum(found[f"c{k}.fz"] for k in range(8))
    assert carried[-50:] == pytest.approx(np.full(50, 9810.0), rel=1e-2)
    lowest = found["box.z"] - 0.2 * np.sin(found["box.x"]) - 0.05 * found["box.y"]
    assert lowest.min() > 0.25, "no corner is far within the ground"


@pytest.mark.parametrize("factor", ["-0.8", "2*-0.3 + 0.1"])
def test_a_friction_factor_below_zero_is_refused(factor):
    touch = f"type: road_contact, i: ball, road: course, radius: 0.1, friction: 0.6, {LAW}"
    with pytest.raises(
        stiffmbs.InputError, match=r"roads\.course\.friction: found -0\.[58], expected zero or a positive"
    ):
        ball(touch, friction=factor)
    for right in ("0", "0.5 - x", "-0.1 + 0.2"):
        ball(touch, friction=right)
