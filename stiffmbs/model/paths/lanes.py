"""Lanes of the standard lane changes, and the smoothest path through them.

ISO 3888-1:2018, Passenger cars, test track for a severe lane-change manoeuvre, part 1: double lane change, and ISO
3888-2:2011, part 2: obstacle avoidance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .curves import SPACING

ROUGHNESS = 30.0
"""Length below which a change of curvature costs more than curvature itself, m: steering stays below 1 Hz at 30 m/s."""
ANCHOR = 1e-3
"""Weight of the distance from the centre of a lane, 1/m^2, against that of curvature: it selects one of equal paths."""
USED = 0.3
"""Part of the free width of a lane that a path uses at most on either side of the centre."""


@dataclass(frozen=True)
class Lane:
    """Straight lane between two rows of cones. `start`, `end`: along x, m. `right`, `left`: boundaries along y, m."""

    start: float
    end: float
    right: float
    left: float

    @property
    def centre(self) -> float:
        """Return y of the centre line, m."""
        return (self.right + self.left) / 2

    def shifted(self, x: float) -> Lane:
        """Return the lane moved along x, m."""
        return Lane(self.start + x, self.end + x, self.right, self.left)


def iso3888_1(width: float, offset: float = 3.5) -> tuple[Lane, ...]:
    """Return the lanes of the double lane change of ISO 3888-1, from x = 0, with the second one to the left.

    `width`: width of the vehicle without mirrors, m. `offset`: distance between the centre lines, m.
    """
    rows = ((0.0, 15.0, 1.1, 0.0), (45.0, 70.0, 1.2, offset), (95.0, 125.0, 1.3, 0.0))
    return tuple(_lane(start, end, centre, factor * width + 0.25) for start, end, factor, centre in rows)


def iso3888_2(width: float) -> tuple[Lane, ...]:
    """Return the lanes of the obstacle avoidance of ISO 3888-2, from x = 0; the second one is 1 m to the left.

    `width`: width of the vehicle without mirrors, m.
    """
    first, second, third = 1.1 * width + 0.25, width + 1.0, max(1.3 * width + 0.25, 3.0)
    avoiding = first / 2 + 1.0 + second / 2
    last = third / 2 - first / 2  # the right boundaries of the first and the third lane are in line
    return (_lane(0.0, 12.0, 0.0, first), _lane(25.5, 36.5, avoiding, second), _lane(49.0, 61.0, last, third))


STANDARDS = {"iso3888-1": iso3888_1, "iso3888-2": iso3888_2}
"""Lanes by the name of their standard."""


def _lane(start: float, end: float, centre: float, width: float) -> Lane:
    return Lane(start, end, centre - width / 2, centre + width / 2)


def path_through(lanes: tuple[Lane, ...], width: float, before: float, after: float) -> np.ndarray:
    """Return points of the smoothest path of a vehicle's centre through lanes.

    The squares of the second and third derivatives of y(x) are minimal, while the vehicle stays within part of the free
    width of each lane. `width`: width of the vehicle, m. `before`, `after`: straight distances before the first and
    after the last lane, m. The result of shape (n, 2): x and y, m.
    """
    from scipy.optimize import lsq_linear

    first, last = lanes[0], lanes[-1]
    x = np.arange(first.start - before, last.end + after + SPACING / 2, SPACING)
    centre, free = np.full((2, len(x)), np.nan)
    for lane in lanes:
        inside = (x >= lane.start - SPACING / 2) & (x <= lane.end + SPACING / 2)
        centre[inside], free[inside] = lane.centre, USED * max(lane.left - lane.right - width, 0.0)
    for outside, lane in ((x < first.start, first), (x > last.end, last)):
        centre[outside], free[outside] = lane.centre, np.inf
    between = np.isnan(centre)
    wide = np.where(np.isfinite(free), free, np.inf) + 1e-6
    centre = np.where(between, np.interp(x, x[~between], centre[~between]), centre)
    wide[[0, 1, 2, -3, -2, -1]] = 1e-6  # straight at both ends
    bends = np.diff(np.eye(len(x)), 2, axis=0) / SPACING**2
    jerks = ROUGHNESS * np.diff(np.eye(len(x)), 3, axis=0) / SPACING**3
    rows = np.vstack([bends, jerks, ANCHOR * np.eye(len(x))])
    found = lsq_linear(rows, _right(rows, centre), (-wide, wide), tol=1e-12)
    return np.stack([x, centre + found.x], axis=1)


def _right(rows: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return the right sides for displacements from the centre: curvature of the whole path, and no displacement."""
    right = -rows @ centre
    right[-len(centre) :] = 0.0
    return right
