"""Akima's interpolation; written here as SciPy's loads its optimisers and more, which a short run would wait for."""

from __future__ import annotations

import numpy as np

UNDEFINED = 1e-9
"""Change of the slopes around a point, relative to the largest of all, up to which the weights of both sides are equal."""


def akima_pieces(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Cubics through points, each slope by the five points around.

    Akima, A New Method of Interpolation and Smooth Curve Fitting Based on Local Procedures, J. ACM 17 (1970) 589-602.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Points, x strictly increasing, two or more.

    Returns
    -------
    ndarray, shape (4, n - 1)
        The coefficients of each piece, highest first, those of `scipy.interpolate.Akima1DInterpolator`.
    """
    apart = np.diff(x)
    chords = np.diff(y) / apart
    slopes = np.full(len(x), chords[0]) if len(x) == 2 else _slopes(chords)
    bend = (slopes[:-1] + slopes[1:] - 2 * chords) / apart
    return np.stack([bend / apart, (chords - slopes[:-1]) / apart - bend, slopes[:-1], y[:-1]])


def _slopes(chords: np.ndarray) -> np.ndarray:
    """The slope at each point, from those of the chords, two more of which are added at both ends."""
    m = np.concatenate([[0.0, 0.0], chords, [0.0, 0.0]])
    m[1] = 2 * m[2] - m[3]
    m[0] = 2 * m[1] - m[2]
    m[-2] = 2 * m[-3] - m[-4]
    m[-1] = 2 * m[-2] - m[-3]
    change = np.abs(np.diff(m))
    ahead, behind = change[2:], change[:-2]
    both = ahead + behind
    defined = both > UNDEFINED * both.max()
    slopes = 0.5 * (m[3:] + m[:-3])
    before, after = m[1:-2], m[2:-1]
    slopes[defined] = (before + behind / np.where(defined, both, 1.0) * (after - before))[defined]
    return np.asarray(slopes)
