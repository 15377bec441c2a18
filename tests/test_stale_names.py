"""Paths, modules, attributes and commands that documentation, docstrings and tests name exist."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path

import click
import pytest

import stiffmbs
from stiffmbs.commands.main import SECTIONS, main

ROOT = Path(__file__).parents[1]
PROJECT = ROOT / "docs" / "project"
MAP = PROJECT / "solver_steps.md"
PAGES = [path for path in ROOT.glob("docs/**/*.*") if path.suffix in (".md", ".rst") and path.stem != "changelog"] + [
    ROOT / "README.md"
]
SOURCES = [path for folder in ("stiffmbs", "tests") for path in ROOT.glob(f"{folder}/**/*.py")]
CODE = [*SOURCES, *ROOT.glob("docs/**/*.py"), *ROOT.glob(".ci/*.py")]
DATA = [
    path
    for pattern in ("examples/**/*.*", "stiffmbs/**/*.yaml", "stiffmbs/**/*.html", "stiffmbs/**/*.js", "pyproject.toml")
    for path in ROOT.glob(pattern)
    if path.suffix in (".yaml", ".adm", ".html", ".js", ".toml")
]
ROOMS = "|".join(sorted(path.parent.name for path in ROOT.glob("stiffmbs/*/__init__.py")))
FOLDER_OR_FILE = re.compile(
    rf"(?<![\w./-])((?:stiffmbs|tests|examples|docs|\.ci)/[\w./*-]*[\w*])|`((?:{ROOMS})/[\w./*]+)`"
)
MODULE = re.compile(r"`((?:stiffmbs|tests)(?:\.\w+)+)(?:\(|`)")
COMMAND = re.compile(r"(?:^ {4}|^\$ |`)stiffmbs ([a-z]\w*)([^`\n]*)", re.MULTILINE)
PYTHON = re.compile(r"python (?:-m (tests[.\w]*)|(\.ci/\w+\.py))((?:\s+[^\s`\"#)]+)*)")
IDENTIFIER = re.compile(r"`([A-Za-z_]\w*(?:\.\w+)*)(?:\([^`]*\))?`")
PLACE = re.compile(r"`((?:[\w.]+/)*\w+\.py)?(?::(\w+(?:\.\w+)?))?`")
"""A file of the package, a name in a file, or a name in the file before."""
FENCE = re.compile(r"^(```+|:::+).*?^\1", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r'"{3}[\s\S]*?"{3}')
"""Docstrings, and long texts."""
MADE_UP = ("stiffmbs/examples", "stiffmbs/a.py")
"""Paths of other installations, and of tests."""
OTHERS = frozenset((
    "axle_1e7", "half_car_1e6", "half_car_1e8", "c_k", "inner_x", "inner_y", "inner_z", "lower_ball_x",
    "lower_ball_y", "bar_in_plane", "NAME_in_plane", "NAME_input", "NAME_activation", "pin_interface", "K_data",
    "K_indices", "K_indptr", "r_lam", "r_p", "EULER_EXPLICIT", "mjd_transitionFD", "JPRIM_2", "BUSHING_2",
    "GFORCE_3_torque", "DIFF_1_rate", "CVCV_1_touch", "chain_10_of_1_m", "chain_100_of_1_m", "chain_1000_of_1_m", "to_dataframe",
))  # fmt: skip
"""Names that are composed at run time, belong to other programs, are symbols of equations, or stand for a user's own."""


def _exists(path: str) -> bool:
    return path in MADE_UP or any(True for top in (ROOT, ROOT / "stiffmbs") for _ in top.glob(path.rstrip("/.")))


@cache
def _defined_in(file: Path) -> frozenset[str]:
    """Return the names that a module defines: functions, classes, ``Class.part`` and constants."""
    names: set[str] = set()
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        names |= set(_targets(node))
        if isinstance(node, ast.ClassDef):
            names |= {f"{node.name}.{part}" for statement in node.body for part in _targets(statement)}
    return frozenset(names)


def _targets(node: ast.stmt) -> Iterator[str]:
    match node:
        case ast.FunctionDef() | ast.ClassDef() | ast.AsyncFunctionDef():
            yield node.name
        case ast.Assign() | ast.AnnAssign():
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name))


def _resolved(name: str) -> bool:
    """Return True if a dotted name is a module, something that a module defines, or an attribute of the package."""
    parts = name.split(".")
    for count in range(len(parts), 1, -1):
        place = ROOT / "/".join(parts[:count])
        file = next((file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file()), None)
        if file is not None and (count == len(parts) or ".".join(parts[count:]) in _defined_in(file)):
            return True
    if parts[0] != "stiffmbs":
        return False
    with suppress(ImportError):
        import_module(".".join(parts[:2]))
    found: object = stiffmbs
    for part in parts[1:]:
        fields = getattr(found, "__annotations__", {}) | getattr(found, "model_fields", {})
        if not hasattr(found, part):
            return part in fields and part == parts[-1]
        found = getattr(found, part)
    return True


@cache
def _known_words() -> frozenset[str]:
    """Return the words of sources and data, without docstrings and comments of Python."""
    words = {*OTHERS}
    for file in [*CODE, *DATA]:
        text = file.read_text(encoding="utf-8")
        code = re.sub(r"#.*", "", QUOTED.sub("", text)) if file.suffix == ".py" else text
        words |= {*re.findall(r"\w+", code), *file.with_suffix("").parts}
    return frozenset(words)


