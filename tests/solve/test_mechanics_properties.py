"""Laws that every scene obeys, over random scenes: energy, momentum, virtual work."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import Body, Model
from tests.stress.random_tree import random_tree

from ..random_parts import random_element, three_bodies

SEEDS = st.integers(0, 2**32 - 1)
FEW = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(1, 5), st.integers(0, 3))
def test_energy_of_an_undamped_scene_is_kept(seed, count, springs):
    rng = np.random.default_rng(seed)
    model = random_tree(rng, count, gravity=True, grounded=True, springs=min(springs, count))
    solution = stiffmbs.run(model, duration=0.5, points=51, rtol=1e-9)
    assert solution.energy_drift() < 1e-5 * (1 + np.max(solution["energy.kinetic"]))


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 5))
def test_momentum_of_a_free_scene_is_kept(seed, count):
    rng = np.random.default_rng(seed)
    model = random_tree(rng, count, gravity=False, grounded=False, springs=1)
    solution = stiffmbs.run(model, duration=0.5, points=51, rtol=1e-9)
    bodies = model.bodies
    linear = [sum(body.mass * solution[f"{name}.{axis}"] for name, body in bodies.items()) for axis in ("vx", "vy")]
    angular = sum(
        body.inertia * solution[f"{name}.omega"]
        + body.mass * (solution[f"{name}.x"] * solution[f"{name}.vy"] - solution[f"{name}.y"] * solution[f"{name}.vx"])
        for name, body in bodies.items()
    )
    for momentum in (*linear, angular):
        assert np.max(np.abs(momentum - momentum[0])) < 1e-6 * (1 + np.max(np.abs(momentum)))


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(1, 5))
def test_joints_do_no_work(seed, count):
    """The reaction on the first body, and its opposite on the second at the same point, have no power together."""
    rng = np.random.default_rng(seed)
    model = random_tree(rng, count, gravity=True, grounded=True, springs=0)
    solution = stiffmbs.run(model, duration=0.2, points=11, rtol=1e-6)
    for name, joint in model.joints.items():
        force = np.array([solution[f"{name}.fx"], solution[f"{name}.fy"]])
        torque = solution[f"{name}.torque"]
        point = _point(solution, joint.i)
        power = np.zeros_like(solution.time)
        for sign, marker in ((1, joint.i), (-1, joint.j)):
            if marker.body != "ground":
                body = marker.body
                arm = point - np.array([solution[f"{body}.x"], solution[f"{body}.y"]])
                omega = solution[f"{body}.omega"]
                velocity = np.array([solution[f"{body}.vx"] - omega * arm[1], solution[f"{body}.vy"] + omega * arm[0]])
                power += sign * (np.sum(force * velocity, axis=0) + torque * omega)
        assert np.max(np.abs(power)) < 1e-9 * (1 + np.max(np.abs(force)) + np.max(np.abs(torque)))


def _point(solution, marker):
    x, y, angle = (solution[f"{marker.body}.{name}"] for name in ("x", "y", "angle"))
    xi, eta = marker.point
    return np.array([x + np.cos(angle) * xi - np.sin(angle) * eta, y + np.sin(angle) * xi + np.cos(angle) * eta])


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(1, 4))
def test_newtons_law_for_every_body(seed, count):
    """Mass times acceleration is weight, spring and joint forces together: nothing is lost between the channels."""
    rng = np.random.default_rng(seed)
    model = random_tree(rng, count, gravity=True, grounded=True, springs=2)
    solution = stiffmbs.run(model, duration=0.1, points=5, rtol=1e-6)
    for name, body in model.bodies.items():
        force = np.array([[body.mass * g] * len(solution.time) for g in model.gravity])
        for element_name, element in (*model.joints.items(), *model.forces.items()):
            reaction = np.array([solution[f"{element_name}.fx"], solution[f"{element_name}.fy"]])
            force += reaction * ((element.i.body == name) * 1.0 - (element.j.body == name) * 1.0)
        acceleration = np.array([solution[f"{name}.ax"], solution[f"{name}.ay"]])
        np.testing.assert_allclose(body.mass * acceleration, force, atol=1e-9 * (1 + np.max(np.abs(force))))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(4))
def test_both_integrators_agree(seed):
    rng = np.random.default_rng(seed)
    model = random_tree(rng, 3, gravity=True, grounded=True, springs=1)
    implicit = stiffmbs.run(model, duration=0.3, points=4, rtol=1e-9)
    explicit = stiffmbs.run(model, duration=0.3, points=4, solver="projected", step=2e-5)
    for name in implicit:
        if name.endswith((".x", ".y", ".angle")):
            np.testing.assert_allclose(explicit[name], implicit[name], atol=2e-3)


def test_a_free_body_falls():
    model = Model(gravity=(0, -9.81))
    model.add("stone", Body(mass=2, inertia=1, velocity=(1, 2), omega=3))
    solution = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-9)
    np.testing.assert_allclose(solution["stone.x"], solution.time, atol=1e-8)
    np.testing.assert_allclose(solution["stone.y"], 2 * solution.time - 9.81 / 2 * solution.time**2, atol=1e-8)
    np.testing.assert_allclose(solution["stone.angle"], 3 * solution.time, atol=1e-8)


def test_reaction_of_a_force_element_is_what_it_does_to_its_first_body():
    """A stretched, damped spring: tension k (L - L0) + c L' towards the other end."""
    model = Model()
    model.add("a", Body(mass=1, inertia=1, position=(3, 4), velocity=(0.3, 0.4)))
    model.add("s", stiffmbs.SpringDamper(i="a", j="ground", stiffness=10, damping=2, free_length=4, preload=1))
    solution = stiffmbs.run(model, duration=1e-3, points=2)
    tension = 10 * (5 - 4) + 2 * 0.5 + 1
    assert solution["s.fx"][0] == pytest.approx(-tension * 0.6)
    assert solution["s.fy"][0] == pytest.approx(-tension * 0.8)
    assert solution["s.torque"][0] == pytest.approx(0)


def test_torque_is_about_the_joints_point():
    """A beam clamped to ground at its end carries its weight and its moment there."""
    model = Model(gravity=(0, -10))
    beam = model.add("beam", Body(mass=3, inertia=1, position=(0.5, 0)))
    model.add("clamp", stiffmbs.Fixed(i=beam.at(-0.5, 0), j="ground"))
    solution = stiffmbs.run(model, duration=0.1, points=2)
    assert solution["clamp.fy"][0] == pytest.approx(30)
    assert solution["clamp.torque"][0] == pytest.approx(15)


def test_spring_of_no_length_is_defined():
    model = Model()
    model.add("a", Body(mass=1, inertia=1, velocity=(1.0, 0)))
    model.add("s", stiffmbs.SpringDamper(i="a", j="ground", stiffness=4.0))
    solution = stiffmbs.run(model, duration=2.0, points=21, rtol=1e-9)
    np.testing.assert_allclose(solution["a.x"], np.sin(2 * solution.time) / 2, atol=1e-7)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", ["force", "torque", "spring_damper"])
def test_a_force_between_bodies_leaves_momentum_alone(kind):
    rng = np.random.default_rng(1)
    model = three_bodies(rng, gravity=False)
    model.add("force", random_element(stiffmbs.model.model.FORCES[kind], rng))
    solution = stiffmbs.run(model, duration=0.2, points=3, rtol=1e-9)
    momentum = sum(body.mass * solution[f"{name}.vx"] for name, body in model.bodies.items())
    np.testing.assert_allclose(momentum, momentum[0], atol=1e-7)
