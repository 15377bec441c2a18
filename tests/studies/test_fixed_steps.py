"""Simulations by explicit steps of fixed length: those of a run, whatever is read or restored between them."""

from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, SolverError, simulation
from stiffmbs.analyses.job import data_of, prepare
from tests.studies.test_simulation import SLED

ARM = Path(__file__).parents[1] / "bench" / "scenes" / "arm.xml"
MOTORS = tuple(f"m{k}_input" for k in range(1, 6))
STEP = 2.0**-10
RK4 = {"solver": "projected", "scheme": "rk4", "step": STEP}
EULER = RK4 | {"scheme": "euler_cromer"}
IMPLICIT = RK4 | {"scheme": "extrapolated_euler"}
LOOP = """
gravity: [0, -9.81]
bodies:
  crank: {mass: 1, inertia: 0.02, position: [0.1, 0]}
  rod: {mass: 1, inertia: 0.05, position: [0.4, 0]}
  slider: {mass: 1, inertia: 0.01, position: [0.6, 0]}
joints:
  shaft: {type: revolute, i: {body: crank, point: [-0.1, 0]}, j: ground}
  pin: {type: revolute, i: {body: rod, point: [-0.2, 0]}, j: {body: crank, point: [0.1, 0]}}
  eye: {type: revolute, i: {body: rod, point: [0.2, 0]}, j: slider}
  rail: {type: prismatic, i: slider, j: ground}
"""


def arm(settings=RK4):
    return simulation(ARM, inputs=dict.fromkeys(MOTORS, 0.0), **settings)


def torques(count):
    return 0.3 * np.random.default_rng(1).standard_normal((count, 5))


def state(sim):
    return np.concatenate([[sim.t], sim.q, sim.u, sim.joint_coordinates])


@pytest.mark.parametrize("settings", [RK4, EULER, IMPLICIT], ids=["rk4", "euler_cromer", "extrapolated_euler"])
@pytest.mark.parametrize("name", ["cart_pendulum.yaml", "heavy_top.yaml", "bouncing_ball.yaml"])
def test_steps_are_those_of_a_run(examples, name, settings):
    expected = stiffmbs.run(examples / name, **settings, duration=64 * STEP, points=33)
    sim = simulation(examples / name, **settings)
    channels = [channel for channel in expected if channel.rpartition(".")[2] in ("x", "y", "z", "vx", "vy", "omega")]
    for k in range(1, 33):
        sim.step(2 * STEP)
        found, wanted = (
            [values[channel] for channel in channels] for values in (sim, {c: expected[c][k] for c in channels})
        )
        if settings is RK4:
            assert found == wanted, k
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13)  # pivots of the LU are those of the step alone


@pytest.mark.long
@pytest.mark.parametrize("settings", [RK4, EULER, IMPLICIT], ids=["rk4", "euler_cromer", "extrapolated_euler"])
def test_steps_in_one_call_or_after_a_reset_or_from_a_file_are_the_same(settings, tmp_path):
    sim, values = arm(settings), torques(40)
    for row in values:
        sim.step(STEP, row)
    expected = state(sim)
    sim.reset()
    sim.steps(25, values[:25])
    assert sim.channels["roll.angle"] == pytest.approx(sim["roll.angle"], abs=1e-12)  # reading changes nothing
    sim.save(tmp_path / "here.npz")
    sim.steps(15, values[25:])
    np.testing.assert_array_equal(state(sim), expected)
    other = arm(settings)
    other.load(tmp_path / "here.npz")
    for row in values[25:]:
        other.step(STEP, dict(zip(MOTORS, row, strict=True)))
    np.testing.assert_array_equal(state(other), expected)


def test_arrays_of_joints_are_the_channels_in_the_order_of_the_scene():
    sim = arm()
    assert sim.joints == ("yaw.angle", "shoulder.angle", "elbow.angle", "roll.angle", "flex.angle")
    sim.steps(600, [0.0, 0.0, 0.0, 2.0, 0.0])
    channels = sim.channels
    assert sim["roll.angle"] > 2 * np.pi
    np.testing.assert_allclose(sim.joint_coordinates, [channels[name] for name in sim.joints], rtol=0, atol=1e-10)
    np.testing.assert_allclose(sim.joint_rates, [channels[f"{name}_rate"] for name in sim.joints], rtol=1e-9)


