"""A run that ends where a request comes to a value.

The whole time is solved once over the solver's own steps.  The first step in which a condition begins to hold is solved again, on
finer and finer points, until straight lines between them give the instant; then the run is solved up to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...describe.files.until import Until
from ...errors import InputError
from ...results.solution import Solution

POINTS, LEVELS = 33, 3
"""Points in a step that is looked at again, and how often: the last ones are 1/32768 of it apart."""
Run = Callable[..., Solution]
"""`stiffmbs.jobs.run.run` of one scene: takes changes of settings, and ``start_from``."""


@dataclass(frozen=True)
class Crossing:
    """Where a condition begins to hold: between two rows of a solution."""

    name: str
    before: int
    t: float


def run_until(
    run: Run, conditions: Mapping[str, Until], interval: float | None, **changes: Any
) -> tuple[Solution, str]:
    """Solve up to where the first condition begins to hold, or over the whole time.

    Parameters
    ----------
    run : callable
        Solves the scene.
    conditions : mapping of str to Until
    interval : float or None
        Between output points, s; None for the solver's own steps.
    **changes
        Of settings, and ``start_from``.

    Returns
    -------
    (Solution, str)
        And the name of the condition; empty where none begins to hold.

    Raises
    ------
    InputError
        When a condition names no request, or holds at the start.
    """
    whole = run(**{**changes, "points": "steps", "output": None})
    margins = {name: _margin_of(name, condition, whole) for name, condition in conditions.items()}
    for name, margin in margins.items():
        if margin(whole)[0] >= 0:
            raise InputError(
                f"'{name}': found its condition true where the run starts, at t = {whole.time[0]:.9g} s, expected it to come "
                "true on the way"
            )
    crossing = _first(margins, whole)
    if crossing is None:
        return run(**changes), ""
    found = whole
    start, end = float(whole.time[0]), crossing.t
    for _ in range(LEVELS):
        a, b = found.time[crossing.before], found.time[crossing.before + 1]
        state = found.state(at=float(a))
        fine = run(
            **{
                **changes,
                "start_from": state,
                "start": float(a),
                "duration": float(b - a),
                "points": POINTS,
                "output": None,
            }
        )
        nearer = _first({crossing.name: margins[crossing.name]}, fine)
        if nearer is None:  # it only comes true with the last digits of the longer run
            break
        found, crossing, end = fine, nearer, nearer.t
    grid = {"output": interval, "points": None} if interval else {}
    solution = run(**{**changes, "duration": end - start, **grid})
    if not solution.success:
        return solution, ""
    message = f"ended at t = {end:.9g} s by '{crossing.name}'"
    return replace(solution, message=message, notes=(*solution.notes, message)), crossing.name


def _margin_of(name: str, condition: Until, whole: Solution) -> Callable[[Solution], np.ndarray]:
    """What is below zero before a condition holds, over the rows of a solution."""
    channel = condition.request
    if channel not in whole:
        raise InputError(f"'{name}': found request = {channel}, expected the name of a request")
    if condition.at_least is not None:
        bound, sign = condition.at_least, 1.0
    elif condition.at_most is not None:
        bound, sign = condition.at_most, -1.0
    else:
        assert condition.equals is not None
        bound = condition.equals
        sign = 1.0 if whole[channel][0] < bound else -1.0
        past = sign * (whole[channel] - bound)
        near = condition.within if np.nanmax(past, initial=-np.inf) < 0 or past[0] >= -condition.within else 0.0
        return lambda solution: sign * (solution[channel] - bound) + near
    return lambda solution: sign * (solution[channel] - bound)


def _first(margins: Mapping[str, Callable[[Solution], np.ndarray]], solution: Solution) -> Crossing | None:
    """The first condition that begins to hold, and where straight lines between the rows put it."""
    found = None
    for name, margin in margins.items():
        values = margin(solution)
        holds = np.flatnonzero((values[1:] >= 0) & (np.diff(solution.time) > 0))
        if not len(holds):
            continue
        k = int(holds[0])
        before, after = values[k], values[k + 1]
        part = -before / (after - before) if before < 0 else 0.0
        t = float(solution.time[k] + part * (solution.time[k + 1] - solution.time[k]))
        if found is None or t < found.t:
            found = Crossing(name, k, t)
    return found
