"""The developers' map of a step names files, functions, classes and constants that exist."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "project" / "solver_steps.md"
PLACE = r"((?:\w+/)*\w+\.py)?(?::(\w+(?:\.\w+)?))?"
"""A file, a name in a file, or a name in the file before."""


def named_places():
    """Return line, file and name (empty for none) of each place on the page, without those of its introduction."""
    text, path, found = PAGE.read_text(encoding="utf-8"), "", []
    for span in re.finditer(r"`([^`]+)`", text):
        place = re.fullmatch(PLACE, span[1])
        if place and span.start() > text.index("\n## "):
            path = place[1] or path
            found.append((text.count("\n", 0, span.start()) + 1, path, place[2] or ""))
    return found


def names_in(file):
    """Return the names that a module defines: functions, classes, ``Class.method`` and constants."""
    names = set()
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        if isinstance(node, ast.ClassDef):
            names |= {f"{node.name}.{part.name}" for part in node.body if isinstance(part, ast.FunctionDef)}
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names |= {part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)}
    return names


@pytest.mark.parametrize("line, path, name", named_places())
def test_named_place_exists(line, path, name):
    file = ROOT / "stiffmbs" / path
    assert file.is_file(), f"{PAGE.name}:{line}: no file {path}"
    assert not name or name in names_in(file), f"{PAGE.name}:{line}: no {name} in {path}"


def test_every_file_on_the_page_is_checked():
    body = PAGE.read_text(encoding="utf-8").partition("\n## ")[2]
    assert {path for _, path, _ in named_places()} == set(re.findall(r"[\w/]+\.py\b", body))
