"""The command ``stiffmbs stress``."""

from __future__ import annotations

import sys

import click

from ..errors import StiffmbsError

SOME_WRONG, WRONG_INPUT = 1, 2


@click.command(short_help="Cases that ask for more than is fair.")
@click.argument("names", metavar="[CASE]...", nargs=-1)
@click.option("--quick", is_flag=True, help="Leave out the cases that take long.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each case.")
def stress(names: tuple[str, ...], quick: bool, as_json: bool) -> None:
    """Ask for more than is fair, and show what came of it: right, told, slow, or WRONG without a word.

    CASE is the name of a case or of a family of cases.

    Exit status: 0 none is wrong, 1 some are, 2 there is no such case.
    """
    from . import catalogue, table
    from .case import Outcome

    try:
        cases = catalogue.chosen(names, quick)
    except StiffmbsError as error:
        click.echo(f"stiffmbs: {error}", err=True)
        sys.exit(WRONG_INPUT)
    rows = []
    for row in catalogue.outcomes(cases):
        rows.append(row)
        click.echo(table.as_json(row) if as_json else table.line(row))
    if not as_json:
        click.echo(table.summary(rows))
    sys.exit(SOME_WRONG if any(row.verdict.outcome is Outcome.WRONG for row in rows) else 0)
