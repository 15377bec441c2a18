"""Simulations that are advanced together, against single ones."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, SolverError, simulation, simulations
from tests.studies.test_fixed_steps import ARM, EULER, IMPLICIT, MOTORS, RK4, STEP
from tests.studies.test_simulation import SLED

STIFFNESS = "forces.spring.stiffness"


def state(sim):
    return np.concatenate([[sim.t], sim.q, sim.u, sim.joint_coordinates, sim.joint_rates])


def states(sims):
    return np.column_stack([sims.t, sims.q, sims.u, sims.joint_coordinates, sims.joint_rates])


@pytest.mark.parametrize(
    ("settings", "workers"), [(RK4, 3), (EULER, 1), (IMPLICIT, 1)], ids=["rk4", "euler_cromer", "extrapolated_euler"]
)
def test_each_is_a_single_simulation_to_the_last_bit(settings, workers):
    values = np.random.default_rng(1).standard_normal((20, 7, 5))
    given = values.copy()
    sims = simulations(ARM, 7, dict.fromkeys(MOTORS, 0.0), workers=workers, **settings)
    for rows in given:
        sims.step(2 * STEP, rows)
    after = states(sims)
    sims.reset()
    np.testing.assert_array_equal(given, values)  # arrays of the caller are not changed
    for k in (0, 3, 6):
        one = simulation(ARM, dict.fromkeys(MOTORS, 0.0), **settings)
        for rows in values:
            one.step(2 * STEP, rows[k])
        np.testing.assert_array_equal(after[k], state(one))


@pytest.mark.parametrize(
    ("name", "settings", "tolerance"),
    [
        ("bouncing_ball.yaml", RK4, 1e-13), ("stick_slip.yaml", RK4, 1e-11), ("four_bar.yaml", RK4, 1e-13),
        ("heavy_top.yaml", EULER, 1e-13), ("half_car.yaml", IMPLICIT, 1e-11),
        ("cart_pendulum.yaml", {"solver": "bdf", "rtol": 1e-8}, 1e-6),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)  # fmt: skip
def test_examples(examples, name, settings, tolerance):
    """By compiled calls; those of bdf, and of half_car with its road over time, one by one."""
    sims = simulations(examples / name, 2, **settings)
    one = simulation(examples / name, **settings)
    for _ in range(20):
        sims.step(4 * STEP)
        one.step(4 * STEP)
    for row in states(sims):
        np.testing.assert_allclose(row, state(one), rtol=tolerance, atol=tolerance)


def test_breakpoints_of_inputs_end_steps():
    """A force of 10 N from 1.5 steps on, also for simulations that have been reset in between."""
    text = SLED.replace("force: [F, 0]", f'force: ["F*step(t, 0, 0, {1.5 * STEP!r}, 1)", 0]')
    sims = simulations(stiffmbs.read_scene(text), 3, {"F": 0.0, "k": 100.0}, **RK4)
    one = simulation(stiffmbs.read_scene(text), {"F": 0.0, "k": 100.0}, **RK4)
    for k in range(4):
        if k == 2:
            sims.reset([1])
        sims.step(STEP, {"F": np.array([10.0, 10.0, 20.0]), "k": 50.0})
    for _ in range(2):
        one.step(STEP, {"F": 10.0, "k": 50.0})
    np.testing.assert_allclose(states(sims)[1], state(one), rtol=0, atol=1e-15)
    assert sims["sled.x"][2] == pytest.approx(2 * sims["sled.x"][0], rel=1e-4)


def test_channels_are_those_of_each_with_its_inputs(examples):
    sims = simulations(examples / "cart_pendulum.yaml", 3, {STIFFNESS: 270.0}, **RK4)
    sims.reset(joints={"hinge": np.array([0.1, 0.2, 0.3])}, rates={"rail": 0.5})
    sims.step(10 * STEP, {STIFFNESS: np.array([100.0, 200.0, 300.0])})
    for k, hinge in enumerate((0.1, 0.2, 0.3)):
        one = simulation(examples / "cart_pendulum.yaml", {STIFFNESS: 270.0}, **RK4)
        one.reset(joints={"hinge": hinge}, rates={"rail": 0.5})
        one.step(10 * STEP, {STIFFNESS: 100.0 * (k + 1)})
        for channel in (
            "cart.x",
            "cart.vx",
            "hinge.angle",
            "rail.displacement_rate",
            "rail.fy",
            "spring.fx",
            "energy.total",
        ):
            assert sims[channel][k] == pytest.approx(one[channel], rel=1e-12), channel


def test_some_are_reset(examples):
    sims = simulations(examples / "cart_pendulum.yaml", 4, {STIFFNESS: 270.0}, **RK4)
    start = states(sims)
    sims.step(STEP, {STIFFNESS: 100.0})
    moved = states(sims)
    sims.reset(np.array([False, True, False, True]))
    np.testing.assert_array_equal(states(sims), np.where([[0], [1], [0], [1]], start, moved))
    np.testing.assert_array_equal(sims.inputs[STIFFNESS], [100.0, 270.0, 100.0, 270.0])
    kept = simulation(examples / "cart_pendulum.yaml", {STIFFNESS: 270.0}, **RK4)
    kept.steps(30)
    sims.reset(2, state=kept.state)
    np.testing.assert_allclose(states(sims)[2, 1:5], state(kept)[1:5], rtol=0, atol=1e-12)
    assert sims.t[2] == kept.t


def test_one_that_fails_keeps_its_state_and_the_others_go_on():
    text = SLED.replace('["-k*sled.x", 0]', '["k*sled.x*(sled.x/1 m)^2", 0]')
    sims = simulations(stiffmbs.read_scene(text), 3, {"F": 0.0}, **RK4)
    before = states(sims)
    with pytest.raises(SolverError, match=r"simulation 1 stopped after t = 0 s: the solution has overflowed"):
        sims.step(8 * STEP, {"F": np.array([1.0, 1e99, 2.0])})
    np.testing.assert_array_equal(sims.failed, [False, True, False])
    np.testing.assert_array_equal(states(sims)[1], before[1])
    np.testing.assert_array_equal(sims.inputs["F"], [1.0, 0.0, 2.0])
    assert np.all(sims["sled.x"][[0, 2]] > 0)
    sims.reset(sims.failed)
    assert not sims.failed.any()
    sims.step(STEP)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda sims: sims.step(0), "step: found dt = 0, expected a time"),
        (lambda sims: sims.step(STEP, np.zeros((2, 1))), r"inputs: found an array of shape \(2, 1\), expected \(3, 1\)"),
        (lambda sims: sims.step(STEP, {"F": [1.0, np.nan, 0.0]}), "input 'F': found nan in row 1, expected a finite number"),
        (lambda sims: sims.step(STEP, {"F": [1.0, 2.0]}), r"input 'F': found \[1.0, 2.0\], expected a number, or 3 numbers"),
        (lambda sims: sims.step(STEP, {"f": 1.0}), "input 'f': found no such input .did you mean 'F'"),
        (lambda sims: sims.reset([3]), "which = .*expected numbers from 0 to 2, or a mask of 3"),
        (lambda sims: sims.reset([True]), "which = .*expected numbers from 0 to 2, or a mask of 3"),
        (lambda sims: sims.reset([0.5]), "which = .*expected numbers from 0 to 2, or a mask of 3"),
        (lambda sims: sims.reset([1], joints={"rale": 0.1}), "simulation 1: reset: joint 'rale'"),
        (lambda sims: sims.reset(joints={"rail": [0.1, 0.2]}), r"reset: 'rail': found \[0.1, 0.2\], expected a number, or 3 numbers"),
        (lambda sims: sims["sled.xx"], "sled.xx"),
        (lambda sims: simulations(stiffmbs.read_scene(SLED), 0), "simulations: found n = 0, expected a whole number"),
        (lambda sims: simulations(stiffmbs.read_scene(SLED), 2, workers=0), "workers: found 0"),
    ],
)  # fmt: skip
def test_wrong_arguments_change_nothing(call, message):
    sims = simulations(stiffmbs.read_scene(SLED), 3, {"F": 0.0}, **RK4)
    sims.step(STEP, {"F": 1.0})
    before = states(sims)
    with pytest.raises(InputError, match=message):
        call(sims)
    np.testing.assert_array_equal(states(sims), before)


def test_inputs_that_a_scene_refuses_are_named():
    sims = simulations(stiffmbs.read_scene(SLED.replace("k: 100 N/m", "k: 100 N/m, c: 1") + "\n"), 3, {"k": 1.0}, **RK4)
    before = states(sims)
    with pytest.raises(InputError, match="input 'k'"):
        sims.step(STEP, {"k": np.array([1.0, 1e300, 2.0])})
    np.testing.assert_array_equal(states(sims), before)
