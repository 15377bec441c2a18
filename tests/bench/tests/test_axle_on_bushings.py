"""An axle on bushings: this package and CasADi, each with its own equations, find the same places and forces."""

import numpy as np
import pytest

from tests.bench.decades import error_of
from tests.bench.peers import peers
from tests.bench.peers.mounted.mounted import turned
from tests.bench.problems.axle_on_bushings import BENCHMARKS

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

STEP, RTOL = 5e-4, 1e-9
COMPILED = "compiled"
"""Of peers whose equations a C compiler takes seconds for: the others have the same ones."""
PROBLEMS = {benchmark.name: benchmark for benchmark in BENCHMARKS}


@pytest.mark.sampled(3)
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
    for own in problem.contestants():
        assert error_of(own.at(RTOL)(), reference) < 1e-5, own.solver
    for peer in peers(problem.in_space()):
        if COMPILED not in peer.solver:
            setting = max((step for step in peer.settings if step <= STEP), default=RTOL)
            assert error_of(peer.at(setting)(), reference) < 1e-4, peer.solver


def test_euler_parameters_turn_vectors():
    """A quarter of a turn about z."""
    p = np.array([[np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
    np.testing.assert_allclose(turned(p, np.array([[1.0, 0, 0]])), [[0, 1, 0]], atol=1e-15)
