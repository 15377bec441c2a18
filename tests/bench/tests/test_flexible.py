"""Flexible bodies in this package and in other tools: all solve one problem."""

import numpy as np
import pytest

from tests.bench.decades import error_of
from tests.bench.peers import peers
from tests.bench.problems.flexible import BEAMS, BENCHMARKS, of_beam, of_elements

ERROR = 1e-3


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("name", BEAMS)
def test_a_beam_has_about_the_error_that_is_asked_for(name):
    reference = of_elements(BEAMS[name], 32)()
    for solver in ("radau", "bdf"):
        assert error_of(of_beam(BEAMS[name], {"solver": solver}, ERROR)(), reference) < 3 * ERROR


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("problem", BENCHMARKS, ids=lambda problem: problem.name)
def test_other_tools_solve_the_same_problem(problem):
    own = problem.contestants()[0].at(ERROR)()
    for peer in peers(problem.in_space()):
        found = peer.at(peer.settings[4])()
        assert np.abs(found - own).max() < 4 * ERROR, peer.solver
