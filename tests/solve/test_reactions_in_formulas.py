"""Forces and states by formulas of joints' reactions: against friction elements, closed forms and another formulation."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import (
    AppliedForce,
    AppliedTorque,
    Body,
    JointFriction,
    Marker,
    Model,
    Prismatic,
    Revolute,
    State,
    spatial,
)
from stiffmbs.errors import InputError

MU, SMOOTH = 0.3, 0.05


def sliding(friction):
    """A bar that swings on a cart; the cart rubs on its rail by the force that presses it."""
    model = Model("rubbing cart", gravity=(0, -9.81))
    model.add("cart", Body(mass=2, inertia=1, velocity=(1, 0)))
    model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="cart"))
    model.add("friction", friction)
    model.add("work", State(rate=f"{MU}*abs(fy(rail))*cart.vx*tanh(cart.vx/{SMOOTH})", start="0 J"))
    return model


FORMULA = AppliedForce(i="cart", force=(f"-{MU}*abs(fy(rail))*tanh(cart.vx/{SMOOTH})", 0))


@pytest.mark.long
@pytest.mark.parametrize(
    "settings",
    [
        {"solver": "bdf"},
        {"solver": "projected"},
        {"solver": "bdf", "formulation": "SI1"},
        {"solver": "bdf", "formulation": "index1"},
    ],
)
def test_friction_by_formula_is_that_of_the_element(settings):
    chosen = {"duration": 1.0, "points": 21, "rtol": 1e-9, **settings}
    element = JointFriction(joint="rail", friction=MU, stiction_velocity=SMOOTH)
    by_formula, by_element = (stiffmbs.run(sliding(friction), **chosen) for friction in (FORMULA, element))
    assert by_formula["cart.x"] == pytest.approx(by_element["cart.x"], abs=1e-6)
    assert by_formula["rail.fy"] == pytest.approx(by_element["rail.fy"], rel=1e-5, abs=1e-4)
    lost = by_formula["energy.total"][0] - by_formula["energy.total"]
    assert by_formula["work"] == pytest.approx(lost, abs=1e-6)
    assert by_formula["work.rate"] == pytest.approx(
        MU * np.abs(by_formula["rail.fy"]) * by_formula["cart.vx"] * np.tanh(by_formula["cart.vx"] / SMOOTH),
        rel=1e-9,
        abs=1e-12,
    )


@pytest.mark.parametrize(
    "settings", [{"solver": "bdf"}, {"solver": "projected"}, {"solver": "projected", "scheme": "rk4", "step": 1e-3}]
)
def test_the_integral_of_a_reaction_is_the_impulse(settings):
    """int fy dt = m (vy - vy0) + m g t of a pendulum."""
    model = Model("pendulum", gravity=(0, -9.81))
    model.add("bar", Body(mass=2, inertia=0.03, position=(0.3, 0)))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground"))
    model.add("impulse", State(rate="fy(hinge)", start="0 N s"))
    solution = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-9, **settings)
    impulse = 2 * (solution["bar.vy"] - solution["bar.vy"][0] + 9.81 * solution.time)
    assert solution["impulse"] == pytest.approx(impulse, abs=1e-6)


@pytest.mark.long
def test_a_reaction_in_a_formula_is_its_channel_in_space_too():
    scene = stiffmbs.spatial.in_space(sliding(FORMULA))
    planar = stiffmbs.run(sliding(FORMULA), duration=0.5, points=6, rtol=1e-9)
    solution = stiffmbs.run(scene, duration=0.5, points=6, rtol=1e-9)
    assert solution["cart.x"] == pytest.approx(planar["cart.x"], abs=1e-7)
    assert solution["friction.fx"] == pytest.approx(
        -MU * np.abs(solution["rail.fy"]) * np.tanh(solution["cart.vx"] / SMOOTH), rel=1e-8
    )


@pytest.mark.long
def test_a_spatial_joints_components_are_its_channels():
    model = spatial.Model("top", gravity=(0, 0, -9.81))
    model.add("bar", spatial.Body(mass=1, inertia=(0.01, 0.03, 0.03), position=(0.3, 0.1, 0), omega=(3, 1, 2)))
    model.add("hinge", spatial.Revolute(i=spatial.Marker(body="bar", point=(-0.3, 0, 0)), j="ground"))
    for name in ("fx", "fy", "fz", "tx", "ty", "tz"):
        model.add(f"of_{name}", State(rate=f"{name}(hinge)", start=0))
    solution = stiffmbs.run(model, duration=0.3, points=7, rtol=1e-8)
    for name in ("fx", "fy", "fz", "tx", "ty", "tz"):
        assert solution[f"of_{name}.rate"] == pytest.approx(solution[f"hinge.{name}"], rel=1e-9, abs=1e-9)


def test_reactions_that_are_not_unique_are_told():
    model = Model("two pins", gravity=(0, -9.81))
    model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    model.add("left", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground"))
    model.add("right", Revolute(i=Marker(body="bar", point=(0.3, 0)), j=Marker(body="ground", point=(0.6, 0))))
    model.add("drag", AppliedTorque(i="bar", torque="-0.1*fx(left)"))
    solution = stiffmbs.run(model, duration=0.1)
    assert any("depends on reactions of left and right that are not unique" in note for note in solution.notes)
    assert "drag.torque" in solution.not_unique


@pytest.mark.parametrize(
    ("force", "message"),
    [
        ("fy(rails)", "found 'fy\\(rails\\)' \\(did you mean 'rail'\\?\\) in .*, expected one of the joints rail"),
        ("fz(rail)", "found 'fz\\(rail\\)' in .*, expected one of fx, fy, tz"),
        ("fy(rail, cart)", "expected the name of one joint"),
        ("tz(rail) + 1 N", "expected one unit in both"),
    ],
)
def test_faults_are_told_in_a_sentence(force, message):
    text = f"""
bodies: {{cart: {{mass: 1, inertia: 1}}}}
joints: {{rail: {{type: prismatic, i: cart, j: ground}}}}
forces: {{push: {{type: force, i: cart, force: ["{force}", 0]}}}}
"""
    with pytest.raises(InputError, match=message):
        stiffmbs.read_scene(text)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("torque", ["-0.3*tanh(fx(hinge)/0.2)", "-0.3*max(fx(hinge), 2)", "-0.3*abs(fy(hinge) - 10)"])
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_laws_of_a_reaction_need_no_event_functions(torque, solver):
    """Their breakpoints are found in the reactions that accelerations give, in a scene without any other event."""
    model = Model("pendulum", gravity=(0, -9.81))
    model.add("bar", Body(mass=1.2, inertia=0.036, position=(0.3, 0)))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground"))
    model.add("torque", AppliedTorque(i="bar", torque=torque))

    def found(**settings):
        return stiffmbs.run(model, duration=1.0, points=11, rtol=1e-8, errors=False, **settings)["bar.angle"]

    assert found(solver=solver) == pytest.approx(found(solver="projected", scheme="dop853"), abs=5e-6)
