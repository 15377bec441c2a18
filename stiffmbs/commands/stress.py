"""The command ``stiffmbs stress``."""

from __future__ import annotations

import sys

import click

from ..errors import InputError, StiffmbsError

SOME_WRONG, WRONG_INPUT = 1, 2
COUNT = 1000
"""Random cases of a fuzzer, unless told."""


@click.command(short_help="Cases that ask for more than is fair.")
@click.argument("names", metavar="[CASE]...", nargs=-1)
@click.option("--quick", is_flag=True, help="Leave out the cases that take long.")
@click.option(
    "--fuzz", metavar="NAME", is_flag=False, flag_value="", help="Try random cases of a fuzzer in place of CASEs."
)
@click.option("--count", type=click.IntRange(1), help="Random cases of --fuzz; 1000 unless given.")
@click.option(
    "--seed",
    type=click.IntRange(0),
    help="Seed of the first random case of --fuzz, the next has the next; 0 unless given.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each case.")
def stress(
    names: tuple[str, ...], quick: bool, fuzz: str | None, count: int | None, seed: int | None, as_json: bool
) -> None:
    """Ask for more than is fair, and show what came of it: right, told, slow, or WRONG without a word.

    CASE is the name of a case or of a family of cases.

    With --fuzz random cases are made from seeds and tried in a process of their own.  Those that are WRONG are printed: with a
    silent difference, a traceback, a crash of the process, or no end within 30 s of processor time.  --fuzz without a name
    lists the fuzzers.

    Exit status: 0 none is wrong, 1 some are, 2 there is no such case.
    """
    try:
        if fuzz is None:
            some_wrong = _cases(names, quick, count, seed, as_json)
        else:
            some_wrong = _random_cases(fuzz, names, quick, range(seed or 0, (seed or 0) + (count or COUNT)), as_json)
    except StiffmbsError as error:
        click.echo(f"stiffmbs: {error}", err=True)
        sys.exit(WRONG_INPUT)
    sys.exit(SOME_WRONG if some_wrong else 0)


def _cases(names: tuple[str, ...], quick: bool, count: int | None, seed: int | None, as_json: bool) -> bool:
    """Try the cases of the catalogue; whether some are wrong."""
    from ..stress import catalogue, table
    from ..stress.case import Outcome

    if count is not None or seed is not None:
        raise InputError("found --count or --seed, expected them with --fuzz alone")
    rows = []
    for row in catalogue.outcomes(catalogue.chosen(names, quick)):
        rows.append(row)
        click.echo(table.as_json(row) if as_json else table.line(row))
    if not as_json:
        click.echo(table.summary(rows))
    return any(row.verdict.outcome is Outcome.WRONG for row in rows)


def _random_cases(fuzzer: str, names: tuple[str, ...], quick: bool, seeds: range, as_json: bool) -> bool:
    """Try a fuzzer's cases; whether some are wrong."""
    from ..stress import fuzz
    from ..stress.case import Outcome

    if names or quick:
        raise InputError("found CASE or --quick beside --fuzz, expected one or the other")
    found = []
    for trial in fuzz.trials(fuzz.module_of(fuzzer), seeds):
        found.append(trial)
        if as_json:
            click.echo(trial.as_json())
        elif trial.verdict.outcome is Outcome.WRONG:
            click.echo(trial.line())
    if not as_json:
        click.echo(fuzz.summary(found))
    return any(trial.verdict.outcome is Outcome.WRONG for trial in found)
