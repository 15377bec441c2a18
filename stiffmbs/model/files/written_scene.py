"""Source of a scene, from which it can be read again with other values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class WrittenScene:
    """Content of a scene file, and its changes; comparisons of scenes ignore it.

    Attributes
    ----------
    content : mapping
        Content of the file, with included files; read-only.
    changes : tuple of (path, value)
        Values that replace those of the file.
    source : str
        Name of the scene in messages.
    folder : Path or None
        Folder of meshes.
    files : dict of str to str
        Digests of all other files that were read for it, and of the code of user-defined elements.
    """

    content: Mapping[str, Any] = field(compare=False)
    changes: tuple[tuple[str, Any], ...] = field(compare=False)
    source: str = field(compare=False)
    folder: Path | None = field(compare=False)
    files: dict[str, str] = field(default_factory=dict, compare=False)
