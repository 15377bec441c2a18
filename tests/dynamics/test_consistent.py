"""States near the constraints made consistent by elimination, beside the LU of the whole block system."""

from dataclasses import fields

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics.dynamics import OutputRows
from stiffmbs.dynamics.native.layouts import DYNAMICS
from stiffmbs.model.read_scene import read_scene
from tests.bench.drives import CARS
from tests.bench.problems.chain_in_space import SCENE, chain_in_space

ELIMINATES = list(DYNAMICS).index("eliminates")
IDEAL = next(car for car in CARS if car.name == "example_car_ideal")


def chain_text():
    return SCENE.format(rods=10)


def chain():
    return prepare(chain_in_space(10)).dynamics


def car():
    return prepare(IDEAL.model("step"), presolve=False).dynamics


def reported(dynamics, q, u, by_elimination):
    """The row of one state, by a way."""
    dynamics.table[ELIMINATES] = by_elimination
    dynamics.forget_pivots()
    rows = dynamics.report(np.zeros(1), q[None].copy(), u[None].copy(), project=True)
    assert rows.status == 0
    return rows


def beside(dynamics, distance):
    """The start, with all numbers off by up to a distance."""
    rng, system = np.random.default_rng(3), dynamics.system
    return (x + rng.uniform(-distance, distance, len(x)) for x in (system.q, system.u))


@pytest.mark.long
@pytest.mark.parametrize("make", [chain, car])
def test_a_state_beside_the_constraints_is_reported_as_by_the_lu(make):
    """The projections differ in their measure alone: both move by as little as the state is off."""
    dynamics = make()
    assert dynamics.table[ELIMINATES]
    q, u = beside(dynamics, 1e-7)
    eliminated, whole = reported(dynamics, q, u, True), reported(dynamics, q, u, False)
    assert dynamics.table.view(DYNAMICS.cells)[0]["by_elimination"] == 0
    assert eliminated.position_violation[0] < 1e-12
    assert eliminated.velocity_violation[0] < 1e-12
    assert 1e-9 < eliminated.drift[0] == whole.drift[0]
    np.testing.assert_allclose(eliminated.q, whole.q, atol=3e-6)
    np.testing.assert_allclose(eliminated.u, whole.u, atol=3e-6)
    np.testing.assert_allclose(eliminated.log_determinant, whole.log_determinant, atol=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("make", [chain, car])
def test_accelerations_multipliers_and_determinant_are_those_of_the_lu(make):
    """At a state that both have to leave where it is."""
    dynamics = make()
    q, u = beside(dynamics, 1e-7)
    at = reported(dynamics, q, u, True)
    eliminated, whole = reported(dynamics, at.q[0], at.u[0], True), reported(dynamics, at.q[0], at.u[0], False)
    for name in ("q", "u", "acceleration", "lam", "values", "log_determinant"):
        found, expected = getattr(eliminated, name), getattr(whole, name)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-10 * (1 + np.abs(expected).max()), err_msg=name)


def test_a_state_far_off_is_brought_back_by_smallest_moves():
    """Frozen factors don't get there: what they have moved is taken back, and the pose is the one nearest in m and rad."""
    dynamics = chain()
    q, u = beside(dynamics, 0.05)
    eliminated, whole = reported(dynamics, q, u, True), reported(dynamics, q, u, False)
    np.testing.assert_array_equal(eliminated.q, whole.q)


def near_by(dynamics):
    """Eleven states beside the constraints, each close to the one before."""
    (q, u), n = beside(dynamics, 1e-6), 11
    along = np.linspace(0.0, 1.0, n)[:, None]
    return np.linspace(0.0, 1e-2, n), q + 1e-9 * along, u * (1.0 + 1e-9 * along)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("make", [chain, car])
def test_a_row_does_not_depend_on_the_rows_before(make):
    """Outputs at more times leave the others as they are, to the last digit."""
    dynamics = make()
    t, q, u = near_by(dynamics)
    together = dynamics.report(t, q, u, project=True)
    for k in (1, 7, 10):
        alone = dynamics.report(t[k : k + 1], q[k : k + 1], u[k : k + 1], project=True)
        for name in (field.name for field in fields(OutputRows) if field.name != "status"):
            np.testing.assert_array_equal(getattr(together, name)[k], getattr(alone, name)[0], err_msg=name)


