"""Scenes that were read before: a scene is kept on disk as it is once valid, as reading it takes longer than much else of a short run.

There is one entry for a file and the changes of it.  It is used for the same text alone, where every other file that was read for it
is the same, and so is what reads it: the files of `stiffmbs.describe`, Python, pydantic and NumPy.
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

from ...cache.entries import digest
from ...cache.source_files import digest_of, files_within
from ...interrupts import uncollected
from .files_read import digest_of_file, recorded
from .folder import folder_of_files, keep
from .unchanged import Unchanged

if TYPE_CHECKING:
    from ..scene import Scene

SCENE = "scene"
"""How the names of the entries begin."""
MOST_ELEMENTS, LARGEST = 5000, 5_000_000
"""Bodies, joints and forces of a scene that is kept, and bytes of its entry."""
OF_SCENES = frozenset(("stiffmbs", "ast", "builtins", "collections", "numpy", "pathlib"))
"""Packages whose classes a scene may hold to be kept; others, such as a user's own elements, may change at any time."""


def read_scene_file(text: str, changes: Sequence[tuple[str, Any]], source: str, file: Path) -> Scene:
    """Read a scene; see `stiffmbs.describe.reading.read_scene`, whose errors are told as there.

    Parameters
    ----------
    text : str
        Of the file.
    changes : sequence of (path, text)
    source : str
        What messages call it.
    file : Path
    """
    with uncollected():
        name = f"{SCENE}-{digest(str(file.resolve()), str(file), source, repr([tuple(pair) for pair in changes]))}"
        may_be_kept = all(type(value) is str for _, value in changes)
        stored = folder_of_files().read(name) if may_be_kept else None
        found = _scene_in(stored, text) if stored is not None else None
        return found or _read(text, changes, source, file, name if may_be_kept else "")


def _read(text: str, changes: Sequence[tuple[str, Any]], source: str, file: Path, name: str) -> Scene:
    """Read a scene, and keep it under a name; nothing is kept without one."""
    from ..reading import read_scene

    with recorded() as others:
        scene = read_scene(text, changes, source, file)
    if name and len(scene.bodies) + len(scene.joints) + len(scene.forces) <= MOST_ELEMENTS:
        content = _pickled(scene)
        if content is not None and len(content) <= LARGEST:
            keep(name, json.dumps([digest(text), _reader(), others]).encode() + b"\n" + content)
    return scene


def _scene_in(stored: bytes, text: str) -> Scene | None:
    """The scene of an entry; None where anything that it was read from is no longer the same."""
    from ..scene import Scene

    head, _, content = stored.partition(b"\n")
    try:
        of_text, reader, others = json.loads(head)
        if of_text != digest(text) or reader != _reader():
            return None
        if any(digest_of_file(file) != found for file, found in others.items()):
            return None
        scene = pickle.loads(content)  # it bears the user's code
    except Exception:  # of a class that is no longer found, or of what is no scene: pickles raise whatever Python does
        return None
    return scene if isinstance(scene, Scene) else None


@cache
def _reader() -> str:
    """A digest of what reads scenes."""
    import numpy
    import pydantic

    package = Path(__file__).parents[2]
    files = [package / "solver_names.py", *files_within(package / "describe")]
    return digest(sys.version, numpy.__version__, pydantic.VERSION, digest_of(files))


def _pickled(scene: Scene) -> bytes | None:
    """A scene as bytes; None for one that holds anything of other packages."""
    content = io.BytesIO()
    try:
        _Pickler(content, pickle.HIGHEST_PROTOCOL).dump(scene)
    except (pickle.PicklingError, AttributeError, TypeError, RecursionError):
        return None
    return content.getvalue()


class _Pickler(pickle.Pickler):
    """Keeps what was validated with a scene, and refuses classes and functions of other packages."""

    def reducer_override(self, found: Any) -> Any:
        """Refuse classes and functions of other packages, and keep unchanged values."""
        if isinstance(found, type | FunctionType) and found.__module__.partition(".")[0] not in OF_SCENES:
            raise pickle.PicklingError(f"found {found!r}, expected what is of this package")
        if isinstance(found, Unchanged):
            return Unchanged, (), vars(found)
        return NotImplemented
