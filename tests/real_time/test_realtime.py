"""Steps in real time: their record, their states, and their differences from a run with error control."""

import gc
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError, SolverError
from stiffmbs.real_time import loop
from stiffmbs.real_time.accuracy import Accuracy
from stiffmbs.real_time.recorded import RecordedSimulation
from stiffmbs.real_time.report import RealTime, duration
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.studies.stepping import FixedSteps

from .scenes import driven

PENDULUM = Path(stiffmbs.__file__).parent.parent / "examples" / "cart_pendulum.yaml"
LINEARLY_IMPLICIT = {"solver": "projected", "scheme": "extrapolated_euler"}


def of_times(spent, late=None):
    return RealTime(
        name="", solver="", step=1e-3, start=2.0, requested=len(spent), spent=np.array(spent), measured="processor time", late=late,
        outcome=Outcome.DONE, message="", channels=(), exchanged=None, accuracy=Accuracy.unknown("none"), solution=None, notes=(),
    )  # fmt: skip


@pytest.fixture(scope="module")
def found():
    return stiffmbs.realtime(PENDULUM, step=1e-3, duration=0.1, paced=False)


def test_statistics_are_those_of_the_recorded_times():
    spent = np.random.default_rng(0).permutation(np.arange(1, 10001)) * 1e-7
    times = of_times(spent, late=spent - 9e-4)
    assert times.mean == pytest.approx(5000.5e-7)
    assert [times.percentile(part) for part in (50, 99, 99.99)] == pytest.approx([5000e-7, 9900e-7, 9999e-7])
    assert times.longest == pytest.approx(1e-3)
    assert times.longest_at == pytest.approx(2.0 + (int(spent.argmax()) + 1) * 1e-3)
    assert times.overruns == (spent > 9e-4).sum()
    for part in (50, 99, 99.99):
        assert np.mean(spent <= times.percentile(part)) >= part / 100


def test_steps_above_the_period_are_counted():
    assert of_times([0.5e-3, 2e-3, 1.5e-3]).above == 2


def test_a_report_without_steps_has_no_numbers():
    empty = of_times([])
    assert np.isnan([empty.mean, empty.longest, empty.longest_at, empty.percentile(99)]).all()
    assert "0 of 0 steps" in str(empty)


def test_every_step_is_recorded(found):
    assert found.steps == found.requested == 100
    assert found.spent.min() > 0
    assert found.late is None and found.overruns is None
    assert found.mean <= found.longest


def test_states_are_those_of_steps_of_a_simulation(found):
    sim = stiffmbs.simulation(PENDULUM, **LINEARLY_IMPLICIT, step=1e-3)
    sim.steps(100)
    for name in ("cart.x", "cart.vx", "bar.angle", "bar.omega"):
        assert found.solution[name][-1] == sim[name]


def test_inputs_have_their_given_values():
    stiffness = "forces.spring.stiffness"
    given = stiffmbs.realtime(PENDULUM, step=1e-3, duration=0.1, paced=False, inputs={stiffness: 400.0})
    sim = stiffmbs.simulation(PENDULUM, inputs={stiffness: 400.0}, **LINEARLY_IMPLICIT, step=1e-3)
    sim.steps(100)
    assert given.solution["cart.x"][-1] == sim["cart.x"]
    assert max(one.largest for one in given.accuracy.differences if one.kind == "position") < 1e-5


def test_differences_are_those_of_a_controlled_run(found):
    exact = stiffmbs.run(PENDULUM, duration=0.1, points=len(found.solution.time))
    of_kinds = {one.kind: one for one in found.accuracy.differences}
    assert set(of_kinds) >= {"position", "angle", "velocity", "angular velocity", "force"}
    for one in of_kinds.values():
        if one.largest:
            apart = np.abs(found.solution[one.channel] - exact[one.channel])
            assert one.largest == pytest.approx(apart.max(), rel=1e-3, abs=1e-9)
    assert of_kinds["force"].unit == "N" and of_kinds["force"].channel in found.solution.channels


def test_differences_are_of_order_two_in_the_step():
    apart = [
        {one.kind: one.largest for one in stiffmbs.realtime(PENDULUM, step=h, duration=0.5, paced=False, rtol=1e-10).accuracy.differences}
        for h in (4e-3, 2e-3)
    ]  # fmt: skip
    assert 3 < apart[0]["position"] / apart[1]["position"] < 5


def test_a_scene_with_fixed_steps_is_compared_with_bdf():
    own = stiffmbs.load_scene(PENDULUM, [("run.solver", "projected"), ("run.scheme", "rk4"), ("run.step", "2 ms")])
    found = stiffmbs.realtime(own, duration=0.1, paced=False)
    assert (found.solver, found.step, found.steps) == ("rk4", 2e-3, 50)
    assert found.accuracy.solver.startswith("bdf at rtol")


def test_channels_are_read_after_each_step(monkeypatch):
    read = []
    own = RecordedSimulation.__getitem__
    monkeypatch.setattr(RecordedSimulation, "__getitem__", lambda sim, name: read.append(name) or own(sim, name))
    stiffmbs.realtime(PENDULUM, step=1e-2, duration=0.1, paced=False, channels=["cart.x", "rail.fy"])
    assert read.count("rail.fy") >= 10


