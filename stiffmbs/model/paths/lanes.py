"""Lanes of the standard lane changes, and the smoothest path through them.

ISO 3888-1:2018, Passenger cars, test track for a severe lane-change manoeuvre, part 1: double lane change, and ISO
3888-2:2011, part 2: obstacle avoidance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .curves import CURVES

ROUGHNESS = 30.0
"""Length below which a change of curvature costs more than curvature itself, m: steering stays below 1 Hz at 30 m/s."""
ANCHOR = 1e-3
"""Weight of the distance from the centre of a lane, 1/m^2, against that of curvature: it selects one of equal paths."""
USED = 0.5
"""Part of the free width of a lane on either side of the vehicle that its corners use at most; the rest is the driver's."""
LENGTH = 4.3
"""Length of a vehicle unless it is given, m: that of a compact car."""
STRAIGHT = 30.0
"""Distance from the last lane within which a path leads back to its centre line, m."""
MARGIN = 1e-9
"""Least square of the infeasibility, relative, above which lanes have no path."""


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
        return replace(self, start=self.start + x, end=self.end + x)


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


def path_through(
    lanes: tuple[Lane, ...], width: float, before: float, after: float, length: float = LENGTH
) -> np.ndarray:
    """Return points of the smoothest path of a vehicle's centre through lanes.

    The squares of the second and third derivatives of y(x) are minimal. The vehicle is a rectangle along the path, and
    uses part of the free width of each lane: its corners between the rows of cones, and its sides at their ends. Before the first and after the last lane their corridors continue. `width`, `length`: of the vehicle, m. `before`,
    `after`: distances before the first and after the last lane, m. The result of shape (n, 2): x and y, m.

    Raises ValueError if there is no such path.
    """
    first, last = lanes[0], lanes[-1]
    x = np.arange(first.start - before, last.end + after + CURVES.spacing / 2, CURVES.spacing)
    corridors = (
        replace(first, start=x[0] - length, end=first.start), *lanes, replace(last, start=last.end, end=x[-1] + length),
    )  # fmt: skip
    points, slopes = np.eye(len(x)), np.gradient(np.eye(len(x)), CURVES.spacing, axis=0)
    sides, low, high = [], [], []
    for lane in corridors:
        free = USED * max(lane.left - lane.right - width, 0.0) / 2
        ends = np.array([lane.start, lane.end])
        for k, at in enumerate(x):
            corners = at + np.array([-length / 2, length / 2])
            inside = corners[(corners >= lane.start) & (corners <= lane.end)]
            for place in (*inside, *ends[np.abs(ends - at) <= length / 2]):
                sides.append(points[k] + (place - at) * slopes[k])
                low.append(lane.centre - free)
                high.append(lane.centre + free)
    middles, centres = zip(*(((lane.start + lane.end) / 2, lane.centre) for lane in lanes), strict=True)
    centre = np.interp(x, middles, centres)
    bends = np.diff(points, 2, axis=0) / CURVES.spacing**2
    jerks = ROUGHNESS * np.diff(points, 3, axis=0) / CURVES.spacing**3
    rows = np.vstack([bends, jerks, ANCHOR * points])
    right = np.concatenate([np.zeros(len(bends) + len(jerks)), ANCHOR * centre])
    straight = (np.arange(len(x)) < 3) | (x > min(last.end + STRAIGHT, x[-3] - CURVES.spacing / 2))
    y = np.where(straight, np.where(x < first.end, first.centre, last.centre), 0.0)
    within = np.vstack([sides, -np.array(sides)])
    limits = np.concatenate([low, -np.array(high)]) - within @ y
    bending = np.any(within[:, ~straight], axis=1)
    found = _least_squares_within(rows[:, ~straight], right - rows @ y, within[bending][:, ~straight], limits[bending])
    if found is None:
        raise ValueError(
            f"found lanes too narrow for a vehicle of {width:g} m by {length:g} m, expected a shorter or narrower one"
        )
    y[~straight] = found
    return np.stack([x, y], axis=1)


def _least_squares_within(
    rows: np.ndarray, right: np.ndarray, within: np.ndarray, least: np.ndarray
) -> np.ndarray | None:
    """Return x of the least abs(rows x - right) with within x >= least; None if no x satisfies the inequalities.

    Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23: as a least-distance problem, by its dual.
    """
    from scipy.optimize import nnls

    q, r = np.linalg.qr(rows)
    offset = q.T @ right
    scaled = np.linalg.solve(r.T, within.T).T
    least = least - scaled @ offset
    size = np.linalg.norm(scaled, axis=1)
    dual = np.vstack([(scaled / size[:, None]).T, least / size])
    target = np.zeros(len(dual))
    target[-1] = 1.0
    left = dual @ nnls(dual, target, maxiter=100 * len(size))[0] - target
    if left @ left < MARGIN:
        return None
    return np.asarray(np.linalg.solve(r, offset - left[:-1] / left[-1]))
