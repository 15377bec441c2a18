"""Formulations of the residual: the same motion from all, and what each is known for."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Marker, Model, Revolute

ERRORS = {"SI2": 2e-6, "SI2_exact": 2e-6, "SI1": 2e-6, "I3": 1e-3, "index1": 2e-5}


@pytest.fixture(scope="module")
def scene(examples):
    return stiffmbs.load_scene(examples / "cart_pendulum.yaml")


@pytest.mark.parametrize("formulation", ERRORS)
def test_motion_at_rtol_1e_8(scene, cart_pendulum_reference, formulation):
    solution = stiffmbs.run(scene, formulation=formulation, rtol=1e-8)
    x, theta = cart_pendulum_reference(solution.time)
    assert np.max(np.abs(solution["cart.x"] - x)) < ERRORS[formulation]
    assert np.max(np.abs(solution["bar.angle"] + np.pi / 2 - theta)) < ERRORS[formulation]


def test_index_1_drifts_and_stabilisation_stops_it(scene):
    drift = {b: stiffmbs.run(scene, formulation="index1", stabilisation=b, rtol=1e-6).solver["drift"] for b in (0, 20)}
    exact = stiffmbs.run(scene, formulation="SI2", rtol=1e-6).solver["drift"]
    assert drift[0] > 30 * exact
    assert drift[20] < drift[0] / 5


def test_index_1_drift_grows_with_time(scene):
    short, long = (stiffmbs.run(scene, formulation="index1", rtol=1e-6, duration=d).solver["drift"] for d in (2, 20))
    assert long > 5 * short


def flat_poses(examples, links, duration, **settings):
    """The rms error of the first top joint of N four-bars against the regular branch."""
    from scipy.integrate import solve_ivp

    scene = stiffmbs.load_scene(examples / "four_bars.yaml", [("N", str(links))])
    solution = stiffmbs.run(scene, duration=duration, points=401, **settings)
    pull = -9.81 * ((links + 1) / 2 + links) / ((links + 1) / 3 + links)
    theta = solve_ivp(
        lambda t, y: [y[1], pull * np.cos(y[0])], (0, duration), [np.pi / 2, -1], "DOP853", solution.time,
        rtol=1e-12, atol=1e-12,
    ).y[0]  # fmt: skip
    x = solution["v0.x"] + 0.5 * np.cos(solution["v0.angle"])
    y = solution["v0.y"] + 0.5 * np.sin(solution["v0.angle"])
    return solution, np.sqrt(np.mean((x - np.cos(theta)) ** 2 + (y - np.sin(theta)) ** 2))


def test_relaxed_si2_passes_flat_poses(examples):
    solution, error = flat_poses(examples, 2, 10, rtol=1e-9)
    assert solution.outcome.name == "DONE"
    assert error < 1e-4


@pytest.mark.long
def test_forty_four_bars_pass_their_flat_poses(examples):
    solution, error = flat_poses(examples, 40, 20, rtol=1e-9)
    assert solution.outcome.name == "DONE"
    assert error < 1e-3


def test_an_early_stop_keeps_the_results_and_says_when(examples):
    """Exact SI2 cannot pass a flat pose at a tight tolerance."""
    solution, _ = flat_poses(examples, 2, 10, rtol=1e-11, formulation="SI2_exact")
    assert solution.outcome.name == "STOPPED"
    assert "t = 0.71" in solution.message
    assert 0.7 < solution.time[-1] < 0.72
    assert solution["constraint.position"].max() < 1e-10


def test_relaxation_holds_a_heavy_load_still():
    """A crane's mast of 1e5 kg on a pin and a stop: the creep stays below the tolerance."""
    model = Model(gravity=(0, -9.81))
    model.add("mast", Body(mass=1e5, inertia=1e6, position=(5, 0)))
    model.add("pin", Revolute(i=Marker(body="mast", point=(-5, 0)), j="ground"))
    model.add("stop", stiffmbs.ConstraintEquation(zero="mast.angle"))
    solution = stiffmbs.run(model, duration=100.0, points=11, rtol=1e-8)
    assert np.max(np.abs(solution["mast.y"])) < 1e-9
    np.testing.assert_allclose(solution["pin.fy"], 9.81e5, rtol=1e-10)


@pytest.mark.long
def test_index_3_refuses_forces_that_follow_reactions(examples):
    scene = stiffmbs.load_scene(examples / "stick_slip.yaml")
    with pytest.raises(stiffmbs.InputError, match=r"formulation I3: found forces that depend on reactions \(rubbing\)"):
        stiffmbs.run(scene, solver="bdf", formulation="I3")
    rows = stiffmbs.compare(scene, solvers=("bdf",), formulations=("I3",), tolerances=(1e-3, 1e-4), repeats=1).rows
    assert [row.message[:14] for row in rows] == ["formulation I3"]
