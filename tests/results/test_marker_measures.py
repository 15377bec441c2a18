"""Axes of markers in those of others, against rotation matrices."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stiffmbs.results.marker_motion import MarkerMotion


def turned(rotation):
    w_last = rotation.as_quat()
    nothing = np.zeros((len(w_last), 3))
    return MarkerMotion(nothing, nothing, nothing, np.roll(w_last, 1, axis=1), nothing, nothing)


@pytest.mark.parametrize("k", range(3))
def test_axes_of_random_markers(k):
    one, other = (Rotation.random(50, random_state=seed) for seed in (k, k + 3))
    expected = (other.inv() * one).as_matrix()[:, :, k]
    np.testing.assert_allclose(turned(one).axis(k, turned(other)), expected, atol=1e-12)
