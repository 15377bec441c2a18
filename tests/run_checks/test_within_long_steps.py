"""What begins and ends within a long step is found without an output instant there, and the run is taken again."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.run_checks import overlooked as within_long_steps
from stiffmbs.solve.events import whole_steps
from stiffmbs.solve.events.whole_steps import WHOLE, WholeSteps
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


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
def test_a_python_function_that_no_output_meets(how, monkeypatch):
    few = replace(parameters_of(within_long_steps.RUN_CHECKS), parts_of_a_run=1000)
    monkeypatch.setattr(within_long_steps, "RUN_CHECKS", few)
    found = stiffmbs.run(ball(5e-3), duration=1.0, points=2, rtol=1e-6, **how)
    (note,) = told(found)
    assert "missed 'push' at t = " in note and "repeated" in note
    assert found["ball.vx"][-1] == pytest.approx(behind(5e-3), abs=2e-3)


@pytest.mark.long(40)
@pytest.mark.parametrize("how", SOLVERS, ids=lambda how: how.get("scheme", how["solver"]))
@pytest.mark.parametrize("width", [1e-4, 3e-4, 1e-3, 3e-3, 1e-2])
@pytest.mark.parametrize("places", [(0.777,), (5.0031,), (3.777, 9.66)])
@pytest.mark.sampled(62)
def test_narrow_python_functions_on_every_solver(places, width, how):
    found = stiffmbs.run(ball(width, places), duration=1.0, points=2, rtol=1e-6, **how)
    assert told(found)
    assert found["ball.vx"][-1] == pytest.approx(behind(width, len(places)), abs=2e-3)


@pytest.mark.long
def test_a_function_without_narrow_features_is_left_alone():
    model = ball(1.0)
    assert not told(stiffmbs.run(model, duration=1.0, points=2))


@pytest.mark.parametrize("how", [{"solver": "bdf"}, {"solver": "radau"}], ids=lambda how: how["solver"])
def test_a_function_that_output_instants_alone_meet(how):
    """The repeated run had max_step inf, which was refused; no sample between outputs meets its force."""
    found = stiffmbs.run(ball(1e-5, (5.0,)), duration=1.0, points=41, rtol=1e-4, errors=False, **how)
    assert "missed 'push' at t = 0.5 s" in told(found)[0] and "repeated with a restart" in told(found)[0]
    assert found["ball.vx"][-1] == pytest.approx(behind(1e-5), abs=2e-3)


@pytest.mark.parametrize("stiffness", [50, 90])
def test_half_a_period_within_a_step_is_not_missed(stiffness):
    """The mean of two accelerations is not the mean rate there, so that runs were repeated with a restart."""
    model = stiffmbs.Model(gravity=(0, 0))
    q, u = -0.004961717094919651, 0.3500491410465814
    model.add("b", stiffmbs.Body(mass=2, inertia=1, position=(q, 0), velocity=(u, 0)))
    model.add("r", stiffmbs.Prismatic(i="b", j="ground"))
    law = f"-{stiffness}*b.x - 0.4*b.vx + 3.0*sin(3.3*t)"
    model.add("s", stiffmbs.AppliedForce(i="b", force=(law, 0)))
    found = stiffmbs.run(model, duration=1000, points=2001, solver="radau", rtol=1e-6, errors=False)
    assert not told(found)


def test_motion_within_steps_is_that_of_their_polynomial():
    part = np.array([0.1, 0.5, 0.93])
    t = 2.0 + 0.5 * WHOLE
    u = np.stack([t**5, 3 * t], axis=1)[None]
    motion = WholeSteps(None, np.array([2.0]), np.array([2.5]), u, u).at(np.zeros(3, dtype=int), part)
    assert motion.t == pytest.approx(2.0 + 0.5 * part)
    assert motion.u[:, 0] == pytest.approx(motion.t**5)
    assert motion.rate == pytest.approx(np.stack([5 * motion.t**4, np.full(3, 3.0)], axis=1))


@pytest.mark.parametrize(("width", "place"), [(0.02, -0.77), (0.01, 0.31)])
def test_a_passage_beside_a_body_with_larger_accelerations(width, place):
    """The other body's accelerations, up to 77 m/s^2, hid a passage of 5 m/s^2; a spring was blamed for others."""

    def push(x):
        return 0.1 / width * np.exp(-(((x[0] - place) / width) ** 2) / 2), 0, 0

    model = stiffmbs.Model(gravity=(0, 0))
    model.add("q", stiffmbs.Body(mass=1, inertia=1, velocity=(10, 0)))
    model.add("b", stiffmbs.Body(mass=1, inertia=1, position=(0, 1)))
    model.add("spring", stiffmbs.AppliedForce(i="q", force=("-100*q.x", 0)))
    model.add("push", stiffmbs.PythonForce(i="b", of=("q.x",), function=push))
    found = stiffmbs.run(model, duration=2, solver="radau", rtol=1e-6, errors=False)
    t = np.linspace(0, 2, 200_001)
    assert found["b.vx"][-1] == pytest.approx(np.trapezoid(push([np.sin(10 * t)])[0], t), rel=1e-3)
    assert all("missed 'push'" in note for note in told(found))  # none where a step has met it


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_steps_beyond_those_that_are_stored_are_told(solver, monkeypatch):
    monkeypatch.setattr(
        whole_steps, "LOOP", replace(parameters_of(whole_steps.LOOP), most_items=100 if solver == "projected" else 1000)
    )
    found = stiffmbs.run(ball(1.0), duration=1.0, points=2, solver=solver)
    (note,) = [note for note in found.notes if "were checked for features" in note]
    assert "those after t = " in note


def damped(mass: float, damping: float) -> stiffmbs.Scene:
    """A light body in a strong damper, which a spring pulls to and fro."""
    return stiffmbs.read_scene(f"""
        gravity: [0, 0]
        bodies: {{b: {{mass: {mass}, inertia: 1}}}}
        joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
        forces:
          spring: {{type: force, i: b, force: ["1e4*(0.1*sin(3*t) - b.x)", 0]}}
          damper: {{type: force, i: b, force: ["-{damping}*b.vx - 2e3*b.x^3", 0]}}
    """)


@pytest.mark.parametrize(
    ("mass", "how"), [(1e-3, {"solver": "radau", "rtol": 1e-8}), (1e-6, {"solver": "bdf", "rtol": 1e-4})]
)
def test_errors_in_a_strong_damper_are_no_missed_event(mass, how):
    """Errors of velocities of a few tolerances are accelerations of 1e6 of them per second: a note listed 35 missed events."""
    assert not told(stiffmbs.run(damped(mass, 1e3), duration=5.0, points=317, errors=False, **how))
