"""Contacts of spheres: their derivatives, Hertz's impact, restitution, sliding and rolling."""

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs
from stiffmbs import spatial
from stiffmbs.compile.state import State

from ..spatial_closed_forms import hertz_impact
from ..spatial_pairs import two_bodies
from .test_element_derivatives import assert_close, derivative, term
from .test_spatial_forces import CLOSED

FINE = {"rtol": 1e-10, "points": 101}


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "surface", [pytest.param(name, marks=() if name == "plane" else pytest.mark.long) for name in CLOSED]
)
def test_derivatives_of_a_closed_contact_that_slides(surface):
    fields = CLOSED[surface] | {"dissipation": 0.1, "friction": 0.3, "static_friction": 0.5, "stiction_velocity": 0.5}
    state = State(stiffmbs.compile_model(two_bodies(spatial.SphereContact, 4, **fields).data()))

    assert np.max(np.abs(term(state, "motion", "f"))) > 1
    assert_close(term(state, "tangent", "f_q"), derivative(lambda: term(state, "motion", "f"), state.q))
    assert_close(term(state, "tangent", "f_u"), derivative(lambda: term(state, "motion", "f"), state.u))


def ball(mass=2.0, radius=0.1, **fields):
    model = spatial.Model(gravity=(0, 0, 0 if "free" in fields else -9.81))
    fields.pop("free", None)
    inertia = (0.4 * mass * radius**2,) * 3
    model.add("ball", spatial.Body(mass=mass, inertia=inertia, **fields))
    return model


def test_an_elastic_impact_takes_as_long_and_goes_as_deep_as_hertz_says():
    mass, speed, k = 2.0, 1.5, 1e6
    depth, duration = hertz_impact(mass=mass, speed=speed, stiffness=k)
    model = ball(mass, free=True, position=(0.3, 0.2, 0.1), velocity=(0, 0, -speed))
    model.add("floor", spatial.SphereContact(i="ball", j="ground", radius=0.1, stiffness=k))
    solution = stiffmbs.run(model, duration=1.5 * duration, rtol=1e-10, points=2001)
    z, closed = solution["ball.z"], solution.time[solution["floor.fz"] > 0]
    assert 0.1 - np.min(z) == pytest.approx(depth, rel=1e-6)
    assert closed[-1] == pytest.approx(duration, abs=solution.time[1])
    assert solution["ball.vz"][-1] == pytest.approx(speed, rel=1e-8)


@pytest.mark.parametrize("dissipation", [0.1, 1.0, 4.0])
def test_restitution_follows_from_the_dissipation(dissipation):
    """Hunt and Crossley's law integrates: chi v - log(1 + chi v) is the same before and after, v outwards below zero."""
    speed, normal = 0.8, np.array([2, 1, -2]) / 3
    kept = dissipation * speed - np.log1p(dissipation * speed)
    after = brentq(lambda v: -dissipation * v - np.log1p(-dissipation * v) - kept, 0, (1 - 1e-9) / dissipation)
    model = ball(free=True, velocity=tuple(speed / 2 * normal))
    other = {"position": tuple(0.2 * normal), "velocity": tuple(-speed / 2 * normal)}
    model.add("other", spatial.Body(mass=2, inertia=(0.008,) * 3, **other))
    radii = {"surface": "sphere", "radius": 0.1, "surface_radius": 0.1}
    model.add("hit", spatial.SphereContact(i="ball", j="other", **radii, stiffness=1e7, dissipation=dissipation))
    solution = stiffmbs.run(model, duration=0.02, rtol=1e-10, points=3)
    v = [solution[f"other.v{axis}"][-1] - solution[f"ball.v{axis}"][-1] for axis in "xyz"]
    np.testing.assert_allclose(v, after * normal, atol=1e-7)


@pytest.mark.long
def test_a_ball_with_side_spin_slides_on_a_parabola_until_it_rolls():
    """Friction is along the sliding velocity, whose direction stays; it ends at v = (5 v0 + 2 w0 x r n)/7 (Coriolis)."""
    mu, radius, g = 0.3, 0.1, 9.81
    v0, w0 = np.array([2.0, 0.0]), np.array([-12.0, -5.0, 3.0])
    spin = radius * np.array([w0[1], -w0[0]])
    slip = v0 - spin
    depth = (2.0 * g / 1e7) ** (1 / 1.5)
    model = ball(position=(0, 0, radius - depth), velocity=(*v0, 0), omega=tuple(w0))
    model.add(
        "table",
        spatial.SphereContact(
            i="ball", j="ground", radius=radius, stiffness=1e7, dissipation=2.0, friction=mu, stiction_velocity=1e-4
        ),
    )
    solution = stiffmbs.run(model, duration=0.8, rtol=1e-8, points=401)
    rolls = 2 / 7 * np.linalg.norm(slip) / (mu * g)
    t = np.minimum(solution.time, rolls)[:, None]
    expected = v0 - mu * g * t * slip / np.linalg.norm(slip)
    found = np.stack([solution["ball.vx"], solution["ball.vy"]], axis=-1)
    np.testing.assert_allclose(found, expected, atol=3e-3)
    np.testing.assert_allclose(found[-1], (5 * v0 + 2 * spin) / 7, atol=1e-3)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"surface": "sphere"}, "found two points, expected a radius or surface_radius above zero"),
        ({"surface": "hollow", "radius": 1, "surface_radius": 0.5}, "found a sphere of radius 1 in a hollow of 0.5"),
        ({"surface_radius": 1}, "found a surface_radius of a plane, expected none"),
        ({"static_friction": 1}, "found static_friction without friction, expected both"),
    ],
)
def test_what_is_wrong_with_a_contact_is_said(fields, message):
    with pytest.raises(stiffmbs.InputError, match=message):
        spatial.SphereContact(i="a", j="b", stiffness=1, **fields)


@pytest.mark.parametrize("part", [1e-3, 0.5, 3.0])
def test_friction_is_smoothed_below_its_velocity(part):
    """mu N tanh(v/v_smooth) against the sliding velocity (0.6, 0.8) v, at the start."""
    speed, depth = part * 1e-4, 1e-3
    model = ball(free=True, position=(0, 0, 0.1 - depth), velocity=(0.6 * speed, 0.8 * speed, 0))
    fields = {"radius": 0.1, "stiffness": 1e6, "friction": 0.3, "stiction_velocity": 1e-4}
    model.add("floor", spatial.SphereContact(i="ball", j="ground", **fields))
    solution = stiffmbs.run(model, duration=1e-12, points=2)
    drag = 0.3 * solution["floor.fz"][0] * np.tanh(part)
    assert solution["floor.fz"][0] > 10
    assert solution["floor.fx"][0] == pytest.approx(-0.6 * drag, rel=1e-6)
    assert solution["floor.fy"][0] == pytest.approx(-0.8 * drag, rel=1e-6)
