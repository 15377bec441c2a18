"""An axle on bushings: this package and CasADi, each with its own equations, find the same places and forces."""

import numpy as np
import pytest

from stiffmbs.bench.decades import error_of
from stiffmbs.bench.peers import peers
from stiffmbs.bench.peers.mounted.mounted import turned
from stiffmbs.bench.problems.axle_on_bushings import BENCHMARKS

PROBLEMS = {benchmark.name: benchmark for benchmark in BENCHMARKS}


@pytest.mark.parametrize(
    "name",
    [
        "axle_1e6",
        "axle_1e6_forces",
        *(pytest.param(f"axle_1e8{end}", marks=pytest.mark.long) for end in ("", "_forces")),
    ],
)
def test_all_solve_the_same_problem(name):
    problem = PROBLEMS[name]
    reference = problem.reference()
    assert np.ptp(reference, axis=0).max() > 0.01
    for contestant in (*problem.contestants(), *peers(problem.in_space())):
        assert error_of(contestant.at(1e-9)(), reference) < 1e-5, contestant.solver


def test_euler_parameters_turn_vectors():
    """A quarter of a turn about z."""
    p = np.array([[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
    np.testing.assert_allclose(turned(p, np.array([[1.0, 0, 0]])), [[0, 1, 0]], atol=1e-15)
