"""Friction in joints: sliding, sticking, and reactions that hang on the friction that they press."""

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs
from stiffmbs import (
    AppliedForce,
    AppliedTorque,
    AssemblyError,
    Body,
    Fixed,
    InputError,
    JointFriction,
    Marker,
    Model,
    Prismatic,
    Revolute,
)

G = 9.81


def block_on_incline(slope, **friction):
    model = Model(gravity=(0, -G))
    model.add("block", Body(mass=2, inertia=0.1, angle=slope))
    model.add("guide", Prismatic(i="block", j=Marker(body="ground", angle=slope)))
    model.add("rubbing", JointFriction(joint="guide", **friction))
    return model


def test_a_block_slides_down_an_incline_with_g_sin_minus_mu_cos():
    slope, mu = np.radians(30), 0.2
    solution = stiffmbs.run(block_on_incline(slope, friction=mu), duration=1, rtol=1e-8, points=11)
    along = solution["block.ax"] * np.cos(slope) + solution["block.ay"] * np.sin(slope)
    assert along[0] == pytest.approx(-G * np.sin(slope), rel=1e-9)  # not yet sliding
    np.testing.assert_allclose(along[1:], -G * (np.sin(slope) - mu * np.cos(slope)), rtol=1e-9)
    braking = solution["rubbing.fx"] * np.cos(slope) + solution["rubbing.fy"] * np.sin(slope)
    np.testing.assert_allclose(braking[1:], mu * 2 * G * np.cos(slope), rtol=1e-9)


def test_a_block_on_a_flat_incline_creeps_as_the_smoothing_says():
    slope, mu, smooth = np.radians(10), 0.3, 1e-3
    model = block_on_incline(slope, friction=mu, stiction_velocity=smooth)
    solution = stiffmbs.run(model, duration=0.1, rtol=1e-8, points=11)
    speed = -solution["block.vx"][-1] / np.cos(slope)
    assert speed == pytest.approx(smooth * np.arctanh(np.tan(slope) / mu), rel=1e-6)


def test_static_friction_is_larger_and_falls_with_speed():
    """A slow belt (imposed by a large mass) feels mu_s, a fast one mu_d."""
    for speed, expected in ((2e-3, 0.1 + 0.3 * np.exp(-(0.2**2))), (1.0, 0.1)):
        model = Model(gravity=(0, -G))
        model.add("block", Body(mass=1e6, inertia=1, velocity=(speed, 0)))
        model.add("guide", Prismatic(i="block", j="ground"))
        model.add("rubbing", JointFriction(joint="guide", friction=0.1, static_friction=0.4))
        solution = stiffmbs.run(model, duration=1e-6, points=2)
        assert solution["rubbing.fx"][0] == pytest.approx(-expected * 1e6 * G, rel=1e-9)


def test_the_moment_on_a_guide_presses_at_its_ends():
    model = Model()
    model.add("slider", Body(mass=2, inertia=0.1, velocity=(3, 0)))
    model.add("guide", Prismatic(i="slider", j="ground"))
    model.add("twist", AppliedTorque(i="slider", torque=5))
    model.add("load", AppliedForce(i="slider", force=(0, -4)))
    model.add("rubbing", JointFriction(joint="guide", friction=0.2, length=0.25))
    solution = stiffmbs.run(model, duration=0.1, rtol=1e-8, points=5)
    np.testing.assert_allclose(solution["slider.ax"], -0.2 * (4 + 5 / 0.125) / 2, rtol=1e-9)


def test_a_loaded_disc_is_braked_evenly_by_its_pin():
    model = Model()
    model.add("disc", Body(mass=3, inertia=0.05, omega=10))
    model.add("pin", Revolute(i="disc", j="ground"))
    model.add("load", AppliedForce(i="disc", force=(0, -100)))
    model.add("rubbing", JointFriction(joint="pin", friction=0.1, radius=0.02))
    solution = stiffmbs.run(model, duration=1, rtol=1e-8, points=11)
    np.testing.assert_allclose(solution["disc.omega"], 10 - 0.1 * 100 * 0.02 / 0.05 * solution.time, atol=1e-6)
    np.testing.assert_allclose(solution["rubbing.torque"], -0.2, rtol=1e-9)


def test_without_load_a_pin_turns_freely():
    model = Model()
    model.add("disc", Body(mass=3, inertia=0.05, omega=10))
    model.add("pin", Revolute(i="disc", j="ground"))
    model.add("rubbing", JointFriction(joint="pin", friction=0.9, radius=0.02))
    solution = stiffmbs.run(model, duration=1, points=11)
    np.testing.assert_allclose(solution["disc.omega"], 10, rtol=1e-8)


LENGTH, MASS, INERTIA = 0.3, 1.2, 0.04


