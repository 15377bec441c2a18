"""Starts of IDA by one compiled call against those by Python: the same numbers, bit for bit."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.jobs.run import prepare
from stiffmbs.solve.bdf import Integrator
from stiffmbs.solve.events.restart import restarted

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
    connection = engine._ida.connection
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
    q, u = integrator.split(integrator.engine._ida.y)
    start = restarted(job.dynamics, 0.05, q, u)
    by_python, by_call = (left_behind(job, integrator, start, 0.05, compiled) for compiled in (False, True))
    assert len(by_python[0]) and np.any(by_python[1])
    for one, other in zip(by_python, by_call, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ["half_car", "bouncing_ball"])
def test_a_run_of_compiled_starts_is_the_run_of_starts_by_python(name, examples, monkeypatch):
    job = prepare(stiffmbs.load_scene(examples / f"{name}.yaml"), solver="bdf", duration=1.0)
    job.integrate()
    done, begin_at = [], type(Integrator(job.dynamics, job.settings).engine).begin_at

    def noted(*arguments):
        done.append(begin_at(*arguments))
        return done[-1]

    engine = "stiffmbs.solve.ida.native_engine.NativeEngine.begin_at"
    monkeypatch.setattr(engine, noted)
    found = job.integrate()
    assert len(done) > 1 and all(done)
    monkeypatch.setattr(engine, lambda *arguments: False)
    expected = job.integrate()
    for name in ("t", "q", "u", "step_times"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert {**found.statistics, "seconds": 0} == {**expected.statistics, "seconds": 0}


def test_infinite_stiffness_is_left_to_python(examples):
    job = prepare(stiffmbs.load_scene(examples / "half_car.yaml"), solver="bdf", duration=0.01)
    integrator = Integrator(job.dynamics, job.settings)
    list(integrator.run(job.start, job.grid))
    engine = integrator.engine
    assert engine.begin_at(job.start, 0.0)
    engine._starts._kept[0]["f_q_scale"][:] = 0.0
    assert not engine.begin_at(job.start, 0.0)
