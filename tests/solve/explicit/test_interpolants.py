"""States between the ends of explicit steps."""

from math import prod

import numpy as np
import pytest

from stiffmbs.analyses.job import prepare
from stiffmbs.solve.explicit.schemes import SCHEMES
from tests.bench.peers.trees.scene import scene_of
from tests.bench.problems.trees_in_space import CONVERGED, OUTPUT, SOLVERS, arm

DOP853 = SCHEMES["dop853"]


def forests(order, largest=None):
    """All sets of rooted trees with so many nodes together; a tree is the tuple of its branches."""
    if order == 0:
        yield ()
    for size in range(1, order + 1):
        for tree in trees(size):
            if largest is None or (size, tree) <= largest:
                for rest in forests(order - size, (size, tree)):
                    yield (tree, *rest)


def trees(order):
    return sorted(forests(order - 1))


def nodes(tree):
    return 1 + sum(map(nodes, tree))


def density(tree):
    return nodes(tree) * prod(map(density, tree))


def weights(tree, a):
    """The elementary weights of the stages (Hairer, Norsett, Wanner I, ch. II.2)."""
    return prod((a @ weights(branch, a) for branch in tree), start=np.ones(len(a)))


def interpolating(scheme, rows, theta):
    """Weights of the stages for the state at a part of the step."""
    ends = scheme.matrix(scheme.a)[scheme.stages]
    begin, end = np.eye(scheme.extended)[[0, scheme.stages]]
    polynomials = [ends, begin - ends, 2 * ends - begin - end, *scheme.matrix(rows)]
    found = np.zeros(scheme.extended)
    for k in range(len(polynomials) - 1, -1, -1):
        found = (found + polynomials[k]) * (1 - theta if k % 2 else theta)
    return found


@pytest.mark.parametrize(
    ("scheme", "rows", "order"), [("dopri5", "dense", 4), ("dop853", "dense", 7), ("dop853", "free", 6)]
)
def test_interpolants_meet_the_conditions_of_their_order(scheme, rows, order):
    scheme = SCHEMES[scheme]
    a = scheme.matrix(scheme.a)
    for theta in (0.0, 0.15, 0.5, 0.8, 1.0):
        b = interpolating(scheme, getattr(scheme, rows), theta)
        for n in range(1, order + 1):
            for tree in trees(n):
                assert b @ weights(tree, a) == pytest.approx(theta**n / density(tree), abs=1e-12)


def test_the_error_of_the_free_interpolant_is_of_order_7():
    a, (row,) = DOP853.matrix(DOP853.a), DOP853.matrix((DOP853.free_error,))
    largest = [max(abs(row @ weights(tree, a)) for tree in trees(n)) for n in range(1, 8)]
    assert max(largest[:6]) < 1e-13 < 1e-6 < largest[6]


@pytest.fixture(scope="module")
def damped_arm():
    return scene_of(arm())


def test_output_at_a_loose_tolerance_needs_few_accelerations(damped_arm):
    """Steps of 12 stages; the interpolant of order 7 would take 3 more in each of them."""
    counted = prepare(damped_arm, rtol=1e-3, **SOLVERS["dop853"], **OUTPUT).integrate().statistics
    assert counted["accelerations"] < 12.5 * (counted["steps"] + counted["rejected"])


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
def test_output_between_steps_that_damping_bounds_is_within_the_tolerance(damped_arm, rtol):
    """The stages of the interpolant of order 7 go further astray than those of the step: it was off by 45 tolerances."""
    exact = prepare(damped_arm, rtol=CONVERGED, **SOLVERS["dop853"], **OUTPUT).integrate().q
    found = prepare(damped_arm, rtol=rtol, **SOLVERS["dop853"], **OUTPUT).integrate().q
    assert np.max(np.abs(found - exact)) < 3 * rtol
