"""Commands for a first use: a first scene, examples, parts, schema, the page to edit a scene, installed versions."""

from __future__ import annotations

import json
import os
import platform
import shutil
import string
from pathlib import Path

import click

from ..comparison.machine import installed
from ..errors import InputError
from ..reading.did_you_mean import instead_of
from .scene import option, refusing

FIRST_SCENE = Path(__file__).with_name("first_scene.yaml")


@click.command(short_help="Write a first scene, with comments.")
@click.argument("file", type=click.Path(path_type=Path), default=Path("scene.yaml"))
def init(file: Path) -> None:
    """Write a first scene with comments to FILE, scene.yaml by default; an existing file is not overwritten."""
    from ..results.files import write_text

    with refusing(str(file), output=file):
        if os.path.lexists(file):
            raise InputError(f"{file}: found a file, expected a name that is not taken")
        write_text(file, FIRST_SCENE.read_text(encoding="utf-8"))
    click.echo(f"wrote {file}; next: stiffmbs check {file}, stiffmbs run {file}")


@click.command("open", short_help="Edit and solve in the browser.")
@click.argument("scene")
@option(
    "--port INTEGER RANGE",
    "Port on the loopback interface; by default a free one.",
    type=click.IntRange(0, 65535),
    default=0,
)
@option("--browser/--no-browser", "Whether to open the browser.", default=True)
def open_scene(scene: str, port: int, browser: bool) -> None:
    """Open SCENE on a page in the browser that solves it again after every change.

    The page has the text of the scene, the mechanism in motion, plots, the verdict, and sliders for the parameters. A new
    name begins an empty scene. The server listens on the loopback interface alone, and its address contains a token.
    Ctrl-C ends it. Needs the extra live.

    Exit status: 0 done, 2 the input is wrong.
    """
    from ..live.page import open as open_page

    with refusing(scene):
        page = open_page(scene, port, browser)
    click.echo(f"open: {page.url}")
    click.echo("Ctrl-C ends the page's server.")
    page.wait()


@click.command()
def schema() -> None:
    """Print the JSON schema of scene files."""
    from ..model.schema import scene_schema

    click.echo(json.dumps(scene_schema(), indent=2))


@click.command(short_help="The parts of vehicles that come with the package.")
@click.argument("name", required=False)
@option("--json", "Print one JSON object on one line.", "as_json")
def parts(name: str | None, as_json: bool) -> None:
    """List the parts that come with the package, or print the definition of the part NAME as a template.

    Exit status: 0 done, 2 there is no such part.
    """
    from ..model.parts.definitions import about, shipped_part, shipped_parts
    from ..reading.files.yaml_text import scene_text

    if name is None:
        known = {part: about(part) for part in shipped_parts()}
        listed = "\n".join(f"{part:16} {words}" for part, words in known.items())
        click.echo(json.dumps({"parts": known}) if as_json else listed)
        return
    found = shipped_part(name)
    if found is None:
        raise click.UsageError(f"found '{name}'{instead_of(name, shipped_parts())}")
    click.echo(json.dumps({name: found}) if as_json else scene_text({"parts": {name: found}}), nl=as_json)


INSTALLED_IN = ("share", "stiffmbs", "examples")
"""Folder of the examples in an installed wheel, relative to the prefix of its Python."""


def examples_folder() -> Path:
    """Return the folder of the examples, in the source tree from which the package is imported or installed.

    Raises InputError if there is none.
    """
    from importlib.metadata import PackageNotFoundError, files

    source = Path(__file__).parents[2]
    if (source / "pyproject.toml").is_file() and (source / "examples").is_dir():
        return source / "examples"
    try:
        recorded = files("stiffmbs") or ()
    except PackageNotFoundError:
        recorded = ()
    for file in recorded:
        if file.parts[-len(INSTALLED_IN) - 1 : -1] == INSTALLED_IN:
            return Path(str(file.locate())).resolve().parent
    raise InputError("found no examples next to the package, expected them where 'pip install' puts them")


