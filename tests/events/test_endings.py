"""A run says that it stopped where results end before its duration."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Model, Revolute
from stiffmbs.compile.machine.native.statuses import NO_BALANCE
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.results.solution import channel_ranges
from stiffmbs.solve.trajectory import Outcome


@pytest.fixture
def without_reactions(monkeypatch):
    """Lets accelerations and reactions be missing at the instants that a condition picks."""
    report = Dynamics.report

    def choose(missing):
        def up_to_the_first(self, t, q, u, project):
            count = int(np.argmax([*(missing(instant) for instant in t), True]))
            found = report(self, t[:count], q[:count], u[:count], project)
            return found if count == len(t) else replace(found, status=NO_BALANCE)

        monkeypatch.setattr(Dynamics, "report", up_to_the_first)

    return choose


def pendulum(solve=stiffmbs.run):
    model = Model(gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(0.3, 0)))
    model.add("hinge", Revolute(i=bar.at(-0.3, 0), j="ground"))
    return solve(model, duration=1.0, points=11)


def test_states_without_reactions_stop_the_run(without_reactions):
    without_reactions(lambda t: t > 0.45)
    solution = pendulum()
    assert len(solution.time) == 5
    assert solution.outcome is Outcome.STOPPED
    assert "t = 0.5 s" in solution.message
    assert "friction" in solution.message


def test_a_single_instant_without_reactions_is_left_out_alone(without_reactions):
    whole = pendulum()
    without_reactions(lambda t: abs(t - 0.3) < 0.01 or abs(t - 0.7) < 0.01)
    solution = pendulum()
    assert solution.outcome is Outcome.DONE
    assert len(solution.time) == 11
    assert [
        note for note in solution.notes if "no accelerations" in note and ("t = 0.3 s" in note or "t = 0.7 s" in note)
    ] == [*solution.notes]
    for name in ("hinge.fy", "bar.ay", "energy.total"):
        assert list(np.flatnonzero(np.isnan(solution[name]))) == [3, 7]
        others = [k for k in range(11) if k not in (3, 7)]
        np.testing.assert_array_equal(solution[name][others], whole[name][others])
    np.testing.assert_allclose(solution["bar.angle"], whole["bar.angle"], atol=1e-9)
    extent = channel_ranges(solution)["hinge.fy"]
    assert extent["max"] == np.nanmax(solution["hinge.fy"])
    assert solution.energy_drift() < 1e-4


def test_channels_are_verified_past_an_instant_without_reactions(without_reactions):
    whole = pendulum(stiffmbs.verify)
    without_reactions(lambda t: abs(t - 0.3) < 1e-9)
    solution = pendulum(stiffmbs.verify)
    assert np.isnan(solution["hinge.fy"][3])
    for name in ("hinge.fy", "bar.ay", "bar.x"):
        assert 0 < solution.errors[name].over_time <= 1.1 * whole.errors[name].over_time
        assert 0 < solution.errors[name].greatest <= 1.1 * whole.errors[name].greatest
    missed = [any("bar.ax reaches" in note for note in run.notes) for run in (whole, solution)]
    assert missed == [False, True]  # the peak is at 0.32 s, and what is left of the output passes it by


def test_two_instants_in_succession_without_reactions_end_the_rows(without_reactions):
    without_reactions(lambda t: 0.25 < t < 0.45)
    solution = pendulum()
    assert len(solution.time) == 3
    assert solution.outcome is Outcome.STOPPED
    assert "t = 0.3 s" in solution.message
