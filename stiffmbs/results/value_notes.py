"""Notes on values of channels: without a number, or outside the valid ranges of the data, such as a tyre's load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from ..dynamics.dynamics import OutputRows
from ..dynamics.storage import with_gaps

ACTING = "load"
"""Channel that is zero if the element does not act; its other channels are then ignored."""
MOST_NAMED = 5
"""Number of channels, or cases of a study, that are named in messages; others are counted."""


def range_notes(
    ranges: Mapping[str, Mapping[str, tuple[float, float]]], series: Callable[[str], np.ndarray]
) -> Iterator[str]:
    """Yield a sentence for each element, with the extremes of its channels outside their ranges.

    `ranges`: valid ranges by element and channel. `series`: returns the values of a channel at the output times.
    """
    for name, of_element in ranges.items():
        acts = series(f"{name}.{ACTING}") > 0 if ACTING in of_element else slice(None)
        found = [
            sentence
            for channel, (low, high) in of_element.items()
            if (sentence := _beyond(channel, series(f"{name}.{channel}")[acts], low, high))
        ]
        if found:
            yield f"'{name}' leaves the valid ranges of its data: {', '.join(found)}"


def _beyond(channel: str, values: np.ndarray, low: float, high: float) -> str:
    """Return a clause with the extremes of a channel and its range, or an empty string within it."""
    values = values[np.isfinite(values)]
    if not len(values) or (low <= values.min() and values.max() <= high):
        return ""
    reached = [x for x, beyond in ((values.min(), values.min() < low), (values.max(), values.max() > high)) if beyond]
    return f"{channel} reaches {' and '.join(f'{x:.4g}' for x in reached)} (valid from {low:.4g} to {high:.4g})"


def undefined_values(rows: OutputRows, channels: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yield a sentence for each channel with NaN or infinite values at solved instants, and one for all beyond the first few."""
    solved = ~np.isnan(rows.position_violation)  # the other instants are reported as left out
    time = rows.t[solved]
    found = {name: ~np.isfinite(values[solved]) for name, values in with_gaps(channels).items()}
    found = {name: bad for name, bad in found.items() if np.any(bad)}
    for name in list(found)[:MOST_NAMED]:
        bad = found[name]
        first = float(time[np.argmax(bad)])
        yield f"{name} is no finite number at {np.count_nonzero(bad)} of {len(time)} output times, first at t = {first:.9g} s"
    if len(found) > MOST_NAMED:
        yield f"the same holds for {len(found) - MOST_NAMED} other channels"
