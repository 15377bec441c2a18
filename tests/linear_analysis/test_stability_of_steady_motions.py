"""Motions beside a steady one, against closed forms."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import SteadyMotion, spatial


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_free_body_that_spins_about_a_principal_axis(axis):
    """Euler: motions beside it grow, or nutate, by w sqrt((I - I1)(I2 - I)/(I1 I2)); about the middle axis they grow."""
    moments, rate = (0.1, 0.2, 0.25), 3.0
    model = spatial.Model("spinning")
    model.add("b", spatial.Body(mass=1, inertia=moments))
    rotation = tuple(rate * (k == axis) for k in range(3))
    found = stiffmbs.equilibrium(model, motion=SteadyMotion(rotation=rotation))
    own, (one, other) = moments[axis], np.delete(moments, axis)
    square = rate**2 * (own - one) * (other - own) / (one * other)
    values = np.array(found.eigenvalues)
    assert ("unstable" in found.notes[0]) == (square > 0)
    assert np.min(np.abs(values - np.sqrt(complex(square)))) < 1e-7
    assert values.real.max() == pytest.approx(np.sqrt(max(square, 0.0)), abs=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("part", [0.9, 1.1])
def test_a_disc_that_rolls_upright_falls_below_its_critical_speed(examples, part):
    """Thin disc: l^2 = (m g R A - C (C + m R^2) w^2)/(A (A + m R^2)); Neimark and Fufaev (1972), chapter III."""
    mass, radius = 2.0, 0.3
    rate = part * float(np.sqrt(9.81 / (3 * radius)))
    changes = {"lean": f"{np.pi / 2!r} rad", "falling": "0 rad/s", "turning": "0 rad/s", "rolling": f"{rate!r} rad/s"}
    scene = stiffmbs.load_scene(examples / "rolling_disc.yaml", list(changes.items()))
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(velocity=(-radius * rate, 0, 0), rolling=("disc",)))
    across, along, contact = mass * radius**2 / 4, mass * radius**2 / 2, mass * radius**2
    square = (mass * 9.81 * radius * across - along * (along + contact) * rate**2) / (across * (across + contact))
    assert ("unstable" in found.notes[0]) == (part < 1)
    assert np.min(np.abs(np.array(found.eigenvalues) - np.sqrt(complex(square)))) < 1e-6


def test_a_steady_motion_with_dampers_is_told_stable(examples):
    found = stiffmbs.equilibrium(examples / "governor.yaml", motion=SteadyMotion(rotation=6.0))
    assert found.notes == ("the steady motion is stable: no disturbance grows",)
    assert found.as_dict("governor")["eigenvalues"][0] == pytest.approx([0, 0], abs=1e-4)
