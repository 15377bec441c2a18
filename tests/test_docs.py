"""What the documentation shows is true: its scenes are read, its code runs, and its output comes out."""

import contextlib
import doctest
import importlib
import io
import re
import shlex
from pathlib import Path
from textwrap import dedent

import pytest
from click.testing import CliRunner
from markdown_it import MarkdownIt
from pydantic import TypeAdapter
from ruamel.yaml import YAML

import stiffmbs
import stiffmbs.spatial
from stiffmbs.commands.main import main
from stiffmbs.model import model
from stiffmbs.model import spatial_model as spatial_model
from stiffmbs.model.files.expand import repeat_entries
from stiffmbs.model.parts.changes import REPEATED
from stiffmbs.model.planar_scene import PlanarScene

HERE = Path(__file__).parent.parent
GENERATED = HERE / "docs" / "gallery"
PAGES = [HERE / "README.md", *sorted(page for page in (HERE / "docs").rglob("*.md") if page.parent != GENERATED)]
TESTED = {"yaml", "python", "console"}
QUICK = r"\$ stiffmbs (run|check|equilibrium|modes|response) "
"""Commands that are run; those that measure take long, and never print the same twice."""
PLOT = ".. plot::\n"
OPTION = r"(?m)^ +:[a-z-]+:.*\n"
IMPORT = r"(?m)^ *from (stiffmbs[\w.]*) import ((?:\w+(?:, )?)+)$"
NUMBER = r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?"
LONG = ("around_a_state", "compare", "kinematics_and_compliance", "studies", "tyres_and_roads")
"""Pages whose scenes take seconds to compile."""
FRAME = "[\u2500-\u257f]+"
"""Lines of tables, as long as their numbers."""
SHOWN = 2e-3
"""Relative difference to which a number on a page has to come out."""


def blocks(page):
    """The fenced blocks of a page: kind, text, line."""
    found = []
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type == "fence":
            found.append((token.info, token.content, token.map[0] + 1))
    return found


def as_expected(shown, printed):
    """Whether output is what a page shows: words alike, numbers to their tolerance, ``...`` for anything."""
    shown, printed = (re.sub(FRAME, " ", text).strip() for text in (shown, printed))
    parts = re.split(rf"({NUMBER}|\.\.\.(?!\.)|\s+)", shown)
    patterns = [
        rf"({NUMBER})" if re.fullmatch(NUMBER, part)
        else r"[\s\S]*?" if part == "..."
        else r"\s+" if part.isspace()
        else re.escape(part)
        for part in parts if part
    ]  # fmt: skip
    match = re.fullmatch("".join(patterns), printed)
    if match is None:
        return False
    expected = [float(part) for part in parts if re.fullmatch(NUMBER, part)]
    return [float(number) for number in match.groups()] == pytest.approx(expected, rel=SHOWN, abs=1e-12)


def run_python(text, line, page, names):
    printed = io.StringIO()
    code = compile("\n" * line + text, str(page), "exec")
    with contextlib.redirect_stdout(printed):
        exec(code, names)
    return printed.getvalue()


def run_command(text):
    """Run the commands of a block; what they print, with the commands themselves."""
    printed = []
    for line in text.splitlines():
        if line.startswith("$ stiffmbs "):
            printed += [line, CliRunner().invoke(main, shlex.split(line)[2:]).output]
        elif line.startswith("$ "):
            printed.append(line)
    return "\n".join(printed)


