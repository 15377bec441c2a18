"""Deriving and compiling ahead what first runs would wait for."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from .. import compile as compile_package
from .. import solve as solve_package
from ..compile.compile_model import kinds_of
from ..compile.kernels import compile_usual
from ..compile.machine.routines import Routine
from .usual_elements import usual_elements


def warm() -> None:
    """Compile every kind of element in its usual forms, and the routines of all solvers.

    Formulas that stand in a scene make kinds of their own, which are compiled when they are first met, and so is what one
    formulation alone uses.
    """
    kinds = [kind for dimensions in (2, 3) for kind in kinds_of(usual_elements(dimensions).data())]
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as processes:
        list(processes.map(compile_usual, kinds))
    for routine in routines():
        routine.call  # noqa: B018 is loaded by being asked for


def routines() -> Iterator[Routine]:
    """Every compiled routine that a module of the package declares."""
    for package in (compile_package, solve_package):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if ".native." not in f"{module.name}.":
                found = vars(importlib.import_module(module.name)).values()
                yield from (value for value in found if isinstance(value, Routine))
