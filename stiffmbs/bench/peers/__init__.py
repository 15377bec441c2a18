"""Other tools on the same problems, each as its own user would write them: a file or folder for each tool.

It has ``contestants(task)``.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator

from ..contestant import Contestant
from ..task import Task

TOOLS = ("scipy", "casadi", "exudyn", "chapter")
PACKAGES = ("exudyn", "casadi")
"""Of the extra ``peers``: what this package itself does not need."""


def missing() -> tuple[str, ...]:
    """Packages of the extra ``peers`` that are not installed."""
    return tuple(package for package in PACKAGES if importlib.util.find_spec(package) is None)


def peers(task: Task) -> Iterator[Contestant]:
    """All tools that are installed, on a problem."""
    for name in TOOLS:
        if name not in missing():
            yield from importlib.import_module(f"{__name__}.{name}").contestants(task)