def scene_files() -> dict[str, Path]:
    """Return the example scenes by name, in alphabetical order, from the folder itself and its folders by theme."""
    folder = examples_folder()
    return {
        path.stem: path
        for path in sorted([*folder.glob("*.yaml"), *folder.glob("*/*.yaml")], key=lambda path: path.stem)
    }


def scene_file(name: str) -> Path:
    """Return the file of an example, by its name with or without its folder and ``.yaml``.

    Raises InputError if there is no such example.
    """
    found = scene_files()
    *folders, stem = name.removesuffix(".yaml").split("/")
    path = found.get(stem)
    if path is None or folders not in ([], list(path.relative_to(examples_folder()).parent.parts)):
        raise InputError(f"found no example '{name}'{instead_of(name, found)}")
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


@click.group(short_help="List, copy or run the examples.")
def examples() -> None:
    """List, copy or run the example scenes that are installed with stiffmbs."""


@examples.command("list", short_help="List the examples.")
@option("--json", "Print one JSON object on one line.", "as_json")
def list_all(as_json: bool) -> None:
    """List the examples, each with its subject."""
    with refusing("examples"):
        found = {name: first_words(path) for name, path in scene_files().items()}
        folder = examples_folder()
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "examples": found}))
        return
    for name, words in found.items():
        click.echo(f"{name:22} {words}")


@examples.command(short_help="Copy examples to a folder.")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@option("--to PATH", "The folder.", "folder", default=Path("examples"))
def copy(names: tuple[str, ...], folder: Path) -> None:
    """Copy the examples with these NAMEs, or all of them, with the files that they read.

    Existing files are not overwritten; a file that several examples read is copied once.
    """
    with refusing("examples"):
        source = examples_folder()
        if names:
            chosen = {file: None for name in names for file in (scene_file(name), *_read_by(scene_file(name), source))}
        else:
            chosen = dict.fromkeys(path for path in sorted(source.rglob("*")) if path.is_file())
        wanted, scenes = {path: folder / path.relative_to(source) for path in chosen}, set(scene_files().values())
        for path, target in wanted.items():
            same = path not in scenes and target.is_file() and target.read_bytes() == path.read_bytes()
            if target.exists() and not same:
                raise InputError(f"{target}: found a file, expected none: --to names another folder")
    for path, target in wanted.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    click.echo(f"{len(wanted)} files copied to {folder}")


def _read_by(scene: Path, source: Path) -> list[Path]:
    """Return the files of a folder that a scene reads."""
    from ..analyses.load_scene import load_scene

    read = load_scene(scene).written
    files = [Path(os.path.normpath(name)) for name in read.files] if read else []
    return [file for file in files if file.is_relative_to(source)]


@examples.command("run", short_help="Run an example.", context_settings={"ignore_unknown_options": True})
@click.argument("name")
@click.argument("options", nargs=-1, type=click.UNPROCESSED)
@click.pass_context
def run_one(context: click.Context, name: str, options: tuple[str, ...]) -> None:
    """Run the example NAME; all options of ``stiffmbs run`` can follow."""
    from .run import run

    with refusing("examples"):
        path = scene_file(name)
    with run.make_context("run", [str(path), *options], parent=context) as own:
        run.invoke(own)


PACKAGE = "stiffmbs"
LETTERS = f"{string.ascii_letters}{string.digits}-_."
"""Characters of a package name, with which a requirement begins."""


@click.command("version", short_help="Show the versions of stiffmbs and of what it depends on.")
@option("--json", "Print one JSON object on one line.", "as_json")
def show_version(as_json: bool) -> None:
    """Show the versions of stiffmbs, Python, and every package it depends on, for bug reports."""
    found = {
        PACKAGE: installed(PACKAGE),
        "python": platform.python_version(),
        "platform": platform.platform(),
        **{name: installed(name) for name in dependencies()},
    }
    if as_json:
        click.echo(json.dumps(found))
        return
    for name, value in found.items():
        click.echo(f"{name:20} {value or 'not installed'}")


def dependencies() -> list[str]:
    """Return the packages that a plain run needs, without those of the extras."""
    from importlib.metadata import requires

    plain = [text for text in requires(PACKAGE) or () if "extra ==" not in text]
    return [text[: len(text) - len(text.lstrip(LETTERS))] for text in plain]
