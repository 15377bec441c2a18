"""A ball on a plane: Hertz's impact, and sliding that becomes rolling."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.spatial import Body, Model, SphereContact

from ..spatial_closed_forms import hertz_impact

RADIUS, MASS = 0.1, 2.0
INERTIA = (0.4 * MASS * RADIUS**2,) * 3
SOLVERS = pytest.mark.parametrize(
    "settings", [{"rtol": 1e-10}, {"solver": "projected", "scheme": "dop853", "rtol": 1e-10}], ids=["bdf", "dop853"]
)


@SOLVERS
def test_an_elastic_impact_goes_as_deep_and_lasts_as_long_as_hertz_says(settings):
    """Without friction: the ball keeps its spin and its speed along the plane, and leaves as fast as it came."""
    speed, stiffness, gap = 0.3, 1e6, 0.01
    model = Model()
    ball = Body(mass=MASS, inertia=INERTIA, position=(0, 0, RADIUS + gap), velocity=(0.5, 0, -speed), omega=(1, 2, 3))
    model.add("ball", ball)
    model.add("floor", SphereContact(i="ball", j="ground", radius=RADIUS, stiffness=stiffness))
    depth, duration = hertz_impact(mass=MASS, speed=speed, stiffness=stiffness)
    begin = gap / speed
    solution = stiffmbs.run(model, duration=2 * begin + duration, points=4001, **settings)
    sunk = RADIUS - solution["ball.z"]
    assert sunk.max() == pytest.approx(depth, rel=1e-6)
    assert solution["floor.fz"].max() == pytest.approx(stiffness * depth**1.5, rel=1e-5)
    inside = solution.time[sunk > 0]
    spacing = solution.time[1]
    assert inside[0] == pytest.approx(begin, abs=2 * spacing)
    assert inside[-1] == pytest.approx(begin + duration, abs=2 * spacing)
    assert solution["ball.z"][-1] == pytest.approx(RADIUS + gap, abs=1e-8)
    assert solution["ball.vz"][-1] == pytest.approx(speed, abs=1e-7)
    np.testing.assert_allclose(solution["ball.vx"], 0.5, atol=1e-12)
    np.testing.assert_allclose([solution[f"ball.w{c}"][-1] for c in "xyz"], [1, 2, 3], atol=1e-12)


def test_a_sliding_ball_comes_to_roll_at_five_sevenths_of_its_speed():
    """Coulomb's friction slows it and turns it until the point of contact rests (Routh, Rigid Dynamics)."""
    speed, friction, stiffness = np.array([1.2, -0.5, 0.0]), 0.3, 1e7
    sunk = (MASS * 9.81 / stiffness) ** (2 / 3)
    model = Model(gravity=(0, 0, -9.81))
    model.add("ball", Body(mass=MASS, inertia=INERTIA, position=(0, 0, RADIUS - sunk), velocity=speed))
    touch = SphereContact(
        i="ball", j="ground", radius=RADIUS, stiffness=stiffness, friction=friction, stiction_velocity=1e-4
    )
    model.add("table", touch)
    rolls = 2 * np.linalg.norm(speed) / (7 * friction * 9.81)
    solution = stiffmbs.run(model, duration=2 * rolls, points=101, rtol=1e-8)
    slowed = 1 - friction * 9.81 * np.minimum(solution.time, rolls) / np.linalg.norm(speed)
    np.testing.assert_allclose(solution["ball.vx"], slowed * speed[0], atol=2e-4)
    np.testing.assert_allclose(solution["ball.vy"], slowed * speed[1], atol=2e-4)
    assert solution["ball.vx"][-1] == pytest.approx(5 / 7 * speed[0], abs=2e-4)
    assert solution["ball.vx"][-1] == pytest.approx(RADIUS * solution["ball.wy"][-1], abs=1e-3)
