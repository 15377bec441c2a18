"""What a scene was read from, so that it can be read again with other values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class WrittenScene:
    """The content of a scene's file, and what was changed of it; scenes are equal wherever they come from.

    Attributes
    ----------
    content : mapping
        As it stands in the file, with what it includes; not to be changed.
    changes : tuple of (path, value)
        Values put in place of the file's.
    source : str
        What messages call it.
    folder : Path or None
        Where meshes are looked for.
    files : dict of str to str
        Digests of all files that were read for it besides its own, and of the code of users' own elements.
    """

    content: Mapping[str, Any] = field(compare=False)
    changes: tuple[tuple[str, Any], ...] = field(compare=False)
    source: str = field(compare=False)
    folder: Path | None = field(compare=False)
    files: dict[str, str] = field(default_factory=dict, compare=False)
