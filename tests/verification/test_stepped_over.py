"""What steps go over is found along a run; error bars hold the true error all the same."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Model
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.run import solved
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.verification import solve_again
from stiffmbs.verification import verify as module
from stiffmbs.verification.missed_events import looked_along

from ..conftest import EXAMPLES

WAY = np.linspace(0, 10, 1_000_001)
BUMP = 1e4 * np.cos((WAY - 5.2371) / 4) ** 20_000_000


def body_at_a_bump():
    model = Model()
    model.add("body", Body(mass=1, inertia=1, velocity=(10, 0)))
    model.add("push", FORCES["force"](i="body", force=("1e4*cos((body.x - 5.2371)/4)^20000000", 0)))
    return model


@pytest.mark.long
def test_a_bump_that_no_step_has_seen_is_found_along_the_run(monkeypatch):
    """The trajectory of a body that does not react, as an integrator without any search for events returns it."""
    job = prepare(body_at_a_bump(), duration=1.0, points=14)
    first = _unaware(monkeypatch, job)
    found = looked_along(job, first, 1e7)
    assert found.missed.element == "push"
    assert found.missed.times[0] == pytest.approx(0.52371, abs=1e-3)


def _unaware(monkeypatch, job):
    """The run of a body that flies straight on in one step, and every further one that is not given a longest step.

    A solution of a single interval between output times sees what is there.
    """
    from dataclasses import replace

    from stiffmbs.analyses.job import Job
    from stiffmbs.solve.trajectory import History, Trajectory

    truly = Job.integrate

    def integrate(self, watch=None):
        if self.settings.max_step or len(self.grid.times) == 2:
            return truly(self, watch)
        t = self.grid.times
        x = 10 * t
        q, u = np.stack([x, 0 * x, 0 * x], axis=1), np.tile([10.0, 0, 0], (len(t), 1))
        history = History(np.array([0.0, 0.2, 0.9, 1.0]), np.empty(0, dtype=int))
        return Trajectory(t, q, u, Outcome.DONE, Outcome.DONE.value, {"steps": 3, "seconds": 0.0}, history)

    monkeypatch.setattr(Job, "integrate", integrate)
    return replace(solved(job), history=History(np.array([0.0, 0.2, 0.9, 1.0]), np.empty(0, dtype=int)))


@pytest.mark.long
def test_runs_that_are_all_blind_get_bars_that_hold_the_error_and_the_remedy(monkeypatch):
    job = prepare(body_at_a_bump(), duration=1.0, points=14)
    first = _unaware(monkeypatch, job)
    found = module.verified(job, first, 1e8)
    true = np.sqrt(100 + 2 * np.trapezoid(BUMP, WAY))
    assert abs(found["body.vx"][-1] - true) < found.errors["body.vx"].over_time
    (doubt,) = (note for note in found.notes if "missed event" in note)
    assert "'push'" in doubt and "max_step" in doubt


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_verified_bump_lies_within_its_bar(solver):
    found = module.verify(body_at_a_bump(), duration=1.0, points=14, solver=solver)
    true = np.sqrt(100 + 2 * np.trapezoid(BUMP, WAY))
    assert abs(found["body.vx"][-1] - true) < found.errors["body.vx"].over_time


@pytest.mark.parametrize("name", ["bouncing_ball", "elastic_bearing"])
def test_nothing_is_found_along_runs_with_impacts_and_stiff_bushings(name):
    job = prepare(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml"))
    found = looked_along(job, solved(job), 1e7)
    assert found.missed is None and found.elsewhere is None


@pytest.mark.long
def test_a_run_with_another_longest_step_where_the_scene_has_laws():
    assert prepare(body_at_a_bump()).dynamics.system.has_laws
    pendulum = prepare(stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml"))
    assert not pendulum.dynamics.system.has_laws
    found = module.verify(stiffmbs.load_scene(EXAMPLES / "bouncing_ball.yaml"))
    assert any("with steps of at most" in sentence for sentence in found.verification)


def test_an_interruption_of_the_search_is_the_users(monkeypatch):
    """It counted as a search that has reached its limit, and the verification continued."""
    job = prepare(stiffmbs.load_scene(EXAMPLES / "bouncing_ball.yaml"), duration=0.5)
    first = solved(job)

    def interrupted(_watch, t):
        raise KeyboardInterrupt

    monkeypatch.setattr(solve_again.Deadline, "__call__", interrupted)
    with pytest.raises(KeyboardInterrupt):
        looked_along(job, first, 1e9)


@pytest.mark.parametrize("at", ["looked_along", "solve_again", "error_bar", "scales"])
def test_interrupted_at_any_moment_the_first_run_is_kept(monkeypatch, at):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, at, interrupted)
    found = module.verify(stiffmbs.load_scene(EXAMPLES / "bouncing_ball.yaml"))
    assert found.outcome is Outcome.DONE and len(found.time) == 1501
    assert any("interrupted by the user" in sentence for sentence in found.verification)
