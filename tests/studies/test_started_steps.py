"""Simulations whose inputs jump at every step: compiled starts of the integrator."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import simulation
from stiffmbs.solve.ida.starts import Starts
from stiffmbs.studies.stepping import STEPPING, ImplicitSteps, StartedSteps

TOP = """
parameters: {M: 0 N m}
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {top: {mass: 2, inertia: [0.02, 0.02, 0.01], position: [0, 0.1, 0.2], omega: [0, 0, 30], velocity: [-3, 0, 0], markers: {tip: {point: [0, -0.1, -0.2]}}}}
joints: {ball: {type: spherical, i: top.tip, j: ground}}
forces: {twist: {type: torque, i: top, torque: [M, 0, "0.1*sin(3*t)"]}}
run: {duration: 1, rtol: 1e-8}
"""
CART = "forces.spring.stiffness"
CASES = {
    "in the plane, with a coordinate less": ("cart_pendulum.yaml", CART, lambda k: 270.0 + 40.0 * np.sin(k), {}),
    "without presolve": ("cart_pendulum.yaml", CART, lambda k: 200.0 + 9.0 * k, {"presolve": False}),
    "integrated multipliers": ("cart_pendulum.yaml", CART, lambda k: 200.0 + 9.0 * k, {"formulation": "SI1"}),
    "a road with corners": ("half_car.yaml", "forces.front_bushing.stiffness.0", lambda k: 1e5 * (1 + k % 3), {}),
    "in space, with a torque over time": (TOP, "M", lambda k: 0.3 * (-1) ** k, {}),
}


def stepped(scene, name, value, settings, steps=40):
    """States after each step; what the integrator was started with may be looked at afterwards."""
    sim = simulation(scene, inputs={name: float(value(0))}, rtol=1e-8, **settings)
    states = []
    for k in range(steps):
        sim.step(0.02, inputs={name: float(value(k))})
        states.append(np.concatenate([sim.q, sim.u]))
    return np.array(states)


@pytest.mark.parametrize("case", CASES)
def test_compiled_starts_give_the_states_of_starts_by_python(case, examples, monkeypatch):
    source, name, value, settings = CASES[case]
    scene = stiffmbs.read_scene(source) if "\n" in source else stiffmbs.load_scene(examples / source)
    done, advance = [], Starts.advance

    def counted(*arguments):
        done.append(advance(*arguments))
        return done[-1]

    monkeypatch.setattr(Starts, "advance", counted)
    found = stepped(scene, name, value, settings)
    assert sum(done) > 25, "starts that were compiled"
    monkeypatch.setattr(Starts, "advance", lambda *arguments: False)
    expected = stepped(scene, name, value, settings)  # by other first steps
    np.testing.assert_allclose(found, expected, atol=5e-8 * max(1.0, np.abs(found).max()), rtol=0)


@pytest.mark.long
def test_a_controlled_cart_is_where_its_minimal_equations_have_it():
    """As right as one run at the same tolerance, for all its starts."""
    from tests.bench.problems.stepping import SCENE, control, reference

    sim, places = simulation(stiffmbs.read_scene(SCENE), inputs={"F": 0.0}), []
    for _ in range(500):
        sim.step(1e-3, inputs={"F": control(sim["cart.x"], sim["cart.vx"])})
        places.append(sim["cart.x"])
    np.testing.assert_allclose(places, reference(1e-3, 500), rtol=0, atol=1e-8)


ARM = """
gravity: [0, -9.81]
parameters: {M: 0 N m}
bodies:
  upper: {mass: 2, inertia: 0.05, position: [0, -0.3], markers: {top: {point: [0, 0.3]}, end: {point: [0, -0.3]}}}
  lower: {mass: 1, inertia: 0.02, position: [0.3, -0.6], markers: {top: {point: [-0.3, 0]}}}
joints: {shoulder: {type: revolute, i: upper.top, j: ground}, elbow: {type: revolute, i: lower.top, j: upper.end}}
forces: {motor: {type: torque, i: lower, j: upper, torque: M}, friction: {type: torque, i: upper, torque: -0.5*upper.omega}}
run: {rtol: 1e-6}
"""


def evaluations(sim):
    """Return the residuals and Jacobians of the last start."""
    counted = sim._stepper._started._engine.ida.counters.counted()
    return counted["residuals"] + counted["jacobians"]


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_step_with_a_new_input_costs_at_most_25_evaluations(solver):
    """Its first step is as long as the last one, of full order; a start of bdf takes 76 evaluations."""
    sim, spent = simulation(stiffmbs.read_scene(ARM), inputs={"M": 0.0}, solver=solver), []
    for k in range(30):
        sim.step(1e-3, inputs={"M": 2.0 * np.sin(k + 1.0)})
        spent.append(evaluations(sim))
    assert max(spent[1:]) <= 25 and np.mean(spent[1:]) < 12


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_the_solver_of_the_run_starts_after_some_steps_with_the_same_inputs(solver, monkeypatch):
    """Before, each pair of a new and an old input cost a start of the solver."""
    begun, started = [], []

    def begin(self, start, t, own=ImplicitSteps._begin):
        begun.append(t)
        own(self, start, t)

    def advance(self, t, end, features, own=StartedSteps.advance):
        started.append(t)
        own(self, t, end, features)

    monkeypatch.setattr(ImplicitSteps, "_begin", begin)
    monkeypatch.setattr(StartedSteps, "advance", advance)
    sim = simulation(stiffmbs.read_scene(ARM), inputs={"M": 0.0}, solver=solver)
    for k in range(20):
        sim.step(1e-3, inputs={"M": float(k // 5)})
    assert len(begun) == 1 and len(started) == 15, "steps with equal inputs start no solver, the first five no method"
    for _ in range(30):
        sim.step(1e-3)
    most = STEPPING.unchanged
    assert len(begun) == 2 and len(started) == 15 + most - 5
    expected = simulation(stiffmbs.read_scene(ARM), inputs={"M": 0.0}, solver="projected", scheme="dop853", rtol=1e-11)
    for k in range(50):
        expected.step(1e-3, inputs={"M": float(min(k, 19) // 5)})
    np.testing.assert_allclose(sim.joint_coordinates, expected.joint_coordinates, atol=1e-5)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_more_or_fewer_such_steps_move_the_start(factor, monkeypatch):
    started, unchanged = [], int(factor * STEPPING.unchanged)

    def advance(self, t, end, features, own=StartedSteps.advance):
        started.append(t)
        own(self, t, end, features)

    monkeypatch.setattr(StartedSteps, "advance", advance)
    sim = simulation(stiffmbs.read_scene(ARM), inputs={"M": 0.0}, tuning={"stepping": {"unchanged": unchanged}})
    for _ in range(20):
        sim.step(1e-3, inputs={"M": 1.0})
    assert len(started) == unchanged


def test_states_are_not_overwritten_by_later_steps(examples):
    sim = simulation(examples / "cart_pendulum.yaml", inputs={CART: 270.0})
    sim.step(0.1, inputs={CART: 200.0})
    q, u = sim.q, sim.u
    sim.step(0.1, inputs={CART: 300.0})
    assert not np.any(q[:1] == sim.q[:1]) and not np.any(u[:1] == sim.u[:1])


def test_a_step_shorter_than_the_rounding_of_time_changes_nothing(examples):
    sim = simulation(examples / "cart_pendulum.yaml", inputs={CART: 270.0})
    sim.step(1.0)
    before = sim.q
    sim.step(1e-18, inputs={CART: 100.0})
    np.testing.assert_array_equal(sim.q, before)
    sim.step(0.01)
    assert sim["cart.x"] != before[0]