def read_yaml(text):
    """A whole scene is read, and kept where its first line names a file; parts of one are checked section by section."""
    found = YAML(typ="safe", pure=True).load(text)
    if "bodies" in found:
        stiffmbs.read_scene(text)
        found = {}
    for key, value in found.items():
        parts = repeat_entries(key, value, {}) if key in REPEATED else value
        TypeAdapter(PlanarScene.model_fields[key].annotation).validate_python(parts)
    if name := re.match(r"# (\w+\.yaml)\n", text):
        Path(name[1]).write_text(text, encoding="utf-8")


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A folder with the examples in it, as the pages take it to be."""
    (tmp_path / "examples").symlink_to(HERE / "examples")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=pytest.mark.long if page.stem in LONG else (), id=page.stem)
        for page in PAGES
        if TESTED & {kind for kind, *_ in blocks(page)}
    ],
)
def test_what_a_page_shows_is_true(page, workplace):
    """A block of text right behind one of code is its output."""
    names, printed = {}, None
    for kind, text, line in blocks(page):
        shown, printed = printed, None
        match kind:
            case "yaml":
                read_yaml(text)
            case "python":
                printed = run_python(text, line, page, names)
            case "console" if re.match(QUICK, text):
                found = run_command(text)
                assert as_expected(text, found), f"{page.name}:{line}: found {found}"
            case "text" if shown is not None:
                assert as_expected(text, shown), f"{page.name}:{line}: found {shown}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_names_that_a_page_imports_exist(page):
    for module, names in re.findall(IMPORT, page.read_text(encoding="utf-8")):
        found = importlib.import_module(module)
        missing = [name for name in re.findall(r"\w+", names) if not hasattr(found, name)]
        assert not missing, f"{page.name}: {module} has no {', '.join(missing)}"


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "page", [page for page in PAGES if PLOT in page.read_text(encoding="utf-8")], ids=lambda page: page.stem
)
def test_figures_of_a_page_are_drawn(page, workplace):
    for kind, text, line in blocks(page):
        if kind == "{eval-rst}" and text.startswith(PLOT):
            code = re.sub(OPTION, "\n", text.removeprefix(PLOT))
            run_python(dedent(code), line + 2, page, {})


@pytest.mark.parametrize(
    "module", [stiffmbs, model, stiffmbs.spatial, spatial_model], ids=lambda module: module.__name__
)
def test_examples_in_docstrings_run(module, workplace):
    results = doctest.testmod(module)
    assert results.attempted and not results.failed


@pytest.mark.parametrize(("page", "family"), [("scenes", ""), ("scenes_in_space", "spatial.")])
def test_the_overview_of_scenes_is_made_of_all_kinds(page, family, monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(HERE / "docs" / "sphinx_plugins"))
    made = importlib.import_module("kinds")
    text = (HERE / "docs" / "reference" / f"{page}.md").read_text(encoding="utf-8")
    for section in ("joints", "forces"):
        assert f"```{{overview}} {family}{section}\n" in text
        rows = "\n".join(made.overview(*made.SECTIONS[family + section]))
        assert all(f"(``{kind}``)" in rows for kind in made.SECTIONS[family + section][1])


def test_expected_output_is_compared():
    assert as_expected("force: 3.142 N ... done", "force:  3.1416 N in 2 steps\ndone\n")
    assert not as_expected("force: 3.142 N", "force: 3.2 N")
    assert not as_expected("force: 3.142 N", "torque: 3.142 N")


@pytest.mark.parametrize("page", ["joints", "forces", "spatial_joints", "spatial_forces"])
def test_the_reference_names_each_kind_in_one_group(page):
    module = spatial_model if page.startswith("spatial") else model
    kinds = module.JOINTS if page.endswith("joints") else module.FORCES
    text = (HERE / "docs" / "reference" / f"{page}.rst").read_text(encoding="utf-8").partition(".. kinds::")[2]
    named = [kind for line in text.splitlines()[1:] for kind in line.partition(": ")[2].split()]
    assert sorted(named) == sorted(kinds.shipped)


def test_each_public_name_is_on_one_page_of_the_python_reference():
    pages = (HERE / "docs" / "reference" / "python").glob("*.md")
    listed = [
        name
        for page in pages
        for kind, text, _ in blocks(page)
        if kind == "{interface} stiffmbs"
        for name in text.split()
    ]
    kinds = [
        element.__name__
        for found in (model, spatial_model)
        for element in (*found.JOINTS.values(), *found.FORCES.values())
    ]
    offered = [name for name in (*stiffmbs.__all__, "open") if name not in kinds and name != "si"]
    assert sorted(listed) == sorted(offered)


def test_the_gallery_names_examples_once_each_with_a_film():
    text = (HERE / "docs" / "gallery.rst").read_text(encoding="utf-8").partition(".. gallery::")[2]
    named = [name for line in text.splitlines() for name in line.partition(": ")[2].split()]
    examples = [*(HERE / "examples").glob("*.yaml"), *(HERE / "examples").glob("*/*.yaml")]
    assert len(named) == len(set(named)) and set(named) <= {path.stem for path in examples}
    films = HERE / "docs" / "_static" / "gallery"
    assert all((films / f"{name}.webp").exists() for name in named)
