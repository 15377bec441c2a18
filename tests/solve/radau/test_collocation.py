"""Coefficients of Radau IIA methods: order conditions, the code RADAU5, and the correction within a step."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from stiffmbs.solve.radau.collocation import radau

STAGES = pytest.mark.parametrize("stages", [3, 5, 7])


def test_three_stages_are_those_of_radau5():
    c, root = radau(3), np.sqrt(6)
    np.testing.assert_allclose(c.nodes, [(4 - root) / 10, (4 + root) / 10, 1], rtol=1e-15)
    np.testing.assert_allclose(c.error, [-(13 + 7 * root) / 3, (-13 + 7 * root) / 3, -1 / 3], rtol=1e-13)
    assert c.gamma == pytest.approx(3.6378342527444957, rel=1e-14)
    assert (c.alpha[0], c.beta[0]) == pytest.approx((2.6810828736277521, 3.0504301992474105), rel=1e-14)


@STAGES
def test_stages_integrate_polynomials_exactly(stages):
    """Collocation: A c^(k-1) = c^k / k for k = 1 to s; the weights, the last row, up to degree 2 s - 2."""
    c = radau(stages)
    a = np.linalg.inv(c.derivative)
    for k in range(1, stages + 1):
        np.testing.assert_allclose(a @ c.nodes ** (k - 1), c.nodes**k / k, atol=1e-14)
    for k in range(stages + 1, 2 * stages):
        assert a[-1] @ c.nodes ** (k - 1) == pytest.approx(1 / k, abs=1e-14)


@STAGES
def test_transformation_makes_the_matrix_block_diagonal(stages):
    c = radau(stages)
    blocks = np.zeros((stages, stages))
    blocks[0, 0] = c.gamma
    for k, (alpha, beta) in enumerate(zip(c.alpha, c.beta, strict=True)):
        blocks[1 + 2 * k : 3 + 2 * k, 1 + 2 * k : 3 + 2 * k] = [[alpha, -beta], [beta, alpha]]
    np.testing.assert_allclose(c.inverse @ c.derivative @ c.transform, blocks, atol=1e-11)


@STAGES
def test_correction_within_a_step_is_exact_for_one_more_degree(stages):
    """y' = p(t) of degree s: the polynomial of the stages is of degree s, the solution of degree s + 1."""
    c, h = radau(stages), 0.7
    p = Polynomial(np.arange(1.0, stages + 2))
    exact = p.integ()
    z = h * np.linalg.inv(c.derivative) @ p(h * c.nodes)
    estimate = h / c.gamma * (p(0.0) + c.error @ z / h)
    points = np.concatenate([[0.0], c.nodes])
    for place in (0.1, 0.5, 0.9):
        lagrange = [
            np.prod((place - np.delete(points, k)) / (points[k] - np.delete(points, k))) for k in range(1, stages + 1)
        ]
        corrected = lagrange @ z + Polynomial(c.bubble)(place) * estimate
        assert corrected == pytest.approx(exact(h * place), rel=1e-12)
        assert abs(lagrange @ z - exact(h * place)) > 1e-8
    np.testing.assert_allclose(Polynomial(c.bubble)([0.0, 1.0]), 0.0, atol=1e-10)
