"""Projection onto the constraints by the matrix of an implicit step."""

from types import SimpleNamespace

import numpy as np
import pytest

from stiffmbs import load_scene
from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics import stiff_projection
from stiffmbs.dynamics.stiff_projection import StiffProjection
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import stiff_rows

from ..conftest import EXAMPLES


def test_the_matrix_is_that_of_a_tenth_of_the_step(monkeypatch):
    job = prepare(load_scene(EXAMPLES / "bar_pendulum.yaml"), RunSettings(duration=1.0))
    found = []
    projection = StiffProjection(job.dynamics)
    seen = SimpleNamespace(short_call=lambda t, cj, *_: found.append(cj) or 0)
    monkeypatch.setattr(stiff_projection, "PROJECT", seen)
    assert projection.project(0.0, 1e-3, job.start.q.copy(), job.start.u.copy())
    assert found == [pytest.approx(1e4)]


def test_a_violation_is_closed():
    job = prepare(load_scene(EXAMPLES / "bar_pendulum.yaml"), RunSettings(duration=1.0, presolve=False))
    q, u = job.start.q + 1e-4, job.start.u.copy()
    assert StiffProjection(job.dynamics).project(0.0, 1e-3, q, u)
    job.dynamics.state.q[:] = q
    job.dynamics.state.evaluate("motion", 0.0)
    assert np.abs(job.dynamics.state.vector("motion", "C")).max() < 1e-11


@pytest.mark.parametrize("example", ["bar_pendulum", "spatial_chain"])
def test_the_largest_force_is_that_of_the_state(example):
    """Accelerations of large spatial mechanisms are found by elimination, without the terms of the block system."""
    job = prepare(load_scene(EXAMPLES / f"{example}.yaml"), RunSettings(duration=1.0))
    state, system = job.dynamics.state, job.dynamics.system
    job.dynamics.place(job.start.q, job.start.u, job.start.lam)
    state.evaluate("motion", 0.0)
    _, acceleration = job.dynamics.accelerate(0.0)
    forces = np.append(state.vector("motion", "f") / np.sqrt(system.mass), np.sqrt(system.mass) * acceleration)
    state.values["motion"][: system.n_values("motion")] = np.nan
    found = stiff_rows.largest_force(job.dynamics, (job.start.q[None, :], job.start.u[None, :]), 0.0)
    assert found == pytest.approx(np.abs(forces).max())
