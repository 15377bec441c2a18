"""Beams at rest: closed forms and converged values from independent methods."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs
from stiffmbs.model.beams.section import Circle, IProfile, Rectangle, Tube

from .scenes import at_rest, bend, cantilever, princeton

ELASTICA = {
    1: (0.46135195, 0.05643324, 0.30172077),
    2: (0.78174983, 0.16064172, 0.49345748),
    5: (1.21536812, 0.38762836, 0.71379152),
    10: (1.43028554, 0.55499560, 0.81060902),
}
BEND = {
    300: (58.779122, 22.244781, 40.191892),
    450: (52.238558, 18.508179, 48.502927),
    600: (47.150439, 15.684801, 53.474859),
}
"""Tip of the bend with GJ = G/6."""
PRINCETON = {
    (4.448, 75): (0.075571497, 0.001502995, -0.006800119),
    (8.896, 45): (0.109041568, 0.008888858, -0.014389320),
    (13.345, 0): (0, 0.016065145, -0.000304811),
    (13.345, 90): (0.200692911, 0, -0.050405680),
    (4.448, 45): (0.056055193, 0.003965163, -0.003746889),
    (13.345, 15): (0.064496309, 0.016502892, -0.005298375),
    (13.345, 45): (0.156587823, 0.015342258, -0.030361114),
    (13.345, 75): (0.196124707, 0.006328438, -0.048074609),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("n", [2, 3, 8, 16])
@pytest.mark.parametrize("turns", [0.5, 1.0])
def test_an_end_moment_rolls_a_beam_up_to_a_circle_with_any_number_of_elements(n, turns):
    found = at_rest(cantilever(n, torque=math.tau * turns))
    angle = math.tau * turns
    assert found["strip.end.x"] == pytest.approx(math.sin(angle) / angle, abs=1e-9)
    assert found["strip.end.y"] == pytest.approx((1 - math.cos(angle)) / angle, abs=1e-9)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("load", ELASTICA)
def test_a_dead_load_bends_a_beam_to_the_elastica(load):
    angle, short, up = ELASTICA[load]
    found = at_rest(cantilever(16, force=f"[0, {load}]", stiffness="[1e8, 1e8, 1]"))
    assert found["strip.end.angle"] == pytest.approx(angle, abs=5e-6)
    assert 1 - found["strip.end.x"] == pytest.approx(short, abs=5e-6)
    assert found["strip.end.y"] == pytest.approx(up, abs=5e-6)


@pytest.mark.long
def test_the_error_in_the_plane_is_of_fourth_order():
    tips = [
        at_rest(cantilever(n, force="[0, 5]", stiffness="[1e7, 1e7, 1]"))["strip.end.angle"] for n in (4, 8, 16, 64)
    ]
    coarse, middle, fine = (abs(tip - tips[-1]) for tip in tips[:3])
    assert math.log2(coarse / middle) > 3.7 and math.log2(middle / fine) > 3.7


@pytest.mark.parametrize("n", [1, 2, 5])
def test_the_nodes_of_a_linear_cantilever_have_no_error(n):
    """Timoshenko's beam under a small end load: P L^3/(3 EI) + P L/GA, for any number of elements."""
    found = at_rest(cantilever(n, force="[0, 1e-5]", stiffness="[1e4, 50, 1]"))
    assert found["strip.end.y"] == pytest.approx(1e-5 * (1 / 3 + 1 / 50), rel=1e-7)
    assert found["strip.end.angle"] == pytest.approx(1e-5 / 2, rel=1e-7)


@pytest.mark.long
@pytest.mark.parametrize("load", BEND)
def test_a_curved_beam_bends_out_of_its_plane(load):
    tip = np.array([at_rest(bend(8, load, 5e6 / 6))[f"bend.end.{axis}"] for axis in "xyz"])
    assert np.max(np.abs(tip - BEND[load])) < 6e-4


