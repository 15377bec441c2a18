"""Monotone and Akima's interpolation against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator, PchipInterpolator

from stiffmbs.compile.table_values import akima_pieces, monotone_pieces


@pytest.mark.parametrize("count", [2, 3, 4, 5, 11, 200])
def test_the_coefficients_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    for y in (rng.normal(size=count), rng.integers(0, 2, count) * 1.0, np.zeros(count), 3.0 + np.arange(count)):
        x = np.cumsum(rng.uniform(0.1, 2.0, count)) - 5
        assert np.array_equal(akima_pieces(x, y), Akima1DInterpolator(x, y).c)
        np.testing.assert_allclose(monotone_pieces(x, y), PchipInterpolator(x, y).c, rtol=1e-12, atol=1e-12)


def test_monotone_cubics_stay_between_their_points():
    rng = np.random.default_rng(7)
    for _ in range(200):
        x, y = np.cumsum(10.0 ** rng.uniform(-3, 2, 12)), rng.normal(size=12)
        pieces = monotone_pieces(x, y)
        part = np.linspace(0, 1, 101)[:, None] * np.diff(x)
        values = np.array([np.polyval(piece, z) for piece, z in zip(pieces.T, part.T, strict=True)])
        least, most = np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])
        assert np.all(values >= least[:, None] - 1e-9)
        assert np.all(values <= most[:, None] + 1e-9)
