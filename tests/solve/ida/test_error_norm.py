"""Steps along motions with slaved velocities are as long as the motion allows."""

from types import SimpleNamespace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.solve.ida.error_norm import ErrorNorm
from stiffmbs.solve.ida.native import error_norm
from tests.interpreted import interpreted
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


MOST_FAILURES = 10
"""Failures of the error test in one step after which IDA gives up; it reduces the step to a quarter after most of them."""


def attempts_up_to(jump):
    """Return the number of attempts of a step of length 1 until it ends before a jump whose place is predicted too late."""
    c = SimpleNamespace(
        t=0.0, attempted=np.nan, begun=np.nan, enlarged=1.0, repeated=0, known_failures=0, memory=None,
        ida=SimpleNamespace(internal=0.0), part_before_event=lambda *_: 0.99, norm=lambda *_: 1.0,
        set_largest_part=lambda *_: 0, set_least_part=lambda *_: 0,
    )  # fmt: skip
    h, attempts = 1.0, 0
    with interpreted():
        while h > jump:
            c.time_of = lambda *_, t=h: setattr(c, "t", t)
            error_norm._see_event(c, None, None)
            h *= 0.99 if c.enlarged != 1.0 else 0.25
            attempts += 1
    return attempts


def test_steps_up_to_a_jump_are_not_all_of_its_predicted_place():
    """Repetitions up to an event are at most two in a step, so that IDA's own failures bring the step before a jump."""
    assert attempts_up_to(5e-4) < MOST_FAILURES


@pytest.mark.long
def test_a_car_on_bushings_passes_the_second_edge_of_a_hole(examples):
    """The contact point jumps at the edge, and with it an event function: bdf gave up after ten failures in one step."""
    hole = [[-100, 0], [3, 0], [3.05, -0.06], [3.6, -0.06], [3.65, 0], [100, 0]]
    changes = [
        ("parameters.V", "6 m/s"),
        ("choose.manoeuvre", "step_steer"),
        ("roads.course", f"{{type: table, profile: {{table: {hole}, lines: true}}}}"),
    ]
    scene = stiffmbs.load_scene(examples / "car.yaml", changes=changes)
    loads = [
        stiffmbs.run(scene, solver=solver, rtol=1e-6, duration=0.4, errors=False)["front.left.tyre.fz"]
        for solver in ("bdf", "radau")
    ]
    assert len(loads[0]) == len(loads[1])
    np.testing.assert_allclose(loads[0], loads[1], atol=0.05)
