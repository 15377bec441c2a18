"""A bushing in place of a redundant joint: unique reactions, and the rigid motion in the limit."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Bushing, Marker, Model, Revolute

STIFFNESSES = (1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10)


def parallelogram(stiffness=None, damping_ratio=0.1):
    """A coupler hanging on two cranks, and on a third one between them by a bushing, where a stiffness is given."""
    model = Model("parallelogram", gravity=(0, -9.81))
    angle = np.radians(-60)
    c, s = np.cos(angle), np.sin(angle)
    model.add("coupler", Body(mass=2, inertia=1, position=(1 + c, s)))
    for name, x in (("a", 0.0), ("b", 1.0), ("c", 2.0)):
        if name == "b" and stiffness is None:
            continue
        model.add(name, Body(mass=1, inertia=1 / 12, position=(x + c / 2, s / 2), angle=angle))
        model.add(f"{name}_foot", Revolute(i=Marker(body=name, point=(-0.5, 0)), j=Marker(body="ground", point=(x, 0))))
        i, j = Marker(body=name, point=(0.5, 0)), Marker(body="coupler", point=(x - 1, 0))
        if name == "b":
            damping = 2 * damping_ratio * np.sqrt(stiffness)
            bushing = Bushing(i=i, j=j, stiffness=(stiffness, stiffness, 0), damping=(damping, damping, 0))
            model.add("bushing", bushing)
        else:
            model.add(f"{name}_head", Revolute(i=i, j=j))
    return model


@pytest.fixture(scope="module")
def runs():
    return {k: stiffmbs.run(parallelogram(k), duration=2.0, points=201, rtol=1e-8) for k in STIFFNESSES}


@pytest.fixture(scope="module")
def rigid():
    """Angle of the cranks: (3 m l^2/3 + m_c l^2) th'' = -(3 m l/2 + m_c l) g cos th."""
    from scipy.integrate import solve_ivp

    pull = -9.81 * (3 * 0.5 + 2) / (3 / 3 + 2)
    t = np.linspace(0, 2, 201)
    return solve_ivp(
        lambda t, y: [y[1], pull * np.cos(y[0])], (0, 2), [-np.pi / 3, 0], "DOP853", t, rtol=1e-12, atol=1e-12
    ).y[0]


@pytest.mark.long
def test_step_count_hardly_grows_over_six_decades_of_stiffness(runs):
    steps = [solution.solver["steps"] for solution in runs.values()]
    assert max(steps) < 3 * steps[0], steps


def test_motion_converges_to_the_rigid_one(runs, rigid):
    errors = [np.max(np.abs(solution["a.angle"] - rigid)) for solution in runs.values()]
    assert max(errors) < 3e-5, errors
    assert errors[-1] < 1e-6, errors
    soft = (1e4, 1e5, 1e6)
    runs = [stiffmbs.run(parallelogram(k, 1.0), duration=2.0, points=201, rtol=1e-9) for k in soft]
    errors = [np.max(np.abs(solution["a.angle"] - rigid)) for solution in runs]
    assert errors[1] < errors[0] / 5
    assert errors[2] < errors[1] / 5


def test_reactions_are_unique_and_settle():
    """In mid-swing each bushing force is one number, which no longer changes as the stiffness grows."""
    tight = [
        stiffmbs.run(parallelogram(k, damping_ratio=1.0), duration=1.0, points=3, rtol=1e-10) for k in (1e4, 1e5, 1e6)
    ]
    assert all(solution.not_unique == () for solution in tight)
    forces = np.array([[solution["bushing.fx"][1], solution["bushing.fy"][1]] for solution in tight])
    assert np.max(np.ptp(forces, axis=0)) < 1e-3
    assert np.linalg.norm(forces[-1]) > 0.05
