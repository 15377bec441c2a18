"""Paths, modules and commands that documentation, docstrings and tests name exist."""

import re
from pathlib import Path

import pytest

from stiffmbs.commands.main import SECTIONS

ROOT = Path(__file__).parents[1]
PAGES = [path for path in ROOT.glob("docs/**/*.*") if path.suffix in (".md", ".rst") and path.stem != "changelog"] + [
    ROOT / "README.md"
]
SOURCES = [path for folder in ("stiffmbs", "tests") for path in ROOT.glob(f"{folder}/**/*.py")]
FOLDER_OR_FILE = re.compile(r"(?<![\w./-])((?:stiffmbs|tests|examples|docs)/[\w./*-]*[\w*])")
MODULE = re.compile(r"`(stiffmbs(?:\.\w+)+)(?:\(|`)")
COMMAND = re.compile(r"(?:^ {4}|^\$ |`)stiffmbs ([a-z]+)\b", re.MULTILINE)
MADE_UP = ("stiffmbs/examples", "stiffmbs/a.py")
"""Paths of other installations, and of tests."""


def _exists(path: str) -> bool:
    return path in MADE_UP or any(True for _ in ROOT.glob(path.rstrip("/.")))


def _resolved(name: str) -> bool:
    """Return True if a dotted name is a module, or the name of something in one, or in the package."""
    *parents, last = name.split(".")
    folder = ROOT / "/".join(parents)
    if (folder / f"{last}.py").is_file() or (folder / last / "__init__.py").is_file():
        return True
    for count in range(len(parents), 0, -1):
        place = ROOT / "/".join(parents[:count])
        file = next((file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file()), None)
        if file is not None:
            text = file.read_text(encoding="utf-8")
            return all(re.search(rf"\b{part}\b", text) for part in (*parents[count:], last)) or (
                count == 1 and _offered(parents[1:], last)
            )
    return False


def _offered(parents: list[str], last: str) -> bool:
    import stiffmbs

    found: object = stiffmbs
    for part in (*parents, last):
        if not hasattr(found, part):
            return False
        found = getattr(found, part)
    return True


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "sources"])
def test_paths_exist(files):
    missing = {
        f"{file.relative_to(ROOT)}: {path}"
        for file in files
        for path in FOLDER_OR_FILE.findall(file.read_text(encoding="utf-8"))
        if not _exists(path)
    }
    assert not missing, "\n".join(sorted(missing))


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "sources"])
def test_modules_and_their_names_exist(files):
    missing = {
        f"{file.relative_to(ROOT)}: {name}"
        for file in files
        for name in MODULE.findall(file.read_text(encoding="utf-8"))
        if not _resolved(name)
    }
    assert not missing, "\n".join(sorted(missing))


def test_commands_exist():
    known = {name for section in SECTIONS.values() for name in section}
    missing = {
        f"{page.relative_to(ROOT)}: stiffmbs {command}"
        for page in PAGES
        for command in COMMAND.findall(page.read_text(encoding="utf-8"))
        if command not in known
    }
    assert not missing, "\n".join(sorted(missing))
