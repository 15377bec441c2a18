"""Parts of the package, in one file each in ``shipped``."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from ..files.include import read_including
from ..files.yaml_text import read_yaml

FOLDER = Path(__file__).with_name("shipped")


@functools.cache
def shipped_parts() -> tuple[str, ...]:
    """Return the names of all parts of the package."""
    return tuple(sorted(file.stem for file in FOLDER.glob("*.yaml")))


def shipped_part(name: str) -> dict[str, Any] | None:
    """Return the definition of a part of the package, read-only; None for any other name."""
    return _read(name) if name in shipped_parts() else None


def shipped_text(name: str) -> str:
    """Return the text of the file of a part of the package."""
    return (FOLDER / f"{name}.yaml").read_text(encoding="utf-8")


def about(name: str) -> str:
    """Return the description of a part of the package, the comment in the first line of its file."""
    return shipped_text(name).partition("\n")[0].removeprefix("# ")


def included_texts(name: str) -> tuple[str, ...]:
    """Return the texts of the files that a part of the package includes."""
    found = read_yaml(shipped_text(name), f"{name}.yaml").get("include") or []
    names = [found] if isinstance(found, str) else found
    return tuple((FOLDER / each).read_text(encoding="utf-8") for each in names)


@functools.cache
def _read(name: str) -> dict[str, Any]:
    found: dict[str, Any]
    found, _ = read_including(shipped_text(name), f"{name}.yaml", FOLDER / f"{name}.yaml")
    return found
