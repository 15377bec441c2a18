"""Run stress tests and random cases: ``python -m tests.stress [CASE]...`` and ``--fuzz NAME``."""

from __future__ import annotations

import os
import sys

import click

from stiffmbs.errors import InputError, StiffmbsError
from stiffmbs.solve import SOLVERS

from .replaced import REPLACEMENT, replace_bdf

SOME_WRONG, WRONG_INPUT = 1, 2
COUNT = 1000
"""Default number of random cases."""


@click.command()
@click.argument("names", metavar="[CASE]...", nargs=-1)
@click.option("--quick", is_flag=True, help="Skip long cases.")
@click.option(
    "--fuzz", metavar="NAME", is_flag=False, flag_value="", help="Run random cases of a fuzzer instead of CASEs."
)
@click.option("--count", type=click.IntRange(1), help="Number of random cases of --fuzz (default 1000).")
@click.option(
    "--seed",
    type=click.IntRange(0),
    help="Seed of the first random case of --fuzz (default 0); the seeds are consecutive.",
)
@click.option(
    "--instead-of-bdf",
    "solver",
    type=click.Choice(sorted(SOLVERS)),
    help="Integrate by this solver wherever a case takes bdf.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each case.")
def stress(
    names: tuple[str, ...],
    quick: bool,
    fuzz: str | None,
    count: int | None,
    seed: int | None,
    solver: str | None,
    as_json: bool,
) -> None:
    """Run stress tests and print their outcomes: right, told (reported), slow, or WRONG.

    CASE is the name of a case or of a family of cases.

    With --fuzz, random cases are drawn from seeds and run in a separate process.  Cases that are WRONG are printed: an
    unreported error, a traceback, a crash of the process, or more than 30 s of processor time.  --fuzz without a name
    lists the fuzzers.

    Exit status: 0 if no case is wrong, 1 if some are, 2 if there is no such case.
    """
    if solver:
        os.environ[REPLACEMENT] = solver  # for child processes
        replace_bdf(solver)
    try:
        if fuzz is None:
            some_wrong = _cases(names, quick, count, seed, as_json)
        else:
            some_wrong = _random_cases(fuzz, names, quick, range(seed or 0, (seed or 0) + (count or COUNT)), as_json)
    except StiffmbsError as error:
        click.echo(f"stress: {error}", err=True)
        sys.exit(WRONG_INPUT)
    sys.exit(SOME_WRONG if some_wrong else 0)


def _cases(names: tuple[str, ...], quick: bool, count: int | None, seed: int | None, as_json: bool) -> bool:
    """Try the cases of the catalogue; whether some are wrong."""
    from . import catalogue, table
    from .case import Outcome

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
    from . import fuzz
    from .case import Outcome

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


if __name__ == "__main__":
    stress(prog_name="python -m tests.stress")
