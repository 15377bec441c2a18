"""Bodies that hardly resist: explicit steps follow the motion, however small mass and inertia are, not the rounding of accelerations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import Body, Model, Prismatic, Revolute, TorsionSpring, spatial
from stiffmbs.dynamics.dynamics import Dynamics
from tests.stress.families.stiffness.light_bodies import sprung as sprung_at

G = 9.81


def sprung(inertia):
    """A point mass of 2 kg on a hinge, 0.5 m from it, with a torsion spring of 100 N m/rad, at 1 rad."""
    model = Model(gravity=(0, -G))
    mass = model.add("mass", Body(mass=2, inertia=inertia, position=(0.5 * np.sin(1), -0.5 * np.cos(1)), angle=1.0))
    model.add("hinge", Revolute(i=mass.at(0, 0.5), j="ground"))
    model.add("spring", TorsionSpring(i="mass", j="ground", stiffness=100))
    return model


def two_in_a_chain(inertia):
    model = sprung(inertia)
    second = model.add(
        "second", Body(mass=1, inertia=inertia, position=(0.5 * np.sin(1) + 0.5, -0.5 * np.cos(1)), angle=np.pi / 2)
    )
    model.add("hinge2", Revolute(i=second.at(0, 0.5), j="mass"))
    model.add("spring2", TorsionSpring(i="second", j="mass", stiffness=50))
    return model


def massless_link(inertia):
    """A body hangs from a link that is as light; the link carries a torsion spring."""
    model = Model(gravity=(0, -G))
    link = model.add("link", Body(mass=inertia, inertia=inertia, position=(0.25, 0)))
    body = model.add("mass", Body(mass=3, inertia=0.1, position=(0.5, -0.2)))
    model.add("p1", Revolute(i=link.at(-0.25, 0), j="ground"))
    model.add("p2", Revolute(i=body.at(0, 0.2), j=link.at(0.25, 0)))
    model.add("spring", TorsionSpring(i="link", j="ground", stiffness=100))
    return model


def massless_coupler(inertia):
    """A crank of 1 kg drives a slider of 1 kg by a coupler that is as light."""
    model = Model(gravity=(0, -G))
    end = 0.2 + np.sqrt(0.36 - 0.04)
    crank = model.add("mass", Body(mass=1, inertia=0.1, position=(0.1, 0.1), angle=np.pi / 4, omega=3.0))
    rod = model.add(
        "rod", Body(mass=inertia, inertia=inertia, position=((0.2 + end) / 2, 0.1), angle=np.arctan2(-0.2, end - 0.2))
    )
    model.add("slider", Body(mass=1, inertia=1, position=(end, 0)))
    model.add("o", Revolute(i=crank.at(-0.1 * np.sqrt(2), 0), j="ground"))
    model.add("k", Revolute(i=rod.at(-0.3, 0), j=crank.at(0.1 * np.sqrt(2), 0)))
    model.add("w", Revolute(i="slider", j=rod.at(0.3, 0)))
    model.add("rail", Prismatic(i="slider", j="ground"))
    return model


def in_space(inertia):
    """The same sprung mass, about the negative y axis of space."""
    model = spatial.Model(gravity=(0, 0, -G))
    model.add("mass", spatial.Body(mass=2, inertia=(inertia,) * 3, position=(0.5 * np.sin(1), 0, -0.5 * np.cos(1))))
    at = (-0.5 * np.sin(1), 0, 0.5 * np.cos(1))
    axis = {"z": (0, -1, 0), "x": (1, 0, 0)}
    hinge = {
        "i": spatial.Marker(body="mass", point=at, orientation=axis),
        "j": spatial.Marker(body="ground", orientation=axis),
    }
    model.add("hinge", spatial.Revolute(**hinge))
    model.add("spring", spatial.TorsionSpring(**hinge, stiffness=100, free_angle=-1.0))
    return model


SCENES = [sprung, two_in_a_chain, massless_link, massless_coupler]


@pytest.mark.parametrize("scheme", ["dop853", "dopri5"])
@pytest.mark.parametrize("inertia", [1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("scene", SCENES)
def test_steps_are_those_of_the_motion(scene, inertia, scheme):
    how = {"solver": "projected", "scheme": scheme, "rtol": 1e-8, "duration": 1.0, "points": 11}
    light, heavier = (stiffmbs.run(scene(i), **how) for i in (inertia, 1e-6))
    assert light.solver["steps"] <= 1.2 * heavier.solver["steps"] + 3
    np.testing.assert_allclose(light["mass.x"], heavier["mass.x"], atol=1e-5)


@pytest.mark.parametrize("inertia", [1e-9, 1e-12, 1e-15])
def test_the_sprung_mass_moves_as_its_equation_says(inertia):
    """2*0.25 phi'' = -100 phi - 2 g 0.5 sin(phi)."""
    solution = stiffmbs.run(sprung(inertia), solver="auto", rtol=1e-9, duration=1.0, points=11)
    expected = solve_ivp(
        lambda t, y: (y[1], -(100 * y[0] + G * np.sin(y[0])) / 0.5),
        (0, 1),
        (1.0, 0.0),
        "DOP853",
        solution.time,
        rtol=1e-12,
        atol=1e-12,
    )
    np.testing.assert_allclose(solution["mass.angle"], expected.y[0], atol=1e-7)
    assert solution.solver["steps"] < 100


def test_accelerations_keep_their_digits():
    dynamics = Dynamics(stiffmbs.compile.compile_model.compile_model(sprung(1e-12).data()))
    state = dynamics.state
    found = []
    for angle in 1 + 1e-13 * np.arange(10):
        state.q[:] = 0.5 * np.sin(angle), -0.5 * np.cos(angle), angle
        found.append(dynamics.accelerate(0.0)[1][2])
    np.testing.assert_allclose(found, -(100 + G * np.sin(1)) / 0.5, rtol=1e-11)


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
def test_elimination_is_left_where_it_loses_digits(rtol):
    """Let go at the height of its hinge: there the pivots of J M^-1 J^T keep their digits, and u' = M^-1 (f - J^T lam) does not."""
    how = {"solver": "projected", "scheme": "dop853", "rtol": rtol, "duration": 1.0, "points": 11}
    light, heavier = (stiffmbs.run(sprung_at(inertia, np.pi / 2), **how) for inertia in (1e-12, 1e-6))
    assert light.solver["steps"] < heavier.solver["steps"] + 2000
    np.testing.assert_allclose(light["mass.angle"], heavier["mass.angle"], atol=1e-4)


@pytest.mark.parametrize("inertia", [1e-9, 1e-12])
def test_in_space_as_in_the_plane(inertia):
    how = {"solver": "projected", "scheme": "dop853", "rtol": 1e-8, "duration": 1.0, "points": 11}
    space, plane = stiffmbs.run(in_space(inertia), **how), stiffmbs.run(sprung(inertia), **how)
    assert space.solver["steps"] < 1.5 * plane.solver["steps"] + 10
    np.testing.assert_allclose(space["mass.x"], plane["mass.x"], atol=1e-5)
