"""Periods and last cycles of channels."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLES


@pytest.fixture(scope="module")
def run():
    return stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1)


def with_channel(run, time, values):
    return replace(run, time=time, channels={"x": values})


@pytest.mark.parametrize("seed", range(12))
def test_the_period_of_a_sum_of_harmonics_is_that_of_the_first(run, seed):
    rng = np.random.default_rng(seed)
    period, end = rng.uniform(0.3, 1.2), 3.0
    time = np.sort(np.append(rng.uniform(0.0, end, 5000), [0.0, end]))
    angle = 2.0 * np.pi * time / period + rng.uniform(0, 6)
    values = 5.0 + np.sin(angle) + sum(rng.uniform(-1, 1) * np.sin(k * angle + rng.uniform(0, 6)) for k in (2, 3, 5))
    found = stiffmbs.cycle(with_channel(run, time, values), "x")
    assert found.period == pytest.approx(period, rel=2e-3) and found.change < 0.03
    assert time[found.rows[0]] == pytest.approx(end - period, abs=0.02) and found.rows[-1] == len(time) - 1


def test_a_decaying_vibration_has_a_period_and_changes(run):
    time = np.linspace(0.0, 10.0, 2001)
    found = stiffmbs.cycle(with_channel(run, time, np.exp(-0.1 * time) * np.sin(2.0 * np.pi * time)), "x")
    assert found.period == pytest.approx(1.0, rel=2e-3) and 0.03 < found.change < 0.1


@pytest.mark.parametrize(
    "values",
    [
        np.zeros(500),
        np.where(np.arange(500) < 200, np.sin(0.3 * np.arange(500)), 1.0),
        np.linspace(0, 30, 500),
        np.full(500, np.nan),
        np.random.default_rng(1).normal(size=500),
        np.arange(500.0) ** 2,
    ],
)
def test_what_does_not_repeat_has_no_cycle(run, values):
    assert stiffmbs.cycle(with_channel(run, np.linspace(0.0, 1.0, 500), values), "x") is None


def test_the_cycle_of_a_crank_is_its_revolution():
    scene = EXAMPLES / "elastic_bearing.yaml"
    solution = stiffmbs.run(scene, rtol=1e-6, duration=0.1)
    found, angle = stiffmbs.cycle(solution, "shaft.fy"), stiffmbs.driving_angle(scene, solution)
    assert found.period == pytest.approx(0.02, rel=1e-4) and len(found.rows) == pytest.approx(len(angle.rows), abs=1)


def test_two_revolutions_are_enough():
    solution = stiffmbs.run(EXAMPLES / "elastic_bearing.yaml", rtol=1e-6)
    assert stiffmbs.cycle(solution, "shaft.fy").period == pytest.approx(0.02, rel=1e-3)


def test_the_last_cycle_is_that_of_the_known_values(run):
    time = np.linspace(0.0, 5.0, 501)
    values = np.where((time < 4.0) & (time != time[350]), np.sin(2.0 * np.pi * time), np.nan)
    found = stiffmbs.cycle(with_channel(run, time, values), "x")
    assert np.isfinite(values[found.rows]).all()
    assert time[found.rows[[0, -1]]] == pytest.approx([2.99, 3.99], abs=0.011)


def test_an_unknown_channel_is_named(run):
    with pytest.raises(stiffmbs.InputError, match=r"hinge\.fq"):
        stiffmbs.cycle(run, "hinge.fq")
