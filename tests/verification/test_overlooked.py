"""Steps that pass over something are told from the forces at output instants, and are taken again."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import rerun
from stiffmbs.compile.law_intervals import Intervals, intervals_of
from stiffmbs.solve.events import event_functions as event_watch
from tests.stress.fuzzers import contacts

from ..conftest import EXAMPLES

SOLVERS = (
    {"solver": "bdf"},
    {"solver": "projected", "scheme": "dopri5"},
    {"solver": "projected", "scheme": "dop853"},
    {"solver": "auto"},
)
HEIGHT, WIDTH = 1e4, 1e-4
BUMP = f"""
gravity: [0, 0]
bodies: {{ball: {{mass: 1, inertia: 1, velocity: [10, 0]}}}}
forces: {{bump: {{type: force, i: ball, force: ["{HEIGHT}*exp(-((ball.x - 5.00001)/{WIDTH})^2)", 0]}}}}
"""
POST = """
gravity: [0, 0]
bodies: {ball: {mass: 1, inertia: 1, velocity: [10, 0]}}
forces:
  post: {type: contact, i: ball, j: {body: ground, point: [5.01, 0]}, surface: circle, surface_radius: 0.028, stiffness: 1e8}
"""
BEHIND = {"bump": np.sqrt(100 + 2 * HEIGHT * WIDTH * np.sqrt(np.pi)), "post": -10.0}


@pytest.fixture
def no_search(monkeypatch):
    """Nothing within a step is looked for: all edges are out of reach."""

    def far_away(system):
        count = len(intervals_of(system).period)
        return Intervals(
            2 * np.arange(count + 1),
            np.full(2 * count, 1e300),
            np.zeros(2 * count),
            np.zeros(count),
            np.empty(0, dtype=np.int64),
            np.empty(0),
            np.zeros(count, dtype=np.int64),
            count,
            np.zeros(count, dtype=np.int64),
            np.empty(0, dtype=np.int64),
        )

    monkeypatch.setattr(event_watch, "intervals_of", far_away)
    monkeypatch.setattr(event_watch.EventSearch, "watch_for", lambda *_: None)


def told(solution):
    return [note for note in solution.notes if "missed" in note]


@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
@pytest.mark.parametrize(("scene", "law"), [(BUMP, "bump"), (POST, "post")], ids=["bump", "post"])
def test_what_steps_pass_over_is_told_and_the_run_taken_again(no_search, scene, law, how):
    model = stiffmbs.read_scene(scene)
    unseen = stiffmbs.run(model, duration=1.0, points=2, rtol=1e-6, **how)
    assert unseen["ball.vx"][-1] == pytest.approx(10, abs=1e-6) and not told(unseen)
    found = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-6, **how)
    (note,) = told(found)
    assert f"'{law}' at t = 0.5 s" in note and "ball.vx" in note and "repeated" in note
    assert found["ball.vx"][-1] == pytest.approx(BEHIND[law], abs=2e-3)
    assert found["ball.vx"][4] == pytest.approx(10, abs=1e-6)


def test_what_is_not_taken_again_is_said(no_search, monkeypatch):
    monkeypatch.setattr(rerun, "ROUNDS", 0)
    found = stiffmbs.run(stiffmbs.read_scene(BUMP), duration=1.0, points=11, solver="projected", scheme="dopri5")
    (note,) = told(found)
    assert found["ball.vx"][-1] == pytest.approx(10, abs=1e-6)
    assert "'bump' at t = 0.5 s" in note and "may be wrong from there on" in note and "max_step" in note


def test_an_interrupted_second_run_leaves_the_first(no_search):
    starts = []

    def watch(t):
        starts.append(t)
        if t < max(starts):
            raise KeyboardInterrupt

    model = stiffmbs.read_scene(BUMP)
    found = stiffmbs.run(model, watch=watch, duration=1.0, points=11, solver="projected", scheme="dopri5")
    assert len(found.time) == 11
    (note,) = told(found)
    assert "may be wrong from there on" in note


@pytest.mark.long
@pytest.mark.sampled(9)
@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
@pytest.mark.parametrize("name", ["bouncing_ball", "cam_follower", "elastic_bearing", "half_car", "stick_slip"])
def test_runs_that_have_seen_everything_are_left_alone(name, how):
    for rtol in (1e-3, 1e-6):
        assert not told(stiffmbs.run(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml"), rtol=rtol, **how))


@pytest.mark.long
def test_a_corner_that_meets_the_ground_while_its_body_spins():
    """A random scene in which a body turns by 11 rad in a step of free flight."""
    described, _ = contacts._made(np.random.default_rng(9))
    model = stiffmbs.read_scene(json.dumps(described))
    found = stiffmbs.run(model, duration=0.5, points=500, rtol=1e-7)
    short = stiffmbs.run(model, duration=0.5, points=500, rtol=1e-7, max_step=2e-4)
    for name in ("b1.vx", "b1.vy"):
        assert found[name][-1] == pytest.approx(short[name][-1], rel=1e-4)
