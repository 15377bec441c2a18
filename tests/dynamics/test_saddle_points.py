"""Block systems with the same matrix share their factors; what is solved with them is right at every pose."""

import numpy as np
import pytest

from stiffmbs.analyses.run import prepare
from stiffmbs.compile.state import State
from stiffmbs.dynamics.saddle_point import ACCELERATIONS, POSITION_STEP, VELOCITY_STEP, saddle_points

MOVES = (0.0, 1e-16, 1e-12, 1e-6, 1e-2)


def tables(scene):
    """Of the factors of positions, velocities and accelerations."""
    found = saddle_points(State(prepare(scene).dynamics.system), POSITION_STEP, VELOCITY_STEP, ACCELERATIONS)
    return [each.factors_table for each in found]


def test_velocities_and_accelerations_share_factors():
    positions, velocities, accelerations = tables("examples/spatial_chain.yaml")
    assert velocities is accelerations and positions is not velocities


def test_friction_has_accelerations_of_their_own():
    _, velocities, accelerations = tables("examples/stick_slip.yaml")
    assert velocities is not accelerations


@pytest.mark.parametrize("scene", ["spatial_chain", "andrews", "heavy_top"])
def test_shared_factors_solve_the_equations_of_each_pose(scene):
    dynamics = prepare(f"examples/{scene}.yaml", presolve=False).dynamics
    state, system = dynamics.state, dynamics.system
    q, u = state.q.copy(), state.u.copy()
    rows = np.flatnonzero(system.active)
    for move in MOVES:
        state.q[:], state.u[:] = q * (1.0 + move), u
        assert dynamics.correct_velocities(0.0) == 0
        status, acceleration = dynamics.accelerate(0.0)
        assert status == 0
        J, gamma, f = (
            state.matrix("acceleration", "J")[rows],
            state.vector("acceleration", "gamma")[rows],
            state.vector("acceleration", "f"),
        )
        forces = system.mass * acceleration + J.T @ state.lam[rows]
        assert forces == pytest.approx(f, rel=1e-9, abs=1e-9 * np.max(np.abs(f)))
        assert J @ acceleration == pytest.approx(gamma, rel=1e-9, abs=1e-9 * np.max(np.abs(acceleration)))
