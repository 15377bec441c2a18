"""The command ``stiffmbs bench``."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

import click

from ..errors import StiffmbsError
from .process import Status
from .scene import refusing

if TYPE_CHECKING:
    from ..comparison.compare import Comparison


@click.command(short_help="Run time against error of the examples.")
@click.argument("names", metavar="[EXAMPLE]...", nargs=-1)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each example.")
def bench(names: tuple[str, ...], as_json: bool) -> None:
    """Measure run time against error of bdf, dop853 and auto on the shipped examples.

    EXAMPLE is a name that `stiffmbs examples list` shows; by default all examples are measured.  Errors and times are
    those of `stiffmbs compare`.

    Exit status: 0 measured, 1 some example could not be measured or the command was interrupted, 2 there is no such
    example.
    """
    from ..comparison.compare import compare
    from ..comparison.machine import machine, machine_sentence
    from .starting import scene_file, scene_files

    with refusing("bench"):
        files = {name: scene_file(name) for name in names or scene_files()}
    if not as_json:
        click.echo(machine_sentence())
    status = Status.DONE
    for name, path in files.items():
        try:
            found = compare(path)
        except StiffmbsError as error:
            click.echo(f"stiffmbs: {name}: {error}", err=True)
            status = Status.FAILED
            continue
        rows = [row.as_dict(found.measure) for row in found.rows]
        as_object = {"problem": name, "machine": machine(), "rows": rows}
        click.echo(json.dumps(as_object) if as_json else _table(name, found))
        if found.interrupted:
            sys.exit(Status.FAILED)
    sys.exit(status)


def _table(name: str, found: Comparison) -> str:
    rows = [
        f"  {row.solver:22} {row.setting:14} "
        + (row.message or f"error {row.errors[found.measure]:8.1e}  {row.seconds * 1e3:10.3f} ms")
        for row in found.rows
    ]
    return "\n".join([f"{name}: {found.conclusion}", *rows])
