"""Interpretation of run settings: solver traits, output grid, presolve, and settings without effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..compile.law_intervals import has_kinks
from ..compile.system import System
from ..model.settings import DEFAULT_POINTS, RunSettings
from ..notes import Note, NoteKind, Severity
from ..tuning import changes_in_use
from . import SOLVERS
from .solver import Traits
from .trajectory import Grid


def traits_of(settings: RunSettings) -> Traits:
    """Return the traits of the solver that the settings choose."""
    return SOLVERS[settings.solver].traits(settings)


def may_presolve(settings: RunSettings) -> bool:
    """Return True if presolve is on and keeps the results: not for exact, fixed-step or unprojected solvers."""
    return settings.presolve and not traits_of(settings).exact and near_constraints(settings)


def near_constraints(settings: RunSettings) -> bool:
    """Return True if states satisfy the constraints to tolerance: not with fixed steps or without projection."""
    traits = traits_of(settings)
    return not traits.fixed_steps and (settings.projection or "projection" not in traits.reads)


def changed(settings: RunSettings, changes: dict[str, Any]) -> RunSettings:
    """Return the settings with some fields changed, validated as a whole.

    Raises InputError when a field is unknown or its value out of bounds.
    """
    if not changes:
        return settings
    kept = {name: getattr(settings, name) for name in settings.model_fields_set}
    if {"output", "points"} & changes.keys():
        kept = {name: value for name, value in kept.items() if name not in ("output", "points")}
    return RunSettings(**{**kept, **changes})


def output_grid(settings: RunSettings) -> Grid:
    """Return the output times of the settings, including both ends."""
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


TUNED = NoteKind("tuning", "run.tuning changes parameters of solvers or checks: {changes}", severity=Severity.REMARK)
NOT_LOCATED = NoteKind(
    "breakpoints-not-located",
    "{solver} does not locate breakpoints of forces (contacts, step, abs, tables), and steps of {step:g} s may miss them; "
    "{remedy}",
    "dopri5, dop853, radau and bdf locate them",
)
IGNORED = NoteKind("setting-ignored", "{settings} no effect: {solver} {reads}", severity=Severity.REMARK)


def settings_notes(settings: RunSettings, system: System) -> Iterator[Note]:
    """Yield notes on settings without effect and on events that steps may miss."""
    traits = traits_of(settings)
    yield from _ignored(settings, traits)
    if changes := ", ".join(changes_in_use()):
        yield TUNED(changes=changes)
    if misses_breakpoints(settings, system):
        yield NOT_LOCATED(solver=traits.name, step=settings.step)


def misses_breakpoints(settings: RunSettings, system: System) -> bool:
    """Return True if a system has breakpoints of forces which the solver's steps do not locate."""
    return not traits_of(settings).locates_events and has_kinks(system)


def _ignored(settings: RunSettings, traits: Traits) -> Iterator[Note]:
    ignored = traits.ignored(settings)
    if ignored:
        given = [f"{name} = {f'{value:g}' if isinstance(value, float) else value}" for name, value in ignored.items()]
        reads = f"reads {_listed(traits.reads)}" if traits.reads else "uses the drives alone"
        yield IGNORED(
            settings=f"{_listed(given)} {'has' if len(given) == 1 else 'have'}", solver=traits.name, reads=reads
        )


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
