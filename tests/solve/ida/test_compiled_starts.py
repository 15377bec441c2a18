"""Starts of IDA by one compiled call against those by Python: the same numbers, bit for bit."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.run import prepare
from stiffmbs.reading.files.yaml_text import read_yaml, scene_text
from stiffmbs.solve.events.restart import restarted
from stiffmbs.solve.ida.ida import NativeIda
from stiffmbs.solve.ida.native_engine import NativeEngine
from stiffmbs.solve.integrator import Integrator

SCENES = {
    "half_car": {"formulation": "SI1"},
    "cart_pendulum": {},
    "stick_slip": {"presolve": False},
    "spatial_slider_crank": {},
    "governor": {"presolve": False},
    "rolling_disc": {},
}


def left_behind(job, integrator, start, t, compiled):
    """All that a start leaves behind: unknowns, relaxations, offsets, what IDA is given."""
    integrator.engine.forget()
    state, engine = job.dynamics.state, integrator.engine
    state.relaxations[:] = 0.0
    if compiled:
        assert engine.begin_at(start, t)
    else:
        integrator._begin_step_by_step(start, t)
    connection = engine.ida
    tables = connection.cells, connection.output_correction._cells, connection.error_norm._cells
    relaxed = [
        values[-1 - 2 * job.dynamics.system.n_c :] for name, values in state.values.items() if values is not None
    ]
    cells = [float(table[name]) for table in tables for name in table.dtype.names]
    given = [engine._newton, engine._stiffness.of_positions, engine._stiffness.of_velocities, *cells]
    vectors = (
        connection.y,
        connection.yp,
        state.mu,
        state.a,
        state.relaxations,
        integrator.equations._offset,
        *relaxed,
    )
    return [np.array(vector) for vector in (*vectors, given)]


@pytest.mark.parametrize("name", SCENES)
def test_a_compiled_start_leaves_the_same_numbers(name, examples):
    job = prepare(stiffmbs.load_scene(examples / f"{name}.yaml"), solver="bdf", duration=0.05, **SCENES[name])
    integrator = Integrator(job.dynamics, job.settings)
    list(integrator.run(job.start, job.grid))
    q, u = integrator.split(integrator.engine.ida.y)
    start = restarted(job.dynamics, 0.05, q, u)
    by_python, by_call = (left_behind(job, integrator, start, 0.05, compiled) for compiled in (False, True))
    assert len(by_python[0]) and np.any(by_python[1])
    for one, other in zip(by_python, by_call, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ["half_car", "bouncing_ball", "cam_follower"])
@pytest.mark.parametrize("starts", [("begin_restart", None), ("begin_restart", None, "begin_at", False)])
def test_a_run_of_compiled_starts_is_the_run_of_starts_by_python(name, starts, examples, monkeypatch):
    job = prepare(stiffmbs.load_scene(examples / f"{name}.yaml"), solver="bdf", duration=1.0)
    job.integrate()
    done, begin_restart = [], NativeEngine.begin_restart

    def noted(*arguments):
        done.append(begin_restart(*arguments))
        return done[-1]

    monkeypatch.setattr(NativeIda, "may_pass", False)
    monkeypatch.setattr(NativeEngine, "begin_restart", noted)
    found = job.integrate()
    assert len(done) > 1 and all(done)
    for name, outcome in zip(starts[::2], starts[1::2], strict=True):
        monkeypatch.setattr(NativeEngine, name, lambda *arguments, outcome=outcome: outcome)
    expected = job.integrate()
    for name in ("t", "q", "u", "step_times"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert {**found.statistics, "seconds": 0} == {**expected.statistics, "seconds": 0}
    assert found.note == expected.note


def test_what_was_counted_before_a_start_that_is_left_to_python_counts_once(examples, monkeypatch):
    job = prepare(stiffmbs.load_scene(examples / "half_car.yaml"), solver="bdf", duration=1.0)
    job.integrate()
    expected = job.integrate().statistics
    engine = Integrator(job.dynamics, job.settings).engine
    begin_restart = NativeEngine.begin_restart

    def without_end(*arguments):
        scales = engine._starts._kept[0]["f_q_scale"]
        kept, scales[:] = scales.copy(), 0.0  # the stiffness is infinite
        found = begin_restart(*arguments)
        scales[:] = kept
        assert found is None
        return found

    monkeypatch.setattr(NativeIda, "may_pass", False)
    monkeypatch.setattr(NativeEngine, "begin_restart", without_end)
    assert {**job.integrate().statistics, "seconds": 0} == {**expected, "seconds": 0}


def test_infinite_stiffness_is_left_to_python(examples):
    job = prepare(stiffmbs.load_scene(examples / "half_car.yaml"), solver="bdf", duration=0.01)
    integrator = Integrator(job.dynamics, job.settings)
    list(integrator.run(job.start, job.grid))
    engine = integrator.engine
    assert engine.begin_at(job.start, 0.0)
    engine._starts._kept[0]["f_q_scale"][:] = 0.0
    assert not engine.begin_at(job.start, 0.0)


def hopping(times):
    """A block on a spring, pushed by a force with a corner at each of some times."""
    force = " + ".join(f"max(0, t - {t!r})" for t in times)
    return stiffmbs.read_scene(
        f"""