def test_paced_steps_begin_when_they_are_due(monkeypatch):
    waited = []
    monkeypatch.setattr(loop, "_wait_until", waited.append)
    found = stiffmbs.realtime(PENDULUM, step=1e-2, duration=0.1)
    assert np.diff(waited).tolist() == [10_000_000] * 9
    assert len(found.late) == found.steps == 10


def test_the_clock_is_waited_for():
    due = time.perf_counter_ns() + 2_000_000
    loop._wait_until(due)
    assert time.perf_counter_ns() >= due
    loop._wait_until(due)  # a time that has passed


def test_no_garbage_is_collected_between_steps(monkeypatch):
    enabled = []
    own = RecordedSimulation.step
    monkeypatch.setattr(RecordedSimulation, "step", lambda sim, dt: enabled.append(gc.isenabled()) or own(sim, dt))
    stiffmbs.realtime(PENDULUM, step=1e-2, duration=0.1, paced=False)
    assert not any(enabled[-10:])
    assert gc.isenabled()


def ending_at(monkeypatch, error, t):
    """Let a step at a time fail."""
    own = RecordedSimulation.step

    def step(sim, dt):
        if sim.t > t:
            raise error
        own(sim, dt)

    monkeypatch.setattr(RecordedSimulation, "step", step)


@pytest.mark.parametrize(
    ("error", "outcome"), [(SolverError("singular"), Outcome.STOPPED), (KeyboardInterrupt(), Outcome.INTERRUPTED)]
)
def test_steps_that_end_early_have_a_report(monkeypatch, error, outcome):
    ending_at(monkeypatch, error, 0.0495)
    found = stiffmbs.realtime(PENDULUM, step=1e-3, duration=0.1, paced=False)
    assert (found.outcome, found.steps, found.requested) == (outcome, 50, 100)
    assert found.accuracy.end == pytest.approx(0.05)
    assert outcome is Outcome.INTERRUPTED or "singular" in found.message


def test_a_comparison_needs_an_output_time(monkeypatch):
    ending_at(monkeypatch, SolverError("singular"), 1e-4)
    found = stiffmbs.realtime(driven(), step=1e-3, paced=False)
    assert found.steps == 1
    assert "no output time" in found.accuracy.message


def test_a_motion_that_is_not_resolved_is_a_note(monkeypatch):
    own = RecordedSimulation.step
    monkeypatch.setattr(
        RecordedSimulation, "step", lambda sim, dt: warnings.warn("not resolved", RuntimeWarning, 1) or own(sim, dt)
    )
    found = stiffmbs.realtime(driven(), step=1e-2, paced=False)
    assert "not resolved" in found.notes


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"step": 0.0}, "step: found 0"),
        ({"step": -1e-3}, "step: found -0.001"),
        ({"step": 1.0}, "at most the duration of 0.2 s"),
        ({}, "step: found none"),
        ({"step": 1e-3, "channels": ["cart.xx"]}, "no channel 'cart.xx'"),
        ({"step": 1e-3, "channels": "cart.x"}, "expected a list of channels"),
        ({"step": 1e-3, "inputs": {"G": 1.0}}, "G: found no such parameter"),
        ({"step": 1e-3, "scheme": "euler"}, "scheme: found 'euler'"),
    ],
)
def test_an_invalid_request_is_refused(settings, message):
    with pytest.raises(InputError, match=message):
        stiffmbs.realtime(driven(), **settings)


@pytest.mark.parametrize(
    ("seconds", "text"), [(2.0, "2 s"), (1.234e-3, "1.23 ms"), (9.99e-4, "999 us"), (5e-8, "0.05 us"), (np.nan, "-")]
)
def test_durations_have_units(seconds, text):
    assert duration(seconds) == text


def test_a_report_is_kept_if_the_controlled_run_fails(monkeypatch):
    monkeypatch.setattr("stiffmbs.real_time.accuracy.run", lambda *_: (_ for _ in ()).throw(SolverError("no start")))
    found = stiffmbs.realtime(driven(), step=1e-2, paced=False)
    assert found.steps == 20
    assert "the run with error control failed: no start" in str(found)


def test_a_warm_up_that_fails_is_not_reported(monkeypatch):
    own, calls = RecordedSimulation.step, []

    def step(sim, dt):
        calls.append(dt)
        if len(calls) == 3:
            raise SolverError("singular")
        own(sim, dt)

    monkeypatch.setattr(RecordedSimulation, "step", step)
    found = stiffmbs.realtime(driven(), step=1e-2, paced=False)
    assert (found.outcome, found.steps) == (Outcome.DONE, 20)


def test_code_for_breakpoints_is_loaded_before_the_first_step(monkeypatch):
    scene = stiffmbs.read_scene(
        "{bodies: {a: {mass: 1, inertia: 1}}, forces: {push: {type: force, i: a, force: ['step(t, 0.05, 0, 0.06, 1)', 0]}}, "
        "run: {duration: 0.1, points: 11}}"
    )
    passed = []
    own = FixedSteps.pass_breakpoints
    monkeypatch.setattr(FixedSteps, "pass_breakpoints", lambda self, t: passed.append(t) or own(self, t))
    found = stiffmbs.realtime(scene, step=1e-3, paced=False)
    assert passed[0] == pytest.approx(0.011)
    assert [t for t in passed[1:] if t < 0.049] == []
    sim = stiffmbs.simulation(scene, **LINEARLY_IMPLICIT, step=1e-3)
    for _ in range(100):
        sim.step(1e-3)
    assert found.solution["a.vx"][-1] == sim["a.vx"]
