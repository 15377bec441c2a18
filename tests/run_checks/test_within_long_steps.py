"""What begins and ends within a long step is found without an output instant there, and the run is taken again."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.run_checks import overlooked as within_long_steps
from stiffmbs.run_checks.overlooked import overlooked_in_long_steps
from stiffmbs.solve.events.long_steps import LONG_STEP, WHOLE, LongSteps
from stiffmbs.tuning import parameters_of

SOLVERS = (
    {"solver": "bdf"},
    {"solver": "projected", "scheme": "dopri5"},
    {"solver": "projected", "scheme": "dop853"},
    {"solver": "auto"},
)
HEIGHT = 1e4


def ball(width: float, places: tuple[float, ...] = (5.0031,)) -> stiffmbs.Model:
    """A ball of 1 kg at 10 m/s, pushed by a Python function that is narrow Gaussians of its place."""

    def push(x):
        return HEIGHT * sum(np.exp(-(((x[0] - place) / width) ** 2)) for place in places), 0, 0

    model = stiffmbs.Model("Ball", gravity=(0, 0))
    model.add("ball", stiffmbs.Body(mass=1, inertia=1, velocity=(10, 0)))
    model.add("push", stiffmbs.PythonForce(i="ball", of=("ball.x",), function=push))
    return model


def behind(width: float, count: int = 1) -> float:
    """The speed behind the Gaussians: their work is HEIGHT * width * sqrt(pi) each."""
    return float(np.sqrt(100 + 2 * HEIGHT * width * np.sqrt(np.pi) * count))


def told(solution):
    return [note for note in solution.notes if "missed" in note]


@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
def test_a_python_function_that_no_output_meets(how, monkeypatch):
    few = replace(parameters_of(within_long_steps.RUN_CHECKS), parts_of_a_run=1000)
    monkeypatch.setattr(within_long_steps, "RUN_CHECKS", few)
    found = stiffmbs.run(ball(5e-3), duration=1.0, points=2, rtol=1e-6, **how)
    (note,) = told(found)
    assert "missed 'push' at t = " in note and "repeated" in note
    assert found["ball.vx"][-1] == pytest.approx(behind(5e-3), abs=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
@pytest.mark.parametrize("width", [1e-4, 3e-4, 1e-3, 3e-3, 1e-2])
@pytest.mark.sampled(7)
def test_narrow_python_functions_on_every_solver(width, how):
    for places in ((0.777,), (5.0031,), (3.777, 9.66)):
        found = stiffmbs.run(ball(width, places), duration=1.0, points=2, rtol=1e-6, **how)
        assert told(found)
        assert found["ball.vx"][-1] == pytest.approx(behind(width, len(places)), abs=2e-3)


def test_a_function_without_narrow_features_is_left_alone():
    model = ball(1.0)
    assert not told(stiffmbs.run(model, duration=1.0, points=2))


def test_motion_within_steps_is_that_of_their_polynomial():
    part = np.array([0.1, 0.5, 0.93])
    t = 2.0 + 0.5 * WHOLE
    u = np.stack([t**5, 3 * t], axis=1)[None]
    motion = LongSteps(None, np.array([2.0]), np.array([2.5]), u, u).at(np.zeros(3, dtype=int), part)
    assert motion.t == pytest.approx(2.0 + 0.5 * part)
    assert motion.u[:, 0] == pytest.approx(motion.t**5)
    assert motion.rate == pytest.approx(np.stack([5 * motion.t**4, np.full(3, 3.0)], axis=1))


@pytest.mark.parametrize("place", [5.0, 8.0, 3.0])
def test_the_middle_of_a_long_step_is_judged(place):
    """Steps that go straight from x = 4 to 6 m and from 7 to 9 m at 10 m/s, beside a formula's Gaussian."""
    model = stiffmbs.Model("Ball", gravity=(0, 0))
    model.add("ball", stiffmbs.Body(mass=1, inertia=1, velocity=(10, 0)))
    model.add("push", stiffmbs.AppliedForce(i="ball", force=(f"{HEIGHT}*exp(-((ball.x - {place})/0.01)^2)", 0)))
    job = prepare(model, duration=1.0, rtol=1e-6)
    begin, end = np.array([0.4, 0.7]), np.array([0.6, 0.9])
    middle = np.array([0.5 - LONG_STEP.from_middle, 0.5 + LONG_STEP.from_middle])
    t = begin[:, None] + middle * (end - begin)[:, None]
    q, u = np.zeros((2, 2, 3)), np.zeros((2, 2, 3))
    q[..., 0], u[..., 0] = 10 * t, 10.0
    found = overlooked_in_long_steps(LongSteps(job.dynamics, begin, end, q, u), job.settings, 1.0)
    if place == 3.0:
        assert found is None
    else:
        assert (found.times, found.element, found.velocity) == (pytest.approx([place / 10]), "push", "ball.vx")
        assert found.step == pytest.approx(0.2)
