"""Figure of a scene as charts of a page: one for each unit, in the display units of the run."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..model.scene import Figure
from ..reading.units.quantity import LARGEST
from ..results.displayed import displayed
from ..results.solution import Solution
from .curves import Curve, curve_chart
from .loads_shown import MOST_CURVES, Chart


def is_charted(figure: Figure) -> bool:
    """Return True if a figure can be drawn by charts: no path in space, no equal scales."""
    return not figure.z and not figure.equal


def figure_charts(solution: Solution, figure: Figure) -> Iterator[Chart]:
    """Yield the charts of a figure: channels of one unit over time or over another channel, a few in each chart.

    Raises InputError if there is no such channel.
    """
    run = displayed(solution)
    x = run.time if figure.x == "time" else _known(run[figure.x])
    of_unit: dict[str, list[str]] = {}
    for channel in figure.y:
        of_unit.setdefault(run.unit(channel), []).append(channel)
    for unit, channels in of_unit.items():
        for first in range(0, len(channels), MOST_CURVES):
            names = channels[first : first + MOST_CURVES]
            quantity = names[0] if len(names) == 1 else figure.title or "channels"
            curves = [Curve(name, x, _known(run[name])) for name in names]
            yield Chart(
                curve_chart(
                    curves, _labelled(quantity, unit), _labelled(figure.x, run.unit(figure.x)), from_zero=False
                ),
                tuple(names),
            )


def _known(values: np.ndarray) -> np.ndarray:
    """Return values without those of a diverged run."""
    return np.where(np.abs(values) < LARGEST, values, np.nan)


def _labelled(quantity: str, unit: str) -> str:
    return f"{quantity}, {unit}" if unit else quantity
