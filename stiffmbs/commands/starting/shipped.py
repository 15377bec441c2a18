"""Example scenes that are installed with the package."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean

INSTALLED_IN = ("share", "stiffmbs", "examples")
"""Folder of the examples in an installed wheel, relative to the prefix of its Python."""


def examples_folder() -> Path:
    """Return the folder of the examples, in the source tree from which the package is imported or installed.

    Raises InputError if there is none.
    """
    from importlib.metadata import PackageNotFoundError, files

    source = Path(__file__).parents[3]
    if (source / "pyproject.toml").is_file() and (source / "examples").is_dir():
        return source / "examples"
    try:
        recorded = files("stiffmbs") or ()
    except PackageNotFoundError:
        recorded = ()
    for file in recorded:
        if file.parts[-len(INSTALLED_IN) - 1 : -1] == INSTALLED_IN:
            return Path(str(file.locate())).resolve().parent
    raise InputError("found no examples beside the package, expected them where 'pip install' puts them")


def scene_files() -> dict[str, Path]:
    """Return the example scenes by name, in alphabetical order, from the folder itself and its folders by theme."""
    folder = examples_folder()
    return {
        path.stem: path
        for path in sorted([*folder.glob("*.yaml"), *folder.glob("*/*.yaml")], key=lambda path: path.stem)
    }


def scene_file(name: str) -> Path:
    """Return the file of an example, by its name with or without ``.yaml``.

    Raises InputError if there is no such example.
    """
    found = scene_files()
    path = found.get(name.removesuffix(".yaml"))
    if path is None:
        raise InputError(f"found no example '{name}'{did_you_mean(name, found)}, expected one of {', '.join(found)}")
    return path


def first_words(path: Path) -> str:
    """Return the first sentence of the first comment of a scene."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comment = []
    for line in lines:
        if not line.startswith("#"):
            break
        comment.append(line.lstrip("# ").strip())
    sentence, _, _ = " ".join(comment).partition(". ")
    return sentence.removesuffix(".")
