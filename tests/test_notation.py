"""The page of symbols lists the letters of native tables as the code uses them."""

from __future__ import annotations

import ast
import importlib
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

from stiffmbs.compile.machine.layout import Layout

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "stiffmbs"
PAGE = ROOT / "docs" / "project" / "notation.md"
ROW = re.compile(r"^\| `(\w)` \| `(\w+)` \| [^|]* \| (.*) \|$", re.MULTILINE)
FILES = [path for path in sorted(PACKAGE.glob("**/native/*.py")) if "machine" not in path.parts or path.stem == "along"]
ROWS_OF_LISTS = "dynamics/elimination/native/by_blocks.py"
"""File whose other letters are rows of lists (`stiffmbs.compile.machine.native.access.row_of`)."""


@cache
def tables():
    """Return the columns of each table by its name."""
    found = {}
    for file in [*PACKAGE.glob("**/layouts.py"), *PACKAGE.glob("**/tables.py")]:
        module = importlib.import_module(".".join(file.relative_to(ROOT).with_suffix("").parts))
        found |= {name: set(value) for name, value in vars(module).items() if isinstance(value, Layout)}
    return found


@cache
def rows():
    """Return the tables of each letter with the files and folders where it stands for them; none for all others."""
    found = defaultdict(list)
    for letter, table, places in ROW.findall(PAGE.read_text(encoding="utf-8")):
        found[letter].append((table, tuple(re.findall(r"`([\w/.]+)`", places))))
    return found


def expected(letter, file):
    """Return the tables that the page gives for a letter in a file: those of the file, else of a folder, else of all."""
    place = file.relative_to(PACKAGE).as_posix()
    of_file = {table for table, places in rows()[letter] if place in places}
    of_folder = {table for table, places in rows()[letter] if any(place.startswith(f"{one}/") for one in places)}
    return of_file or of_folder or {table for table, places in rows()[letter] if not places}


def used(file):
    """Yield each letter with the columns that a function reads or sets by it."""
    for function in ast.parse(file.read_text(encoding="utf-8")).body:
        columns = defaultdict(set)
        for node in ast.walk(function):
            match node:
                case ast.Attribute(value=ast.Name(id=name), attr=column) if len(name) == 1:
                    columns[name].add(column)
        yield from columns.items()


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_letters_of_tables_are_those_of_the_page(file):
    for letter, columns in used(file):
        if file.relative_to(PACKAGE).as_posix() == ROWS_OF_LISTS and letter not in "bsr":
            continue
        named = expected(letter, file)
        assert any(columns <= tables()[table] for table in named), (
            f"'{letter}' has {sorted(columns)}, which are no columns of {sorted(named)}"
        )


def test_each_row_of_the_page_is_a_table_and_names_files_that_exist():
    for letter, found in rows().items():
        for table, places in found:
            assert table in tables(), f"{letter}: {table}"
            assert all((PACKAGE / place).exists() for place in places), f"{letter}: {places}"
