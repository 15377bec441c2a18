"""Table data for kernels, and tables as functions of arrays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import InputError
from ..reading.table import Table
from .local_cubics import akima_pieces, monotone_pieces

Curve = Callable[[np.ndarray], np.ndarray]


def spline_data(table: Table) -> np.ndarray:
    """Return the kernel data of a table: count, 1 if it is periodic, knots, and the coefficients of each piece (highest first).

    Splines are those of SciPy, monotone and Akima's cubics those of `stiffmbs.compile.local_cubics`; straight lines are
    pieces without curvature.

    Raises
    ------
    InputError
        If points are so close that a coefficient is not finite.
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
    return np.concatenate([[len(x), table.ends == "periodic"], x, pieces.T.ravel()])


def _pieces(table: Table, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the coefficients of each piece, highest first, as columns."""
    match table.interpolation:
        case "lines":
            slope = np.diff(y) / np.diff(x)
            return np.stack([np.zeros_like(slope), np.zeros_like(slope), slope, y[:-1]])
        case "akima":
            return akima_pieces(x, y)
        case "monotone":
            return monotone_pieces(x, y)
    from scipy.interpolate import CubicSpline

    if table.ends == "periodic":
        y = np.append(y[:-1], y[0])
    return np.asarray(CubicSpline(x, y, bc_type=table.ends or "natural").c)


def curve(table: Table) -> Curve:
    """Return a function of the table's values as computed by kernels: extrapolated linearly, or periodic."""
    data = spline_data(table)
    return lambda arguments: value_of(data, np.asarray(arguments, dtype=float))


def value_of(data: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the values of a table of `spline_data` at an array of arguments."""
    x, pieces = _taken_apart(data)
    if data[1]:
        at = x[0] + np.mod(at - x[0], x[-1] - x[0])
    inside = np.clip(at, x[0], x[-1])
    k = np.clip(np.searchsorted(x, inside, side="right") - 1, 0, len(x) - 2)
    a, b, c, d = np.moveaxis(pieces[k], -1, 0)
    h = inside - x[k]
    slope = (3 * a * h + 2 * b) * h + c
    return np.asarray(((a * h + b) * h + c) * h + d + slope * (at - inside))


def ends_of(data: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the knots of a table of `spline_data`, its values, and its slopes before and after each knot."""
    x, pieces = _taken_apart(data)
    h = np.diff(x)
    a, b, c, _ = pieces.T
    at_ends = (3 * a * h + 2 * b) * h + c
    periodic = bool(data[1])
    before = np.append(at_ends[-1] if periodic else c[0], at_ends)
    behind = np.append(c, c[0] if periodic else at_ends[-1])
    return x, value_of(data, x), before, behind


def parts_of(table: Table) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a table, and the coefficients of each piece, highest first."""
    return _taken_apart(spline_data(table))


def _taken_apart(data: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points, and the coefficients of each piece."""
    count = int(data[0])
    return data[2 : 2 + count], data[2 + count :].reshape(-1, 4)