@pytest.mark.long
def test_an_arm_with_two_joints_of_one_link_moves_as_by_bdf():
    """The body between them is nearly massless; its accelerations by elimination lose half the digits unless corrected."""
    sim, exact = arm(), arm({"solver": "bdf", "rtol": 1e-10})
    for row in torques(40):
        sim.step(STEP, row)
        exact.step(STEP, row)
    np.testing.assert_allclose(sim.joint_coordinates, exact.joint_coordinates, rtol=0, atol=1e-7)


def test_accelerations_next_to_a_light_body_are_those_of_the_lu():
    job = prepare(data_of(ARM))
    dynamics, attempt = job.dynamics, np.empty(job.dynamics.system.n_u)
    from stiffmbs.compile.machine.layout import address
    from stiffmbs.dynamics.elimination.eliminated import ATTEMPT

    dynamics.state.q[:], dynamics.state.u[:] = job.start.q, job.start.u
    assert ATTEMPT.call(0.0, address(attempt), address(dynamics.eliminated.table))
    assert dynamics.eliminated._cells["kept"] < 1e-7
    lam = dynamics.state.lam.copy()
    status, expected = dynamics.accelerate(0.0)
    assert status == 0
    np.testing.assert_allclose(attempt, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    np.testing.assert_allclose(lam, dynamics.state.lam, rtol=0, atol=1e-11 * np.abs(lam).max())


@pytest.mark.parametrize("settings", [RK4, EULER, IMPLICIT], ids=["rk4", "euler_cromer", "extrapolated_euler"])
def test_a_step_of_an_input_within_a_step_is_not_smeared(settings):
    """A force of 10 N from 1.5 steps on: by rk4, which is exact for constant forces, the sled moves as it should."""
    law = f"10*step(t, {1.5 * STEP!r}, 0, {1.5 * STEP!r}, 1)"
    scene = stiffmbs.read_scene(SLED.replace("[F, 0]", f'["{law}", 0]').replace("-k*sled.x", "0*sled.x"))
    sim = simulation(scene, **settings)
    for _ in range(4):
        sim.step(STEP)
    assert sim["sled.vx"] == pytest.approx(5 * 2.5 * STEP, rel=1e-6)
    if settings is RK4:
        assert sim["sled.x"] == pytest.approx(2.5 * (2.5 * STEP) ** 2, rel=1e-6)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("settings", [RK4, {"solver": "bdf"}], ids=["rk4", "bdf"])
def test_invalid_inputs_leave_the_simulation_as_it_was(settings):
    sim = arm(settings)
    sim.step(STEP, [0.1] * 5)
    before, inputs = state(sim), sim.inputs
    for message, call in (
        (r"inputs: found an array of shape \(4,\), expected \(5,\)", lambda: sim.step(STEP, np.zeros(4))),
        (r"inputs: found an array of shape \(2, 5\), expected \(3, 5\)", lambda: sim.steps(3, np.zeros((2, 5)))),
        (r"input 'm3_input': found nan, expected a finite", lambda: sim.step(STEP, [0, 0, np.nan, 0, 0])),
        (r"input 'm2_input': found inf in row 1", lambda: sim.steps(2, [[0] * 5, [0, np.inf, 0, 0, 0]])),
        (r"input 'm9': found no such input", lambda: sim.step(STEP, {"m1_input": 1.0, "m9": 1.0})),
        (r"inputs: found 'a', expected a number", lambda: sim.step(STEP, {"m1_input": "a"})),
        (r"inputs: found \[\[1.0\], \[\]\], expected numbers", lambda: sim.steps(2, [[1.0], []])),
        (r"step: found dt = -0.1, expected a time greater than 0 s", lambda: sim.step(-0.1)),
        (r"step: found dt = nan", lambda: sim.step(float("nan"))),
        (r"steps: found n = 0 and dt = 0.1", lambda: sim.steps(0, dt=0.1)),
    ):
        with pytest.raises(InputError, match=message):
            call()
        np.testing.assert_array_equal(state(sim), before)
        assert sim.inputs == inputs
    with pytest.raises(ZeroDivisionError):
        sim.step(STEP, [1 / (k - 2) for k in range(5)])
    np.testing.assert_array_equal(state(sim), before)


@pytest.mark.parametrize("settings", [RK4, EULER, IMPLICIT], ids=["rk4", "euler_cromer", "extrapolated_euler"])
def test_a_step_that_fails_keeps_the_state_before_it(settings):
    text = SLED.replace("force: [F, 0]", 'force: ["1e209*F", 0]')
    sim = simulation(stiffmbs.read_scene(text), inputs={"F": 0.0}, **settings)
    sim.steps(3, [[1e-209], [2e-209], [3e-209]])
    before = state(sim)
    with pytest.raises(SolverError, match=r"stopped after t = 0\.0029296875 s: the solution has overflowed"):
        sim.step(1e3 * STEP, {"F": 1.7e99})
    np.testing.assert_array_equal(state(sim), before)
    with pytest.raises(SolverError, match="overflowed"):
        sim.steps(2, [[0.0], [1.7e99]], dt=1e3 * STEP)
    assert sim.t == pytest.approx(1003 * STEP)
    sim.step(STEP, {"F": 0.0})


@pytest.mark.long
def test_steps_of_other_solvers_follow_rows_of_inputs_too():
    values = torques(4)
    sim, expected = arm({"solver": "bdf"}), arm({"solver": "bdf"})
    sim.steps(4, values, dt=0.01)
    for row in values:
        expected.step(0.01, row)
    np.testing.assert_array_equal(state(sim), state(expected))


@pytest.mark.long
def test_a_reset_places_an_arm_by_its_joints():
    sim = arm()
    sim.step(0.1, [1.0] * 5)
    sim.reset(joints={"yaw": 0.3, "shoulder.angle": -1.2, "flex": 7.0}, rates={"elbow": 2.0})
    np.testing.assert_allclose(sim.joint_coordinates, [0.3, -1.2, 0, 0, 7.0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(sim.joint_rates, [0, 0, 2, 0, 0], rtol=0, atol=1e-10)
    assert sim.t == 0 and sim.inputs == dict.fromkeys(MOTORS, 0.0)
    assert sim.channels["constraint.position"] < 1e-11
    with pytest.raises(InputError, match=r"joint 'shouldr': found no such joint coordinate"):
        sim.reset(joints={"shouldr": 1.0})
    with pytest.raises(InputError, match=r"rate of joint 'yaw': found nan"):
        sim.reset(rates={"yaw": np.nan})
    np.testing.assert_allclose(sim.joint_coordinates, 0, atol=1e-12)


def test_a_reset_moves_a_loop_by_one_of_its_joints():
    sim = simulation(stiffmbs.read_scene(LOOP), **RK4)
    sim.reset(joints={"shaft": 1.0}, rates={"shaft": 3.0})
    s, c = 0.2 * np.sin(1.0), 0.2 * np.cos(1.0)
    rod = np.sqrt(0.16 - s**2)
    assert sim["slider.x"] == pytest.approx(c + rod, abs=1e-10)
    assert sim["slider.vx"] == pytest.approx(3.0 * (-s - s * c / rod), abs=1e-9)
    with pytest.raises(InputError, match=r"no pose of the mechanism has the joint coordinates rail\.displacement = 2"):
        sim.reset(joints={"rail": 2.0})
    assert sim["slider.x"] == pytest.approx(0.6)


@pytest.mark.long
def test_a_reset_to_a_state_is_a_load():
    sim = arm()
    sim.steps(10, [1.0] * 5)
    kept, expected = sim.state, state(sim)
    sim.steps(5)
    sim.reset(kept)
    np.testing.assert_allclose(state(sim), expected, rtol=0, atol=1e-15)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", [RK4, {"solver": "bdf"}], ids=["rk4", "bdf"])
@pytest.mark.parametrize("angle", [4.0, -30.0])
def test_a_reset_moves_counters_of_turns_too(settings, angle):
    """Angles that a force reads stayed within half a turn, and a screw further away was refused."""
    sim = simulation(
        stiffmbs.read_scene("""
            dimensions: 3
            bodies: {b: {mass: 2, inertia: [0.1, 0.2, 0.3]}, n: {mass: 1, inertia: [1, 1, 1]}}
            joints: {c: {type: revolute, i: b, j: ground}, s: {type: screw, i: n, j: ground, pitch: 0.1}}
            forces: {spring: {type: torque, i: b, torque: [0, 0, -2*c.angle]}}
        """),
        **settings,
    )
    sim.reset(joints={"c": angle, "s.angle": angle})
    assert sim["spring.tz"] == pytest.approx(-2 * angle, rel=1e-9)
    assert sim.joint_coordinates == pytest.approx([angle, 0.1 * angle / (2 * np.pi), angle], rel=1e-9)


def test_a_reset_of_a_straight_loop_makes_no_turns_that_the_loop_cannot_make():
    """Newton's first move was far too long in the singular pose: the eye had turned by 12 rad, of at most 0.5."""
    sim = simulation(stiffmbs.read_scene(LOOP), **RK4)
    sim.reset(joints={"rail": 0.5})
    shaft, _, eye, _ = sim.joint_coordinates
    assert abs(shaft) == pytest.approx(np.arccos((0.5**2 + 0.2**2 - 0.4**2) / (2 * 0.5 * 0.2)), rel=1e-9)
    assert abs(eye) == pytest.approx(np.arcsin(0.2 * np.sin(abs(shaft)) / 0.4), rel=1e-9)
    with pytest.raises(InputError, match="expected at most 200"):
        sim.reset(joints={"shaft": 1e9})


def test_a_load_of_an_earlier_time_meets_breakpoints_again():
    """Features of inputs began at a later time: the step of a force within a step was smeared."""
    scene = stiffmbs.read_scene("""
        bodies: {sled: {mass: 1, inertia: 1}}
        joints: {rail: {type: prismatic, i: sled, j: ground}}
        forces: {push: {type: force, i: sled, force: ["10*branch(t - 0.1333, 0, 0, 1)", 0]}}
        run: {duration: 0.1}
    """)
    sim = simulation(scene, **RK4 | {"step": 0.02})
    sim.step(0.02)
    early = sim.state
    for _ in range(30):
        sim.step(0.02)
    sim.load(early)
    sim.steps(10)
    assert sim["sled.vx"] == pytest.approx(10 * (0.22 - 0.1333), rel=1e-9)


def test_inputs_have_the_order_in_which_they_are_given_and_fail_with_their_step():
    scene = stiffmbs.read_scene("""
        inputs: {A: 1, B: 0}
        bodies: {sled: {mass: 1, inertia: 1}}
        joints: {rail: {type: prismatic, i: sled, j: ground}}
        tables: {T: {table: [[-1, 0], [1, 1]], beyond: error}}
        forces: {push: {type: force, i: sled, force: ["A + B + 0*T(sled.x)", 0]}}
    """)
    sim = simulation(scene, inputs={"B": 0, "A": 0}, **RK4)
    assert list(sim.inputs) == ["B", "A"]
    with pytest.raises(SolverError, match="stopped at t = 5 s"):
        sim.step(5, [2.0, 0.0])
    assert sim.inputs == {"B": 0.0, "A": 0.0} and sim["sled.ax"] == 0.0
    for invalid in (
        lambda: sim.step("a"),
        lambda: sim.steps(2.5),
        lambda: sim.load(None),
        lambda: sim.reset(sim.state, {"rail": 0.1}),
    ):
        with pytest.raises(InputError):
            invalid()
