"""Newton's iteration in a step: a rate of convergence is not believed for longer than it holds."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.solve.bdf import solve
from stiffmbs.solve.error_control.error_test import ErrorControl
from tests.stress.fuzzers import fmu

IDAS_OWN, DOUBTFUL = ErrorControl(predicted_residual=False), ErrorControl(predicted_residual=True)


def ends(scene, rtol, *controls, duration):
    """Coordinates at the end, and counters, under each control."""
    job = prepare(scene, solver="bdf", presolve=False, duration=duration, points=3, rtol=rtol)
    runs = [solve(job.dynamics, job.start, job.grid, job.settings, lambda t: None, control) for control in controls]
    return [(run.q[-1], run.statistics) for run in runs]


@pytest.mark.parametrize(("name", "duration", "rtol"), [("governor", 2.0, 1e-7), ("bricard", 3.0, 1e-8)])
def test_turning_bodies_take_fewer_steps_to_a_smaller_error(examples, name, duration, rtol):
    """Bodies in space turn away from the iteration matrix in long stretches of equal steps."""
    scene = stiffmbs.load_scene(examples / f"{name}.yaml")
    ((exact, _),) = ends(scene, 1e-11, DOUBTFUL, duration=duration)
    (found, counted), (idas, before) = ends(scene, rtol, DOUBTFUL, IDAS_OWN, duration=duration)
    assert np.max(np.abs(found - exact)) < np.max(np.abs(idas - exact))
    assert counted["steps"] < 0.6 * before["steps"]
    assert counted["error_test_failures"] < 5


def test_a_slow_matrix_is_made_anew(examples):
    """Before the iteration fails, and without a cut of the step."""
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    ((_, counted),) = ends(scene, 1e-6, DOUBTFUL, duration=10.0)
    assert counted["newton_failures"] > 10
    assert counted["convergence_failures"] == 0


def test_steps_of_a_linear_scene_stay_what_they_were(examples):
    """Where the iteration matrix depends on cj alone an old one is as good as a new one."""
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e5")])
    (_, counted), (_, before) = ends(scene, 1e-6, DOUBTFUL, IDAS_OWN, duration=1.0)
    assert counted["steps"] == pytest.approx(before["steps"], rel=0.02)
    assert counted["residuals"] < 1.1 * before["residuals"]


@pytest.mark.long
def test_reactions_that_vanish_under_friction_do_not_stall_the_steps():
    """The moment in a slider with friction changes its sign: reactions went back and forth between the two signs from step to step."""
    content = fmu._scene(np.random.default_rng(1000474))
    content["parameters"][fmu.GAIN] = 0.9455251332885011
    inputs = 0.014703376842906568, 1.9601075123737801, 0.8376444829185199
    scene = stiffmbs.read_scene(json.dumps(content))
    simulated = stiffmbs.simulation(scene, rtol=1e-8, solver="bdf")
    for k in range(fmu.STEPS):
        simulated.step(scene.run.duration / fmu.STEPS, {fmu.GIVEN: inputs[np.searchsorted((6, 13), k, "right")]})
    assert simulated._stepper._engine.steps() < 5000