bodies:
  block: {{mass: 1, inertia: 1, position: [0, 0]}}
joints:
  rail: {{type: prismatic, i: block, j: ground}}
forces:
  spring: {{type: force, i: block, force: ["20*({force}) - 400*dx(block) - vx(block)", 0]}}
"""
    )


def both_ways(job, monkeypatch):
    """The run that passes breakpoints in one call, and the one that comes back to Python at each; how many were passed."""
    job.integrate()
    found, passed = job.integrate(), []
    advance_past = NativeIda.advance_past

    def counted(ida, anew, *arguments):
        result = advance_past(ida, anew, *arguments)
        passed.append(anew.passed[0])
        return result

    monkeypatch.setattr(NativeIda, "advance_past", counted)
    job.integrate()
    monkeypatch.setattr(NativeIda, "may_pass", False)
    expected = job.integrate()
    for name in ("t", "q", "u", "step_times"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    np.testing.assert_array_equal(found.history.order, expected.history.order)
    assert {**found.statistics, "seconds": 0} == {**expected.statistics, "seconds": 0}
    assert found.note == expected.note and found.message == expected.message
    return found, sum(passed)


@pytest.mark.parametrize(
    ("solver", "stiffness", "rtol", "expected"),
    [("bdf", "1e7", 1e-3, 3), ("bdf", "1e7", 1e-10, 2), ("bdf", "1e12", 1e-3, 3), ("radau", "1e12", 1e-4, 3)],
)
def test_breakpoints_are_passed_in_one_call_with_the_same_numbers(
    examples, solver, stiffness, rtol, expected, monkeypatch
):
    """As long as there are rows for the steps of one call; without constraints, after steps that are long for the bushings too."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", stiffness)])
    job = prepare(scene, solver=solver, duration=1.0, rtol=rtol)
    found, passed = both_ways(job, monkeypatch)
    assert found.statistics["breakpoints"] == 3 and passed == expected


@pytest.mark.long
def test_many_breakpoints_are_passed_in_a_few_calls(monkeypatch):
    times = [0.01 * k for k in range(1, 100)]
    found, passed = both_ways(prepare(hopping(times), solver="bdf", duration=1.0, rtol=1e-6), monkeypatch)
    assert found.statistics["breakpoints"] == 99
    assert passed > 90


def test_an_output_time_a_rounding_behind_a_breakpoint_is_left_to_python(monkeypatch):
    """0.01 s * 70 is above 0.7 s by one rounding."""
    job = prepare(hopping([0.2, 0.7]), solver="bdf", duration=1.0, rtol=1e-6, output=0.01)
    found, passed = both_ways(job, monkeypatch)
    assert (found.statistics["breakpoints"], passed, len(found.t)) == (2, 2, 101)


@pytest.mark.long
def test_rows_before_a_breakpoint_keep_the_offsets_of_their_start(examples, monkeypatch):
    """Projections change what stands still by rounding."""
    scene = read_yaml((examples / "spatial_slider_crank.yaml").read_text(), "scene")
    corners = "10*(max(0, min(t - 0.1, 0.2)) - 2*max(0, min(t - 0.45, 0.3)) + max(0, t - 0.8))"
    last = [*scene["bodies"]][-1]
    scene.setdefault("forces", {}).update(
        push={"type": "force", "i": last, "force": [corners, "0", "0"]},
        hold={"type": "force", "i": last, "force": [f"-3*vx({last}) - 20*dx({last})", "0", "0"]},
    )
    found, _ = both_ways(
        prepare(stiffmbs.read_scene(scene_text(scene)), solver="bdf", duration=1.5, rtol=1e-5), monkeypatch
    )
    assert found.statistics["breakpoints"] == 5
