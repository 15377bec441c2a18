"""What a run examines at its output instants, by compiled loops over the rows."""

from __future__ import annotations

import numpy as np

from ..compile.machine.routines import together

ENERGIES, CONTRADICTING_ROWS, WORK, STEPS_INSIDE = together(
    "stiffmbs.solve.native.output_rows",
    energies="void(int64, int64, float64*, float64*, int64, float64*, int64, int64*, int64, int64*, float64*, float64*, float64*)",
    contradicting_rows="int64(int64, int64, float64*, float64*, float64*, float64*, float64, int64*)",
    work="float64(int64, float64*, float64*, float64*, float64*)",
    steps_inside="void(int64, float64*, int64, float64*, int64*)",
)


def write_energies(
    motion: tuple[np.ndarray, np.ndarray],
    terms: tuple[np.ndarray, np.ndarray, np.ndarray],
    into: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> None:
    """Write kinetic and potential energies, J, and powers, W, of rows.

    Parameters
    ----------
    motion : tuple of ndarrays, shapes (n, n_u), (n_u,)
        Velocities and masses.
    terms : tuple of ndarrays
        Values of output terms, shape (n, values), and which of these are potentials and powers.
    into : tuple of ndarrays, shape (n,)
    """
    (u, mass), (values, potential, power) = motion, terms
    ENERGIES.call(
        len(u), len(mass), u.ctypes.data, mass.ctypes.data, values.shape[1], values.ctypes.data,
        len(potential), potential.ctypes.data, len(power), power.ctypes.data, *(array.ctypes.data for array in into),
    )  # fmt: skip


def contradicting_rows(
    t: np.ndarray, u: np.ndarray, acceleration: np.ndarray, mass: np.ndarray, part: float
) -> np.ndarray:
    """Numbers of the rows of which the change of velocities until the next differs from the mean of their accelerations.

    Parameters
    ----------
    t, u, acceleration : ndarrays, shapes (n,), (n, n_u), (n, n_u)
    mass : ndarray, shape (n_u,)
        Weights.
    part : float
        Of the larger acceleration, that is exceeded.
    """
    found = np.empty(len(t), dtype=np.int64)
    arrays = [np.ascontiguousarray(array) for array in (t, u, acceleration, mass)]
    count = CONTRADICTING_ROWS.call(
        len(t), len(mass), *(array.ctypes.data for array in arrays), part, found.ctypes.data
    )
    return found[:count]


def work_since_start(t: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The integral of a power by the trapezoidal rule with end corrections.

    Davis and Rabinowitz, Methods of Numerical Integration (1984), sec. 2.9.

    Parameters
    ----------
    t, power : ndarrays, shape (n,)
        s, W; n is 1 or more.

    Returns
    -------
    work : ndarray, shape (n,)
        J.
    within : ndarray, shape (n - 1,)
        What the corrections add in each interval, J.
    resolved : float
        How far the work is from that of every other instant, J.
    """
    t, power = np.ascontiguousarray(t), np.ascontiguousarray(power)
    total, within = np.empty(len(t)), np.empty(len(t) - 1)
    resolved = WORK.call(len(t), *(array.ctypes.data for array in (t, power, total, within)))
    return total, within, resolved


def steps_inside(t: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """How many of increasing steps end inside each interval between increasing instants, its ends left out; shape (n - 1,)."""
    t, steps = np.ascontiguousarray(t), np.ascontiguousarray(steps, dtype=float)
    inside = np.empty(max(len(t) - 1, 0), dtype=np.int64)
    STEPS_INSIDE.call(len(t), t.ctypes.data, len(steps), steps.ctypes.data, inside.ctypes.data)
    return inside