@pytest.mark.parametrize("count", [1, 7, 8, 11])
def test_rows_are_stored_by_columns_and_judged(count):
    """Whole and partial cache lines; moves and energies by NumPy."""
    dynamics = chain()
    system = dynamics.system
    t, q, u = (array[:count] for array in near_by(dynamics))
    rows = dynamics.report(t, q, u, project=True)
    assert rows.values[:, 0].flags.c_contiguous
    assert rows.q.shape == q.shape
    changed, moved = np.abs(rows.u - u), np.abs(rows.q - q) * np.sqrt(system.mass_by_coordinate)
    np.testing.assert_allclose(rows.changed, changed.max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(rows.moved, moved.max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(rows.moved_velocity, (changed * np.sqrt(system.mass)).max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(rows.kinetic, 0.5 * rows.u**2 @ system.mass, rtol=1e-12)
    potential = system.term("output", "potential").source
    np.testing.assert_allclose(rows.potential, rows.values[:, potential].sum(axis=1), rtol=1e-12)


def test_rows_end_before_the_first_without_a_solution():
    """Rows of an incomplete cache line are stored, too."""
    dynamics = chain()
    t, q, u = near_by(dynamics)
    whole = dynamics.report(t, q, u, project=True)
    q[9] = np.nan
    rows = dynamics.report(t, q, u, project=True)
    assert rows.status < 0
    assert len(rows.t) == 9
    np.testing.assert_array_equal(rows.values, whole.values[:9])


def test_where_pivots_lose_digits_the_lu_takes_over():
    """Each second rod is so light that both of its hinges ask nearly the same of J M^-1 J^T: steps take that, reports do not."""
    light = SCENE.replace("    mass: m\n", "    mass: m*10^(-5*(1 - (-1)^k)/2)\n").replace(
        "[m*", "[10^(-5*(1 - (-1)^k)/2)*m*"
    )
    dynamics = prepare(read_scene(light.format(rods=10)), presolve=False).dynamics
    assert dynamics.table[ELIMINATES]
    whole = reported(dynamics, dynamics.system.q, dynamics.system.u, False)
    found = reported(dynamics, dynamics.system.q, dynamics.system.u, True)
    assert dynamics.table.view(DYNAMICS.cells)[0]["by_elimination"] == 0
    np.testing.assert_array_equal(found.lam, whole.lam)


BEAD = """
  bead: {mass: 1e-9, inertia: [1e-13, 1e-13, 1e-13], position: [10, 0, 0], markers: {off: {point: [0.03, 0.01, 0.02]}}}
joints:
  tip: {type: fixed, i: bead, j: {body: link10, point: [L/2, 0, 0]}}"""
PULL = """
forces:
  pull: {type: spring_damper, i: bead.off, j: {body: ground, point: [12, 1, 0.5]}, stiffness: 1e5, free_length: 1}
run:"""


def test_rounding_of_forces_on_a_light_body_is_left_to_the_lu():
    """All pivots keep their digits; yet M^-1 (f - J^T lam) holds 1e5 N times the rounding over 1e-9 kg."""
    text = chain_text().replace("\njoints:", BEAD, 1).replace("\nrun:", PULL, 1)
    dynamics = prepare(read_scene(text), presolve=False).dynamics
    assert dynamics.table[ELIMINATES]
    at = reported(dynamics, dynamics.system.q, dynamics.system.u, True)
    assert dynamics.table.view(DYNAMICS.cells)[0]["by_elimination"] == 0
    assert dynamics.eliminated._cells["kept"] > 0.1
    whole = reported(dynamics, at.q[0], at.u[0], False)
    np.testing.assert_allclose(at.acceleration, whole.acceleration, atol=1e-6 * np.abs(whole.acceleration).max())


def test_small_mechanisms_do_without_it(examples):
    assert not prepare(stiffmbs.load_scene(examples / "heavy_top.yaml")).dynamics.table[ELIMINATES]
