"""Shared parts of commands on a scene: options, solution, errors."""

from __future__ import annotations

import os
import sys
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar, get_args

import click

from ..errors import AssemblyError, InputError, SolverError, StiffmbsError
from ..reading.files.text_file import STANDARD_INPUT, source_name
from ..solver_names import SchemeName, SolverName
from .process import Status

if TYPE_CHECKING:
    from ..model.scene import Scene
    from ..results.solution import Solution

Command = TypeVar("Command", bound=Callable[..., Any])
Value = TypeVar("Value")
TYPES = {
    "FLOAT": float, "FLOAT RANGE": click.FloatRange(0, min_open=True), "INTEGER": int, "INTEGER RANGE": click.IntRange(1),
    "PATH": click.Path(path_type=Path),
}  # fmt: skip
"""Types of options by their placeholders, unless given; text for others."""


def option(usage: str, words: str, name: str = "", **settings: Any) -> Callable[[Command], Command]:
    """Return an option.

    `usage`: names and placeholder, as ``-o, --output PATH``; without a placeholder it is a flag, and three dots follow if it
    may be given any number of times. `words`: its help. `name`: parameter of the command, by default the last name. Other
    settings are those of `click.option`.
    """
    parts = usage.removesuffix(" ...").split(" ")
    names = [part.rstrip(",") for part in parts if part.startswith("-")]
    placeholder = " ".join(parts[len(names) :])
    settings.setdefault("show_default", settings.get("default") not in (None, ""))
    if usage.endswith(" ..."):
        settings["multiple"], words = True, f"{words}; any number of times."
    settings |= (
        {"metavar": placeholder, "type": settings.get("type", TYPES.get(placeholder))}
        if placeholder
        else {"is_flag": True}
    )
    return click.option(*names, *([name] if name else []), help=words, **settings)


def assigned(usage: str, texts: Iterable[str], read: Callable[[str], Value]) -> dict[str, Value]:
    """Return the values of an option, NAME=VALUE, by name; raise an InputError for other texts. `usage`: option and placeholder."""
    found = {}
    option, _, expected = usage.partition(" ")
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        with suppress(ValueError):
            if name and value:
                found[name] = read(value)
                continue
        raise InputError(f"{option}: found '{text}', expected {expected}")
    return found


