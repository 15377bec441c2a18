"""States of the user's own beside the motion: against closed forms and SciPy, by every solver and formulation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import AppliedForce, Body, Drive, Marker, Model, Prismatic, Revolute, State
from stiffmbs.analyses.job import prepare

STIFFNESS, DELAY = 100.0, 0.1
SOLVERS = [
    {"solver": "bdf"},
    *({"solver": "bdf", "formulation": name} for name in ("SI2_exact", "SI1", "I3", "index1")),
    {"solver": "projected"},
    {"solver": "projected", "scheme": "dopri5"},
    {"solver": "projected", "scheme": "rk4", "step": 1e-3},
    {"solver": "auto"},
]


def reference(rates, start, t, **options):
    """The solution of a differential equation to 1e-12, by SciPy."""
    found = solve_ivp(rates, (t[0], t[-1]), start, t_eval=t, rtol=1e-12, atol=1e-14, **options)
    assert found.success
    return found.y


def delayed_spring():
    model = Model("delayed spring")
    model.add("cart", Body(mass=1, inertia=1, position=(0.1, 0)))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("delayed", State(rate=f"(cart.x - delayed)/{DELAY}", start="0 m"))
    model.add("push", AppliedForce(i="cart", force=(f"-{STIFFNESS}*delayed", 0)))
    model.request("twice", "2*delayed")
    return model


@pytest.mark.parametrize("settings", SOLVERS, ids=lambda settings: "-".join(map(str, settings.values())))
def test_a_delayed_spring_moves_as_scipy_says(settings):
    solution = stiffmbs.run(delayed_spring(), duration=1.0, points=11, rtol=1e-9, **settings)
    x, _, delayed = reference(
        lambda t, y: [y[1], -STIFFNESS * y[2], (y[0] - y[2]) / DELAY], [0.1, 0.0, 0.0], solution.time, method="DOP853"
    )
    assert solution["cart.x"] == pytest.approx(x, abs=1e-7)
    assert solution["delayed"] == pytest.approx(delayed, abs=1e-7)
    assert solution["delayed.rate"] == pytest.approx((x - delayed) / DELAY, abs=1e-6)
    assert solution["twice"] == pytest.approx(2 * solution["delayed"], abs=1e-15)


def test_a_tolerance_is_met_in_the_state_too():
    model = delayed_spring()
    fine = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-11)
    for rtol in (1e-4, 1e-6, 1e-8):
        for solver in ("bdf", "projected"):
            found = stiffmbs.run(model, duration=1.0, points=11, rtol=rtol, solver=solver)
            assert np.abs(found["delayed"] - fine["delayed"]).max() < 20 * rtol


def test_the_same_scene_in_space_and_read_again_gives_the_same():
    model = delayed_spring()
    planar = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-9)
    again = stiffmbs.run(stiffmbs.read_scene(model.to_scene()), duration=1.0, points=11, rtol=1e-9)
    in_space = stiffmbs.run(stiffmbs.spatial.in_space(model), duration=1.0, points=11, rtol=1e-9)
    assert again["delayed"] == pytest.approx(planar["delayed"], abs=1e-14)
    assert in_space["delayed"] == pytest.approx(planar["delayed"], abs=1e-8)


def pendulum_and(**states):
    model = Model("beside a pendulum", gravity=(0, -9.81))
    model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground"))
    for name, state in states.items():
        model.add(name, state)
    return model


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
def test_a_van_der_pol_circuit_swings_beside_a_pendulum(solver):
    model = pendulum_and(x=State(rate="y", start=2), y=State(rate="5*(1 - x^2)*y - x", start=0))
    solution = stiffmbs.run(model, duration=20.0, points=21, rtol=1e-10, solver=solver)
    alone = stiffmbs.run(pendulum_and(), duration=20.0, points=21, rtol=1e-10, solver=solver)
    x, y = reference(lambda t, z: [z[1], 5 * (1 - z[0] ** 2) * z[1] - z[0]], [2, 0], solution.time, method="DOP853")
    assert solution["x"] == pytest.approx(x, abs=1e-7)
    assert solution["y"] == pytest.approx(y, abs=1e-6)
    assert solution["bar.angle"] == pytest.approx(alone["bar.angle"], abs=1e-6)


@pytest.mark.parametrize("solver", ["bdf", pytest.param("auto", marks=pytest.mark.long)])
def test_a_stiff_van_der_pol_circuit_is_solved(solver):
    """x at the end: Mazzia and Magherini, Test Set for Initial Value Problem Solvers, problem VDPOL."""
    model = Model("a body at rest")
    model.add("box", Body(mass=1, inertia=1))
    model.add("x", State(rate="y", start=2))
    model.add("y", State(rate="1000*(1 - x^2)*y - x", start=0))
    solution = stiffmbs.run(model, duration=2000.0, points=21, rtol=1e-10, solver=solver)
    assert solution["x"][-1] == pytest.approx(1.706167732170469, abs=1e-6)


def test_robertsons_reaction_keeps_its_mass_and_its_published_end():
    """y at t = 40 s: Hairer and Wanner, Solving Ordinary Differential Equations II, ch. IV.1; digits by Radau at 1e-13."""
    model = Model("a body at rest")
    model.add("box", Body(mass=1, inertia=1))
    model.add("a", State(rate="-0.04*a + 1e4*b*c", start=1))
    model.add("b", State(rate="0.04*a - 1e4*b*c - 3e7*b^2", start=0, scale=1e-5))
    model.add("c", State(rate="3e7*b^2", start=0))
    solution = stiffmbs.run(model, duration=40.0, points=11, rtol=1e-9, solver="bdf")
    assert solution["a"][-1] == pytest.approx(0.7158270687, abs=1e-8)
    assert solution["b"][-1] == pytest.approx(9.185534764e-6, rel=1e-7)
    assert solution["a"] + solution["b"] + solution["c"] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["kinematic", "bdf", "projected"])
def test_a_lag_follows_a_prescribed_motion(solver):
    model = Model("crank")
    model.add("crank", Body(mass=1, inertia=1))
    model.add("pin", Revolute(i="crank", j="ground"))
    model.add("motor", Drive(joint="pin", position="2*t"))
    model.add("lag", State(rate="(sin(crank.angle) - lag)/0.2", start=0))
    solution = stiffmbs.run(model, duration=3.0, points=31, solver=solver, rtol=1e-9)
    t, w, tau = solution.time, 2.0, 0.2
    lag = (np.sin(w * t) - w * tau * np.cos(w * t) + w * tau * np.exp(-t / tau)) / (1 + (w * tau) ** 2)
    assert solution["lag"] == pytest.approx(lag, abs=1e-7 if solver != "kinematic" else 1e-9)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_tyre_builds_its_side_force_over_its_relaxation_length(solver):
    """sigma alpha' + |v| alpha = v_y: at constant speed the slip comes to v_y/v by exp(-v t/sigma) (Pacejka, ch. 5)."""
    model = Model("towed wheel")
    model.add("wheel", Body(mass=10, inertia=1, velocity=(20, 1)))
    model.add("slip", State(rate="(wheel.vy - abs(wheel.vx)*slip)/0.5", start=0))
    model.add("side", AppliedForce(i="wheel", force=(0, "-40*slip")))
    solution = stiffmbs.run(model, duration=0.2, points=21, rtol=1e-10, solver=solver)
    matrix = np.array([[0, -40 / 10], [1 / 0.5, -20 / 0.5]])  # of v_y and the slip
    values, vectors = np.linalg.eig(matrix)
    parts = np.linalg.solve(vectors, [1.0, 0.0])
    vy, slip = (vectors * parts) @ np.exp(np.outer(values, solution.time))
    assert solution["slip"] == pytest.approx(slip, abs=1e-9)
    assert solution["wheel.vy"] == pytest.approx(vy, abs=1e-9)