@pytest.mark.parametrize(("mu", "radius"), [(0.2, 0.02), (0.9, 0.05), (0.9, 0.12)])
def test_a_pin_and_its_friction_are_found_together(mu, radius):
    """Bar pendulum: the torque of friction moves the bar, and so the reaction that makes the friction."""
    angle, omega = 0.7, 2.0
    model = Model(gravity=(0, -G))
    c, s = np.cos(angle), np.sin(angle)
    velocity = (-LENGTH * omega * s, LENGTH * omega * c)
    model.add(
        "bar",
        Body(
            mass=MASS, inertia=INERTIA, position=(LENGTH * c, LENGTH * s), angle=angle, velocity=velocity, omega=omega
        ),
    )
    model.add("pin", Revolute(i=Marker(body="bar", point=(-LENGTH, 0)), j="ground"))
    model.add("rubbing", JointFriction(joint="pin", friction=mu, radius=radius))
    solution = stiffmbs.run(model, duration=1e-3, points=2)

    def reaction(alpha):
        ax, ay = LENGTH * (-alpha * s - omega**2 * c), LENGTH * (alpha * c - omega**2 * s)
        return MASS * ax, MASS * (ay + G)

    def balance(alpha):
        torque = -mu * np.hypot(*reaction(alpha)) * radius
        return (INERTIA + MASS * LENGTH**2) * alpha + MASS * G * LENGTH * c - torque

    alpha = brentq(balance, -1e3, 1e3, xtol=1e-14)
    assert solution["bar.alpha"][0] == pytest.approx(alpha, rel=1e-9)
    np.testing.assert_allclose([solution["pin.fx"][0], solution["pin.fy"][0]], reaction(alpha), rtol=1e-9)


def slider_crank(mu):
    model = Model(gravity=(0, -G))
    model.add("crank", Body(mass=1, inertia=0.01, position=(0.1, 0), omega=8))
    model.add("rod", Body(mass=1, inertia=0.03, position=(0.5, 0), omega=-4))
    model.add("slider", Body(mass=2, inertia=0.01, position=(0.8, 0)))
    model.add("ground_pin", Revolute(i=Marker(body="crank", point=(-0.1, 0)), j="ground"))
    model.add("crank_pin", Revolute(i=Marker(body="crank", point=(0.1, 0)), j=Marker(body="rod", point=(-0.3, 0))))
    model.add("wrist_pin", Revolute(i=Marker(body="rod", point=(0.3, 0)), j="slider"))
    model.add("guide", Prismatic(i="slider", j="ground"))
    for name in ("ground_pin", "crank_pin", "wrist_pin"):
        model.add(f"{name}_rubbing", JointFriction(joint=name, friction=mu, static_friction=1.3 * mu, radius=0.02))
    model.add("guide_rubbing", JointFriction(joint="guide", friction=mu, length=0.1))
    return model


@pytest.mark.parametrize("settings", [{"rtol": 1e-8}, {"solver": "projected", "scheme": "dopri5", "rtol": 1e-8}])
def test_a_slider_crank_loses_what_its_joints_rub_away(settings):
    solution = stiffmbs.run(slider_crank(0.1), duration=0.5, output=1e-4, **settings)
    omega = {name: solution[f"{name}.omega"] for name in ("crank", "rod", "slider")}
    power = solution["ground_pin_rubbing.torque"] * omega["crank"]
    power += solution["crank_pin_rubbing.torque"] * (omega["crank"] - omega["rod"])
    power += solution["wrist_pin_rubbing.torque"] * (omega["rod"] - omega["slider"])
    power += solution["guide_rubbing.fx"] * solution["slider.vx"]
    assert np.all(power <= 0)
    lost = solution["energy.total"] - solution["energy.total"][0]
    assert lost[-1] < -0.2
    found = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(solution.time))])
    np.testing.assert_allclose(found, lost, atol=1e-4)


@pytest.mark.parametrize(
    ("joint", "fields", "sentence"),
    [
        (
            Fixed,
            {"radius": 0.1},
            "rubbing.joint: found 'joint', which is of type fixed, expected a prismatic or revolute",
        ),
        (Revolute, {}, "rubbing.radius: found none for the revolute joint 'joint', expected the radius of its pin"),
        (Prismatic, {"joint": "rail"}, "rubbing.joint: found the unknown joint 'rail'"),
        (Prismatic, {"friction": -0.1}, "friction: found -0.1, expected a number of 0 or more"),
        (Prismatic, {"stiction_velocity": 0}, "stiction_velocity: found 0, expected a velocity greater than 0"),
        (Prismatic, {"length": "3 kg"}, "length: found '3 kg', which is in kg, expected a length"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(joint, fields, sentence):
    model = Model()
    model.add("block", Body(mass=1, inertia=1))
    model.add("joint", joint(i="block", j="ground"))
    with pytest.raises(InputError, match=sentence):
        model.add("rubbing", JointFriction(**{"joint": "joint", "friction": 0.1} | fields))


@pytest.mark.parametrize(
    ("old", "new"), [("smooth_velocity", "stiction_velocity"), ("stribeck_velocity", "friction_velocity")]
)
def test_an_old_name_of_a_field_is_refused_with_the_new_one(examples, old, new):
    sentence = f"found '{old}', expected its new name '{new}'"
    for kind in (JointFriction, stiffmbs.Contact, stiffmbs.spatial.JointFriction, stiffmbs.spatial.SphereContact):
        with pytest.raises(InputError, match=sentence):
            kind(**{old: 0.1})
    with pytest.raises(InputError, match=rf"forces\.\w+: {sentence}"):
        stiffmbs.load_scene(examples / "stick_slip.yaml", [(f"forces.rubbing.{old}", "1 mm/s")])


def test_a_jam_is_put_down_to_friction():
    """A guide of length l at the arm h jams where mu exceeds l/(2 h): no balance, though the equations are independent."""
    model = Model(gravity=(0, -G))
    model.add("block", Body(mass=1, inertia=0.01, velocity=(-0.5, 0)))
    below = {"point": (0, -1)}
    model.add("guide", Prismatic(i=Marker(body="block", **below), j=Marker(body="ground", **below)))
    model.add("rubbing", JointFriction(joint="guide", friction=0.5, length=0.01))
    with pytest.raises(AssemblyError, match=r"friction and reactions.*no unique solution.*rubbing"):
        stiffmbs.run(model, duration=0.1)
