"""Plot of a solver's own steps: their length, and their order if it varies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..solve.trajectory import History
from .style import COLORS, dress

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


def step_history(history: History) -> Sheet:
    """Plot the step length over time on a logarithmic axis, and below it the order if known."""
    from matplotlib.figure import Figure as Sheet

    told = len(history.order) == len(history.t)
    sheet = Sheet(figsize=(8, 5 if told else 3), layout="constrained")
    lengths = np.diff(history.t)
    rows = sheet.subplots(2 if told else 1, sharex=True, squeeze=False, height_ratios=[2, 1] if told else None)[:, 0]
    shown = lengths > 0
    rows[0].plot(history.t[1:][shown], lengths[shown], ".", color=COLORS[0], markersize=2)
    rows[0].set_yscale("log")
    rows[0].set_ylabel("step (s)")
    rows[0].set_title("steps of the solver")
    if told:
        rows[1].plot(history.t, history.order, ".", color=COLORS[0], markersize=2)
        rows[1].set_ylabel("order")
    rows[-1].set_xlabel("time (s)")
    for axes in rows:
        dress(axes)
    return sheet
