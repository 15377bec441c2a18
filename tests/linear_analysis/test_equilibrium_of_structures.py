"""Equilibria of columns, suspensions and large structures."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Marker, Model, Revolute, TorsionSpring
from stiffmbs.errors import SolverError


def column(load, links=2, offset=0.0):
    """Upright links with torsion springs between them, under a dead load at the top."""
    bodies = {
        f"link{k}": {"mass": 0.1, "inertia": 0.01, "position": [0, k + 0.5], "angle": np.pi / 2} for k in range(links)
    }
    joints, forces = (
        {},
        {"load": {"type": "force", "i": {"body": f"link{links - 1}", "point": [0.5, offset]}, "force": [0, -load]}},
    )
    for k in range(links):
        below = {"body": f"link{k - 1}", "point": [0.5, 0]} if k else {"body": "ground"}
        turned = {"free_angle": np.pi / 2} if k == 0 else {}
        joints[f"pin{k}"] = {"type": "revolute", "i": {"body": f"link{k}", "point": [-0.5, 0]}, "j": below}
        forces[f"spring{k}"] = {
            "type": "torsion_spring", "i": f"link{k}", "j": below["body"], "stiffness": 10, **turned,
        }  # fmt: skip
    return {"bodies": bodies, "joints": joints, "forces": forces}


def read(content):
    return stiffmbs.read_scene(json.dumps(content))


@pytest.mark.long
@pytest.mark.parametrize("load, buckled", [(3.5, False), (4.2, True), (30.0, True)])
def test_a_column_of_two_links_buckles_at_its_critical_load(load, buckled):
    """P_1 = k/L (3 - sqrt 5)/2 = 3.82 N (Timoshenko and Gere, Theory of Elastic Stability, 1961, sec. 2.1)."""
    found = stiffmbs.equilibrium(read(column(load)))
    tip = found.channels["link1.x"]
    assert (abs(tip) > 0.1) == buckled
    assert any("of 2 branches from it" in note for note in found.notes) == buckled
    a, b = (found.channels[f"link{k}.angle"] - np.pi / 2 for k in (0, 1))
    assert 10 * a - 10 * (b - a) == pytest.approx(load * np.sin(a), abs=1e-8)
    assert 10 * (b - a) == pytest.approx(load * np.sin(b), abs=1e-8)


@pytest.mark.long
def test_a_column_of_ten_links_under_far_too_much_load():
    found = stiffmbs.equilibrium(read(column(20.0, links=10)))
    modes = stiffmbs.modes(read(column(20.0, links=10)), start_from=found.solution)
    assert max(value.real for mode in modes.modes for value in mode.eigenvalues) < 1e-6
    assert any("unstable" in note for note in found.notes)


def test_an_eccentric_load_says_nothing_of_branches():
    assert stiffmbs.equilibrium(read(column(30.0, offset=0.05))).notes == ()


SUSPENSION = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {lift: 0}
bodies:
  chassis: {mass: 400, inertia: [60, 60, 60], position: [0, 0, 0.6 + lift]}
  arm: {mass: 6, inertia: [0.2, 0.05, 0.2], position: [0, 0.5, 0.35 + lift]}
  carrier: {mass: 40, inertia: [1.2, 2, 1.2], position: [0, 0.7, 0.4 + lift]}
joints:
  frame: {type: prismatic, i: chassis, j: ground}
  pivot: {type: revolute, i: {body: arm, point: [0, -0.2, 0], orientation: {z: [1, 0, 0]}},
          j: {body: chassis, point: [0, 0.3, -0.25], orientation: {z: [1, 0, 0]}}}
  ball: {type: spherical, i: {body: arm, point: [0, 0.15, -0.05]}, j: {body: carrier, point: [0, -0.05, -0.1]}}
  tie_rod: {type: distance, i: {body: chassis, point: [-0.15, 0.25, -0.2]}, j: {body: carrier, point: [-0.15, -0.06, 0]}, length: 0.39}
forces:
  leaf: {type: bushing, i: {body: carrier, point: [0, -0.05, 0.15]}, j: {body: chassis, point: [0, 0.65, 0.05]},
         stiffness: [3e6, 1e5, 35900, 2000, 500, 2000], axes: ground}
  tyre: {type: sphere_contact, i: carrier, j: ground, radius: 0.35, stiffness: 460e3, exponent: 1}
"""
"""A wheel carrier under a leaf spring, led by a lower arm and a tie rod, on a tyre, as in the Iltis; round numbers."""


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("lift", [-0.1, 0.0, 0.2])
def test_a_leaf_spring_and_a_tie_rod_carry_the_car_from_any_height(lift):
    scene = stiffmbs.read_scene(SUSPENSION, [("lift", str(lift))])
    found = stiffmbs.equilibrium(scene)
    weight = 9.81 * 446
    assert abs(found.channels["tyre.fz"] - weight) < 1e-9 * weight
    assert found.channels["carrier.z"] == pytest.approx(0.35 - weight / 460e3, abs=1e-9)
    still = stiffmbs.run(scene, start_from=found.solution, duration=10.0, rtol=1e-9, points=101)
    for body in ("chassis", "arm", "carrier"):
        for axis in "xyz":
            assert np.ptp(still[f"{body}.{axis}"]) < 1e-8


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("count", [200, pytest.param(1000, marks=pytest.mark.long)])
def test_many_bodies_hang_as_a_catenary_of_springs_says(count):
    """Weights on springs: each carries what hangs below it."""
    mass, stiffness = 0.01, 1e3
    bodies = {f"b{k}": {"mass": mass, "inertia": 1e-4, "position": [0, -0.1 * (k + 1)]} for k in range(count)}
    forces = {
        f"s{k}": {"type": "bushing", "i": f"b{k}", "j": {"body": f"b{k - 1}" if k else "ground", "point": [0, -0.1]},
                  "stiffness": [1e3, stiffness, 10]}
        for k in range(count)
    }  # fmt: skip
    found = stiffmbs.equilibrium(read({"gravity": [0, -9.81], "bodies": bodies, "forces": forces}))
    sag = mass * 9.81 / stiffness * count * (count + 1) / 2
    assert found.channels[f"b{count - 1}.y"] == pytest.approx(-0.1 * count - sag, rel=1e-10)
    assert not found.notes  # stable, and nothing free


