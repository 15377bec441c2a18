"""Two boxes, cylinders or ellipsoids in contact: energy, rest, Coulomb's law, corners and edges, in either order."""

import numpy as np
import pytest

import stiffmbs

from .test_solids_in_contact import LAW, RUBBING, G, solved

pytestmark = pytest.mark.long

BODY = "inertia: [0.004, 0.009, 0.01]"
BOX, PLATE = "box, i_size: [0.3, 0.2, 0.1]", "box, j_size: [2, 1, 0.2]"
SUNK = (G / 1e5) ** (2 / 3)


def pair(first, second):
    return f"type: solid_impact, i: b, j: ground, i_shape: {first}, j_shape: {second}"


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


@pytest.mark.parametrize("at", ["0, 0", "0.7, 0.3"])
def test_a_box_rests_on_another_at_one_depth_and_slides_by_coulombs_law(at):
    force, start = f"{pair(BOX, PLATE)}, {RUBBING}", f"{BODY}, position: [{at}, {0.15 - SUNK}]"
    found = solved(force, start, duration=0.05, points=6)
    np.testing.assert_allclose(found["b.z"], 0.15 - SUNK, atol=1e-5)
    found = solved(force, f"{start}, velocity: [1, 0, 0]", duration=0.02, points=6)
    np.testing.assert_allclose(found["b.vx"], 1 - 0.2 * G * found.time, atol=2e-3)


def test_logs_that_cross_carry_each_other():
    """No corner of one is in the other."""
    first, second = "box, i_size: [1, 0.1, 0.1]", "box, j_size: [0.1, 1, 0.1]"
    found = solved(f"{pair(first, second)}, {RUBBING}", f"{BODY}, position: [0, 0, {0.1 - SUNK}]")
    np.testing.assert_allclose(found["b.z"], 0.1 - SUNK, atol=1e-6)


def test_a_box_whose_middle_is_beyond_the_edge_tips_over():
    for x, falls in ((0.97, False), (1.03, True)):
        found = solved(f"{pair(BOX, PLATE)}, {RUBBING}", f"{BODY}, position: [{x}, 0, {0.15 - SUNK}]", duration=0.3)
        assert (found["b.z"][-1] < 0.1) == falls


def test_solids_that_pass_into_each_other_stop_the_run():
    found = solved(f"{pair(BOX, PLATE)}, stiffness: 10", f"{BODY}, position: [0, 0, 0.2]", duration=1)
    assert found.time[-1] < 1 and "found solids that overlap by a quarter of the smallest size" in found.message


def test_shapes_are_named():
    with pytest.raises(stiffmbs.InputError, match="i_shape"):
        solved(f"{pair('cone, i_size: [1, 1, 1]', PLATE)}, {LAW}", BODY)
