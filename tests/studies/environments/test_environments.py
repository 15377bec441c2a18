"""Environments of Gymnasium: its checks, single simulations, and a controller that is learnt."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import stiffmbs
import stiffmbs.gym
from stiffmbs import InputError

CART = """
parameters: {F: 0 N}
gravity: [0, -9.81]
bodies:
  cart: {mass: 1, inertia: 0.1}
  pole: {mass: 0.2, inertia: 0.005, position: [0, 0.5]}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: {body: pole, point: [0, -0.5]}, j: cart}
forces:
  push: {type: force, i: cart, force: [F, 0]}
run: {duration: 10}
"""
TASK = {
    "actions": {"F": (-10.0, 10.0)},
    "observations": ["cart.x", "cart.vx", "sin(hinge.angle)", "hinge.angle_rate"],
    "reward": "1 - hinge.angle^2 - 1e-3*F^2",
    "limits": {"cart.x": (-2, 2), "hinge.angle": (-0.3, 0.3)},
    "joints": {"hinge": (-0.1, 0.1)},
    "rates": {"rail": (-0.1, 0.1)},
    "dt": 0.02,
    "steps": 100,
    "solver": "projected",
    "scheme": "rk4",
    "step": 5e-3,
}


def scene(text=CART):
    return stiffmbs.read_scene(text)


def environment(text=CART, **others):
    return stiffmbs.gym.Environment(scene(text), **{**TASK, **others})


def environments(n, text=CART, **others):
    return stiffmbs.gym.VectorEnvironment(scene(text), n, **{**TASK, **others})


@pytest.mark.filterwarnings("ignore:.*(infinity|normalized|spec)")
def test_the_checks_of_gymnasium():
    check_env(environment(), skip_render_check=True)


def test_a_step_is_that_of_a_simulation():
    env, one = environment(), stiffmbs.simulation(scene(), {"F": 0.0}, solver="projected", scheme="rk4", step=5e-3)
    observed, told = env.reset(seed=3)
    assert told == {} and env.observation_space.contains(observed)
    one.reset(joints={"hinge": float(np.arcsin(observed[2]))}, rates={"rail": float(observed[1])})
    for force in (3.0, -2.0, 0.5):
        one.step(0.02, {"F": force})
        observed, reward, terminated, truncated, told = env.step(np.array([force]))
        expected = [one["cart.x"], one["cart.vx"], np.sin(one["hinge.angle"]), one["hinge.angle_rate"]]
        np.testing.assert_allclose(observed, expected, rtol=0, atol=1e-14)
        assert reward == pytest.approx(1 - one["hinge.angle"] ** 2 - 1e-3 * force**2, abs=1e-12)
        assert (terminated, truncated, told) == (False, False, {})


def test_starts_are_uniform_in_their_ranges_and_follow_from_the_seed():
    envs = environments(200)
    first, _ = envs.reset(seed=7)
    again, _ = envs.reset(seed=7)
    np.testing.assert_array_equal(first, again)
    angles, speeds = np.arcsin(first[:, 2]), first[:, 1]
    for values in (angles, speeds):
        assert -0.1 <= values.min() < -0.09 and 0.09 < values.max() <= 0.1 and abs(values.mean()) < 0.015
    np.testing.assert_allclose(first[:, [0, 3]], 0.0, atol=1e-15)


def test_episodes_end_at_limits_and_after_their_steps():
    env = environment()
    env.reset(seed=1)
    steps = 0
    while True:
        observed, _, terminated, truncated, _ = env.step(np.array([10.0]))
        steps += 1
        if terminated or truncated:
            break
    assert terminated and not truncated and steps < 100
    assert abs(observed[0]) > 2 or abs(np.arcsin(observed[2])) > 0.3
    env = environment(limits={}, steps=5)
    env.reset(seed=1)
    ends = [env.step(np.array([0.0]))[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]


def test_environments_that_are_advanced_together_are_single_ones():
    envs, env = environments(3, steps=30, workers=2), environment(steps=30)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observed, _ = envs.reset(seed=5)
    assert envs.observation_space.contains(observed)
    actions = np.random.default_rng(0).uniform(-10, 10, (60, 3, 1))
    lengths = np.zeros(3, dtype=int)
    ended = np.zeros(3, dtype=bool)
    starts, taken = observed.copy(), [[], [], []]
    checked = 0
    for action in actions:
        observed, rewards, terminated, truncated, told = envs.step(action)
        assert told == {}
        for k in range(3):
            if ended[k]:
                assert rewards[k] == 0 and not terminated[k] and not truncated[k]
                starts[k], taken[k], lengths[k] = observed[k], [], 0
            else:
                taken[k].append(action[k])
                lengths[k] += 1
        ended = terminated | truncated
        for k in np.flatnonzero(ended):
            assert truncated[k] == (lengths[k] == 30)
            env.reset()
            env._sims.reset(joints={"hinge": np.arcsin(starts[k, 2])}, rates={"rail": starts[k, 1]})
            last = [env.step(each) for each in taken[k]][-1]
            np.testing.assert_allclose(last[0], observed[k], rtol=0, atol=1e-12)
            assert last[1] == pytest.approx(rewards[k], abs=1e-12) and last[2] == terminated[k]
            checked += 1
    assert checked > 3


def test_a_step_that_fails_ends_the_episode_and_says_why():
    text = CART.replace("force: [F, 0]", 'force: ["F*(cart.x/1 m)^2", 0]')
    how = {"limits": {}, "actions": {"F": (-1e90, 1e90)}, "joints": {"rail": (0.5, 1.0)}, "rates": {}}
    env = environment(text, **how)
    env.reset(seed=0)
    observed, _, terminated, truncated, told = env.step(np.array([1e90]))
    assert terminated and not truncated and "stopped after t = 0 s" in told["failure"]
    assert np.isfinite(observed).all()
    envs = environments(3, text, **how)
    envs.reset(seed=0)
    observed, _, terminated, _, told = envs.step(np.array([[0.0], [1e90], [1.0]]))
    assert terminated.tolist() == told["_failure"].tolist() == [False, True, False]
    assert "simulation 1 stopped" in told["failure"][1] and told["failure"][0] == ""
    _, rewards, terminated, _, told = envs.step(np.zeros((3, 1)))
    assert told == {} and not terminated.any() and rewards[1] == 0.0


def test_a_linear_controller_is_learnt():
    """The cross-entropy method (Rubinstein, 1999) finds four gains that balance the pole in all episodes."""
    envs, random = environments(40), np.random.default_rng(0)
    mean, spread = np.zeros(4), 10.0 * np.ones(4)
    for round_ in range(12):
        gains = mean + spread * random.standard_normal((40, 4))
        observed, _ = envs.reset(seed=round_)
        returns, alive = np.zeros(40), np.ones(40, dtype=bool)
        for _ in range(100):
            actions = np.clip(np.sum(gains * observed, axis=1), -10, 10)[:, None]
            observed, rewards, terminated, truncated, _ = envs.step(actions)
            returns += alive * rewards
            alive &= ~(terminated | truncated)
        best = gains[np.argsort(-returns)[:8]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.5
    observed, _ = envs.reset(seed=99)
    for k in range(100):
        observed, _, terminated, truncated, _ = envs.step(np.clip(observed @ mean, -10, 10)[:, None])
        assert not terminated.any(), k
    assert truncated.all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"actions": {"G": (-1, 1)}}, "G: found no such parameter, expected one of F"),
        ({"actions": {"F": (1, -1)}}, r"actions: 'F': found \(1, -1\), expected a least and a largest number"),
        ({"actions": {"F": 3}}, "actions: 'F': found 3, expected a least and a largest number"),
        ({"actions": [1]}, r"actions: found \[1\], expected ranges by name"),
        ({"actions": {}}, "actions: found no ranges, expected one of an input at least"),
        ({"observations": []}, r"observations: found \[\], expected a list"),
        ({"observations": "cart.x"}, "observations: found 'cart.x', expected a list"),
        ({"observations": ["cart.z"]}, "'cart.z'"),
        ({"observations": ["cart.x +"]}, "observations: output 'cart.x [+]': found no formula"),
        ({"reward": "peak(cart.x)"}, r"reward: 'peak\(cart.x\)': found peak, expected values at one instant"),
        ({"reward": 1}, "reward: found 1, expected a formula"),
        ({"limits": {"cart.x": (np.nan, 1)}}, "limits: 'cart.x'"),
        ({"joints": {"hunge": (0, 1)}}, "hunge"),
        ({"rates": {"rail": "a"}}, "rates: 'rail': found 'a'"),
        ({"dt": 0}, "dt: found 0, expected a time greater than 0 s"),
        ({"steps": 0.5}, "steps: found 0.5, expected a whole number"),
    ],
)
def test_wrong_tasks_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        environment(**change)


def test_a_task_has_actions_observations_and_a_reward():
    for missing, message in (
        ("actions", "actions: found no ranges"),
        ("observations", r"observations: found \(\)"),
        ("reward", "reward: found None"),
    ):
        task = {name: value for name, value in TASK.items() if name != missing}
        for made in (
            lambda task=task: stiffmbs.gym.Environment(scene(), **task),
            lambda task=task: stiffmbs.gym.VectorEnvironment(scene(), 2, **task),
        ):
            with pytest.raises(InputError, match=message):
                made()


def test_wrong_calls_are_refused():
    env = environment()
    with pytest.raises(InputError, match="step: found no episode, expected a call of reset before"):
        env.step(np.array([0.0]))
    with pytest.raises(InputError, match="reset: found the option 'low', expected none"):
        env.reset(options={"low": 1})
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"actions: found an array of shape \(2,\), expected \(1,\)"):
        env.step(np.array([0.0, 1.0]))
    with pytest.raises(InputError, match="input 'F': found nan"):
        env.step(np.array([np.nan]))


def test_the_extra_is_named_where_gymnasium_is_missing(monkeypatch):
    import importlib.util
    import sys

    found = importlib.util.find_spec
    monkeypatch.setattr("stiffmbs.errors.find_spec", lambda name: None if name == "gymnasium" else found(name))
    monkeypatch.delitem(sys.modules, "stiffmbs.gym")
    with pytest.raises(InputError, match=r"stiffmbs\[gym\]"):
        importlib.import_module("stiffmbs.gym")
    assert isinstance(gymnasium.__version__, str)
