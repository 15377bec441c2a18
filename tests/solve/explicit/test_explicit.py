"""Explicit schemes with projection: their orders, dense output, constraints, and what they say of stiff scenes."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import Body, Model
from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics.elimination.eliminated import ATTEMPT
from stiffmbs.solve.explicit.schemes import SCHEMES
from stiffmbs.solve.trajectory import Outcome
from tests.stress.mechanisms.parallelogram import parallelogram, swing_error
from tests.stress.random_tree import random_tree

ADAPTIVE = ["dopri5", "dop853"]


@pytest.fixture(scope="module")
def scene(examples):
    return stiffmbs.load_scene(examples / "cart_pendulum.yaml")


@pytest.fixture(scope="module")
def error_of(scene, cart_pendulum_reference):
    """The largest error of the cart-pendulum's two coordinates, and the run."""

    def solve(scheme, **changes):
        solution = stiffmbs.run(scene, solver="projected", scheme=scheme, **changes)
        x, theta = cart_pendulum_reference(solution.time)
        parts = (solution["cart.x"] - x, solution["bar.angle"] + np.pi / 2 - theta)
        return max(np.max(np.abs(part)) for part in parts), solution

    return solve


def slope(sizes, errors):
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_nodes_are_the_sums_of_their_rows(scheme):
    np.testing.assert_allclose(scheme.matrix(scheme.a).sum(axis=1), scheme.c, atol=2e-15)


@pytest.mark.parametrize("name", [name for name, scheme in SCHEMES.items() if not scheme.columns])
def test_weights_integrate_powers_up_to_the_order(name):
    """sum b_i c_i^(k-1) = 1/k for k up to the order, the conditions of quadrature among those of order."""
    scheme = SCHEMES[name]
    weights, c = scheme.matrix(scheme.a)[scheme.stages, : scheme.stages], np.array(scheme.c)[: scheme.stages]
    for k in range(1, scheme.order + 1):
        assert weights @ c ** (k - 1) == pytest.approx(1 / k, abs=1e-14)


@pytest.mark.long
def test_rk4_is_of_order_4(error_of):
    steps = np.array([0.02, 0.01, 0.005])
    assert slope(steps, [error_of("rk4", step=h, output=0.04)[0] for h in steps]) == pytest.approx(4, abs=0.15)


@pytest.mark.parametrize(("scheme", "order"), [("dopri5", 5), ("dop853", 8)])
def test_error_falls_with_the_steps_as_the_order_says(error_of, scheme, order):
    found = [error_of(scheme, rtol=rtol, points="steps") for rtol in (1e-6, 1e-7, 1e-8, 1e-9, 1e-10)]
    steps = [solution.solver["steps"] for _, solution in found]
    assert -slope(steps, [error for error, _ in found]) == pytest.approx(order, abs=0.15 * order)


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_error_follows_the_tolerance(error_of, scheme):
    errors = [error_of(scheme, rtol=rtol)[0] for rtol in (1e-4, 1e-6, 1e-8, 1e-10)]
    assert all(coarse > 10 * fine for coarse, fine in itertools.pairwise(errors)), errors
    assert errors[2] < 1e-6


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_output_between_steps_is_as_good_as_the_steps(error_of, scheme):
    at_steps, solution = error_of(scheme, rtol=1e-8, points="steps")
    between, dense = error_of(scheme, rtol=1e-8, points=5001)
    assert dense.solver["steps"] == solution.solver["steps"] < 500
    assert between < 2 * at_steps


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_output_times_leave_the_steps_alone(scene, scheme):
    few, many = (stiffmbs.run(scene, solver="projected", scheme=scheme, points=n) for n in (2, 1001))
    np.testing.assert_array_equal(few.step_times, many.step_times)
    assert few["cart.x"][-1] == many["cart.x"][-1]


def test_more_output_than_one_call_holds(scene, cart_pendulum_reference):
    solution = stiffmbs.run(scene, solver="projected", scheme="dop853", output=1e-3, rtol=1e-9)
    assert len(solution.time) == 10_001
    np.testing.assert_allclose(solution["cart.x"], cart_pendulum_reference(solution.time)[0], atol=1e-8)


@pytest.mark.parametrize("name", ["stick_slip", "bouncing_ball"])
def test_runs_of_one_job_do_not_depend_on_those_before(examples, name):
    """They work on the same memory: counters, signs of event functions, and output times begin anew."""
    job = prepare(stiffmbs.load_scene(examples / f"{name}.yaml"), solver="projected", scheme="dop853", rtol=1e-6)
    first, second = job.integrate(), job.integrate()
    np.testing.assert_array_equal(first.q, second.q)
    np.testing.assert_array_equal(first.step_times, second.step_times)
    counts = [{k: v for k, v in run.statistics.items() if k != "seconds"} for run in (first, second)]
    assert counts[0] == counts[1]


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_own_steps_can_be_reported(scene, scheme):
    solution = stiffmbs.run(scene, solver="projected", scheme=scheme, points="steps", rtol=1e-11, max_step=0.01)
    assert len(solution.time) == solution.solver["steps"] + 1 > 1000
    np.testing.assert_array_equal(solution.time[1:], solution.step_times)
    assert solution.time[-1] == 10.0
    assert np.max(np.diff(solution.time)) < 0.0102


