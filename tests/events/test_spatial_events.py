"""Contacts and friction in space: events are met by all integrators, and bodies roll and bounce as closed forms say."""

import numpy as np
import pytest

import stiffmbs

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

RADIUS, MASS, PRESS = 0.1, 1.0, 1e6
EXPLICIT = {"solver": "projected", "scheme": "dop853"}
BALL = f"""
dimensions: 3
parameters: {{m: {MASS}, r: {RADIUS}, k: {PRESS}}}
gravity: [0, 0, -9.81]
bodies:
  ball: {{mass: m, inertia: [0.4*m*r^2, 0.4*m*r^2, 0.4*m*r^2], position: [0, 0, HEIGHT], velocity: VELOCITY, omega: OMEGA}}
forces:
  floor: {{type: sphere_contact, i: ball, j: ground, radius: r, stiffness: k, exponent: 1.5, MORE}}
run: {{duration: 1.0, points: 201, rtol: 1e-9}}
"""


def ball(height, velocity, omega=(0, 0, 0), more="dissipation: 0"):
    text = BALL.replace("HEIGHT", repr(height)).replace("VELOCITY", str(list(velocity)))
    return stiffmbs.read_scene(text.replace("OMEGA", str(list(omega))).replace("MORE", more))


RESTING = RADIUS - (MASS * 9.81 / PRESS) ** (1 / 1.5)


@pytest.mark.parametrize("how", [{}, EXPLICIT], ids=["bdf", "dop853"])
def test_a_sliding_ball_comes_to_roll(how):
    """Friction mu m g until the foot rests after 2 v/(7 mu g), when 5/7 of the speed are left; spin about z goes on."""
    friction, speed = 0.2, 1.0
    more = f"friction: {friction}, stiction_velocity: 1e-4"
    found = stiffmbs.run(ball(RESTING, (0.6, 0.8, 0), (0, 0, 3), more), **how)
    t = found.time
    along = 0.6 * found["ball.vx"] + 0.8 * found["ball.vy"]
    rolls = 2 * speed / (7 * friction * 9.81)
    expected = speed - friction * 9.81 * np.minimum(t, rolls)
    np.testing.assert_allclose(along, expected, atol=3e-4)
    np.testing.assert_allclose(0.8 * found["ball.vx"], 0.6 * found["ball.vy"], atol=1e-7)
    late = t > rolls + 0.01
    assert np.max(np.abs(found["floor.fx"][late])) < 1e-2
    assert np.max(np.abs(found["floor.fz"] - MASS * 9.81)) < 1e-3
    momentum = found["energy.kinetic"][-1] - MASS * 25 / 49 / 2 - 0.4 * MASS * RADIUS**2 * (25 / 49 / RADIUS**2 + 9) / 2
    assert abs(momentum) < 5e-4


ENGINES = {"bdf": {}, "dopri5": {"solver": "projected", "scheme": "dopri5"},
           "auto": {"solver": "auto"}}  # fmt: skip


@pytest.mark.parametrize("engine", ENGINES)
def test_all_integrators_meet_the_same_impacts(engine):
    """A ball with backspin on an elastic floor that rubs."""
    scene = ball(0.3, (1, 0, 0), (0, -30, 5), "dissipation: 0.2, friction: 0.3, stiction_velocity: 0.01")
    exact = stiffmbs.run(scene, **EXPLICIT, rtol=1e-12)
    found = stiffmbs.run(scene, **ENGINES[engine])
    assert found.solver["events"] == exact.solver["events"] >= 4
    for name in ("ball.x", "ball.z", "ball.q0", "ball.q2", "ball.vx", "ball.wy"):
        np.testing.assert_allclose(found[name], exact[name], atol=2e-4)
    assert exact["ball.vx"][-1] < 0.5 and abs(exact["ball.wy"][-1]) < 15
    assert np.all(np.diff(exact["energy.total"]) < 1e-8)


def test_impacts_between_output_instants_are_told():
    found = stiffmbs.verify(ball(0.3, (1, 0, 0)), points=11)
    assert any("between the output times: ball.az" in note for note in found.notes)
    assert found["floor.fz"].max() + found.errors["floor.fz"].greatest > 600


def test_an_elastic_ball_keeps_its_energy_through_all_its_impacts():
    found = stiffmbs.run(ball(0.3, (0, 0, 0)), duration=3.0, **EXPLICIT, rtol=1e-11)
    assert found.solver["events"] >= 12
    assert found.energy_drift() < 1e-7
    np.testing.assert_allclose(found["ball.q0"], 1, atol=1e-15)


@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-4])
def test_a_projection_back_before_an_event_is_passed_with_it(rtol):
    """A double pendulum on a stop: its drift at loose tolerances is no event of its own."""
    text = """
    dimensions: 3
    gravity: [0, 0, -9.81]
    bodies:
      a: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0]}
      b: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [2, 1, 0]}
    joints:
      shoulder: {type: spherical, i: {body: a, point: [-1, 0, 0]}, j: ground}
      elbow: {type: spherical, i: {body: b, point: [0, -1, 0]}, j: {body: a, point: [1, 0, 0]}}
    forces:
      stop: {type: force, i: b, force: [0, 0, "max(0, -1e5*(b.z + 1.5))"]}
    """
    solution = stiffmbs.run(stiffmbs.read_scene(text), solver="bdf", rtol=rtol, duration=5.0)
    height = stiffmbs.run(stiffmbs.read_scene(text), solver="projected", rtol=1e-8, duration=5.0, points=20001)["b.z"]
    assert solution.solver["events"] == np.count_nonzero(np.diff(np.sign(height + 1.5)))


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_projection_at_a_turning_point_leads_to_no_later_event(solver):
    """A bar on two lines turns back, where its damping has an event, between stops that move."""
    text = """
    gravity: [0, -9.81]
    parameters: {L: 0.5, turned: 1, rate: -2}
    variables: {gap: 0.24 + 0.1*sin(8*t)}
    bodies:
      bar:
        mass: 1
        inertia: 0.05
        position: [L*cos(turned), -L*sin(turned)]
        angle: turned
        velocity: [-L*rate*sin(turned), -L*rate*cos(turned)]
        omega: rate
    joints:
      a: {type: point_on_line, i: {body: bar, point: [L, 0]}, j: ground}
      b: {type: point_on_line, i: {body: bar, point: [-L, 0]}, j: {body: ground, angle: 90 deg}}
    forces:
      damping: {type: torque, i: bar, torque: "branch(bar.omega, -0.1*bar.omega, 0, -0.5*bar.omega)"}
      stops: {type: force, i: bar, force: ["1e4*(max(0, -bar.x - gap) - max(0, bar.x - gap))", 0]}
    """
    scene = stiffmbs.read_scene(text)
    solution = stiffmbs.run(scene, solver=solver, rtol=1e-3, duration=3.0)
    exact = stiffmbs.run(scene, solver="projected", rtol=1e-9, duration=3.0)
    np.testing.assert_allclose(solution["bar.angle"], exact["bar.angle"], atol=0.3)
