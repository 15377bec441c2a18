"""Accelerations with u' eliminated: by blocks of all sizes and by planar pins, in trees and loops, beside the LU of the whole block system."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.dynamics.elimination.eliminated import ATTEMPT
from stiffmbs.dynamics.native.layouts import ELIMINATED as ELIMINATED_TABLE
from tests.bench.problems.chain_in_space import chain_in_space
from tests.stress.random_space import random_space_tree


def both_ways(dynamics):
    """Accelerations and multipliers at the state at hand by elimination, and by the LU of the whole."""
    found = np.empty(dynamics.system.n_u)
    served = ATTEMPT.call(0.0, found.ctypes.data, dynamics.eliminated.table.ctypes.data)
    eliminated = np.concatenate([found, dynamics.state.lam])
    status, whole = dynamics.accelerate(0.0)
    assert served and status == 0
    return eliminated, np.concatenate([whole, dynamics.state.lam])


def assert_equal(eliminated, whole, tolerance):
    assert np.max(np.abs(eliminated - whole)) <= tolerance * (1 + np.max(np.abs(whole)))


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=(pytest.mark.long, pytest.mark.sampled(3))) for seed in range(1, 6))]
)
def test_trees_of_all_kinds_of_joints(seed):
    """Blocks of one to six equations."""
    rng = np.random.default_rng(seed)
    dynamics = prepare(random_space_tree(rng, 8, springs=2), presolve=False).dynamics
    assert dynamics.eliminated.serves
    assert_equal(*both_ways(dynamics), 1e-11)


@pytest.mark.parametrize("name", ["bricard", "door", "governor", "spatial_slider_crank"])
def test_loops(examples, name):
    dynamics = prepare(stiffmbs.load_scene(examples / f"{name}.yaml")).dynamics
    assert_equal(*both_ways(dynamics), 1e-10)


def pins(dynamics):
    return dynamics.eliminated.table[list(ELIMINATED_TABLE).index("by_pins")]


@pytest.mark.parametrize("name", ["andrews", "bar_pendulum", "chain", "four_bars"])
def test_planar_pins(examples, name):
    """Three pins at one body and closed loops fill blocks that were empty, and change others."""
    dynamics = prepare(stiffmbs.load_scene(examples / f"{name}.yaml")).dynamics
    dynamics.state.u[:] = np.random.default_rng(1).normal(size=dynamics.system.n_u)
    assert pins(dynamics)
    assert_equal(*both_ways(dynamics), 1e-12)


def test_pins_beside_other_joints_are_eliminated_entry_by_entry(examples):
    dynamics = prepare(stiffmbs.load_scene(examples / "crank_slider.yaml")).dynamics
    assert not pins(dynamics)
    assert_equal(*both_ways(dynamics), 1e-11)


def test_pins_leave_no_trace_of_what_is_not_finite(examples):
    dynamics = prepare(stiffmbs.load_scene(examples / "chain.yaml")).dynamics
    dynamics.state.u[:] = np.nan
    found = np.empty(dynamics.system.n_u)
    ATTEMPT.call(0.0, found.ctypes.data, dynamics.eliminated.table.ctypes.data)
    assert not np.isfinite(found).all()
    dynamics.return_to_start()
    assert_equal(*both_ways(dynamics), 1e-12)


def test_slender_rods_in_a_chain_are_eliminated_at_all_poses():
    """Their inertias differ by a factor of 1000, so that each rod has a pivot that keeps 1/300: digits that no other joint loses again."""
    job = prepare(chain_in_space(10), solver="projected", rtol=1e-4)
    trajectory, dynamics = job.integrate(), job.dynamics
    for q, u in zip(trajectory.q[::20], trajectory.u[::20], strict=True):
        dynamics.state.q[:], dynamics.state.u[:] = q, u
        assert_equal(*both_ways(dynamics), 1e-11)


def test_what_is_not_finite_leaves_no_trace(examples):
    dynamics = prepare(stiffmbs.load_scene(examples / "spatial_slider_crank.yaml")).dynamics
    dynamics.state.u[:] = np.nan
    found = np.empty(dynamics.system.n_u)
    ATTEMPT.call(0.0, found.ctypes.data, dynamics.eliminated.table.ctypes.data)
    assert not np.isfinite(found).all()
    dynamics.return_to_start()
    assert_equal(*both_ways(dynamics), 1e-10)


def test_a_pose_far_away_leaves_no_trace():
    """Stages of rejected steps are no measure of pivots."""
    dynamics = prepare(random_space_tree(np.random.default_rng(0), 8, springs=2), presolve=False).dynamics
    found, q = np.empty(dynamics.system.n_u), dynamics.state.q.copy()
    dynamics.state.q[:] = 1e14 * q
    ATTEMPT.call(0.0, found.ctypes.data, dynamics.eliminated.table.ctypes.data)
    dynamics.state.q[:] = q
    assert_equal(*both_ways(dynamics), 1e-11)


def column(dynamics, name):
    """A number in the table of the blocks."""
    lists = dynamics.eliminated._lists
    return lists[name]


def test_no_entry_of_a_hinge_is_copied_by_itself():
    """Its rotations have entries in all five rows, its translations one in each of three: for two bodies, and one at the ground."""
    dynamics = prepare(chain_in_space(4), presolve=False).dynamics
    assert (column(dynamics, "n_full"), column(dynamics, "n_diagonal")) == (7, 7)
    assert column(dynamics, "n_j") == column(dynamics, "n_copied") == column(dynamics, "n_single") == 0


def test_rows_of_a_slider_are_copied_where_they_have_gaps(examples):
    dynamics = prepare(stiffmbs.load_scene(examples / "spatial_slider_crank.yaml"), presolve=False).dynamics
    assert column(dynamics, "n_full") > 0
    assert column(dynamics, "n_j") > 0
    assert_equal(*both_ways(dynamics), 1e-10)
