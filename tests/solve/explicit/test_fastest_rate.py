"""The fastest rate of a motion against closed forms."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Bushing, Marker, Model, Prismatic, Revolute
from stiffmbs.analyses.job import prepare
from stiffmbs.solve.explicit.stable_step import rates_at


def rates_of(model, **settings):
    job = prepare(model, presolve=False, **settings)
    return rates_at(job.dynamics, 0.0, job.start.q, job.start.u)


def rate_of(model, **settings):
    return rates_of(model, **settings).fastest


def on_bushing(stiffness, damping, position=(0, 0)):
    model = Model(gravity=(0, -9.81))
    model.add("a", Body(mass=2, inertia=0.5, position=position))
    model.add("bush", Bushing(i="a", j=Marker(body="ground"), stiffness=stiffness, damping=damping))
    return model


def test_an_undamped_bushing_rings_at_its_stiffest_direction():
    found = rate_of(on_bushing((2e6, 3e8, 1e3), (0, 0, 0)))
    np.testing.assert_allclose(found, np.sqrt(3e8 / 2), rtol=0.02)


def test_strong_damping_is_faster_than_a_soft_spring():
    np.testing.assert_allclose(rate_of(on_bushing((1e2, 1e2, 1e2), (0, 0, 4e4))), 4e4 / 0.5, rtol=0.02)


def test_the_damping_of_the_excited_vibration_is_not_that_of_another_motion():
    """A bushing that is stiff along x is damped along y, 40 times as much; displaced by 1 mm, it starts to vibrate along x."""
    found = rates_of(on_bushing((3e8, 1e2, 1e2), (1e2, 4e3, 0), (1e-3, 0)))
    frequency = np.sqrt(3e8 / 2)
    np.testing.assert_allclose((found.vibration, found.excited), frequency, rtol=0.02)
    np.testing.assert_allclose((found.decay, found.damping), (1e2 / 2, 4e3 / 2), rtol=0.02)
    np.testing.assert_allclose(found.decay_ratio, 0.25 * 1e2 / frequency, rtol=0.03)
    np.testing.assert_allclose(found.velocity, (1e-3 * frequency, 0, 0), atol=0.02 * 1e-3 * frequency)


def test_a_stiff_vibration_at_rest_is_not_excited():
    """Gravity lets the body fall along y, where the bushing is soft and its damping large."""
    found = rates_of(on_bushing((3e8, 1e2, 1e2), (1e2, 4e3, 0)))
    np.testing.assert_allclose((found.excited, found.decay), (np.sqrt(1e2 / 2), 4e3 / 2), rtol=0.02)
    assert found.decay_ratio == 0.5
    np.testing.assert_allclose(found.velocity, (0, 9.81 / np.sqrt(1e2 / 2), 0), rtol=0.02, atol=1e-9)


def test_a_joint_takes_damping_along_it_out_of_the_motion():
    """A damper of any strength on a slider that a rod holds does not damp the spring across it."""
    model = on_bushing((0, 2e6, 0), (1e9, 0, 0))
    model.add("rail", Prismatic(i=Marker(body="a", angle=np.pi / 2), j=Marker(body="ground", angle=np.pi / 2)))
    found = rates_of(model)
    assert found.damping < 1.0
    assert found.damping_ratio < 1e-3
    np.testing.assert_allclose(found.vibration, 1e3, rtol=0.02)


def test_a_joint_takes_the_stiffness_along_it_out_of_the_motion():
    """What is left of a bar pinned where a bushing of any stiffness holds it is the pendulum."""
    model = Model(gravity=(0, -9.81))
    model.add("bar", Body(mass=1.2, inertia=0.036, position=(0, -0.3)))
    pin = Marker(body="bar", point=(0, 0.3))
    model.add("hinge", Revolute(i=pin, j="ground"))
    model.add("bush", Bushing(i=pin, j=Marker(body="ground"), stiffness=(1e9, 1e9, 0), damping=(0, 0, 0)))
    expected = np.sqrt(1.2 * 9.81 * 0.3 / (0.036 + 1.2 * 0.3**2))
    np.testing.assert_allclose(rate_of(model), expected, rtol=0.02)


@pytest.mark.parametrize("scene", ["stick_slip", "cam_follower"])
def test_the_state_is_left_as_it_was(examples, scene):
    job = prepare(stiffmbs.load_scene(examples / f"{scene}.yaml"), presolve=False)
    rates_at(job.dynamics, 0.0, job.start.q, job.start.u)
    np.testing.assert_array_equal(job.dynamics.state.q, job.start.q)
    np.testing.assert_array_equal(job.dynamics.state.u, job.start.u)