@pytest.mark.parametrize("scheme", ["rk4", *ADAPTIVE])
def test_constraints_hold_at_every_output(scene, scheme):
    solution = stiffmbs.run(scene, solver="projected", scheme=scheme, rtol=1e-6, step=0.01)
    assert solution["constraint.position"].max() < 2e-12
    assert solution["constraint.velocity"].max() < 1e-12


def test_without_projection_the_constraints_drift(scene):
    drifting, held = (
        stiffmbs.run(scene, solver="projected", scheme="dop853", rtol=1e-6, projection=projection)
        for projection in (False, True)
    )
    assert 1e-9 < drifting["constraint.position"].max() < 1e-3
    assert held["constraint.position"].max() < 2e-12


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_energy_is_kept_to_the_tolerance(scene, scheme):
    drift = [stiffmbs.run(scene, solver="projected", scheme=scheme, rtol=r).energy_drift() for r in (1e-6, 1e-10)]
    assert drift[0] < 1e-3
    assert drift[1] < 1e-8


@pytest.fixture(scope="module")
def chain(examples):
    return stiffmbs.load_scene(examples / "chain.yaml")


def integrated(scene, frozen, **changes):
    """A run of dop853 whose steps return to the constraints by frozen factors, or by Newton's moves with new ones."""
    job = prepare(scene, solver="projected", scheme="dop853", duration=1.0, **changes)
    job.dynamics.eliminated.serves = frozen
    return job.dynamics, job.integrate()


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
def test_steps_end_on_the_constraints(chain, rtol):
    """One move by frozen factors leaves positions at the projection's tolerance and velocities far below the run's."""
    dynamics, trajectory = integrated(chain, True, rtol=rtol, points="steps")
    for t, q, u in zip(trajectory.t, trajectory.q, trajectory.u, strict=True):
        dynamics.state.q[:], dynamics.state.u[:] = q, u
        dynamics.state.evaluate("motion", t)
        assert np.max(np.abs(dynamics.state.vector("motion", "C"))) < 2e-12
        assert np.max(np.abs(dynamics.state.vector("motion", "V"))) < 1e-3 * rtol + 1e-14


@pytest.mark.long
def test_frozen_factors_cost_no_accuracy(examples):
    """The mean (geometric) of the errors is that of full projections, to a tenth."""
    ratios = []
    for name in ("cart_pendulum", "four_bar"):
        scene = stiffmbs.load_scene(examples / f"{name}.yaml")
        exact = integrated(scene, False, rtol=1e-13, points=51)[1].q
        for rtol in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
            frozen, full = (
                np.max(np.abs(integrated(scene, f, rtol=rtol, points=51)[1].q - exact)) for f in (True, False)
            )
            ratios.append(frozen / full)
    assert np.exp(np.mean(np.log(ratios))) < 1.1


@pytest.mark.long
@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5))
def test_all_integrators_agree_on_random_trees(seed, count):
    model = random_tree(np.random.default_rng(seed), count, gravity=True, grounded=True, springs=1)
    implicit = stiffmbs.run(model, duration=0.3, points=7, rtol=1e-10)
    for scheme in ("rk4", *ADAPTIVE):
        explicit = stiffmbs.run(model, duration=0.3, points=7, solver="projected", scheme=scheme, rtol=1e-10, step=1e-4)
        for name in implicit:
            if name.endswith((".x", ".y", ".angle", ".vx", ".omega", ".fx", ".fy")):
                scale = 1 + np.max(np.abs(implicit[name]))
                np.testing.assert_allclose(explicit[name], implicit[name], atol=2e-6 * scale, err_msg=name)


