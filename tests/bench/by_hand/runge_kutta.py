"""The classical Runge-Kutta method with short steps of one length: a reference where stiffness is high."""

from __future__ import annotations

import numpy as np

from .half_car import minimal
from .loop import fast


@fast
def half_car_rows(y, times, parts, k, c):
    """Rows of the half car's coordinates and velocities at evenly spaced times, so many steps between two."""
    h = (times[1] - times[0]) / parts
    rows = np.empty((len(times), len(y)))
    rows[0] = y
    for row in range(1, len(times)):
        for part in range(parts):
            t = times[row - 1] + part * h
            first = minimal(t, y, k, c)
            second = minimal(t + h / 2, y + h / 2 * first, k, c)
            third = minimal(t + h / 2, y + h / 2 * second, k, c)
            fourth = minimal(t + h, y + h * third, k, c)
            y = y + h / 6 * (first + 2 * second + 2 * third + fourth)
        rows[row] = y
    return rows