@pytest.mark.long
def test_a_long_strut_finds_its_stable_branch_as_the_elastica_has_it():
    """Euler's column, clamped below, of 120 rods: Timoshenko and Gere, Theory of Elastic Stability, 2nd ed., table 2-1."""
    count, load = 120, 1.152 * np.pi**2 / 4
    model = Model("strut")
    below = Marker(body="ground", point=(0, 0))
    for k in range(count):
        rod = model.add(f"b{k}", Body(mass=1 / count, inertia=1 / count**3 / 12, position=(0, (k + 0.5) / count)))
        foot = rod.at(0, -0.5 / count)
        model.add(f"pin{k}", Revolute(i=foot, j=below))
        model.add(f"bend{k}", TorsionSpring(i=foot, j=below, stiffness=count if k else 2 * count))
        below = rod.at(0, 0.5 / count)
    model.add("load", AppliedForce(i=below, force=(0, -load)))
    found = stiffmbs.equilibrium(model)
    assert any("unstable" in note and "of 2 branches from it" in note for note in found.notes)
    assert abs(found.channels[f"b{count - 1}.x"]) == pytest.approx(0.593, abs=0.01)
    assert found.channels[f"b{count - 1}.y"] == pytest.approx(0.741, abs=0.01)


def test_the_body_with_the_largest_imbalance_is_named(few_moves):
    scene = "gravity: [0, -9.81]\nbodies: {light: {mass: 1, inertia: 1}, heavy: {mass: 5, inertia: 1}}"
    with pytest.raises(SolverError, match=r"the largest imbalance is heavy\.fy"):
        stiffmbs.equilibrium(stiffmbs.read_scene(scene))


@pytest.mark.long
def test_wheels_that_spin_freely_are_free_and_not_unstable(examples):
    found = stiffmbs.equilibrium(examples / "vehicles" / "leaf_sprung_car.yaml")
    assert not any("unstable" in note for note in found.notes)
    wheels = [f"{axle}.{side}_wheel.wy" for axle in ("front", "rear") for side in ("left", "right")]
    assert set(found.free) == {*wheels, "chassis.vx", "chassis.vy", "chassis.wz"}
