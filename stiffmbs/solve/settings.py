"""What the settings of a run mean for it: the solver's traits, the instants to report, what its states are good for, what is asked in vain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..compile.system import System
from ..describe.settings import RunSettings
from . import SOLVERS
from .solver import Traits
from .trajectory import Grid

DEFAULT_POINTS = 1001


def traits_of(settings: RunSettings) -> Traits:
    """The traits of the solver that the settings choose."""
    return SOLVERS[settings.solver].traits(settings)


def may_presolve(settings: RunSettings) -> bool:
    """Whether a smaller problem has the same results: explicit steps of fixed length and drifts are shown as they are."""
    return settings.presolve and not traits_of(settings).exact and near_constraints(settings)


def near_constraints(settings: RunSettings) -> bool:
    """Whether states are on the constraints but for the tolerance; those of explicit fixed steps are shown as they are."""
    traits = traits_of(settings)
    return not traits.fixed_steps and (settings.projection or "projection" not in traits.reads)


def changed(settings: RunSettings, changes: dict[str, Any]) -> RunSettings:
    """The settings with some fields changed, checked as a whole.

    Raises
    ------
    InputError
        When a field is unknown or its value out of bounds.
    """
    if not changes:
        return settings
    kept = {name: getattr(settings, name) for name in settings.model_fields_set}
    if {"output", "points"} & changes.keys():
        kept = {name: value for name, value in kept.items() if name not in ("output", "points")}
    return RunSettings(**{**kept, **changes})


def output_grid(settings: RunSettings) -> Grid:
    """The instants to report, from the settings: ends included."""
    start, end = settings.start, settings.start + settings.duration
    if settings.points == "steps":
        return Grid(start, end, None)
    if settings.output is not None:
        count = int(np.floor(settings.duration / settings.output * (1 + 1e-12))) + 1
        times = start + settings.output * np.arange(count)
        whole = count > 1 and end - times[-1] <= 1e-9 * settings.output
        times = np.append(times[:-1] if whole else times, end)
        return Grid(start, end, times)
    points = settings.points if isinstance(settings.points, int) else DEFAULT_POINTS
    return Grid(start, end, np.linspace(start, end, points))


def settings_notes(settings: RunSettings, system: System) -> Iterator[str]:
    """Settings that were given and have no effect, and events that the steps may pass over."""
    traits = traits_of(settings)
    yield from _ignored(settings, traits)
    if not traits.locates_events and system.n_values("event_function"):
        yield (
            f"{traits.name} does not locate the breakpoints that forces have in the state (contacts, step, abs, tables), and a step of "
            f"{settings.step:g} s may pass over them; dopri5, dop853 and bdf see them"
        )


def _ignored(settings: RunSettings, traits: Traits) -> Iterator[str]:
    ignored = traits.ignored(settings)
    if ignored:
        given = [f"{name} = {f'{value:g}' if isinstance(value, float) else value}" for name, value in ignored.items()]
        reads = f"reads {_listed(traits.reads)}" if traits.reads else "follows the drives alone"
        yield f"{_listed(given)} {'has' if len(given) == 1 else 'have'} no effect: {traits.name} {reads}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
