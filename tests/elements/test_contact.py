"""Contact: restitution, Hertz's impact, energy, momentum, friction, and finite derivatives everywhere."""

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs
from stiffmbs import Body, Contact, InputError, Marker, Model, compile_model
from stiffmbs.compile.state import State

from ..closed_forms import momenta
from .test_element_derivatives import assert_close, derivative, term

G = 9.81
FINE = {"rtol": 1e-10, "points": 201}


def ball_at_wall(speed=1.0, start=0.05, gravity=0.0, radius=0.04, **fields):
    """A ball of 0.5 kg that flies down on the ground's axis."""
    model = Model(gravity=(0, -gravity))
    model.add("ball", Body(mass=0.5, inertia=1e-3, position=(0, start), velocity=(0, -speed)))
    model.add("contact", Contact(i="ball", j="ground", radius=radius, **fields))
    return model


def restitution(chi, speed):
    """Of the Hunt-Crossley force, exact for every stiffness and exponent: v dv/(1 + chi v) integrated over the impact."""

    def left(v):
        return chi * v - np.log(1 + chi * v)

    return brentq(lambda v: left(-v) - left(speed), 0, min(speed, (1 - 1e-15) / chi), xtol=1e-15) / speed


@pytest.mark.parametrize(("chi", "exponent"), [(0.15, 1.5), (0.6, 1.5), (0.6, 1.0), (4.0, 2.2)])
def test_restitution_of_hunt_and_crossley(chi, exponent):
    model = ball_at_wall(speed=0.8, stiffness=1e6, exponent=exponent, dissipation=chi)
    solution = stiffmbs.run(model, duration=0.1, **FINE)
    assert solution["ball.vy"][-1] / 0.8 == pytest.approx(restitution(chi, 0.8), rel=1e-6)
    assert solution["contact.fy"].min() == 0


def test_dissipation_for_a_coefficient_of_restitution_near_one():
    """What the docstring recommends, after Hunt and Crossley, to first order in 1 - e."""
    assert restitution(3 * (1 - 0.98) / (2 * 0.8), 0.8) == pytest.approx(0.98, abs=5e-4)


def test_a_surface_never_pulls():
    """Torn off the ground faster than 1/chi the ball feels nothing; at that speed the force ends without a jump."""
    for speed, pulled in ((-0.2, False), (-0.6, True)):
        model = ball_at_wall(speed=speed, start=0.03, stiffness=1e5, dissipation=2.0)
        force = stiffmbs.run(model, duration=1e-6, points=2)["contact.fy"][0]
        assert force == pytest.approx(0 if pulled else 1e5 * 0.01**1.5 * (1 - 2.0 * 0.2), rel=1e-12)


def test_hertzian_impact():
    """Largest indentation (5 m v^2 / 4 k)^(2/5), and 2.94 of it over v in contact (Goldsmith, Impact, 1960)."""
    k, speed = 1e8, 0.5
    model = ball_at_wall(speed=speed, start=0.0401, stiffness=k)
    solution = stiffmbs.run(model, duration=2e-3, rtol=1e-10, points=4001)
    deepest = (5 * 0.5 * speed**2 / (4 * k)) ** 0.4
    assert 0.04 - solution["ball.y"].min() == pytest.approx(deepest, rel=1e-5)
    assert solution["contact.fy"].max() == pytest.approx(k * deepest**1.5, rel=1e-5)
    duration = np.sum(solution["contact.fy"] > 0) * (solution.time[1] - solution.time[0])
    assert duration == pytest.approx(2.9432 * deepest / speed, abs=1.1e-6)


def test_an_elastic_ball_bounces_without_loss():
    solution = stiffmbs.run(ball_at_wall(0, 0.2, G, stiffness=1e7), duration=1.2, rtol=1e-10, points=4001)
    assert solution.energy_drift() < 1e-6
    tops = np.diff(np.sign(solution["ball.vy"][1:])) < 0
    assert np.sum(tops) == 3  # at 0.36, 0.72 and 1.08 s, after falls of 0.18 s


def test_a_ball_in_a_hole_keeps_inside_and_keeps_its_energy():
    model = Model(gravity=(0, -G))
    model.add("ball", Body(mass=0.5, inertia=1e-3, position=(0.3, 0.1), velocity=(1, 2)))
    model.add("hole", Contact(i="ball", j="ground", radius=0.1, surface="hole", surface_radius=0.5, stiffness=1e6))
    solution = stiffmbs.run(model, duration=1, **FINE)
    distance = np.hypot(solution["ball.x"], solution["ball.y"])
    assert 0.4 < distance.max() < 0.41
    assert solution.energy_drift() < 1e-6


@pytest.mark.long
@pytest.mark.parametrize("surface", ["line", "circle", "hole"])
def test_bodies_in_contact_keep_momentum_and_angular_momentum(surface):
    model = Model()
    y = {"line": 0.35, "circle": 0.65, "hole": 0.05}[surface]
    model.add("a", Body(mass=1, inertia=0.02, position=(0.1, y), velocity=(0.5, {"hole": 2}.get(surface, -2)), omega=3))
    model.add("b", Body(mass=2, inertia=0.3, angle=0.2, velocity=(0.1, 0.1), omega=0.5))
    j = Marker(body="b", point=(0.05, 0.02), angle=-0.1)
    model.add(
        "contact",
        Contact(
            i=Marker(body="a", point=(0.01, -0.02)), j=j, radius=0.2, surface=surface, surface_radius=0.4, stiffness=1e5,
            dissipation=0.2, friction=0.3, static_friction=0.5,
        ),
    )  # fmt: skip
    solution = stiffmbs.run(model, duration=0.3, **FINE)
    assert np.max(np.hypot(solution["contact.fx"], solution["contact.fy"])) > 10
    assert np.ptp(solution["a.omega"]) > 0.5
    for momentum in momenta(model, solution):
        assert np.ptp(momentum) < 1e-7
    assert solution["energy.total"][-1] < solution["energy.total"][0] - 0.01


