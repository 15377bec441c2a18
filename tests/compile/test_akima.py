"""Akima's interpolation against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator

from stiffmbs.compile.akima import akima_pieces


@pytest.mark.parametrize("count", [2, 3, 4, 5, 11, 200])
def test_the_coefficients_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    for y in (rng.normal(size=count), rng.integers(0, 2, count) * 1.0, np.zeros(count), 3.0 + np.arange(count)):
        x = np.cumsum(rng.uniform(0.1, 2.0, count)) - 5
        assert np.array_equal(akima_pieces(x, y), Akima1DInterpolator(x, y).c)
