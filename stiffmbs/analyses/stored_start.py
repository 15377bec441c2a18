"""Disk cache of starts in equilibrium: initial values, and whether the run begins with implicit steps.

An entry belongs to the content of a scene, to settings and to a version of the package on one kind of processor.
"""

from __future__ import annotations

import io
import os
import pickle
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..cache import entries
from ..cache.installed import installed_version
from ..cache.source_files import versions_within
from ..compile.machine.object_code import machine
from ..model.files.scenes_read_before import ScenePickler
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..model.settings import RunSettings
from ..results.saved_state import SavedState

Found = TypeVar("Found")
PACKAGE = Path(__file__).parents[1]


class StoredStart:
    """Findings of a job before it integrates, from the cache or new.

    Described starts need no search, and code of other packages may change; both are computed each time.

    `name`: name of the entry, or empty if there is none.
    """

    def __init__(self, data: ModelData, settings: RunSettings, state: SavedState | None) -> None:
        searched = isinstance(data, Scene) and data.start != "described" and not data.at_start and state is None
        self.name = _name(data, settings) if searched else ""
        stored = entries.read(self.name) if self.name else None
        self._found: dict[str, Any] = {} if stored is None else pickle.loads(stored)
        self._stored = len(self._found)

    def get(self, what: str, find: Callable[[], Found]) -> Found:
        """Return a finding, or call the function that makes it."""
        if what not in self._found:
            self._found[what] = find()
        found: Found = self._found[what]
        return found

    def keep(self) -> None:
        """Store the findings if some are new."""
        if self.name and len(self._found) > self._stored:
            entries.write(self.name, pickle.dumps(self._found))


def _name(data: ModelData, settings: RunSettings) -> str:
    """Return the name of the entry; empty for data that cannot be pickled."""
    content = io.BytesIO()
    try:
        _ByContent(content, pickle.HIGHEST_PROTOCOL).dump((data, settings))
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError):
        return ""
    return entries.name_of("start", _solver(), sha256(content.getbuffer()).hexdigest())


class _ByContent(ScenePickler):
    """Pickler whose bytes do not depend on the order of sets, which varies between processes."""

    def persistent_id(self, found: object) -> object:
        return tuple(sorted(found, key=repr)) if isinstance(found, set | frozenset) else None


@cache
def _solver() -> str:
    """Return the dependencies of the rounding of a start: files, libraries, threads, compiler, processor."""
    threads = os.cpu_count(), *map(os.environ.get, ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"))
    libraries = np.__version__, installed_version("scipy"), installed_version("sympy")
    return repr(([*versions_within(str(PACKAGE))], threads, libraries, machine()))
