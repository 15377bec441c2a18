"""Orders 3 to 5 are given up where they creep along a vibration below the tolerance, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Bushing, Model
from stiffmbs.analyses.job import prepare
from stiffmbs.solve.bdf import bdf_integrator
from stiffmbs.solve.error_control import stability_limit
from stiffmbs.solve.ida.native.parameters import LOOP
from stiffmbs.solve.trajectory import Grid
from stiffmbs.tuning import parameters_of


def rod_on_bushing(stiffness):
    """A pendulum of 1 m and 1 kg whose pin is an undamped bushing, let go from 60 degrees in an unloaded bushing."""
    model = Model(gravity=(0, -9.81))
    angle = -np.pi / 6
    centre = (0.5 * np.cos(angle), 0.5 * np.sin(angle))
    rod = model.add("rod", Body(mass=1, inertia=1 / 12, position=centre, angle=angle))
    model.add("pin", Bushing(i=rod.at(-0.5, 0), j="ground", stiffness=[stiffness, stiffness, 0], damping=[0, 0, 0]))
    return model


def check_first_after(monkeypatch, steps):
    """The first check comes after that many steps."""
    changed = replace(parameters_of(stability_limit.STABILITY_LIMIT), interval=steps)
    monkeypatch.setattr(stability_limit, "STABILITY_LIMIT", changed)


def solved(model, **settings):
    return stiffmbs.run(model, solver="bdf", duration=0.3, points=101, **settings)


@pytest.mark.parametrize(("stiffness", "rtol"), [(1e9, 1e-5), (1e10, 1e-6)])
def test_a_vibration_below_the_tolerance_is_not_followed(stiffness, rtol, monkeypatch):
    mended = solved(rod_on_bushing(stiffness), rtol=rtol)
    check_first_after(monkeypatch, 10**9)
    creeping = solved(rod_on_bushing(stiffness), rtol=rtol)
    assert mended.solver["steps"] < 0.7 * creeping.solver["steps"]
    assert any("order of BDF was limited to 2" in note and "steps" in note for note in mended.notes)
    np.testing.assert_allclose(mended["rod.angle"], creeping["rod.angle"], atol=100 * rtol)


@pytest.mark.long
def test_a_faint_vibration_is_damped_away_and_the_order_free_again(examples, monkeypatch):
    """Rounding decides when it is seen, so the median of tolerances that are nearly the same counts."""
    scene, tolerances = stiffmbs.load_scene(examples / "half_car.yaml"), np.linspace(0.9e-7, 1.1e-7, 21)
    mended = [stiffmbs.run(scene, solver="bdf", rtol=float(rtol)) for rtol in tolerances]
    check_first_after(monkeypatch, 10**9)
    creeping = [stiffmbs.run(scene, solver="bdf", rtol=float(rtol)) for rtol in tolerances]
    ratios = [ours.solver["steps"] / other.solver["steps"] for ours, other in zip(mended, creeping, strict=True)]
    assert np.median(ratios) < 0.93
    for ours, other in zip(mended, creeping, strict=True):
        assert ours.notes == ()
        np.testing.assert_allclose(ours["chassis.y"], other["chassis.y"], atol=2e-6)


def test_a_pendulum_on_a_stiff_undamped_bushing_swings_as_on_a_pin():
    """By its energy: omega^2 = 3 g/l (sin 30 deg + sin of the angle below the horizontal)."""
    solution = solved(rod_on_bushing(1e9), rtol=1e-6)
    fallen = np.sin(solution["rod.angle"][0]) - np.sin(solution["rod.angle"])
    np.testing.assert_allclose(np.abs(solution["rod.omega"]), np.sqrt(3 * 9.81 * fallen), atol=1e-3)


@pytest.mark.parametrize("name", ["cart_pendulum", "chain", "andrews"])
def test_scenes_without_such_a_vibration_are_solved_as_before(examples, name, monkeypatch):
    scene = stiffmbs.load_scene(examples / f"{name}.yaml")
    check_first_after(monkeypatch, 100)
    watched = stiffmbs.run(scene, solver="bdf", rtol=1e-7)
    check_first_after(monkeypatch, 10**9)
    unwatched = stiffmbs.run(scene, solver="bdf", rtol=1e-7)
    assert watched.solver["steps"] == unwatched.solver["steps"]
    assert watched.notes == unwatched.notes


def test_states_are_compared_with_the_cubics_of_least_squares():
    random, n = np.random.default_rng(2), 5
    t = 3.0 + np.cumsum(0.5 + random.random(LOOP.samples))
    rows = np.vander(t - 9.0, 4) @ random.normal(size=(4, n)) + 1e-4 * random.normal(size=(len(t), n))
    atol = 1e-6 * (1.0 + random.random(n))
    x, scale = (2 * t - t[0] - t[-1]) / (t[-1] - t[0]), 1e-5 * np.abs(rows[-1]) + atol
    best = np.polyfit(x, rows, 3)
    off = (rows - np.vander(x, 4) @ best) / scale
    expected = np.sqrt((off**2).mean(axis=1).max()), np.sqrt(((best[0] / scale) ** 2).mean())
    fit = stability_limit.cubic_fit(np.column_stack([t, rows]), 1e-5, atol)
    np.testing.assert_allclose((fit.distance, fit.third), expected, rtol=1e-7)


def test_ida_is_not_started_where_it_is_to_stop(monkeypatch):
    """It refuses to: an order that is to change there waits for the next start."""
    job = prepare(rod_on_bushing(1e4), duration=0.1, solver="bdf")
    integrator = bdf_integrator(job.dynamics, job.settings)
    for _ in integrator.run(job.start, Grid(0.0, 0.1, np.array([0.1]))):
        pass
    engine, starts = integrator.engine, []
    monkeypatch.setattr(engine, "_resume", lambda *given: starts.append(given))
    monkeypatch.setattr(stability_limit.StabilityLimitDetection, "due", lambda *_: True)
    monkeypatch.setattr(stability_limit.StabilityLimitDetection, "changed", lambda *_: True)
    engine._adapt(0.1)
    assert not starts
    engine._adapt(0.2)
    assert len(starts) == 1


def test_steps_that_max_step_limits_keep_their_order(examples):
    """They are as close to a cubic as rounding allows; steps of order 2 would move the cart by 5e-4 m."""
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    limited, exact = (
        stiffmbs.run(scene, solver="bdf", duration=2.0, points=21, **how)
        for how in ({"rtol": 1e-6, "max_step": 1e-4}, {"rtol": 1e-11})
    )
    assert limited.solver["steps"] < 20_100
    np.testing.assert_allclose(limited["cart.x"], exact["cart.x"], atol=1e-6)
