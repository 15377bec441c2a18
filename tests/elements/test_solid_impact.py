"""Two boxes, cylinders, ellipsoids or capsules in contact: energy, gaps, rest, Coulomb's law, corners and edges, in either order."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import stiffmbs

from .test_solids_in_contact import LAW, RUBBING, G, solved

BODY = "inertia: [0.004, 0.009, 0.01]"
BOX, PLATE = "box, i_size: [0.3, 0.2, 0.1]", "box, j_size: [2, 1, 0.2]"
SUNK = (G / 1e5) ** (2 / 3)


def pair(first, second):
    return f"type: solid_impact, i: b, j: ground, i_shape: {first}, j_shape: {second}"


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    ("first", "second", "start"),
    [
        (BOX, PLATE, "position: [0, 0, 0.4], omega: [1, 2, 3]"),
        (BOX, PLATE, "position: [1.1, 0, 0.17]"),  # over an edge
        ("cylinder, i_size: [0.1, 0.1, 0.6]", "cylinder, j_size: [0.2, 0.2, 0.6]", "position: [0.05, 0.02, 0.5], orientation: [0.6, 0.8, 0, 0]"),
        ("ellipsoid, i_size: [0.4, 0.2, 0.06]", "ellipsoid, j_size: [1, 1, 0.3]", "position: [0.1, 0.1, 0.25], omega: [1, 2, 3]"),
        ("cylinder, i_size: [0.2, 0.2, 0.3]", PLATE, "position: [0, 0, 0.5], omega: [2, 1, 0], orientation: [0.6, 0.8, 0, 0]"),
    ],
)  # fmt: skip
def test_energy_is_kept_over_impacts(first, second, start):
    found = solved(f"{pair(first, second)}, {LAW}", f"{BODY}, {start}")
    fallen = found["b.vz"] + G * found.time
    assert np.abs(fallen).max() > 0.5
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], rtol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("at", ["0, 0", "0.7, 0.3"])
def test_a_box_rests_on_another_at_one_depth_and_slides_by_coulombs_law(at):
    force, start = f"{pair(BOX, PLATE)}, {RUBBING}", f"{BODY}, position: [{at}, {0.15 - SUNK}]"
    found = solved(force, start, duration=0.05, points=6)
    np.testing.assert_allclose(found["b.z"], 0.15 - SUNK, atol=1e-5)
    found = solved(force, f"{start}, velocity: [1, 0, 0]", duration=0.02, points=6)
    np.testing.assert_allclose(found["b.vx"], 1 - 0.2 * G * found.time, atol=2e-3)


@pytest.mark.long
def test_logs_that_cross_carry_each_other():
    """No corner of one is in the other."""
    first, second = "box, i_size: [1, 0.1, 0.1]", "box, j_size: [0.1, 1, 0.1]"
    found = solved(f"{pair(first, second)}, {RUBBING}", f"{BODY}, position: [0, 0, {0.1 - SUNK}]")
    np.testing.assert_allclose(found["b.z"], 0.1 - SUNK, atol=1e-6)


@pytest.mark.long
def test_a_box_whose_middle_is_beyond_the_edge_tips_over():
    for x, falls in ((0.97, False), (1.03, True)):
        found = solved(f"{pair(BOX, PLATE)}, {RUBBING}", f"{BODY}, position: [{x}, 0, {0.15 - SUNK}]", duration=0.3)
        assert (found["b.z"][-1] < 0.1) == falls


@pytest.mark.long
def test_solids_that_pass_into_each_other_stop_the_run():
    found = solved(f"{pair(BOX, PLATE)}, stiffness: 10", f"{BODY}, position: [0, 0, 0.2]", duration=1)
    assert found.time[-1] < 1 and "found solids that overlap by a quarter of the smallest size" in found.message


def test_shapes_are_named():
    with pytest.raises(stiffmbs.InputError, match="i_shape"):
        solved(f"{pair('cone, i_size: [1, 1, 1]', PLATE)}, {LAW}", BODY)


SCENE = """dimensions: 3
gravity: {gravity}
bodies:
  a: {{mass: 1, inertia: [0.01, 0.01, 0.005], {a}}}
  b: {{mass: 1, inertia: [0.01, 0.01, 0.005], {b}}}
forces:
  c: {{type: capsule_impact, i: a, j: b, {capsules}, {law}}}
