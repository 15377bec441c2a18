"""The rolling-radius filter: the heights that a disc rolls on.

A rigid disc of radius R on a profile h has its centre at the height max over s of h(x + s) + sqrt(R^2 - s^2); R less is the height
that a tyre with a single point of contact sees.  What is narrower than the disc is bridged, and a step rises as a circle.
Captain, Boghani, Wormley, Analytical tire models for dynamic vehicle simulation, Vehicle System Dynamics 8 (1979) 1-32.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from ...errors import InputError
from ..table import Table

if TYPE_CHECKING:
    import numpy as np

FINE = 50
"""Points on a radius: the heights are then exact to R/20000."""
MOST = 40000
"""Points of a profile."""


def through_filter(table: Table, radius: float | None) -> Table:
    """The heights that a disc of a radius rolls on; the profile itself without one."""
    return table if radius is None else rolled(table, radius)


@lru_cache(maxsize=64)
def rolled(table: Table, radius: float) -> Table:
    """The heights over x that a disc rolls on.

    Raises
    ------
    InputError
        When the profile is longer than 800 radii.
    """
    import numpy as np
    from scipy.ndimage import grey_dilation

    first, last = table.table[0][0], table.table[-1][0]
    count = int(np.ceil((last - first) / radius * FINE))
    if count > MOST:
        raise InputError(
            f"found a road of {last - first:g} m and a filter's radius of {radius:g} m, expected a road of at most "
            f"{MOST // FINE} radii"
        )
    x, step = np.linspace(first, last, max(count, 2) + 1, retstep=True)
    margin = int(np.floor(radius / step))
    beside = step * np.arange(1, margin + 1)
    heights = _heights(table, np.concatenate([first - beside[::-1], x, last + beside]))
    disc = _disc(step * np.arange(-margin, margin + 1), radius)
    centre = grey_dilation(heights, footprint=np.ones(len(disc)), structure=disc, mode="nearest")[
        margin : margin + len(x)
    ]
    _take_in(centre, x, np.array(table.table), radius)
    if table.ends == "periodic":
        centre[-1] = centre[0]
    rows = zip(x.tolist(), (centre - radius).tolist(), strict=True)
    periodic = table.ends == "periodic"
    return Table.model_construct(
        table=tuple(rows), ends="periodic" if periodic else "natural", lines=False, akima=not periodic
    )


def _take_in(centre: np.ndarray, x: np.ndarray, points: np.ndarray, radius: float) -> None:
    """Raise the centre of the disc where a point of the table touches it, as between samples the edge of a kerb does."""
    import numpy as np

    ends = np.searchsorted(x, points[:, :1] + np.array([-radius, radius]))
    for (at, height), (begin, end) in zip(points, ends, strict=True):
        np.maximum(centre[begin:end], height + _disc(x[begin:end] - at, radius), out=centre[begin:end])


def _heights(table: Table, x: np.ndarray) -> np.ndarray:
    """The profile, which goes on straight or repeats as in the equations."""
    import numpy as np
    from scipy.interpolate import Akima1DInterpolator, CubicSpline

    at, heights = np.array(table.table).T
    if table.ends == "periodic":
        x = at[0] + np.mod(x - at[0], at[-1] - at[0])
        heights = np.append(heights[:-1], heights[0])
    inside = np.clip(x, at[0], at[-1])
    if table.lines:
        slope = np.diff(heights) / np.diff(at)
        ends = np.where(x < at[0], slope[0], slope[-1])
        return np.interp(inside, at, heights) + ends * (x - inside)
    found = Akima1DInterpolator(at, heights) if table.akima else CubicSpline(at, heights, bc_type=table.ends)
    return np.asarray(found(inside) + found(inside, 1) * (x - inside))


def _disc(s: np.ndarray, radius: float) -> np.ndarray:
    import numpy as np

    return np.sqrt(np.maximum(radius**2 - s**2, 0.0))
