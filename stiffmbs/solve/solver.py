"""Solver interface: a function, and declared traits, on which callers depend in place of a solver's name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from ..model.settings import RunSettings
from .sampling import solved_between_samples
from .trajectory import Solver, Trajectory

FOR_ALL_SOLVERS = frozenset(
    {"duration", "start", "output", "points", "solver", "presolve", "drop_first", "errors", "accuracy", "tuning"}
)
"""Settings that are read before a solver begins; all others are read by the solvers that declare them."""


@dataclass(frozen=True)
class Traits:
    """Traits of a solver with its scheme or formulation.

    - `name`: name in messages.
    - `reads`: settings that it reads, in addition to those for all solvers.
    - `implicit`: true if it takes implicit steps; dependent coordinates are then eliminated from the dynamics.
    - `fixed_steps`: true if all steps have the length `step`, without error control; then `order` is that of the method.
    - `exact`: true if states follow from drives alone, exact apart from rounding.
    - `locates_events`: true if it stops at events of force laws, or does not need to.
    - `switches`: true if it switches between integrators during a run.
    """

    name: str
    reads: tuple[str, ...] = ()
    implicit: bool = False
    fixed_steps: bool = False
    order: int = 0
    exact: bool = False
    locates_events: bool = True
    switches: bool = False

    def ignored(self, settings: RunSettings) -> dict[str, object]:
        """Return the given settings that the solver does not read, with their values."""
        unread = settings.model_fields_set.difference(FOR_ALL_SOLVERS, self.reads)
        given = {name: getattr(settings, name) for name in RunSettings.model_fields if name in unread}
        return {name: value for name, value in given.items() if value is not None}


class Registered(NamedTuple):
    """Registered solver. `traits`: return the traits for the scheme or formulation in the settings."""

    solve: Solver
    traits: Callable[[RunSettings], Traits]


def loaded_when_used(module: str, package: str, known: Callable[[RunSettings], Traits] | None = None) -> Registered:
    """Return the solver in a module with functions ``solve`` and ``traits``, imported at its first call.

    `known`: function for the traits that need not import the module.
    """

    @cache
    def loaded() -> Any:
        return import_module(module, package)

    def solve(*asked: Any) -> Trajectory:
        return solved_between_samples(loaded().solve, *asked)

    def traits(settings: RunSettings) -> Traits:
        found: Traits = loaded().traits(settings)
        return found

    return Registered(solve, known or traits)
