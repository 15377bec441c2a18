"""The scenes in the folder ``examples`` of the directory at hand."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path("examples")


def example_scenes() -> list[Path]:
    """The files of all scenes by name; what folders within those of a theme hold are parts of scenes."""
    return sorted([*FOLDER.glob("*.yaml"), *FOLDER.glob("*/*.yaml")], key=lambda path: path.stem)
