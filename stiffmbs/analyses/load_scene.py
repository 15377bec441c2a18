"""Scenes from files of any kind: YAML, an Adams/Solver dataset, or a robot's URDF or MJCF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..describe.files.text_file import STANDARD_INPUT, file_text, source_name
from ..errors import InputError

if TYPE_CHECKING:
    from ..describe.scene import Scene

DATASET = ".adm"
"""How the name of an Adams/Solver dataset ends."""
ROBOTS = (".urdf", ".xml", ".mjcf")
"""How those of robots' files end."""


def load_scene(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Read a scene file, an Adams/Solver dataset, or a robot's file.

    Parameters
    ----------
    path : str or Path
        A YAML file, or ``-`` for standard input; a dataset where its name ends in ``.adm``, a robot in URDF where it
        ends in ``.urdf``, in MJCF (needs the extra ``robots``) in ``.xml`` or ``.mjcf``.
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
    for change in changes:
        if not (isinstance(change, tuple | list) and len(change) == 2 and isinstance(change[0], str)):
            raise InputError(f"changes: found {change!r}, expected pairs such as ('bodies.cart.mass', '12 kg')")
    suffix = Path(path).suffix.lower()
    if suffix in ROBOTS:
        from ..robots.load import load_robot

        return load_robot(path, changes)
    if suffix == DATASET:
        from ..adams.load import load_adams

        return load_adams(path, changes)
    if str(path) == STANDARD_INPUT:
        from ..describe.reading import read_scene

        return read_scene(file_text(path), changes, source_name(path))
    from ..describe.files.scenes_read_before import read_scene_file

    return read_scene_file(file_text(path), changes, source_name(path), Path(path))
