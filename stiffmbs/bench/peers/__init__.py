"""Other tools on the same problems, each as its own user would write them: a file or folder for each tool.

It has ``contestants(task)``.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator

from ..contestant import Contestant
from ..task import Task
from .trees.tree import Tree

IN_THE_PLANE = ("scipy", "casadi", "exudyn", "chapter")
TREES_IN_SPACE = ("exudyn", "mujoco", "pinocchio")
PACKAGES = ("exudyn", "casadi", "mujoco", "pinocchio")
"""Of the extra ``peers``, as they are imported: what this package itself does not need; Pinocchio is ``pin`` on PyPI."""


def missing() -> tuple[str, ...]:
    """Packages of the extra ``peers`` that are not installed."""
    return tuple(package for package in PACKAGES if importlib.util.find_spec(package) is None)


def peers(task: Task | Tree) -> Iterator[Contestant]:
    """All tools that are installed, on a problem."""
    package, tools = (f"{__name__}.trees", TREES_IN_SPACE) if isinstance(task, Tree) else (__name__, IN_THE_PLANE)
    for name in tools:
        if name not in missing():
            yield from importlib.import_module(f"{package}.{name}").contestants(task)
