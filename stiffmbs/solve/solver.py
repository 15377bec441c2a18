"""What a solver is to the other packages: a function, and traits that it declares, so that none asks for its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from ..describe.settings import RunSettings
from .trajectory import Solver, Trajectory

FOR_ALL_SOLVERS = frozenset({"duration", "start", "output", "points", "solver", "presolve", "drop_first"})
"""Settings that are read before a solver begins; every other one is for the solvers that declare it."""


@dataclass(frozen=True)
class Traits:
    """What a solver, with its scheme or formulation, is like.

    Attributes
    ----------
    name : str
        What messages call it.
    reads : tuple of str
        The settings that it follows, besides those for all solvers.
    implicit : bool
        Whether it takes implicit steps; their dynamics leave out coordinates that others determine.
    fixed_steps : bool
        Whether all its steps have the length `step`, whatever the error.
    exact : bool
        Whether states follow from drives alone, exact but for rounding.
    locates_events : bool
        Whether it stops where a force changes its law, or has no need to.
    switches : bool
        Whether it goes from one integrator to another during a run.
    """

    name: str
    reads: tuple[str, ...] = ()
    implicit: bool = False
    fixed_steps: bool = False
    exact: bool = False
    locates_events: bool = True
    switches: bool = False

    def ignored(self, settings: RunSettings) -> dict[str, object]:
        """Settings that were given and that the solver does not read, with their values."""
        given = {
            name: getattr(settings, name) for name in RunSettings.model_fields if name in settings.model_fields_set
        }
        return {
            name: value
            for name, value in given.items()
            if value is not None and name not in FOR_ALL_SOLVERS and name not in self.reads
        }


class Registered(NamedTuple):
    """A solver by the name in the settings.

    Attributes
    ----------
    solve : Solver
    traits : callable
        Its traits with the scheme or formulation that the settings choose.
    """

    solve: Solver
    traits: Callable[[RunSettings], Traits]


def loaded_when_used(module: str, package: str) -> Registered:
    """The solver in a module of a package that has functions ``solve`` and ``traits``."""

    @cache
    def loaded() -> Any:
        return import_module(module, package)

    def solve(*asked: Any) -> Trajectory:
        found: Trajectory = loaded().solve(*asked)
        return found

    def traits(settings: RunSettings) -> Traits:
        found: Traits = loaded().traits(settings)
        return found

    return Registered(solve, traits)
