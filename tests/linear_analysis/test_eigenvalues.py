"""Eigenvalues of state matrices, with those that are zero."""

import numpy as np
import pytest

from stiffmbs.linear_analysis.eigenvalues import eigen


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_eigenvalues_scale_with_the_matrix(scale):
    """Two first-order states, one at rest: 0 and -3."""
    values, _, zeros = eigen(scale * np.array([[-3.0, 0.0], [1.0, 0.0]]), 0, 2)
    assert values == pytest.approx([-3 * scale], rel=1e-12)
    assert zeros.eigenvectors.shape == (2, 1)
