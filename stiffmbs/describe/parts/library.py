"""The parts that come with the package: one file each in ``shipped``, named as the part."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from ..files.include import read_including
from ..files.yaml_text import read_yaml

FOLDER = Path(__file__).with_name("shipped")


@functools.cache
def shipped_parts() -> tuple[str, ...]:
    """The names of all parts that come with the package."""
    return tuple(sorted(file.stem for file in FOLDER.glob("*.yaml")))


def shipped_part(name: str) -> dict[str, Any] | None:
    """The definition of a part that comes with the package, not to be changed; None for any other name."""
    return _read(name) if name in shipped_parts() else None


def shipped_text(name: str) -> str:
    """The file of a part that comes with the package, as text."""
    return (FOLDER / f"{name}.yaml").read_text(encoding="utf-8")


def about(name: str) -> str:
    """The first line of comment of a part that comes with the package: what it is."""
    return shipped_text(name).partition("\n")[0].removeprefix("# ")


def included_texts(name: str) -> tuple[str, ...]:
    """The files that a part which comes with the package includes, as text."""
    found = read_yaml(shipped_text(name), f"{name}.yaml").get("include") or []
    names = [found] if isinstance(found, str) else found
    return tuple((FOLDER / each).read_text(encoding="utf-8") for each in names)


@functools.cache
def _read(name: str) -> dict[str, Any]:
    found: dict[str, Any]
    found, _ = read_including(shipped_text(name), f"{name}.yaml", FOLDER / f"{name}.yaml")
    return found
