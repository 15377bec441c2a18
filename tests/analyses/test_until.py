"""Stages that end where a request comes to a value."""

from types import SimpleNamespace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import conditions
from stiffmbs.solve import sampling

THROWN = """
name: a ball that is thrown up
gravity: [0, -10]
bodies: {ball: {mass: 2, inertia: 1, velocity: [1, 6]}}
requests: {height: ball.y, speed: ball.vy, pull: ball.ay}
run: {rtol: 1e-9}
stages:
  - {until: {top: {request: CONDITION}}, run: {duration: 2, output: 0.25}}
  - {change: {gravity: [0, 0]}, end: 3, run: {points: 3}}
"""


def ran(condition, scene=THROWN, **changes):
    return stiffmbs.run(stiffmbs.read_scene(scene.replace("CONDITION", condition)), **changes)


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
@pytest.mark.parametrize(
    ("condition", "t"),
    [
        ("speed, at_most: 0", 0.6),
        ("height, at_least: 1", 0.2),
        ("height, equals: 1", 0.2),
        ("height, equals: -1", 0.6 + np.sqrt(0.36 + 0.2)),
        ("height, equals: 2, within: 0.35", 0.6 - np.sqrt(0.03)),  # 1.8 m high at the most
    ],
)
def test_a_stage_ends_where_a_request_comes_to_a_value(condition, t, solver):
    found = ran(condition, solver=solver)
    assert "3 runs" not in found.message and found.success
    k = np.flatnonzero(found.time == found.time[np.searchsorted(found.time, t - 1e-4)])
    np.testing.assert_allclose(found.time[k], t, atol=1e-7)
    np.testing.assert_allclose(found["height"][k], 6 * found.time[k] - 5 * found.time[k] ** 2, atol=1e-6)
    np.testing.assert_allclose(found.time[: k[0]], np.arange(0, t, 0.25)[: k[0]])
    assert found.time[-1] == pytest.approx(3) and len(found.time) == k[-1] + 3
    np.testing.assert_allclose(found["ball.vy"][-1], found["ball.vy"][k[-1]], atol=1e-8)


def test_a_condition_that_never_holds_changes_nothing():
    found = ran("height, at_least: 9")
    np.testing.assert_allclose(found.time, [*np.arange(9) / 4, 2.0, 2.5, 3.0][: len(found.time)])
    assert found.time[8] == 2.0 and found["ball.vy"][-1] == pytest.approx(-14)


@pytest.mark.parametrize(
    "settings",
    [
        {"solver": "bdf", "max_step": 1e-3},
        {"solver": "radau", "max_step": 1e-3},
        {"solver": "auto", "max_step": 1e-3},
        {"solver": "projected", "scheme": "rk4", "step": 1e-3},
    ],
)
@pytest.mark.parametrize(
    ("condition", "t"), [("speed, at_most: 0", 0.6), ("sampled, at_most: 0.05", 0.6), ("speed, at_least: 1", 0.0)]
)
def test_the_time_after_a_condition_is_not_solved(settings, condition, t):
    """A stage was solved over its whole time before its conditions were looked at."""
    scene = THROWN.replace("duration: 2", "duration: 20").replace("end: 3", "end: 21")
    scene = scene.replace(
        "requests: {", "states: {seen: {update: ball.vy, period: 0.1, start: 9}}\nrequests: {sampled: seen, "
    )
    if "sampled" not in condition:
        scene = "\n".join(line for line in scene.split("\n") if "states" not in line).replace("sampled: seen, ", "")
    reached = []
    try:
        found = ran(condition + ", then: stop", scene, watch=reached.append, **settings)
    except stiffmbs.InputError as error:
        assert not t and "true at the start" in str(error)
    else:
        assert found.success and found.time[-1] == pytest.approx(t, abs=1e-2 if "sampled" in condition else 1e-7)
    assert max(reached) < 5


def test_mechanisms_that_are_solved_apart_end_together():
    scene = THROWN.replace("speed: ball.vy", "speed: ball.vy + 0*disc.vx").replace(
        "bodies: {", "bodies: {disc: {mass: 1, inertia: 1, velocity: [1, 0]}, "
    )
    for settings in ({"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected"}):
        found = ran("speed, at_most: 0, then: stop", scene, **settings)
        assert found.time[-1] == pytest.approx(0.6, abs=1e-7)
        np.testing.assert_allclose(found["disc.x"], found.time, atol=1e-7)


