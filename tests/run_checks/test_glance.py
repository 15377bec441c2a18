"""What a glance at all rows shows is what looking at them one by one shows."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.results.energy_balance import energy_balance
from stiffmbs.run_checks.glance import glance_at
from stiffmbs.run_checks.overlooked import contradicting_rows
from stiffmbs.solve.missing_rows import reported

PART = 0.05


@pytest.fixture(scope="module")
def run():
    """A pendulum on a cart with output instants inside its steps, disturbed so that all bounds are met."""
    job = prepare(stiffmbs.load_scene("examples/cart_pendulum.yaml"), solver="bdf", points=2000, rtol=1e-4)
    trajectory = job.integrate()
    rows, _ = reported(job.dynamics, trajectory, True)
    random = np.random.default_rng(1)
    rows.acceleration[:] *= 1 + 0.2 * random.standard_normal(rows.acceleration.shape)
    rows.power[:] += random.standard_normal(len(rows.t))
    return job.dynamics.system, rows, trajectory.step_times


def test_energies_widths_and_contradictions(run):
    system, rows, steps = run
    seen, balance = glance_at(system, rows, steps, PART), energy_balance(system, rows, steps)
    assert seen.missing == pytest.approx(balance.furthest, rel=1e-12)
    assert seen.exchanged == pytest.approx(balance.scale, rel=1e-12)
    assert seen.width_q == max(rows.q.max(), 0.0) - min(rows.q.min(), 0.0)
    assert seen.width_u == max(rows.u.max(), 0.0) - min(rows.u.min(), 0.0)
    assert seen.contradicting == len(contradicting_rows(rows, system.mass, steps, PART)) > 0


@pytest.mark.parametrize("name", ["q", "u", "acceleration", "values", "kinetic", "position_violation"])
@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_what_is_not_finite_is_looked_at_closely(run, name, value):
    system, rows, steps = run
    array = getattr(rows, name)
    before, array.flat[-3] = array.flat[-3], value
    assert glance_at(system, rows, steps, PART) is None
    array.flat[-3] = before
    assert glance_at(system, rows, steps, PART) is not None


def test_large_numbers_are_finite_though_their_sum_is_not(run):
    system, rows, steps = run
    before = rows.values.copy()
    rows.values[:2] = 1.5e308
    assert glance_at(system, rows, steps, PART) is not None
    rows.values[:] = before
