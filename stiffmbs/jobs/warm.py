"""Deriving and compiling ahead what first runs would wait for."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from .. import compile as compile_package
from .. import solve as solve_package
from ..compile.compile_model import kinds_of
from ..compile.kernels import compile_usual
from ..compile.machine.routines import Routine
from .load_scene import load_scene

USUAL = {
    dimensions: Path(__file__).with_name(name)
    for dimensions, name in ((2, "usual_elements.yaml"), (3, "usual_spatial_elements.yaml"))
}
"""Scenes of all kinds of elements in the forms in which they are mostly used, by their dimensions."""


def warm() -> None:
    """Compile every kind of element in its usual forms, and the routines of all solvers.

    Formulas that stand in a scene make kinds of their own, which are compiled when they are first met, and so is what one
    formulation alone uses.
    """
    kinds = [kind for path in USUAL.values() for kind in kinds_of(load_scene(path))]
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as processes:
        list(processes.map(compile_usual, kinds))
    for routine in routines():
        routine.load()


def routines() -> Iterator[Routine]:
    """Every compiled routine that a module of the package declares."""
    for package in (compile_package, solve_package):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if ".native." not in f"{module.name}.":
                found = vars(importlib.import_module(module.name)).values()
                yield from (value for value in found if isinstance(value, Routine))