def _reported(missing: set[str]) -> None:
    assert not missing, "\n".join(sorted(missing))


@pytest.mark.parametrize("files", [PAGES, SOURCES], ids=["pages", "sources"])
@pytest.mark.parametrize(
    ("named", "exists"), [(FOLDER_OR_FILE, _exists), (MODULE, _resolved)], ids=["paths", "modules"]
)
def test_what_is_named_exists(files, named, exists):
    found = ((file, match) for file in files for match in named.finditer(file.read_text(encoding="utf-8")))
    names = ((file, match[match.lastindex]) for file, match in found)
    _reported({f"{file.relative_to(ROOT)}: {name}" for file, name in names if not exists(name)})


def _identifiers() -> Iterator[tuple[Path, str]]:
    """Yield what pages and docstrings set in backquotes, without the names that the code of a page defines."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        own = {*re.findall(r"\w+", " ".join(match[0] for match in FENCE.finditer(text)))}
        yield from ((page, name) for name in IDENTIFIER.findall(FENCE.sub("", text)) if name not in own)
    for file in SOURCES:
        for text in QUOTED.findall(file.read_text(encoding="utf-8")):
            yield from ((file, name) for name in IDENTIFIER.findall(text))


def test_identifiers_in_backquotes_exist():
    """Those with an underscore, which are no words of English: fields, functions, parameters, channels, scenes."""
    missing = set()
    for file, name in _identifiers():
        if [part for part in name.split(".") if "_" in part.strip("_") and part not in _known_words()]:
            missing.add(f"{file.relative_to(ROOT)}: {name}")
    _reported(missing)


def _places() -> Iterator[tuple[Path, str, str]]:
    """Yield page, file and name (empty for none) of each place that the pages for developers name, as ``path.py:name``."""
    for page in sorted({*PROJECT.rglob("*.md")} & {*PAGES}):
        text, path = page.read_text(encoding="utf-8"), ""
        begin = text.index("\n## ") if page == MAP else 0  # its introduction explains the form
        for match in PLACE.finditer(text, begin):
            path = match[1] or path
            if path and (match[1] or match[2]):
                yield page, path, match[2] or ""


def test_places_in_source_files_exist():
    tops, missing = ("", "stiffmbs/", "stiffmbs/compile/machine/", "stiffmbs/**/"), set()
    for page, path, name in _places():
        files = [file for top in tops[: 4 if "/" not in path else 3] for file in ROOT.glob(top + path)]
        if not files or (name and not any(name in _defined_in(file) for file in files)):
            missing.add(f"{page.name}: {path}:{name}")
    _reported(missing)


def test_every_file_of_the_map_of_steps_is_checked():
    body = MAP.read_text(encoding="utf-8").partition("\n## ")[2]
    assert {path for page, path, _ in _places() if page == MAP} == set(re.findall(r"[\w/]+\.py\b", body))


def _options(command: click.Command) -> set[str]:
    return {
        "--help",
        "--version",
        "-vv",
        *(name for option in command.params for name in (*option.opts, *option.secondary_opts)),
    }


def test_commands_and_their_options_exist():
    known = {name for section in SECTIONS.values() for name in section}
    context, missing = click.Context(main), set()
    for page in PAGES:
        for name, rest in COMMAND.findall(page.read_text(encoding="utf-8")):
            if name not in known:
                missing.add(f"{page.relative_to(ROOT)}: stiffmbs {name}")
                continue
            command = main.get_command(context, name)
            assert command is not None
            rest = rest.partition("#")[0].partition("| ")[0]
            if isinstance(command, click.Group) and (
                own := command.commands.get(rest.split()[0] if rest.split() else "")
            ):
                command = own
            for option in re.findall(r"(?<=\s|\[)--?[a-z][\w-]*", rest):
                if option not in _options(command):
                    missing.add(f"{page.relative_to(ROOT)}: stiffmbs {name} {option}")
    _reported(missing)


def _unknown(module: str, words: list[str]) -> Iterator[str]:
    """Yield the cases that a command asks for and that no file names; words in capitals stand for one."""
    for option, word in zip(["", *words], words, strict=False):
        is_case = module in ("tests.bench", "tests.stress") and option in ("", "--fuzz", "--peers", "--solvers")
        if is_case and re.fullmatch(r"[a-z][\w-]*", word) and word.replace("-", "_") not in _known_words():
            yield word


def test_what_python_runs_exists():
    """Modules of tests, scripts of .ci, and the cases that they are asked for."""
    missing = set()
    for file in [*PAGES, *CODE]:
        for module, script, rest in PYTHON.findall(file.read_text(encoding="utf-8")):
            if script and not (ROOT / script).is_file():
                missing.add(f"{file.relative_to(ROOT)}: {script}")
            place = ROOT / module.rstrip(".").replace(".", "/")
            if module and not (place.with_suffix(".py").is_file() or (place / "__main__.py").is_file()):
                missing.add(f"{file.relative_to(ROOT)}: {module}")
            words = shlex.split(rest.partition("#")[0].replace("'", " "))
            missing |= {f"{file.relative_to(ROOT)}: {module} {word}" for word in _unknown(module, words)}
    _reported(missing)
