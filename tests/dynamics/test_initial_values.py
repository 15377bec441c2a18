"""Assembly: smallest moves, velocity corrections, what is reported, and what cannot be assembled."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AssemblyError, Body, ConstraintEquation, InputError, Model, Prismatic, Revolute


def pendulum(**start):
    model = Model(gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, **start))
    model.add("pin", Revolute(i=bar.at(-1, 0), j="ground"))
    return model


@pytest.mark.parametrize("off", [1e-1, 1e-3, 1e-6, 1e-12])
def test_positions_are_assembled_by_a_small_move(off):
    solution = stiffmbs.run(pendulum(position=(1 + off, -off)), duration=1e-3, points=2)
    assert solution["constraint.position"][0] < 1e-12
    moved = abs(solution["bar.x"][0] - 1 - off) + abs(solution["bar.y"][0] + off) + abs(solution["bar.angle"][0])
    assert moved <= 3 * off
    assert any("bar" in note for note in solution.notes) == (off > 1e-9)


def test_velocities_are_corrected_by_least_kinetic_energy():
    """A blow on a pinned bar: the pin's impulse is all that changes, so moments about it are kept."""
    solution = stiffmbs.run(pendulum(position=(1, 0), velocity=(0.7, 2.0)), duration=1e-6, points=2)
    assert solution["constraint.velocity"][0] < 1e-14
    assert solution["bar.omega"][0] == pytest.approx(2.0 * 1 * 1 / (0.1 + 1), rel=1e-6)
    assert any("bar.omega" in note for note in solution.notes)


def test_what_cannot_be_assembled_names_the_joint_with_the_gap():
    model = pendulum(position=(1, 0))
    model.add(
        "far", Revolute(i=stiffmbs.Marker(body="bar", point=(1, 0)), j=stiffmbs.Marker(body="ground", point=(5, 0)))
    )
    with pytest.raises(AssemblyError, match=r"cannot be assembled.*(far|pin)"):
        stiffmbs.run(model)


def test_equations_that_repeat_each_other_are_left_out_and_told():
    model = pendulum(position=(1, 0))
    model.add("again", Revolute(i=stiffmbs.Marker(body="bar", point=(-1, 0)), j="ground"))
    twice, once = (stiffmbs.run(m, duration=0.5, points=11, rtol=1e-9) for m in (model, pendulum(position=(1, 0))))
    np.testing.assert_allclose(twice["bar.angle"], once["bar.angle"], atol=1e-7)
    for axis in ("fx", "fy"):
        np.testing.assert_allclose(twice[f"pin.{axis}"] + twice[f"again.{axis}"], once[f"pin.{axis}"], atol=1e-5)
    assert twice.not_unique == ("pin.fx", "pin.fy", "again.fx", "again.fy")
    assert any("again" in note and "pin" in note for note in twice.notes)


def test_a_driven_coordinate_starts_with_its_own_velocity():
    model = Model()
    cart = model.add("cart", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="cart", j="ground"))
    import sympy

    model.add("motor", ConstraintEquation(zero=cart.x - 0.5 * sympy.sin(3 * sympy.Symbol("t"))))
    solution = stiffmbs.run(model, duration=2.0, points=21, rtol=1e-9)
    np.testing.assert_allclose(solution["cart.x"], 0.5 * np.sin(3 * solution.time), atol=1e-8)
    assert solution["cart.vx"][0] == pytest.approx(1.5)
    np.testing.assert_allclose(solution["motor.fx"], -2 * 4.5 * np.sin(3 * solution.time), atol=1e-9)


def test_initial_accelerations_and_multipliers_satisfy_newton():
    solution = stiffmbs.run(pendulum(position=(1, 0)), duration=1e-3, points=2)
    assert solution["bar.alpha"][0] == pytest.approx(-9.81 / 1.1)
    assert solution["pin.fy"][0] == pytest.approx(9.81 - 9.81 / 1.1)


def test_an_equation_without_coordinates_is_refused():
    model = pendulum(position=(1, 0))
    model.add("nothing", ConstraintEquation(zero="bar.x - bar.x"))
    with pytest.raises(InputError, match=r"nothing.*no coordinate"):
        stiffmbs.run(model)


def test_a_force_that_is_not_finite_at_the_start_is_named():
    model = pendulum(position=(1, 0))
    model.add("root", ConstraintEquation(zero="sqrt(bar.x - 2)"))
    with pytest.raises(AssemblyError, match=r"root"):
        stiffmbs.run(model)


@pytest.mark.filterwarnings("error")
def test_an_equation_with_an_infinite_derivative_at_the_start_is_named():
    """The gap of sqrt(x) - y is zero at the origin, its derivative is not finite there."""
    model = Model()
    model.add("bar", Body(mass=1, inertia=0.1))
    model.add("root", ConstraintEquation(zero="sqrt(bar.x) - bar.y"))
    with pytest.raises(AssemblyError, match=r"'root' has no finite value"):
        stiffmbs.run(model)