def test_mechanisms_are_solved_together_where_a_state_couples_them():
    model = Model("two carts")
    for k, name in enumerate(("left", "right")):
        model.add(name, Body(mass=1, inertia=1, position=(0.1 + k, 0)))
        model.add(f"{name}_rail", Prismatic(i=name, j="ground"))
    model.add("seen", State(rate="(right.x - 1 - seen)/0.1", start=0.2))
    model.add("push", AppliedForce(i="left", force=("50*seen - 20*left.vx", 0)))
    model.add("pull", AppliedForce(i="right", force=("9*(1 - right.x)", 0)))
    model.add("alone", State(rate="-alone", start=1))
    solution = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-10)
    rates = lambda t, y: [y[1], 50 * y[4] - 20 * y[1], y[3], -9 * y[2], (y[2] - y[4]) / 0.1]  # noqa: E731
    left, _, right, _, seen = reference(rates, [0.1, 0, 0.1, 0, 0.2], solution.time, method="DOP853")
    assert solution["left.x"] == pytest.approx(left, abs=1e-8)
    assert solution["right.x"] == pytest.approx(1 + right, abs=1e-8)
    assert solution["seen"] == pytest.approx(seen, abs=1e-8)
    assert solution["alone"] == pytest.approx(np.exp(-solution.time), abs=1e-8)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_breakpoint_of_a_rate_is_located(solver):
    """The rate jumps from -3 to -1 where x comes to 1/2."""
    model = Model("a body at rest")
    model.add("box", Body(mass=1, inertia=1))
    model.add("x", State(rate="-branch(x - 0.5, 1, 1, 3)", start=1))
    solution = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-6, solver=solver)
    bend = 0.5 / 3
    exact = np.where(solution.time < bend, 1 - 3 * solution.time, 0.5 - (solution.time - bend))
    assert solution["x"] == pytest.approx(exact, abs=5e-6)


@pytest.mark.parametrize("how", [{"solver": "bdf"}, {"solver": "projected"}, {"solver": "auto"}, {"solver": "projected", "scheme": "rk4", "step": 0.01}])  # fmt: skip
def test_a_run_does_not_depend_on_the_run_before(how):
    """A state that is fast at the start and slow at the end: its first rate is that of the start, also in the second run."""
    model = Model("a delayed body")
    model.add("cart", Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("w", State(rate="cos(3*cart.x)*cart.vx", start=0))
    model.add("push", AppliedForce(i="cart", force=("-w - 20*cart.x", 0)))
    job = prepare(model, duration=1.0, rtol=1e-6, **how)
    first, second = job.integrate(), job.integrate()
    assert np.array_equal(first.q, second.q) and np.array_equal(first.u, second.u)


def test_a_run_goes_on_from_a_saved_state():
    model = delayed_spring()
    whole = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-10)
    half = stiffmbs.run(model, duration=0.5, points=6, rtol=1e-10)
    rest = stiffmbs.run(model, duration=0.5, points=6, rtol=1e-10, start_from=half)
    assert rest["delayed"][-1] == pytest.approx(whole["delayed"][-1], abs=1e-8)
    assert rest["cart.x"][-1] == pytest.approx(whole["cart.x"][-1], abs=1e-8)


def test_verify_and_the_energy_balance_know_states():
    solution = stiffmbs.verify(delayed_spring(), duration=1.0, points=11, rtol=1e-7)
    assert solution.errors["delayed"].over_time < 1e-5
    assert not [note for note in solution.notes if "peaks" not in note]