def spring_scene(stiffness, damping):
    """A heavy bob that swings slowly, held to a light body by a spring in its own line."""
    model = Model("stiff", gravity=(0, -9.81))
    model.add("bob", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("s", stiffmbs.SpringDamper(i="bob", j="ground", stiffness=stiffness, damping=damping, free_length=1))
    return model


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_a_stiff_scene_is_solved_and_named_so(scheme):
    solution = stiffmbs.run(spring_scene(1e9, 1e5), duration=0.2, solver="projected", scheme=scheme, rtol=1e-4)
    assert solution.outcome is Outcome.DONE
    assert "stiff" in solution.message and "bdf" in solution.message
    slow = stiffmbs.run(spring_scene(10.0, 0.1), duration=0.2, solver="projected", scheme=scheme, rtol=1e-4)
    assert "stiff" not in slow.message


def test_a_hopelessly_stiff_scene_is_given_up():
    solution = stiffmbs.run(spring_scene(1e9, 1e9), duration=10, solver="projected", scheme="dop853")
    assert solution.outcome is Outcome.STOPPED
    assert "bdf" in solution.message and "t = " in solution.message
    assert len(solution.time) >= 1


def test_motion_that_ends_in_a_singularity_stops_there():
    """x'' = 2 x^3 with x(0) = x'(0) = 1 is 1/(1 - t): no solver gets past t = 1."""
    model = Model("blow-up")
    model.add("a", Body(mass=1, inertia=1, position=(1, 0), velocity=(1, 0)))
    model.add("push", stiffmbs.AppliedForce(i="a", force=("2*a.x^3", 0)))
    solution = stiffmbs.run(model, duration=2, output=0.01, solver="projected", scheme="dop853", rtol=1e-8)
    assert solution.outcome is Outcome.STOPPED
    assert 0.985 < solution.time[-1] < 1.005
    np.testing.assert_allclose(solution["a.x"][:90], 1 / (1 - solution.time[:90]), rtol=1e-5)


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_eliminated_accelerations_are_those_of_the_whole_block_system(seed, count):
    rng = np.random.default_rng(seed)
    dynamics = prepare(random_tree(rng, count, gravity=True, grounded=True, springs=1)).dynamics
    dynamics.state.u[:] = rng.uniform(-1, 1, dynamics.system.n_u)
    _, whole = dynamics.accelerate(0.0)
    lam = dynamics.state.lam.copy()
    found = np.empty_like(whole)
    assert dynamics.eliminated.serves
    assert ATTEMPT.call(0.0, found.ctypes.data, dynamics.eliminated.table.ctypes.data)
    np.testing.assert_allclose(found, whole, atol=1e-9 * (1 + np.abs(whole).max()))
    np.testing.assert_allclose(dynamics.state.lam, lam, atol=1e-9 * (1 + np.abs(lam).max()))


def test_one_plate_with_many_pendulums_is_left_to_the_whole_system():
    """All its joints meet in one body, so that eliminating it would fill the matrix."""
    model = Model("comb", gravity=(0, -9.81))
    plate = model.add("plate", Body(mass=50, inertia=50))
    for k in range(60):
        bob = model.add(f"bob{k}", Body(mass=1, inertia=0.1, position=(k, -1)))
        model.add(f"pin{k}", stiffmbs.Revolute(i=bob.at(0, 1), j=plate.at(k, 0)))
    job = prepare(model, duration=0.1, points=3, solver="projected", scheme="dop853")
    assert not job.dynamics.eliminated.serves
    assert job.integrate().outcome is Outcome.DONE


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_between_long_steps_at_rest_nothing_moves(scheme):
    """A load of 1e-15 N on a damped spring: steps at rest are far longer than stability allows, and amplify rounding."""
    law = "-1e4*mass.x - 70*mass.vx + 1e-15*(1 + sin(t))"
    given = {
        "gravity": [0, 0],
        "bodies": {"mass": {"mass": 1, "inertia": 1}},
        "forces": {"load": {"type": "force", "i": "mass", "force": [law, 0]}},
    }
    how = {"duration": 20.0, "points": 2001, "rtol": 1e-6}
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(given)), solver="projected", scheme=scheme, **how)
    assert np.max(np.abs(solution["mass.vx"])) < 1e-2


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_flat_poses_are_passed_wherever_steps_end(scheme):
    """Some step in every run ends beside a flat pose: one in eight runs stopped there, depending on rounding (dop853)."""
    how = {"duration": 3.0, "points": 31, "rtol": 1e-8, "solver": "projected", "scheme": scheme}
    solutions = [stiffmbs.run(parallelogram(omega=float(omega)), **how) for omega in np.linspace(8.5, 45, 60)]
    done = [solution for solution in solutions if solution.outcome is Outcome.DONE]
    assert len(done) >= 58
    assert max(swing_error(solution) for solution in done) < 1e-5


def test_a_tighter_tolerance_is_better_where_friction_rises_within_a_step(examples):
    """Slip ends within 0.2 mm/s: orders 3 and 5 told an error 300 times too small of a step, and rtol 1e-10 was worse than 1e-8."""
    scene = stiffmbs.load_scene(examples / "stick_slip.yaml")
    how = {"duration": 1.0, "points": 401, "solver": "projected", "scheme": "dop853"}
    best, *others = (stiffmbs.run(scene, rtol=rtol, **how)["block.x"] for rtol in (1e-13, 1e-8, 1e-10))
    loose, tight = (np.abs(x - best).max() for x in others)
    assert tight < min(loose, 1e-9)
