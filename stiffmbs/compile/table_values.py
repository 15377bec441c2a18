"""Table data for kernels, and tables as functions of arrays."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Final

import numpy as np

from ..errors import InputError
from ..reading.table import Table

Curve = Callable[[np.ndarray], np.ndarray]
REPEATS: Final = 1.0
HOLDS: Final = 2.0
"""End codes in the data of a table that is periodic, or keeps the value of its ends (as in `native.spline`)."""


def spline_data(table: Table) -> np.ndarray:
    """Return the kernel data of a table: count, its end code, knots, and the coefficients of each piece (highest first).

    The end code is `REPEATS`, `HOLDS`, or 0 for a table that is extrapolated with the slope of its ends.

    Splines are those of SciPy, monotone and Akima's cubics those of `stiffmbs.compile.table_values`; straight lines
    are pieces without curvature. Raises InputError if points are so close that a coefficient is not finite.
    """
    x, y = np.array(table.table, dtype=float).T
    try:
        with np.errstate(all="ignore"):
            pieces = _pieces(table, x, y)
    except (ValueError, np.linalg.LinAlgError):  # SciPy reports non-finite numbers
        pieces = np.full(1, np.nan)
    if not np.all(np.isfinite(pieces)):
        raise InputError(
            f"found points of a table that are {np.diff(x).min():.3g} apart, where its slope or curvature has no finite "
            "value, expected them further apart"
        )
    code = REPEATS if table.repeats else HOLDS if table.beyond == "hold" else 0.0
    return np.concatenate([[len(x), code], x, pieces.T.ravel()])


def _pieces(table: Table, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the coefficients of each piece, highest first, as columns."""
    match table.interpolation:
        case "lines":
            slope = np.diff(y) / np.diff(x)
            return np.stack([np.zeros_like(slope), np.zeros_like(slope), slope, y[:-1]])
        case "akima":
            return _closed(akima_pieces, x, y) if table.repeats else akima_pieces(x, y)
        case "monotone":
            return _closed(monotone_pieces, x, y) if table.repeats else monotone_pieces(x, y)
    from scipy.interpolate import CubicSpline

    if table.smoothing is not None:
        y = smoothed(table)
    ends = "periodic" if table.repeats else table.ends or "natural"
    if table.repeats:
        y = np.append(y[:-1], y[0])
    return np.asarray(CubicSpline(x, y, bc_type=ends).c)


def _closed(pieces: Callable[[np.ndarray, np.ndarray], np.ndarray], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the pieces of a period whose interpolant is smooth where it repeats: its neighbours are periods too."""
    period, count = x[-1] - x[0], len(x) - 1
    around = np.concatenate([x[:-1] - period, x[:-1], x + period])
    return pieces(around, np.concatenate([y[:-1], y[:-1], y[:-1], y[:1]]))[:, count : 2 * count]


@lru_cache(maxsize=64)
def smoothed(table: Table) -> np.ndarray:
    """Return the values at the points of the natural cubic spline of least curvature within a root mean square distance.

    Reinsch, Smoothing by spline functions, Numer. Math. 10 (1967) 177-183. If a straight line is that near, it is returned.
    """
    from scipy.interpolate import make_smoothing_spline
    from scipy.optimize import brentq

    assert table.smoothing is not None
    allowed = table.smoothing
    x, y = np.array(table.table, dtype=float).T
    x = (x - x[0]) / (x[-1] - x[0])
    line = np.polyval(np.polyfit(x, y, 1), x)
    if _distance(line, y) <= allowed:
        return line

    def departure(power: float) -> float:
        return _distance(make_smoothing_spline(x, y, lam=10.0**power)(x), y) - allowed

    low = high = 0.0
    while departure(low) > 0.0:
        low -= 4.0
    while departure(high) < 0.0:
        high += 4.0
    return np.asarray(make_smoothing_spline(x, y, lam=10.0 ** brentq(departure, low, high, xtol=1e-3))(x))


def _distance(curve: np.ndarray, y: np.ndarray) -> float:
    return float(np.sqrt(np.mean((curve - y) ** 2)))


def curve(table: Table) -> Curve:
    """Return a function of the table's values as computed by kernels, also outside its points."""
    data = spline_data(table)
    return lambda arguments: value_of(data, np.asarray(arguments, dtype=float))


def value_of(data: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the values of a table of `spline_data` at an array of arguments."""
    x, pieces = _taken_apart(data)
    if data[1] == REPEATS:
        at = x[0] + np.mod(at - x[0], x[-1] - x[0])
    inside = np.clip(at, x[0], x[-1])
    k = np.clip(np.searchsorted(x, inside, side="right") - 1, 0, len(x) - 2)
    a, b, c, d = np.moveaxis(pieces[k], -1, 0)
    h = inside - x[k]
    value = ((a * h + b) * h + c) * h + d
    if data[1] == HOLDS:
        return np.asarray(value)
    return np.asarray(value + ((3 * a * h + 2 * b) * h + c) * (at - inside))


def ends_of(data: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the knots of a table of `spline_data`, its values, and its slopes before and after each knot."""
    x, pieces = _taken_apart(data)
    h = np.diff(x)
    a, b, c, _ = pieces.T
    at_ends = (3 * a * h + 2 * b) * h + c
    outer = {REPEATS: (at_ends[-1], c[0]), HOLDS: (0.0, 0.0)}.get(float(data[1]), (c[0], at_ends[-1]))
    before, after = np.append(outer[0], at_ends), np.append(c, outer[1])
    return x, value_of(data, x), before, after


def parts_of(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a table, and the coefficients of each piece, highest first."""
    return _taken_apart(spline_data(table))


def _taken_apart(data: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points, and the coefficients of each piece."""
    count = int(data[0])
    return data[2 : 2 + count], data[2 + count :].reshape(-1, 4)


UNDEFINED = 1e-9
"""Difference of slopes, relative to the largest, below which both sides have equal weights."""


def akima_pieces(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return Akima's piecewise cubic interpolant.

    Akima, A New Method of Interpolation and Smooth Curve Fitting Based on Local Procedures, J. ACM 17 (1970) 589-602.
    `x`, `y` of shape (n,): points, x strictly increasing, two or more. Returns an array of shape (4, n - 1): the
    coefficients of each piece, highest first, those of `scipy.interpolate.Akima1DInterpolator`.
    """
    chords = np.diff(y) / np.diff(x)
    return _hermite(x, y, chords, np.full(len(x), chords[0]) if len(x) == 2 else _akima_slopes(chords))


def monotone_pieces(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the monotone piecewise cubic interpolant (PCHIP), which does not overshoot.

    Fritsch, Butland, A Method for Constructing Local Monotone Piecewise Cubic Interpolants, SIAM J. Sci. Stat. Comput.
    5 (1984) 300-304. `x`, `y` of shape (n,): points, x strictly increasing, two or more. Returns an array of shape (4,
    n - 1): the coefficients of each piece, highest first, those of `scipy.interpolate.PchipInterpolator`.
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
    ahead, back = change[2:], change[:-2]
    both = ahead + back
    defined = both > UNDEFINED * both.max()
    slopes = 0.5 * (m[3:] + m[:-3])
    before, after = m[1:-2], m[2:-1]
    slopes[defined] = (before + back / np.where(defined, both, 1.0) * (after - before))[defined]
    return np.asarray(slopes)