@pytest.mark.long
def test_different_stiffness_in_bending_and_torsion_gives_second_order():
    """Richardson extrapolation then reaches the value of the shooting method."""
    expected = np.array([46.891925, 15.557786, 53.607369])
    coarse, fine = (
        np.array([found[f"bend.end.{axis}"] for axis in "xyz"])
        for found in (at_rest(bend(n, 600, 0.140577 * 5e6)) for n in (8, 16))
    )
    assert np.max(np.abs(fine - expected)) < 4e-4
    assert np.max(np.abs(fine + (fine - coarse) / 3 - expected)) < 1.5e-4


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("load", "degrees"), PRINCETON)
def test_the_princeton_beam(load, degrees):
    coarse, fine = (at_rest(princeton(n, load, degrees)) for n in (8, 16))
    tips = [np.array([f["strip.end.y"], f["strip.end.z"], f["strip.end.x"] - 0.508]) for f in (coarse, fine)]
    assert np.max(np.abs(tips[1] - PRINCETON[load, degrees])) < 8e-6
    assert np.max(np.abs(tips[1] + (tips[1] - tips[0]) / 3 - PRINCETON[load, degrees])) < 5e-7


def test_a_beam_on_its_end_bears_its_own_weight_and_a_distributed_load():
    found = at_rest("""
gravity: [0, -10]
bodies:
  bar: {type: beam, start: [0, 0], end: [0, 2], elements: 5, stiffness: [1e4, 1e4, 100], mass_per_length: 3, inertia_per_length: 0.01}
joints: {foot: {type: fixed, i: bar.start.ground_axes, j: ground}}
forces: {wind: {type: distributed_load, beam: bar, force: [1e-3 N/m, 0]}}
""")
    assert found["foot.fy"] == pytest.approx(60)
    assert found["bar.end.y"] == pytest.approx(2 - 3 * 10 * 2**2 / (2 * 1e4), rel=1e-6)
    assert found["foot.fx"] == pytest.approx(-2e-3)


def test_a_follower_load_turns_with_the_section():
    load = "{type: distributed_load, beam: strip, force: [0, 1.5 N/m], axes: section}"
    text = cantilever(12).replace("P: {type: force, i: strip.end, force: [0, 0]}", f"P: {load}")
    found = at_rest(text)
    assert found["P.end.fx"] < 0
    assert math.hypot(found["P.end.fx"], found["P.end.fy"]) == pytest.approx(math.hypot(0, 1.5) / 12 * 3 / 8, rel=1e-9)


def test_a_tapered_cantilever_bends_as_in_the_integral_of_its_curvature():
    """A cone of diameters D and d: the deflection under an end load is 64 P L^3/(3 pi E D^3 d)."""
    found = at_rest("""
bodies:
  cone:
    type: beam
    start: [0, 0]
    end: [1, 0]
    elements: 6
    section: {type: circle, diameter: 40 mm}
    section_end: {type: circle, diameter: 20 mm}
    material: {E: 200 GPa, nu: 0, density: 7800}
joints: {clamp: {type: fixed, i: cone.start, j: ground}}
forces: {P: {type: force, i: cone.end, force: [0, 1]}}
""")
    bending = 64 / (3 * math.pi * 200e9 * 0.04**3 * 0.02)
    shear = 1 / (6 / 7 * 100e9 * math.pi / 4 * 0.04 * 0.02)
    assert found["cone.end.y"] == pytest.approx(bending + shear, rel=1e-6)


