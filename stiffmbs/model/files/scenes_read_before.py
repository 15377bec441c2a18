"""Disk cache of validated scenes.

There is one entry for a file and its changes. It is valid for the same text if all other files read for it are
unchanged. It also depends on the code of `stiffmbs.reading`, `stiffmbs.elements` and `stiffmbs.model`, and on Python,
pydantic and NumPy.
"""

from __future__ import annotations

import io
import json
import pickle
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any

from ...cache import entries
from ...cache.installed import installed_version
from ...cache.source_files import digest_of, files_within
from ...interrupts import uncollected
from ...reading.files.files_read import digest_of_file, recorded
from ...reading.files.unchanged import Unchanged

if TYPE_CHECKING:
    from ..scene import Scene

MOST_ELEMENTS, LARGEST = 5000, 5_000_000
"""Largest number of bodies, joints and forces of a cached scene, and largest size of its entry, bytes."""
OF_SCENES = frozenset(("stiffmbs", "ast", "builtins", "collections", "numpy", "pathlib"))
"""Packages whose classes a cached scene may contain; code of other packages, such as user elements, may change."""


def read_scene_file(text: str, changes: Sequence[tuple[str, object]], source: str, file: Path) -> Scene:
    """Read a scene, or its cached form; results and errors are those of `stiffmbs.model.read_scene.read_scene`.

    `text`: text of the file. `source`: name of the scene in messages.
    """
    with uncollected():
        name = entries.name_of("scene", str(file.resolve()), str(file), source, repr([tuple(pair) for pair in changes]))
        may_be_kept = all(type(value) is str for _, value in changes)
        stored = entries.read(name) if may_be_kept else None
        found = _scene_in(stored, text) if stored is not None else None
        return found or _read(text, changes, source, file, name if may_be_kept else "")


def _read(text: str, changes: Sequence[tuple[str, Any]], source: str, file: Path, name: str) -> Scene:
    """Read a scene, and cache it if a name is given."""
    from ..read_scene import read_scene

    with recorded() as others:
        scene = read_scene(text, changes, source, file)
    if name and len(scene.bodies) + len(scene.joints) + len(scene.forces) <= MOST_ELEMENTS:
        content = _pickled(scene)
        if content is not None and len(content) <= LARGEST:
            entries.write(name, json.dumps([entries.digest(text), _reader(), others]).encode() + b"\n" + content)
            return _unpickled(content) or scene  # the same objects are shared as in a later process
    return scene


def _scene_in(stored: bytes, text: str) -> Scene | None:
    """Return the scene of an entry; None if anything that it was read from has changed."""
    head, _, content = stored.partition(b"\n")
    try:
        of_text, reader, others = json.loads(head)
        if of_text != entries.digest(text) or reader != _reader():
            return None
        if any(digest_of_file(file) != found for file, found in others.items()):
            return None
    except Exception:  # of a damaged entry
        return None
    return _unpickled(content)


def _unpickled(content: bytes) -> Scene | None:
    """Return a pickled scene; None for anything else."""
    from ..scene import Scene

    try:
        scene = pickle.loads(content)  # may contain user code
    except Exception:  # of a missing class: unpickling may raise any error
        return None
    return scene if isinstance(scene, Scene) else None


@cache
def _reader() -> str:
    import numpy
    import pydantic

    package = Path(__file__).parents[2]
    rooms = "reading", "flexible_bodies", "elements", "model"
    files = [package / "solver_names.py", *(file for room in rooms for file in files_within(package / room))]
    versions = sys.version, numpy.__version__, pydantic.VERSION, installed_version("ruamel.yaml")
    return entries.digest(*versions, digest_of(files))


def _pickled(scene: Scene) -> bytes | None:
    """Return a scene as bytes; None if it contains objects of other packages."""
    content = io.BytesIO()
    try:
        ScenePickler(content, pickle.HIGHEST_PROTOCOL).dump(scene)
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError):
        return None
    return content.getvalue()


class ScenePickler(pickle.Pickler):
    """Pickler for scenes, which refuses classes and functions of other packages."""

    def reducer_override(self, found: object) -> Any:
        """Refuse classes and functions of other packages, and pickle `Unchanged` with its content."""
        if isinstance(found, type | FunctionType) and found.__module__.partition(".")[0] not in OF_SCENES:
            raise pickle.PicklingError(f"found {found!r}, expected what is of this package")
        if isinstance(found, Unchanged):
            return Unchanged, (), vars(found)
        return NotImplemented
