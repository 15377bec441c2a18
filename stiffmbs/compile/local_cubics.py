"""Local piecewise cubic interpolation: monotone (PCHIP) and Akima. SciPy's modules take longer to import."""

from __future__ import annotations

import numpy as np

UNDEFINED = 1e-9
"""Difference of slopes, relative to the largest, below which both sides have equal weights."""


def akima_pieces(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return Akima's piecewise cubic interpolant.

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
    chords = np.diff(y) / np.diff(x)
    return _hermite(x, y, chords, np.full(len(x), chords[0]) if len(x) == 2 else _akima_slopes(chords))


def monotone_pieces(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the monotone piecewise cubic interpolant (PCHIP), which does not overshoot.

    Fritsch, Butland, A Method for Constructing Local Monotone Piecewise Cubic Interpolants, SIAM J. Sci. Stat. Comput.
    5 (1984) 300-304.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Points, x strictly increasing, two or more.

    Returns
    -------
    ndarray, shape (4, n - 1)
        The coefficients of each piece, highest first, those of `scipy.interpolate.PchipInterpolator`.
    """
    apart = np.diff(x)
    chords = np.diff(y) / apart
    return _hermite(x, y, chords, np.full(len(x), chords[0]) if len(x) == 2 else _monotone_slopes(apart, chords))


def _hermite(x: np.ndarray, y: np.ndarray, chords: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    apart = np.diff(x)
    bend = (slopes[:-1] + slopes[1:] - 2 * chords) / apart
    return np.stack([bend / apart, (chords - slopes[:-1]) / apart - bend, slopes[:-1], y[:-1]])


def _monotone_slopes(apart: np.ndarray, chords: np.ndarray) -> np.ndarray:
    """Return the slope at each point: a weighted harmonic mean of the secant slopes, 0 if these differ in sign."""
    before, after = chords[:-1], chords[1:]
    rises = np.sign(before) * np.sign(after) > 0
    first, second = 2 * apart[1:] + apart[:-1], apart[1:] + 2 * apart[:-1]
    inverse = first / np.where(rises, before, 1.0) + second / np.where(rises, after, 1.0)
    inner = np.where(rises, (first + second) / inverse, 0.0)
    ends = (_slope_at_end(apart[k], apart[m], chords[k], chords[m]) for k, m in ((0, 1), (-1, -2)))
    return np.concatenate([[next(ends)], inner, [next(ends)]])


def _slope_at_end(apart: float, next_apart: float, chord: float, next_chord: float) -> float:
    """Return the slope of the parabola through three end points, limited so that the end piece is monotone."""
    slope = ((2 * apart + next_apart) * chord - apart * next_chord) / (apart + next_apart)
    if np.sign(slope) != np.sign(chord):
        return 0.0
    if np.sign(chord) != np.sign(next_chord) and abs(slope) > 3 * abs(chord):
        return float(3 * chord)
    return float(slope)


def _akima_slopes(chords: np.ndarray) -> np.ndarray:
    """Return the slope at each point from the secant slopes, extended by two at each end."""
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