run: {{duration: {duration}, points: {points}, rtol: 1e-9}}
"""


def of_capsules(a, b, capsules, law, duration=1e-9, points=2, gravity=(0, 0, 0)):
    text = SCENE.format(
        a=a, b=b, capsules=capsules, law=law, duration=duration, points=points, gravity=list(map(float, gravity))
    )
    return stiffmbs.run(stiffmbs.read_scene(text))


def placed(turn, position=(0, 0, 0)):
    x, y, z, w = map(float, turn.as_quat())
    return f"orientation: [{w}, {x}, {y}, {z}], position: {list(map(float, position))}"


@pytest.mark.parametrize("seed", range(24))
def test_the_gap_is_the_least_distance_of_both_axes(seed):
    """At any angle, almost parallel ones and spheres too; the force acts along the shortest line."""
    rng = np.random.default_rng(seed)
    lengths = rng.uniform(0.1, 1, 2) * [seed % 5 > 0, seed % 7 > 0]
    at, first, second = rng.normal(size=3) * 0.4, *Rotation.random(2, random_state=seed)
    if seed % 3 == 0:
        second = first * Rotation.from_rotvec(rng.normal(size=3) * 10 ** rng.uniform(-6, -1))
    axes = np.array([first.apply([0, 0, 1]) * lengths[0], -second.apply([0, 0, 1]) * lengths[1]])

    def square(x):
        return float(np.sum((at + x @ axes) ** 2))

    starts = ([0, 0], [0.5, 0.5], [-0.5, 0.5], [0.5, -0.5])
    best = min((minimize(square, x, bounds=[(-0.5, 0.5)] * 2, tol=1e-15) for x in starts), key=lambda found: found.fun)
    distance, radius = np.sqrt(best.fun), 0.6 * np.sqrt(best.fun)
    capsules = f"radius: {radius}, length: {lengths[0]}, other_radius: {radius}, other_length: {lengths[1]}"
    found = of_capsules(placed(first, at), placed(second), capsules, "stiffness: 1, exponent: 1")
    force = np.array([found[f"c.f{axis}"][0] for axis in "xyz"])
    np.testing.assert_allclose(force, 0.2 * (at + best.x @ axes), atol=1e-7 * distance)


@pytest.mark.parametrize("seed", range(6))
def test_energy_and_momentum_are_kept_over_an_impact(seed):
    rng = np.random.default_rng(seed)
    first, second = Rotation.random(2, random_state=seed)
    a = f"{placed(first, [0.02, 0.03, 0.3])}, velocity: [0, 0, -2], omega: {rng.normal(size=3).tolist()}"
    b = f"{placed(second)}, omega: {rng.normal(size=3).tolist()}"
    capsules = "radius: 0.05, length: 0.4, other_radius: 0.04, other_length: 0.5"
    found = of_capsules(a, b, capsules, "stiffness: 1e4, exponent: 1.5", duration=0.3, points=61)
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], rtol=1e-6)
    for axis in "xyz":
        np.testing.assert_allclose(found[f"a.v{axis}"] + found[f"b.v{axis}"], -2.0 * (axis == "z"), atol=1e-7)
    assert found["a.vz"][-1] > -1.7


def test_friction_acts_at_the_surface():
    """A capsule that spins about its axis on a crossing one is pushed along it by mu N, at its radius."""
    across = Rotation.from_euler("x", 90, degrees=True)
    sunk = 1e-3
    a = f"{placed(across, [0, 0, 0.1 - sunk])}, omega: [0, 0, 50]"
    law = "stiffness: 1e4, exponent: 1, friction: 0.3, static_friction: 0.3, stiction_velocity: 1e-3, friction_velocity: 2e-3"
    capsules = "radius: 0.06, length: 0.3, other_radius: 0.04, other_length: 0.3"
    found = of_capsules(a, placed(Rotation.from_euler("y", 90, degrees=True)), capsules, law)
    normal = 1e4 * sunk
    assert found["c.fz"][0] == pytest.approx(normal, rel=1e-6)
    assert abs(found["c.fx"][0]) == pytest.approx(0.3 * normal, rel=1e-6)
    assert 0.005 * abs(found["a.wdz"][0]) == pytest.approx(0.3 * normal * 0.06, rel=1e-6)


def test_axes_that_meet_end_the_run():
    found = of_capsules(
        f"{placed(Rotation.identity(), [0.1, 0, 0])}, velocity: [-5, 0, 0]",
        placed(Rotation.from_euler("y", 90, degrees=True)),
        "radius: 0.03, length: 0.3, other_radius: 0.03, other_length: 0.3",
        "stiffness: 10, exponent: 1",
        duration=0.1,
        points=11,
    )
    assert found.time[-1] < 0.03 and "the axes of two capsules that meet" in found.message
