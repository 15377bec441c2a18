"""Eigenvalues of state matrices, with those that are zero."""

import numpy as np
import pytest

from stiffmbs.linear_analysis.eigenvalues import eigen, is_singular


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_eigenvalues_scale_with_the_matrix(scale):
    """Two first-order states, one at rest: 0 and -3."""
    values, _, zeros = eigen(scale * np.array([[-3.0, 0.0], [1.0, 0.0]]), 0, 2)
    assert values == pytest.approx([-3 * scale], rel=1e-12)
    assert zeros.eigenvectors.shape == (2, 1)


@pytest.mark.parametrize(("part", "singular"), [(0.7, True), (1.4, False)])
def test_singular_values_count_as_zero_up_to_ten_roundings_for_each_row(part, singular):
    """Two rows of length 1 with the angle phi between them have the smallest singular value phi/sqrt(2)."""
    phi = np.sqrt(2) * part * 10 * 2 * np.finfo(float).eps
    assert is_singular(np.array([[1.0, 0.0], [1.0, phi]])) is singular


@pytest.mark.parametrize("rounding", [0.0, 1e-34, -1e-30, 1e-22, 1e-17])
def test_stiffness_of_rounding_hides_no_rate_of_a_state(rounding):
    """A free sled pushed by two states, whose input has the velocity's rounding."""
    matrix = np.array(
        [
            [0.0, 1.0, 0.0, 0.0, 0.0],
            [rounding, 0.0, 0.0, -2.8, -2.4],
            [0.0, 0.0, -7.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -4.9, -0.06],
            [-rounding, -rounding / 10, 0.0, 0.03, -4.8],
        ]
    )
    values, _, zeros = eigen(matrix, 1, 3)
    expected = np.linalg.eigvals(matrix[2:, 2:])
    assert np.sort(values.real) == pytest.approx(np.sort(expected), rel=1e-9)
    assert zeros.eigenvectors.shape[1] + zeros.generalised.shape[1] == 2


@pytest.mark.parametrize("seed", range(20))
def test_double_real_eigenvalues_are_real(seed):
    """Rounding makes a pair with imaginary parts of 1e-14 of some."""
    rng = np.random.default_rng(seed)
    basis = np.eye(6) + 0.3 * rng.standard_normal((6, 6))
    blocks = np.diag([-100 / 3, -100 / 3, -1.0, -2.0, -3.0, -3.0])
    blocks[4, 5], blocks[5, 4] = 5.0, -5.0
    matrix = basis @ blocks @ np.linalg.inv(basis)
    values, vectors, _ = eigen(matrix, 3)
    assert np.sum(values.imag == 0) == 4
    np.testing.assert_allclose(matrix @ vectors, vectors * values, atol=1e-10)
    assert np.linalg.matrix_rank(vectors, tol=1e-6) == 6
