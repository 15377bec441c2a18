"""Contacts of cylinders, boxes, ellipsoids and spheres by IMPACT: energy, closed forms, shapes that touch as drawn."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.run import prepare
from stiffmbs.solve.trajectory import Outcome

G = 9.81
LAW = "stiffness: 1e5, exponent: 1.5"
RUBBING = f"{LAW}, damping: 300, depth: 1e-4, friction: 0.2, static_friction: 0.3, stiction_velocity: 1e-3, friction_velocity: 2e-3"


def solved(force, body, gravity=(0, 0, -G), duration=0.4, points=21):
    text = (
        f"dimensions: 3\ngravity: {list(gravity)}\nbodies:\n  b: {{mass: 1, {body}}}\nforces:\n  c: {{{force}}}\n"
        f"run: {{duration: {duration}, points: {points}, rtol: 1e-9}}\n"
    )
    return stiffmbs.run(stiffmbs.read_scene(text))


BALL = "inertia: [0.004, 0.004, 0.004]"
SPHERE_BOX = "type: sphere_box_impact, i: b, j: ground, radius: 0.1, x: 1, y: 0.8, z: 0.2"
SPHERE_CYLINDER = (
    "type: sphere_cylinder_impact, i: b, j: ground, radius: 0.1, cylinder_radius: 0.5, cylinder_length: 0.2"
)
CYLINDER = "type: cylinder_plane_impact, i: b, j: ground, radius: 0.1, length: 0.4"
ELLIPSOID = "type: ellipsoid_plane_impact, i: b, j: ground, x: 0.3, y: 0.2, z: 0.1"
BOX = "type: box_plane_impact, i: b, j: ground, x: 0.3, y: 0.2, z: 0.1"
SPHERES = "type: sphere_sphere_impact, i: b, j: ground, radius: 0.1, other_radius: 0.3"
FALLING = [  # by an edge, by a corner, tumbling
    (SPHERES, f"{BALL}, position: [0.2, 0.1, 0.5]"),
    (SPHERE_BOX, f"{BALL}, position: [0.55, 0, 0.25]"),
    (SPHERE_BOX, f"{BALL}, position: [0.54, 0.43, 0.25]"),
    (SPHERE_CYLINDER, f"{BALL}, position: [0.53, 0.1, 0.22]"),
    (
        CYLINDER,
        "inertia: [0.014, 0.014, 0.005], position: [0, 0, 0.2], orientation: [0.8, 0.6, 0, 0], omega: [1, 2, 3]",
    ),
    (ELLIPSOID, "inertia: [0.004, 0.009, 0.01], position: [0, 0, 0.2], omega: [1, 2, 3]"),
    (BOX, "inertia: [0.004, 0.009, 0.01], position: [0, 0, 0.2], omega: [1, 2, 3]"),
]


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize(("force", "body"), FALLING)
def test_energy_is_kept_over_impacts(force, body):
    found = solved(f"{force}, {LAW}", body)
    assert np.abs(found["c.fz"]).max() > 5 or np.abs(np.diff(found["b.vz"])).max() > 0.5
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], rtol=1e-6)


@pytest.mark.sampled(6)
@pytest.mark.long
@pytest.mark.parametrize(
    ("force", "inertia", "height", "points"),
    [
        (SPHERE_BOX, BALL, 0.2, 1),
        (SPHERE_CYLINDER, BALL, 0.2, 1),
        (CYLINDER, "inertia: [0.014, 0.005, 0.014], orientation: [0.5, 0.5, 0.5, 0.5]", 0.1, 2),
        (ELLIPSOID, "inertia: [0.01, 0.01, 0.01]", 0.1, 1),
        (BOX, "inertia: [0.004, 0.009, 0.01]", 0.05, 4),
    ],
)
def test_solids_rest_at_their_height_and_slide_by_coulombs_law(force, inertia, height, points):
    """At rest each point carries its part of the weight; sliding fast, mu g slows the body down."""
    sunk = (G / points / 1e5) ** (2 / 3)
    found = solved(f"{force}, {RUBBING}", f"{inertia}, position: [0, 0, {height - sunk}]", duration=0.05, points=6)
    np.testing.assert_allclose(found["b.z"], height - sunk, atol=1e-6)
    found = solved(
        f"{force}, {RUBBING}",
        f"{inertia}, position: [0, 0, {height - sunk}], velocity: [1, 0, 0]",
        duration=0.02,
        points=6,
    )
    np.testing.assert_allclose(found["b.vx"], 1 - 0.2 * G * found.time, atol=2e-3)


@pytest.mark.long
def test_a_ball_that_slides_over_another_is_pressed_on_by_its_weight_less_what_its_path_takes():
    """N = m (g n_z - v^2 / R) in the direction n of the centres, and mu N against the sliding."""
    sunk = (G / 1e5) ** (2 / 3)
    found = solved(
        f"{SPHERES}, {RUBBING}", f"{BALL}, position: [0, 0, {0.4 - sunk}], velocity: [1, 0, 0]", duration=0.02
    )
    x, z, later = found["b.x"], found["b.z"], found.time > 0.01  # settled to the path
    distance = np.hypot(x, z)
    normal = (found["c.fx"] * x + found["c.fz"] * z) / distance
    along = (found["c.fx"] * z - found["c.fz"] * x) / distance
    expected = G * z / distance - (found["b.vx"] ** 2 + found["b.vz"] ** 2) / distance
    np.testing.assert_allclose(normal[later], expected[later], rtol=0.05)
    np.testing.assert_allclose(along, -0.2 * normal, rtol=1e-4)


@pytest.mark.long
def test_a_sphere_meets_the_edge_of_a_box_at_its_distance():
    """Without gravity a sphere flies past an edge at 0.0999 m of it, or at 0.1001 m without any force."""
    for distance, touched in ((0.0999, True), (0.1001, False)):
        body = f"{BALL}, position: [{0.5 + distance / np.sqrt(2)}, -0.2, {0.1 + distance / np.sqrt(2)}], velocity: [0, 1, 0]"
        found = solved(f"{SPHERE_BOX}, {LAW}", body, (0, 0, 0), 0.1, 5)
        force = np.hypot(found["c.fx"], found["c.fz"])
        assert (force.max() > 0.01) == touched
        np.testing.assert_allclose(found["c.fx"], found["c.fz"], atol=1e-9)


def test_friction_needs_both_coefficients():
    with pytest.raises(stiffmbs.InputError, match="found one of friction and static_friction"):
        solved(f"{CYLINDER}, {LAW}, friction: 0.2", BALL)


@pytest.mark.long
@pytest.mark.parametrize("lean", [0.02, -0.03, 0.6])
def test_both_ends_of_a_leaning_cylinder_press_on_the_plane(lean):
    """k (-g)^1.5 at the lowest point of each rim, with its moment about the middle; 0.02 rad: both ends overlap."""
    height, length, radius = 0.095, 0.4, 0.1
    half = np.pi / 4 + lean / 2  # turns z to y, and down by the lean
    body = f"inertia: [0.014, 0.014, 0.005], position: [0, 0, {height}], orientation: [{np.cos(half)}, {-np.sin(half)}, 0, 0]"
    found = solved(f"{CYLINDER}, {LAW}", body, duration=1e-9, points=2)
    force = moment = 0.0
    for side in (0.5 * length, -0.5 * length):
        y, z = side * np.cos(lean), height - side * np.sin(lean)
        gap = z - radius * np.cos(lean)
        press = 1e5 * max(-gap, 0.0) ** 1.5
        force += press
        moment += press * (y - radius * np.sin(lean))
    assert force > 10
    assert found["c.fz"][0] == pytest.approx(force, rel=1e-6)
    assert found["b.az"][0] == pytest.approx(force - G, rel=1e-6)
    assert abs(0.014 * found["b.wdx"][0]) == pytest.approx(abs(moment), rel=1e-5)


@pytest.mark.long
@pytest.mark.parametrize(
    "settings", [{"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}], ids=lambda s: s["solver"]
)
def test_a_push_that_damping_ends_is_an_event_of_its_own(settings):
    """A ball touches, is no longer pushed while it still overlaps on its way back, and leaves."""
    scene = stiffmbs.read_scene(
        "dimensions: 3\ngravity: [0, 0, 0]\n"
        f"bodies: {{b: {{mass: 1, {BALL}, position: [0, 0, 0.2], velocity: [0, 0, -3]}}}}\n"
        "forces: {c: {type: ellipsoid_plane_impact, i: b, j: ground, x: 0.1, y: 0.1, z: 0.1, stiffness: 1e5, exponent: 1.5, "
        "damping: 60, depth: 1e-6}}\n"
        "run: {duration: 0.5, rtol: 1e-7}\n"
    )
    assert prepare(scene, **settings).integrate().statistics["events"] == 3


@pytest.mark.long
@pytest.mark.parametrize(
    "settings", [{"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}], ids=lambda s: s["solver"]
)
def test_a_sphere_whose_centre_enters_a_solid_ends_the_run_at_its_surface(settings):
    """The normal of the contact is not defined at the surface: the run ends at a thousandth of the radius from it."""
    scene = stiffmbs.read_scene(
        f"dimensions: 3\nbodies: {{b: {{mass: 1, {BALL}, position: [0, 0, 0.25], velocity: [0, 0, -1]}}}}\n"
        f"forces: {{c: {{{SPHERE_BOX}, stiffness: 1, exponent: 1.5}}}}\n"
        "run: {duration: 0.5, points: 51, rtol: 1e-9}\n"
    )
    solution = stiffmbs.run(scene, **settings)
    assert solution.outcome is not Outcome.DONE and "'c'" in solution.message
    assert solution["b.z"][-1] == pytest.approx(0.1 + 1e-4, abs=1.1e-2) and solution["b.z"][-1] > 0.1
    assert solution.time[-1] < 0.15 + 1e-3
