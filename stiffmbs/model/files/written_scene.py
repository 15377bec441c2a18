"""Source of a scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...reading.files.yaml_text import Content


@dataclass(frozen=True)
class WrittenScene:
    """Content of a scene file, and its changes; comparisons of scenes ignore it."""

    content: Content = field(compare=False)  # content of the file, with included files; read-only
    changes: tuple[tuple[str, object], ...] = field(compare=False)  # values that replace those of the file
    source: str = field(compare=False)  # name of the scene in messages
    folder: Path | None = field(compare=False)  # folder of meshes
    # digests of all other files that were read for it, and of the code of user-defined elements
    files: dict[str, str] = field(default_factory=dict, compare=False)
    # joints and forces that start to act after the described pose, in a stage
    starts_later: frozenset[str] = field(default=frozenset(), compare=False)
