"""Scenes from files of any kind: YAML, or an Adams/Solver dataset."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..describe.files.text_file import STANDARD_INPUT, file_text, source_name

if TYPE_CHECKING:
    from ..describe.scene import Scene

DATASET = ".adm"
"""How the name of an Adams/Solver dataset ends."""


def load_scene(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Read a scene file, or an Adams/Solver dataset.

    Parameters
    ----------
    path : str or Path
        A YAML file, or ``-`` for standard input; a dataset where its name ends in ``.adm``.
    changes : sequence of (path, text)
        Values put in place of the file's, such as ``("bodies.cart.mass", "12 kg")``.

    Returns
    -------
    Scene
        `PlanarScene`, or `SpatialScene` where it says ``dimensions: 3``.

    Raises
    ------
    InputError
        When the file cannot be read or is no valid scene; names the file, the line and the path in it.
    """
    if Path(path).suffix.lower() == DATASET:
        from ..adams.load import load_adams

        return load_adams(path, changes)
    from ..describe.scene import read_scene

    file = None if str(path) == STANDARD_INPUT else Path(path)
    return read_scene(file_text(path), changes, source_name(path), file)
