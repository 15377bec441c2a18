"""Derivation and compilation ahead of first runs."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from ..compile.compile_model import kinds_of
from ..compile.kind import Kind
from ..compile.machine.routines import Routine
from ..compile.record import compile_usual
from ..presolve.spinning_bodies import AXES, SpinningBodies
from .usual_elements import usual_bearings, usual_elements


def warm() -> None:
    """Compile all kinds of elements in their usual forms, bearings of spinning bodies, and the routines of all solvers.

    Formulas in a scene form kinds of their own, which are compiled on first use, like code that a single formulation
    uses.
    """
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as processes:
        list(processes.map(compile_usual, usual_kinds()))
    for routine in routines():
        routine.call  # noqa: B018 is loaded by being asked for


def usual_kinds() -> tuple[Kind, ...]:
    """Return the usual kinds of elements, and joints of bodies whose quaternions do not follow their spin."""
    models = [usual_elements(dimensions).data() for dimensions in (2, 3)]
    spun = [SpinningBodies(usual_bearings().data(), {"a": axis}) for axis in AXES]
    return tuple(dict.fromkeys(kind for model in (*models, *spun) for kind in kinds_of(model)))


def routines() -> Iterator[Routine]:
    """Yield every compiled routine that a module of the package declares."""
    for name in ("compile", "dynamics", "solve", "sensitivity_equations", "results", "run_checks"):
        package = importlib.import_module(f"stiffmbs.{name}")
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if ".native." not in f"{module.name}.":
                found = vars(importlib.import_module(module.name)).values()
                yield from (value for value in found if isinstance(value, Routine))
