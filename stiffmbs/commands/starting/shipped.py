"""The example scenes that are installed with the package."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError

INSTALLED_IN = ("share", "stiffmbs", "examples")
"""Where a wheel puts them, below the prefix of the Python that it is installed for."""


def examples_folder() -> Path:
    """The folder of the examples: that of the source tree the package is imported from, or the installed one.

    Raises
    ------
    InputError
        When there is none.
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
    """The example scenes by name, in alphabetical order: those in the folder itself, and in its folders by theme."""
    folder = examples_folder()
    return {
        path.stem: path
        for path in sorted([*folder.glob("*.yaml"), *folder.glob("*/*.yaml")], key=lambda path: path.stem)
    }


def scene_file(name: str) -> Path:
    """The file of an example, by its name with or without ``.yaml``.

    Raises
    ------
    InputError
        When there is no such example.
    """
    found = scene_files()
    path = found.get(name.removesuffix(".yaml"))
    if path is None:
        raise InputError(f"found no example '{name}', expected one of {', '.join(found)}")
    return path


def first_words(path: Path) -> str:
    """What the first comment of a scene says, up to its first full stop."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comment = []
    for line in lines:
        if not line.startswith("#"):
            break
        comment.append(line.lstrip("# ").strip())
    sentence, _, _ = " ".join(comment).partition(". ")
    return sentence.removesuffix(".")