@pytest.mark.long
def test_an_anti_roll_bar_twists_and_bends():
    """Relative end displacement of a bar of two arms in two bushings, by hand: 41.863725 mm, without shear."""
    found = at_rest("""
dimensions: 3
bodies:
  bar:
    type: beam
    points: [[0.25, -0.5, 0], [0, -0.5, 0], [0, 0.5, 0], [0.25, 0.5, 0]]
    elements: 14
    stations: {left: 0.4, right: 1.1}
    section: {type: circle, diameter: 22 mm}
    material: {E: 2.06e11, nu: 0.3, density: 7850}
forces:
  left_bushing: {type: bushing, i: bar.left, j: {body: ground, point: [0, -0.35, 0]}, stiffness: [1e9, 0, 1e9, 0, 0, 0]}
  right_bushing: {type: bushing, i: bar.right, j: {body: ground, point: [0, 0.35, 0]}, stiffness: [1e9, 1e3, 1e9, 0, 0, 0]}
  level: {type: torque, i: bar.left, torque: [0, "-1e4*bar.left.wy - 2000*(bar.start.z + bar.end.z)", 0]}
  down: {type: force, i: bar.start, force: [0, 0, -1]}
  up: {type: force, i: bar.end, force: [0, 0, 1]}
""")
    assert found["bar.end.z"] - found["bar.start.z"] == pytest.approx(41.863725e-6, rel=0.01)
    assert found["bar.end.z"] - found["bar.start.z"] > 41.863725e-6


@pytest.mark.long
def test_the_result_does_not_depend_on_the_direction_in_which_a_beam_is_described():
    """A cantilever in space, in three orientations, with the same load in its own axes."""
    found = []
    for along, across in (("[1, 0, 0]", "[0, 0, 1]"), ("[0, 0, -1]", "[1, 0, 0]"), ("[0.6, 0, 0.8]", "[-0.8, 0, 0.6]")):
        load = [3 * float(part) for part in across.strip("[]").split(",")]
        channels = at_rest(f"""
dimensions: 3
bodies:
  strip:
    {{type: beam, start: [0, 0, 0], end: {along}, up: {across}, elements: 5, stiffness: [1e5, 1e5, 1e5, 1, 2, 3],
     mass_per_length: 1, inertia_per_length: [2, 1, 1]}}
joints: {{clamp: {{type: fixed, i: strip.start, j: {{body: ground, orientation: {{x: {along}, z: {across}}}}}}}}}
forces: {{P: {{type: force, i: strip.end, force: [{load[0]}, 0.1, {load[2]}]}}}}
""")
        tip = np.array([channels[f"strip.end.{axis}"] for axis in "xyz"])
        axes = [np.array(eval(part), dtype=float) for part in (along, across)]
        found.append([tip @ axes[0], tip @ axes[1], tip[1]])
    assert np.ptp(np.array(found), axis=0) == pytest.approx(0, abs=1e-10)


def test_sections():
    of_circle, of_tube = Circle(diameter=0.02).properties(0.3), Tube(diameter=0.02, thickness=0.00999).properties(0.3)
    assert (of_tube.A, of_tube.shear2) == pytest.approx((of_circle.A, of_circle.shear2), rel=1e-4)
    assert (of_circle.shear2, of_circle.J / of_circle.I2) == pytest.approx((0.886364, 2), abs=1e-6)
    of_strip, G = Rectangle(width=3.2024e-3, height=12.377e-3).properties(0.31), 71.7e9 / 2 / 1.31
    assert pytest.approx((36.27936, 3.103338), rel=1e-6) == (71.7e9 * of_strip.I2, G * of_strip.J)
    profile = IProfile(width=0.1, height=0.2, flange=0.01, web=0.006).properties(0.3)
    assert profile.I2 > 5 * profile.I3 and 0 < profile.shear3 < 1


def test_stretched_and_sheared_channels_are_the_section_forces():
    found = at_rest(cantilever(4, force="[3, 0]", torque=2.0))
    assert found["strip.element1.n1"] == pytest.approx(3 * math.cos(found["strip.node1.angle"] / 2), rel=1e-2)
    assert found["strip.element4.m3"] == pytest.approx(2, rel=0.2)