def pairs(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return paths and values of an option PATH=VALUE."""
    found = []
    for value in values:
        path, equals, text = value.partition("=")
        if not equals or not path:
            raise click.BadParameter(f"found '{value}', expected PATH=VALUE such as bodies.cart.mass=12")
        found.append((unicodedata.normalize("NFC", path.strip()), text))
    return found


CHANGES = option(
    "--set PATH=VALUE ...",
    "Change a value of the scene, such as bodies.cart.mass=12, or a parameter, N=40",
    "changes",
    callback=pairs,
)


def several(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Return one decorator that adds several options to a command, in their order."""

    def add(command: Command) -> Command:
        for each in reversed(options):
            command = each(command)
        return command

    return add


def output_option(words: str) -> Callable[[Command], Command]:
    """Return the option ``-o`` with its help."""
    return option("-o, --output PATH", words)


solving_options = several(
    option("--rtol TEXT", "Relative tolerance of bdf and the adaptive schemes."),
    option("--duration TEXT", "Time to solve, s, or with a unit."),
    option("--solver TEXT", f"{', '.join(get_args(SolverName))}."),
    option(
        "--scheme TEXT",
        f"Scheme of projected: {', '.join(get_args(SchemeName))}; by default dop853, or euler_cromer if a step is given.",
    ),
    CHANGES,
)
"""Options ``--rtol``, ``--duration``, ``--solver``, ``--scheme`` and ``--set``; see `changes_of`."""
state_options = several(
    option("--from FILE", "Start from the state in FILE, results of run -o or equilibrium -o.", "state"),
    option("--at FLOAT", "Time of the row in FILE, s; by default the last row."),
)
"""Options ``--from`` and ``--at`` of a command that may start from a saved state; see `start_of`."""


def changes_of(options: dict[str, Any]) -> list[tuple[str, str]]:
    """Return all changes that the options of `solving_options` request, as paths and values."""
    chosen = [(f"run.{name}", options[name]) for name in ("rtol", "duration", "solver", "scheme")]
    return options["changes"] + [(path, value) for path, value in chosen if value is not None]


def start_of(scene: Scene, state: str | None, at: float | None, changes: list[tuple[str, str]]) -> dict[str, Any]:
    """Return the values of `state_options` as keywords of a job; the start is the state's time unless ``--set`` has it.

    Raises InputError if there is no such state.
    """
    if state is None:
        if at is not None:
            raise InputError(f"--at {at:g}: found no file to take a row of, expected --from FILE too")
        return {}
    from ..results.saved_state import read_state

    found = read_state(state, at)
    start_given = any(path == "run.start" for path, _ in changes)
    return {"start_from": found, "start": scene.run.start if start_given else found.t}


def solve_scene(path: str, scene: Scene, verified: bool, **start: Any) -> Solution:
    """Solve a scene with a progress bar, from the start of `start_of`.

    Raises InputError, AssemblyError: The message names the file.
    """
    from .progress import ProgressBar

    if verified:
        from ..verification.verify import verify as solve
    else:
        from ..analyses.run import run as solve
    first = start.get("start", scene.run.start)
    with in_file(path), ProgressBar(first, first + scene.whole_duration) as progress:
        return solve(scene, watch=progress, **start)


@contextmanager
def in_file(path: str) -> Iterator[None]:
    """Add the file's name to errors in a scene that are found after it was read."""
    try:
        yield
    except (InputError, AssemblyError) as error:
        raise type(error)(f"{source_name(path)}: {error}") from None


def refuse_file(option: str, path: Path | None, scene: str, kind: str) -> None:
    """Reject a requested file of a kind of `KINDS` that cannot be written, or that is the file that is read."""
    if path is not None:
        from ..results.files import refuse_path

        refuse_own_input(option, scene, path)
        refuse_path(option, path, kind)


def refuse_own_input(option: str, scene: str, output: Path | None) -> None:
    """Reject an output that is the input file under any name."""
    try:
        same = output is not None and scene != STANDARD_INPUT and os.path.samefile(scene, output)
    except (OSError, ValueError):  # one of them does not exist
        return
    if same:
        raise InputError(f"{option} {output}: found the file that is read, {scene}, expected another one")


def is_written(path: Path | None, write: Callable[[Path], object]) -> bool:
    """Write a file if it is requested; return False, and print the reason, if that fails."""
    try:
        if path is not None:
            write(path)
    except OSError as error:
        tell_unwritten(path, error)
        return False
    return True


def tell_unwritten(path: Path | None, error: OSError) -> None:
    """Print the reason why a file is not written."""
    click.echo(f"stiffmbs: not written: {path}: {error.strerror or error}", err=True)


LONGEST_NAME: Final = 255
"""Largest length of a file name in common file systems, bytes."""


def file_beside(scene: str, ending: str) -> Path:
    """Return the default output file: in the working folder, named after the scene, as far as file names may be long."""
    stem = os.fsencode("stdin" if scene == STANDARD_INPUT else Path(scene).stem)[: LONGEST_NAME - len(ending)]
    return Path(f"{stem.decode(errors='ignore')}{ending}")


@contextmanager
def refusing(scene: str, as_json: bool = False, output: Path | None = None) -> Iterator[None]:
    """End the command with one sentence on an invalid input, a failure of the solver, or an output that is not written."""
    try:
        yield
    except StiffmbsError as error:
        from ..show.summary import json_line

        unsolved = isinstance(error, SolverError)
        if as_json:
            status = "stopped" if unsolved else "error"
            click.echo(json_line({"scene": scene, "status": status, "message": str(error)}))
        click.echo(f"stiffmbs: {error}", err=True)
        sys.exit(Status.FAILED if unsolved else Status.WRONG_INPUT)
    except OSError as error:
        if output is None:
            raise
        tell_unwritten(output, error)
        sys.exit(Status.FAILED)
