"""Shared parts of commands on a scene: options, solution, errors."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_args

import click

from ..errors import AssemblyError, InputError, SolverError, StiffmbsError
from ..reading.files.text_file import STANDARD_INPUT, source_name
from ..solver_names import SchemeName, SolverName
from .process import Status

if TYPE_CHECKING:
    from ..model.scene import Scene
    from ..results.solution import Solution

Command = TypeVar("Command", bound=Callable[..., Any])


def pairs(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return paths and values of an option PATH=VALUE."""
    found = []
    for value in values:
        path, equals, text = value.partition("=")
        if not equals or not path:
            raise click.BadParameter(f"found '{value}', expected PATH=VALUE such as bodies.cart.mass=12")
        found.append((path.strip(), text))
    return found


CHANGES = click.option(
    "--set",
    "changes",
    multiple=True,
    callback=pairs,
    metavar="PATH=VALUE",
    help="Change a value of the scene, such as bodies.cart.mass=12, or a parameter, N=40; any number of times.",
)


def several(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """Return one decorator that adds several options to a command, in their order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def output_option(words: str) -> Callable[[Command], Command]:
    """Return the option ``-o`` with its help."""
    return click.option("-o", "--output", type=click.Path(path_type=Path), help=words)


solving_options = several(
    click.option("--rtol", help="Relative tolerance of bdf and the adaptive schemes."),
    click.option("--duration", help="Time to solve, s, or with a unit."),
    click.option("--solver", help=f"{', '.join(get_args(SolverName))}."),
    click.option(
        "--scheme",
        help=f"Scheme of projected: {', '.join(get_args(SchemeName))}; by default dop853, or euler_cromer if a step is given.",
    ),
    CHANGES,
)
"""Options ``--rtol``, ``--duration``, ``--solver``, ``--scheme`` and ``--set``; see `changes_of`."""
state_options = several(
    click.option(
        "--from", "state", metavar="FILE", help="Start from the state in FILE, results of run -o or equilibrium -o."
    ),
    click.option("--at", type=float, help="Time of the row in FILE, s; by default the last row."),
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


def refuse_own_input(option: str, scene: str, output: Path | None) -> None:
    """Reject an output that is the input file under any name."""
    try:
        same = output is not None and scene != STANDARD_INPUT and os.path.samefile(scene, output)
    except (OSError, ValueError):  # one of them does not exist
        return
    if same:
        raise InputError(f"{option} {output}: found the file that is read, {scene}, expected another one")


def is_written(path: Path, write: Callable[[], object]) -> bool:
    """Write a requested file; if this fails, print the reason and continue."""
    try:
        write()
    except OSError as error:
        tell_unwritten(path, error)
        return False
    return True


def tell_unwritten(path: Path, error: OSError) -> None:
    """Print the reason why a file is not written."""
    click.echo(f"stiffmbs: not written: {path}: {error.strerror or error}", err=True)


def file_beside(scene: str, ending: str) -> Path:
    """Return the default output file: in the working folder, named after the scene."""
    return Path(f"{'stdin' if scene == STANDARD_INPUT else Path(scene).stem}{ending}")


@contextmanager
def refusing(scene: str, as_json: bool = False, output: Path | None = None) -> Iterator[None]:
    """End the command with one sentence on an invalid input, a failure of the solver, or an output that is not written."""
    try:
        yield
    except StiffmbsError as error:
        from ..show.summary import error_as_json

        unsolved = isinstance(error, SolverError)
        if as_json:
            click.echo(error_as_json(scene, str(error), "stopped" if unsolved else "error"))
        click.echo(f"stiffmbs: {error}", err=True)
        sys.exit(Status.FAILED if unsolved else Status.WRONG_INPUT)
    except OSError as error:
        if output is None:
            raise
        tell_unwritten(output, error)
        sys.exit(Status.FAILED)