def test_modes_of_a_cantilever():
    """Euler and Bernoulli: (1.875104, 4.694091, 7.854757)^2 sqrt(EI/(rho A))/(2 pi)."""
    text = cantilever(16, stiffness="[1e6, 1e6, 1]").replace("inertia_per_length: 0.01", "inertia_per_length: 1e-9")
    found = stiffmbs.modes(stiffmbs.read_scene(text))
    frequencies = [mode.frequency for mode in found.modes[:3]]
    assert frequencies == pytest.approx([x**2 / math.tau for x in (1.8751041, 4.6940911, 7.8547574)], rel=3e-4)


def test_nodes_of_a_ring_have_continuous_angles():
    end = f"[{math.cos(1.75 * math.pi)!r}, {math.sin(1.75 * math.pi)!r}]"
    middle = f"[{math.cos(0.875 * math.pi)!r}, {math.sin(0.875 * math.pi)!r}]"
    text = cantilever(20, force="[1e-5, 0]").replace("[1, 0], elements", f"{end}, through: {middle}, elements")
    found = stiffmbs.equilibrium(
        stiffmbs.read_scene(
            text.replace("start: [0, 0]", "start: [1, 0]").replace(
                "strip.start, j: ground", "strip.start.ground_axes, j: {body: ground, point: [1, 0]}"
            )
        )
    )
    assert found.channels["strip.end.angle"] == pytest.approx(2.25 * math.pi, abs=1e-3)
    assert max(turn for _, turn in found.moved.values()) < 1e-3


def test_a_corner_of_two_beams_and_the_message_if_it_is_folded_straight():
    text = """
bodies:
  post: {type: beam, start: [0, 0], end: [0, 1], elements: 4, stiffness: [1e6, 1e6, 1e3], mass_per_length: 1, inertia_per_length: 1e-4}
  bar: {type: beam, start: [0, 1], end: [1, 1], elements: 4, stiffness: [1e6, 1e6, 1e3], mass_per_length: 1, inertia_per_length: 1e-4}
joints:
  foot: {type: fixed, i: post.start.ground_axes, j: ground}
  corner: {type: fixed, i: bar.start, j: post.end.ground_axes}
forces: {P: {type: force, i: bar.end, force: [0, -0.01]}}
"""
    found = stiffmbs.equilibrium(stiffmbs.read_scene(text))
    assert found.channels["bar.end.y"] - 1 == pytest.approx(-0.01 * (4 / 3e3 + 2e-6), rel=1e-4) and not found.notes
    folded = stiffmbs.equilibrium(stiffmbs.read_scene(text.replace("post.end.ground_axes", "post.end")))
    assert "the axes of a beam's node are along the beam, those of its marker post.end.ground_axes" in folded.notes[0]


@pytest.mark.parametrize("EI", [1e-4, 1e-2])
def test_a_cable_that_is_described_as_an_arc_hangs_as_an_elastic_catenary(EI):
    """Its bending stiffness is far below its tension times the square of an element's length."""
    EA, w, length, span = 1e6, 2 * 9.81, 10.5, 10.0
    V = w * length / 2
    H = brentq(lambda H: H * length / EA + 2 * H / w * math.asinh(V / H) - span, 1, 1e4)
    sag = V * length / (4 * EA) + H / w * (math.hypot(1, V / H) - 1)
    half = brentq(lambda angle: angle * span / math.sin(angle) - length, 0.1, 2)
    found = at_rest(f"""
gravity: [0, -9.81]
bodies:
  c: {{type: beam, start: [0, 0], through: [5, {-5 * math.tan(half / 2)!r}], end: [10, 0], elements: 20,
       stiffness: [1e6, 1e6, {EI}], mass_per_length: 2, inertia_per_length: 1e-6}}
joints:
  a: {{type: revolute, i: c.start, j: ground}}
  b: {{type: revolute, i: c.end, j: {{body: ground, point: [10, 0]}}}}
""")
    assert -found["c.node10.y"] == pytest.approx(sag, rel=1e-4)
    assert found["b.fx"] == pytest.approx(H, rel=1e-4)
