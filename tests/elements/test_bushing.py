"""Bushings against closed forms: each direction, coupled directions, preload, curves, axes."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Bushing, Marker, Model, compile_model

from ..closed_forms import momenta, oscillation, two_bodies

FINE = {"rtol": 1e-10, "points": 101}
TURN = 0.4
MASS, INERTIA = 2.0, 0.5


def bushed(x=0.0, y=0.0, angle=0.0, **fields):
    """A body held at its centre by a bushing whose axes are turned by 0.4 rad; x, y along them."""
    c, s = np.cos(TURN), np.sin(TURN)
    model = Model()
    position = (c * x - s * y, s * x + c * y)
    model.add("block", Body(mass=MASS, inertia=INERTIA, position=position, angle=TURN + angle))
    model.add("bushing", Bushing(i="block", j=Marker(body="ground", angle=TURN), **fields))
    return model


def deformation(solution):
    c, s = np.cos(TURN), np.sin(TURN)
    x, y = solution["block.x"], solution["block.y"]
    return np.array([c * x + s * y, -s * x + c * y, solution["block.angle"] - TURN])


@pytest.mark.parametrize("direction", range(3))
def test_bushing_oscillates_along_each_of_its_axes(direction):
    stiffness, damping = (300.0, 900.0, 40.0), (1.5, 6.0, 0.3)
    start = [0.0, 0.0, 0.0]
    start[direction] = 0.02
    solution = stiffmbs.run(bushed(*start, stiffness=stiffness, damping=damping), duration=1, **FINE)
    inertia = (MASS, MASS, INERTIA)[direction]
    omega = np.sqrt(stiffness[direction] / inertia)
    expected = np.zeros((3, len(solution.time)))
    expected[direction] = oscillation(solution.time, 0.02, omega, damping[direction] / (2 * inertia * omega))
    np.testing.assert_allclose(deformation(solution), expected, atol=1e-9)


COUPLED = np.array([[500.0, 120.0, -30.0], [120.0, 800.0, 45.0], [-30.0, 45.0, 90.0]])


@pytest.mark.parametrize("mode", range(3))
def test_coupled_bushing_swings_in_its_eigenmodes(mode):
    from scipy.linalg import eigh

    squares, shapes = eigh(COUPLED, np.diag([MASS, MASS, INERTIA]))
    solution = stiffmbs.run(bushed(*(0.01 * shapes[:, mode]), stiffness=COUPLED.tolist()), duration=1, **FINE)
    expected = 0.01 * np.outer(shapes[:, mode], np.cos(np.sqrt(squares[mode]) * solution.time))
    np.testing.assert_allclose(deformation(solution), expected, atol=1e-8)
    assert solution.energy_drift() < 1e-8


def test_preload_is_balanced_where_the_deformation_says():
    preload = np.array([10.0, -20.0, 3.0])
    at_rest = np.linalg.solve(COUPLED, preload)
    model = bushed(*at_rest, stiffness=COUPLED.tolist(), preload=preload.tolist())
    solution = stiffmbs.run(model, duration=1e-3, points=2)
    for name in ("ax", "ay", "alpha"):
        assert abs(solution[f"block.{name}"][0]) < 1e-12
    undeformed = stiffmbs.run(bushed(stiffness=COUPLED.tolist(), preload=preload.tolist()), duration=1e-3, points=2)
    c, s = np.cos(TURN), np.sin(TURN)
    found = [undeformed[f"bushing.{name}"][0] for name in ("fx", "fy", "torque")]
    np.testing.assert_allclose(found, [c * 10 + s * 20, s * 10 - c * 20, 3.0], rtol=1e-12)


@pytest.mark.parametrize("axes", ["j", "ground"])
def test_a_preloaded_bushing_keeps_energy(axes):
    model = bushed(0.02, -0.03, 0.1, stiffness=COUPLED.tolist(), preload=(10, -20, 3), axes=axes)
    solution = stiffmbs.run(model, duration=1, **FINE)
    assert np.ptp(solution["energy.kinetic"]) > 0.1
    assert solution.energy_drift() < 1e-7


@pytest.mark.long
def test_bushing_by_curves_keeps_energy_and_is_stiffer_where_they_say():
    law = {"table": [[-0.1, -300], [0, 0], [0.1, 300]], "lines": True}
    model = bushed(0.02, -0.03, 0.1, stiffness=(1, 1, 1), law_x="1e6*s^3 - s", law_y=law, law_angle="40*s")
    solution = stiffmbs.run(model, duration=1, **FINE)
    assert solution.energy_drift() < 1e-6
    x, y, angle = deformation(solution)[:, 0]
    expected = 1e6 * x**4 / 4 + 3001 * y**2 / 2 + 41 * angle**2 / 2
    assert solution["energy.potential"][0] == pytest.approx(expected, rel=1e-9)
    force = np.hypot(solution["bushing.fx"][0], solution["bushing.fy"][0])
    assert force == pytest.approx(np.hypot(1e6 * x**3, 3001 * y), rel=1e-9)


def test_bushing_in_ground_axes_keeps_momentum_and_energy():
    model = two_bodies(Bushing, stiffness=COUPLED.tolist(), axes="ground")
    solution = stiffmbs.run(model, duration=1, **FINE)
    px, py, _ = momenta(model, solution)
    assert np.ptp(px) < 1e-8 and np.ptp(py) < 1e-8
    assert solution.energy_drift() < 1e-6


def test_directions_that_are_not_coupled_cost_nothing():
    """Three numbers compile to fewer terms than a full matrix, and give the same force."""
    forces = []
    for stiffness in ((3, 4, 5), np.diag([3.0, 4.0, 5.0]).tolist()):
        model = two_bodies(Bushing, stiffness=stiffness)
        (group,) = compile_model(model.data()).groups
        solution = stiffmbs.run(model, duration=0.1, points=2)
        forces.append([solution[f"element.{name}"][0] for name in ("fx", "fy", "torque")])
        forces.append(len(group.numbers))
    np.testing.assert_allclose(forces[0], forces[2], rtol=1e-13)
    assert forces[3] - forces[1] == 6
