"""Steps along motions with slaved velocities are as long as the motion allows."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.solve.ida.error_norm import ErrorNorm
from tests.stress.families.stiffness.overdamped_nodes import node


def solved(model, rtol, **settings):
    return stiffmbs.run(model, solver="bdf", duration=1.0, points=3, rtol=rtol, **settings)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("mass", "rtol"), [(1e-9, 1e-6), (1e-8, 1e-8)])
def test_a_light_node_in_a_damper_does_not_creep(mass, rtol, monkeypatch):
    filtered = solved(node(mass).model(), rtol)
    monkeypatch.setattr(ErrorNorm, "take_place", lambda self, *arguments: None)
    plain = solved(node(mass, drag=0.010000001).model(), rtol)  # another model: a job's engine is kept
    assert filtered.solver["steps"] < 0.2 * plain.solver["steps"]
    assert filtered.solver["error_test_failures"] < 50
    expected, _ = node(mass).solved(1.0, 1e-9, "Radau")
    assert filtered["m0.y"][-1] == pytest.approx(expected[0][1], abs=10 * rtol)


@pytest.mark.parametrize("rtol", [1e-4, 5e-5])
def test_a_run_that_creeps_comes_off_order_1(examples, rtol):
    scene = stiffmbs.load_scene(examples / "elastic_bearing.yaml")
    counted = stiffmbs.run(scene, solver="bdf", rtol=rtol).solver
    assert counted["steps"] < 4000  # 16 800 and 9100 where each step after a failure is doubled
    assert counted["jacobians"] < 0.5 * counted["residuals"]


def test_the_highest_order_is_the_users_choice(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    runs = {order: solved(scene, 1e-5, max_order=order) for order in (1, 2, 3, 5, None)}
    for order, run in runs.items():
        assert max(run.history.order) == (order or 5)
        np.testing.assert_allclose(run["cart.x"], runs[5]["cart.x"], atol=2e-2)
    assert runs[1].solver["steps"] > runs[2].solver["steps"] > runs[5].solver["steps"]


def test_a_highest_order_that_means_nothing_is_told(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    with pytest.raises(InputError, match="max_order: found 6"):
        stiffmbs.run(scene, max_order=6)
    notes = stiffmbs.run(scene, solver="projected", scheme="dop853", duration=0.1, max_order=2).notes
    assert any("max_order = 2 has no effect" in note for note in notes)
