"""Notes on channels without a value at some output times, as of a request that divides by zero."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

MOST_NAMED = 5


def no_number_sentences(time: np.ndarray, channels: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yield a sentence for each channel with NaN or infinite values, and one for all beyond the first few.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Times, s.
    channels : mapping of str to ndarray, shape (n,)
    """
    found = {name: ~np.isfinite(values) for name, values in channels.items()}
    found = {name: bad for name, bad in found.items() if np.any(bad)}
    for name in list(found)[:MOST_NAMED]:
        bad = found[name]
        first = float(time[np.argmax(bad)])
        yield f"{name} is no finite number at {np.count_nonzero(bad)} of {len(time)} output times, first at t = {first:.9g} s"
    if len(found) > MOST_NAMED:
        yield f"the same holds for {len(found) - MOST_NAMED} other channels"
