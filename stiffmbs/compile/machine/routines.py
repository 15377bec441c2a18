"""Compiled routines of the native modules, by name and signature."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from ...tuning import parameters_are_changed, values_in
from . import drafts
from .compiler import compiled_routines, compiled_source
from .linking import Compiled, Signatures
from .object_code import FULL

Unit: TypeAlias = tuple[str, Signatures, bool, int]
"""Module and functions that are compiled together, with their settings (`Routine`)."""
_ROOMS = ("compile", "dynamics", "solve", "sensitivity_equations", "results", "run_checks")
"""Packages whose modules declare routines."""


@dataclass(frozen=True)
class Routine:
    """Function of a ``native`` module, compiled or loaded from the cache on first use.

    `others`: functions of the module compiled with it, because they share most of their code. `unrolled`: true if its
    loops are unrolled, which pays for solutions with dense blocks. `level`: `SHORT` if calls are too rare, or too
    short next to the kernels they call, for LLVM's usual passes.
    """

    module: str
    name: str
    signature: str
    others: Signatures = ()
    unrolled: bool = False
    level: int = FULL

    @property
    def call(self) -> Callable[..., Any]:
        """Function for calls from Python; pointers are passed as addresses."""
        return self.compiled.call

    @property
    def short_call(self) -> Callable[..., Any]:
        """Function for calls of a few microseconds, which keep the interpreter lock."""
        return self.compiled.short_call

    @property
    def address(self) -> int:
        """Address for calls from compiled code."""
        return self.compiled.address

    @property
    def compiled(self) -> Compiled:
        """The compiled function, with the unit that it belongs to."""
        return self._changed if parameters_are_changed() else self._usual

    @cached_property
    def _usual(self) -> Compiled:
        _loaded.append(self)
        return self._with("")

    @property
    def _changed(self) -> Compiled:
        return self._with(values_in(self.module))

    def _with(self, changed: str) -> Compiled:
        """Return the function compiled with the parameters in use; `changed` are those that are not the default."""
        return compiled_routines(*self.unit, changed)[self.name]

    @property
    def unit(self) -> Unit:
        """Module and functions that are compiled together, with their settings."""
        return self.module, tuple(sorted(((self.name, self.signature), *self.others))), self.unrolled, self.level


def units() -> tuple[Unit, ...]:
    """Return all units of routines that modules of the package declare, which are imported."""
    package = __package__.partition(".")[0]
    found: dict[Unit, None] = {}
    for room in _ROOMS:
        folder = importlib.import_module(f"{package}.{room}").__path__
        for module in pkgutil.walk_packages(folder, f"{package}.{room}."):
            if ".native." not in f"{module.name}.":
                declared = vars(importlib.import_module(module.name)).values()
                found |= {value.unit: None for value in declared if isinstance(value, Routine)}
    return tuple(found)


_loaded: list[Routine] = []
"""Routines that this process has loaded."""


@contextmanager
def fully_compiled() -> Iterator[None]:
    """Compile all code that is asked for within a context at its full level: for long runs, and for times of runs."""
    with drafts.down_to(drafts.Tier.NATIVE):
        if drafts.are_used():
            forget()
        yield


@fully_compiled()
def compile_unit(unit: Unit) -> None:
    """Compile and cache routines that are compiled together."""
    compiled_routines(*unit, "")


@contextmanager
def on_drafts() -> Iterator[None]:
    """Use drafts for code that is compiled for the first time within a context: for what ends soon, or notes that it does not."""
    is_timed = drafts.tier() == drafts.Tier.NATIVE
    with drafts.down_to(drafts.Tier.NATIVE if is_timed else drafts.Tier.DRAFT):
        yield


def renew() -> None:
    """Look for all compiled functions again, if drafts in use were finished since, or are not for this context."""
    are_for_others = drafts.tier() < drafts.Tier.DRAFT and drafts.quick_ones_are_used()
    if drafts.some_are_finished() or are_for_others:
        forget()


def forget() -> None:
    """Forget which functions are loaded, so that the next lookups find what was compiled since."""
    compiled_source.cache_clear()
    compiled_routines.cache_clear()
    with suppress(IndexError):  # when none is left, also because another thread forgets them at the same time
        while True:
            vars(_loaded.pop()).pop("_usual", None)


def together(module: str, level: int = FULL, **signatures: str) -> tuple[Routine, ...]:
    """Return functions of one native module that are compiled together."""
    return tuple(
        Routine(module, name, signature, tuple(other for other in signatures.items() if other[0] != name), level=level)
        for name, signature in signatures.items()
    )


TERMS = Routine("stiffmbs.compile.machine.native.evaluate", "terms", "void(float64, int64, int64*)")