def test_a_near_miss_does_not_count_if_the_value_is_reached_later():
    """An extremum within the tolerance counts only if the bound itself is never met, also where another condition is."""
    near = "height, equals: 2, within: 0.35}, low: {request: height, at_most: -3, then: stop"
    assert ran(near).time[3] == pytest.approx(0.6 - np.sqrt(0.03), abs=1e-6)
    rising = THROWN.replace("bodies: {", "bodies: {rocket: {mass: 1, inertia: 1, position: [0, 0.5]}, ").replace(
        "height: ball.y", "height: 'ball.y + 100*max(t - 1.2, 0)^2'"
    )
    later = ran("height, equals: 2, within: 0.35}, slow: {request: speed, at_most: -1, then: stop", rising)
    assert later.time[-1] == pytest.approx(0.7, abs=1e-6)


def test_no_stage_follows_where_the_condition_says_so():
    found = ran("speed, at_most: 0, then: stop")
    assert found.time[-1] == pytest.approx(0.6, abs=1e-8) and found.success
    assert "ended at t = 0.6" in found.message and "'top'" in found.message


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ("speed", "found no bound, expected one of at_least, at_most, equals"),
        ("speed, at_least: 1, at_most: 2", "found at_least and at_most, expected one of"),
        ("spin, at_least: 1", "stage 1 of 2: 'top': found request = spin, expected the name of a request"),
        ("speed, at_least: 1", "'top': found its condition true at the start"),
    ],
)
def test_a_wrong_condition_is_said(condition, message):
    with pytest.raises(stiffmbs.InputError, match=message):
        ran(condition)


def test_a_stage_has_one_end_that_lies_after_its_start():
    with pytest.raises(stiffmbs.InputError, match="found end and a duration, expected one of them"):
        ran("speed, at_most: 0", THROWN.replace("end: 3, run: {", "end: 3, run: {duration: 1, "))
    with pytest.raises(
        stiffmbs.InputError, match=r"stage 2 of 2: found its end at 0.5 s, expected a time after its start at 0.6 s"
    ):
        ran("speed, at_most: 0", THROWN.replace("end: 3", "end: 0.5"))


def test_all_looks_of_a_monitor_take_a_time_in_proportion_to_the_rows(monkeypatch):
    start = SimpleNamespace(q=np.zeros(1), u=np.zeros(1), lam=np.zeros(0))
    job = SimpleNamespace(
        dynamics=SimpleNamespace(system=None), start=start, grid=SimpleNamespace(start=0.0, end=1.0), data=None
    )
    monkeypatch.setattr(conditions, "Dynamics", lambda _: SimpleNamespace(place=lambda *_: None))
    known = []
    monkeypatch.setattr(conditions.Monitor, "_is_met", lambda self: known.append(self._known))
    monitor, count, row = conditions.Monitor({}, True, job), 100_000, np.zeros((1, 1))
    for k in range(1, count):
        monitor.look(np.array([k / count]), row, row)
    assert known[-1] > 0.9 * count
    assert sum(known) < 100 * count


SAMPLED = """
name: a ball that is thrown up, with a controller that begins to push at 0.5 s
gravity: [0, -10]
bodies: {ball: {mass: 2, inertia: 1, velocity: [1, 6]}}
states:
  count: {update: count + 1, period: 1 ms}
  push: {update: "branch(t - 0.495, 0, 0, -4*ball.vy)", period: 10 ms}
forces: {thrust: {type: force, i: ball, force: [0, push]}}
requests: {height: ball.y, speed: ball.vy, samples: count}
run: {rtol: 1e-9}
stages:
  - {until: {end: {request: CONDITION}}, run: {duration: 2, output: 0.25}}
"""


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
@pytest.mark.parametrize(("condition", "t"), [("height, at_least: 1", 0.2), ("samples, at_least: 350", 0.349)])
def test_samples_that_change_nothing_that_acts_end_no_step_before_a_condition(condition, t, solver, monkeypatch):
    """The count of samples, which a condition reads, is right in all rows; none of the first 350 starts the solver anew."""
    begun = []
    restarted = sampling._restarted
    monkeypatch.setattr(sampling, "_restarted", lambda *given: begun.append(given[1]) or restarted(*given))
    found = ran(condition, SAMPLED, solver=solver)
    assert found.time[-1] == pytest.approx(t, abs=1e-7)
    assert len(begun) < 120, "two runs up to the condition, and those that locate it"
    assert found["ball.y"][-1] == pytest.approx(6 * t - 5 * t**2, abs=1e-7)


def test_samples_that_act_before_a_condition_start_the_solver_anew():
    """From 0.5 s on each push is that of the speed 0 to 10 ms ago."""
    t, v = 0.5, 1.0
    while v - 0.01 * (10 + 2 * v) > -0.9:
        t, v = t + 0.01, v - 0.01 * (10 + 2 * v)
    found = ran("speed, at_most: -0.9", SAMPLED)
    assert found.time[-1] == pytest.approx(t + (v + 0.9) / (10 + 2 * v), abs=1e-7)
