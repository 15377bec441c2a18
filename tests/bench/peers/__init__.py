"""Other tools on the same problems, each as its own user would write them: a file or folder for each tool.

It has ``contestants(task)``.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator

from ..contestant import Contestant
from ..task import Task
from .flexible.tasks import HungBeam, HungBody
from .mounted.mounted import Shaken
from .trees.tree import Tree

IN_THE_PLANE = ("scipy", "casadi", "exudyn", "chapter")
TREES_IN_SPACE = ("exudyn", "mujoco", "pinocchio", "casadi")
ON_BUSHINGS = ("casadi", "exudyn")
FLEXIBLE = ("exudyn",)
PACKAGES = ("exudyn", "casadi", "mujoco", "pinocchio")
"""Of the extra ``peers``, as they are imported: what this package itself does not need; Pinocchio is ``pin`` on PyPI."""


def missing() -> tuple[str, ...]:
    """Packages of the extra ``peers`` that are not installed."""
    return tuple(package for package in PACKAGES if importlib.util.find_spec(package) is None)


def peers(task: Task | Tree | Shaken | HungBeam | HungBody) -> Iterator[Contestant]:
    """All tools that are installed, on a problem."""
    package, tools = _tools(task)
    for name in tools:
        if name not in missing():
            yield from importlib.import_module(f"{package}.{name}").contestants(task)


def _tools(task: Task | Tree | Shaken | HungBeam | HungBody) -> tuple[str, tuple[str, ...]]:
    """The package of the tools for a kind of problem, and their names."""
    if isinstance(task, Tree):
        return f"{__name__}.trees", TREES_IN_SPACE
    if isinstance(task, Shaken):
        return f"{__name__}.mounted", ON_BUSHINGS
    if isinstance(task, HungBeam | HungBody):
        return f"{__name__}.flexible", FLEXIBLE
    return __name__, IN_THE_PLANE
