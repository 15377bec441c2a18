"""Rows that contradict the next one, and work of the order that its rule has."""

from types import SimpleNamespace

import numpy as np
import pytest

from stiffmbs.results.energy_balance import work_since_start
from stiffmbs.run_checks.overlooked import contradicting_rows


@pytest.fixture
def random():
    return np.random.default_rng(3)


def test_rows_contradict_where_the_velocity_changes_otherwise_than_accelerations_say(random):
    t, u, a = np.sort(random.random(50)), random.normal(size=(50, 2)), random.normal(size=(50, 2))
    u[1:] = u[0] + np.cumsum(np.diff(t)[:, None] * (a[1:] + a[:-1]) / 2, axis=0)
    u[20:, 1] += 5.0
    a[30] = np.nan
    rows = SimpleNamespace(t=t, u=u, acceleration=a)
    mass, between = np.array([1.0, 2.0]), (t[1:] + t[:-1]) / 2
    none = np.zeros(2)
    assert contradicting_rows(rows, mass, np.array([-1.0, 2.0]), none)[0].tolist() == [19]
    assert not len(contradicting_rows(rows, mass, np.array([-1.0, 2.0]), np.full(2, 1e4))[0])
    assert not len(contradicting_rows(rows, mass, between, none)[0]), "steps end inside the interval"
    assert contradicting_rows(rows, mass, np.array([t[19] - 1e-6, t[20] + 1e-6]), none)[0].tolist() == [19]
    assert not len(contradicting_rows(rows, mass, np.array([t[19], t[20] + 1e-6]), none)[0])
    assert not len(contradicting_rows(rows, mass, np.array([t[19] - 1e-6, t[20]]), none)[0])


def test_the_work_of_a_smooth_power_is_of_fourth_order():
    errors = []
    for n in (101, 201):
        t = np.linspace(0, 1, n) ** 1.2
        errors.append(abs(work_since_start(t, np.exp(t))[-1] - np.expm1(1.0)))
    assert errors[0] / errors[1] > 7  # the ends have slopes of first order alone


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_the_work_of_a_constant_power_at_few_instants(n):
    t = np.arange(n, dtype=float)
    assert (work_since_start(t, np.full(n, 3.0)) == 3 * t).all()