def test_a_sliding_disc_ends_rolling_with_two_thirds_of_its_speed():
    """It slides for v / (3 mu g), then rolls; the ground is an incline of zero slope at a turned marker."""
    radius, mass, mu, speed, k = 0.1, 2.0, 0.3, 3.0, 1e8
    sunk = (mass * G / k) ** (1 / 1.5)
    model = Model(gravity=(0, -G))
    model.add("disc", Body(mass=mass, inertia=mass * radius**2 / 2, position=(0, radius - sunk), velocity=(speed, 0)))
    ground = Marker(body="ground", point=(7, 0))
    model.add("contact", Contact(i="disc", j=ground, radius=radius, stiffness=k, dissipation=1, friction=mu))
    solution = stiffmbs.run(model, duration=0.5, rtol=1e-8, points=101)
    sliding = solution.time < speed / (3 * mu * G) - 0.01
    np.testing.assert_allclose(solution["disc.vx"][sliding], speed - mu * G * solution.time[sliding], atol=1e-3)
    np.testing.assert_allclose(solution["disc.vx"][-1], 2 / 3 * speed, rtol=1e-3)
    np.testing.assert_allclose(solution["disc.omega"][-1], -2 / 3 * speed / radius, rtol=1e-3)


def in_contact(**fields):
    """Two bodies whose surfaces overlap by a few centimetres, in motion."""
    model = Model()
    model.add("a", Body(mass=1, inertia=0.2, position=(0.1, 0.6), angle=0.4, velocity=(0.3, -0.2), omega=2))
    model.add("b", Body(mass=2, inertia=0.3, position=(0.5, -0.2), angle=-0.7, velocity=(-0.1, 0.4), omega=-1))
    i, j = Marker(body="a", point=(0.1, -0.1)), Marker(body="b", point=(-0.1, 0.2), angle=1.1)
    fields = {"radius": 0.5, "stiffness": 3.0, "dissipation": 0.1} | fields
    model.add("contact", Contact(i=i, j=j, **fields))
    return State(compile_model(model.data()))


RUBBING = {"friction": 0.3, "static_friction": 0.5, "stiction_velocity": 2, "friction_velocity": 3}


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "fields",
    [
        {"surface": "line", "radius": 1.0, **RUBBING},
        {"surface": "circle", "surface_radius": 0.6, "exponent": 2, **RUBBING},
        {"surface": "hole", "surface_radius": 0.7, **RUBBING},
        {"surface": "circle", "surface_radius": 0.6},
    ],
)
def test_derivatives_in_contact(fields):
    state = in_contact(**fields)
    assert np.linalg.norm(term(state, "motion", "f")) > 0.05
    assert_close(term(state, "tangent", "f_q"), derivative(lambda: term(state, "motion", "f"), state.q))
    assert_close(term(state, "tangent", "f_u"), derivative(lambda: term(state, "motion", "f"), state.u))


@pytest.mark.parametrize("surface", ["line", "circle", "hole"])
@pytest.mark.parametrize("gap", [-1e-300, 0.0, 1e-300, -1e-12, 0.1, 1e6, None])
def test_force_and_derivatives_are_finite_at_every_gap(surface, gap):
    """Also where nothing touches, where the powers of negative numbers are not taken, and where centres coincide."""
    state = in_contact(surface=surface, surface_radius=0.6, **RUBBING)
    state.q[:] = 0
    i, j = np.array([0.1, -0.1]), np.array([-0.1, 0.2])
    normal = np.array([-np.sin(1.1), np.cos(1.1)])
    reach = {"line": 0.5, "circle": 1.1, "hole": 0.1}[surface]
    away = 0.0 if gap is None else max(reach - gap, 0.0) if surface == "hole" else reach + gap
    state.q[:2] = j + away * normal - i
    for name in ("f_q", "f_u"):
        assert np.all(np.isfinite(term(state, "tangent", name)))
    force = term(state, "motion", "f")
    assert np.all(np.isfinite(force))
    if gap is not None and gap >= 0.1:
        assert np.all(force == 0)


REFUSED = [
    ({}, "stiffness: found nothing"),
    ({"stiffness": 0}, "stiffness: found 0, expected a value greater than 0"),
    ({"stiffness": 1, "exponent": 0.5}, "exponent: found 0.5, expected a number of 1 or more"),
    ({"stiffness": 1, "dissipation": -1}, "dissipation: found -1, expected a value of 0"),
    ({"stiffness": 1, "surface": "sphere"}, "surface: found 'sphere', expected 'line', 'circle' or 'hole'"),
    ({"stiffness": 1, "surface": "circle"}, "found two points, expected a radius or surface_radius above zero"),
    ({"stiffness": 1, "surface": "hole", "radius": 1, "surface_radius": 0.5}, "a circle of radius 1 in a hole of 0.5"),
    ({"stiffness": 1, "static_friction": 1}, "found static_friction without friction, expected both"),
]


@pytest.mark.parametrize(("fields", "sentence"), REFUSED)
def test_bad_input_is_refused_in_one_sentence(fields, sentence):
    with pytest.raises(InputError, match=sentence):
        Contact(i="b", j="ground", **fields)
