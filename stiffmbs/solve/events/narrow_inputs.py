"""Ends of inputs within a run, and warnings on features shorter than fixed steps or than the output spacing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...compile.inputs.features import INSTANTS, InputFeatures
from ...compile.inputs.of_time import Input
from ...dynamics.dynamics import Dynamics
from ...tuning import tuned
from ..trajectory import Grid, Outcome, Trajectory
from .native.parameters import SEARCH


@dataclass(frozen=True)
class NarrowInputParameters:
    """Parameters of the warnings on narrow features of inputs."""

    hidden: float = 0.05
    """Height of a peak between output times, relative to the input's change, above which it is reported."""
    most_samples: int = 5000
    """Samples in all narrow features of inputs."""


NARROW_INPUTS = tuned("narrow_inputs", NarrowInputParameters())


def narrower_than(features: InputFeatures, length: float, what: str) -> str:
    """Return a sentence on features shorter than a length, s, of which `what` tells what follows; empty if there are none."""
    narrowest, t = features.narrowest()
    if narrowest >= length:
        return ""
    return f"a prescribed motion or force has a feature of {narrowest:.2g} s at t = {t:.6g} s, shorter than the {what}"


def hidden_peak(inputs: Sequence[Input], features: InputFeatures, times: np.ndarray) -> str:
    """Return a sentence on an input with a peak between output times; empty if there is none."""
    parts = times[:-1, None] + np.diff(times)[:, None] * np.arange(INSTANTS) / INSTANTS
    narrow = features.instants(
        times[0], times[-1], float(np.max(np.diff(times), initial=0.0)), NARROW_INPUTS.most_samples
    )
    between = np.concatenate([parts.ravel(), narrow, features.breakpoints])
    for given in inputs if len(between) else ():
        with np.errstate(all="ignore"):
            shown, values = given.at(times), given.at(between)
        if not (np.isfinite(shown).all() and np.isfinite(values).all()):
            continue
        low, high = np.min(shown), np.max(shown)
        change, size = max(high, np.max(values)) - min(low, np.min(values)), np.max(np.abs(values))
        beyond = np.maximum(values - high, low - values)
        k = int(np.argmax(beyond))
        if beyond[k] > NARROW_INPUTS.hidden * change and change > SEARCH.precision * size:
            return (
                f"'{given.text}' has a peak of {values[k]:.3g} at t = {between[k]:.6g} s, between output times, where "
                f"it is between {low:.3g} and {high:.3g}: use a shorter output interval or --verify"
            )
    return ""


NEAR_INPUT_END = 1e-3
"""Fraction of the run before the end of an input in which a solver that stops is assumed to stop at that end."""


def solve_up_to_the_inputs_end(dynamics: Dynamics, grid: Grid, solve: Callable[[Grid], Trajectory]) -> Trajectory:
    """Solve over a grid, or up to the first end of an input.

    `dynamics`: dynamics of the whole system. `grid`: grid of the whole run. `solve`: returns the trajectory over a
    grid.
    """
    end = dynamics.input_end(grid.start, grid.end)
    if end is None:
        return solve(grid)
    # values of the input still have their precision up to there
    found = solve(grid.up_to(max(end.t - end.near, 0.5 * (grid.start + end.t))))
    own_end = found.outcome is Outcome.INTERRUPTED or (
        found.outcome is Outcome.STOPPED and end.t - _reached(found) > NEAR_INPUT_END * (grid.end - grid.start)
    )
    return found if own_end else replace(found, outcome=Outcome.STOPPED, message=end.sentence())


def _reached(found: Trajectory) -> float:
    return float(max(found.t[-1], found.step_times[-1] if len(found.step_times) else found.t[-1]))
