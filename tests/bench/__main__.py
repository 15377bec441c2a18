"""Compare run time and error with those of yardsticks: ``python -m tests.bench [PROBLEM]...``."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from stiffmbs.errors import InputError

if TYPE_CHECKING:
    from .benchmark import Benchmark

WRONG_INPUT = 2


@click.command()
@click.argument("names", metavar="[PROBLEM]...", nargs=-1)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each problem.")
@click.option("--quick", is_flag=True, help="The smallest of each problem, at a few tolerances.")
@click.option("--solvers", is_flag=True, help="All formulations and schemes of this package, over decades of error.")
@click.option("--peers", is_flag=True, help="Compare with other tools, over decades of error.")
@click.option(
    "--plot", type=click.Path(file_okay=False, path_type=Path), help="Draw run time over error into a folder."
)
def bench(names: tuple[str, ...], as_json: bool, quick: bool, peers: bool, solvers: bool, plot: Path | None) -> None:
    """Measure run time against error, and that of yardsticks in the same process.

    PROBLEM is the name of a problem or of a family of problems; all without one.

    Exit status: 0 measured, 2 there is no such problem, or it cannot be measured in the way that is asked for.
    """
    if peers and solvers:
        raise click.UsageError("found both --peers and --solvers, expected one of them")
    if plot is not None and find_spec("matplotlib") is None:
        raise click.UsageError("--plot: this needs matplotlib, which is not installed: pip install 'stiffmbs[plot]'")
    try:
        _measure(names, as_json, quick, peers, solvers, plot)
    except InputError as error:
        _refuse(str(error))


def _measure(names: tuple[str, ...], as_json: bool, quick: bool, peers: bool, solvers: bool, plot: Path | None) -> None:
    from stiffmbs.comparison.machine import machine_sentence
    from stiffmbs.compile.machine.routines import fully_compiled

    from .report import as_json as object_of
    from .report import table

    chosen = _chosen(names, quick)
    if peers or solvers:
        chosen = _over_decades(chosen, peers)
    if not as_json:
        click.echo(machine_sentence())
    for benchmark in chosen:
        with fully_compiled():
            rows = benchmark.glanced() if quick else benchmark.measured()
        if as_json:
            click.echo(json.dumps(object_of(benchmark.name, rows)))
        else:
            click.echo("\n".join(table(benchmark.name, rows)))
        if plot is not None:
            from .figure import draw

            draw(benchmark.name, rows, plot)


def _refuse(sentence: str) -> NoReturn:
    click.echo(f"bench: {sentence}", err=True)
    sys.exit(WRONG_INPUT)


def _chosen(names: Iterable[str], quick: bool) -> list[Benchmark]:
    """The benchmarks of the names, of a family the smallest alone where that is asked for."""
    from .benchmark import families

    known = families()
    single = {benchmark.name: benchmark for family in known.values() for benchmark in family}
    chosen: list[Benchmark] = []
    for name in names or known:
        if name not in known and name not in single:
            _refuse(
                f"found the problem '{name}', expected one of {', '.join(known)}, or a problem of one of these such as {next(name for name in single if name not in known)}"
            )
        family = known.get(name) or (single[name],)
        chosen += family[:1] if quick else family
    return chosen


def _over_decades(chosen: Iterable[Benchmark], peers: bool) -> list[Benchmark]:
    """Compare this package, or all of its solvers, with other tools, in the tasks that they have."""
    from .beside_peers import BesidePeers
    from .own_solvers import OwnSolvers
    from .peers import missing
    from .problem import Problem

    known = [benchmark for benchmark in chosen if isinstance(benchmark, Problem)]
    problems = [problem for problem in known if problem.task or (peers and problem.in_space)]
    if not problems:
        _refuse("found no problem among these that other tools have a task in, expected one such as cart_pendulum")
    if not peers:
        return [OwnSolvers(problem) for problem in problems]
    for package in missing():
        click.echo(f"bench: without {package}, which is not installed (pip install 'stiffmbs[peers]')", err=True)
    return [BesidePeers(problem) for problem in problems]


if __name__ == "__main__":
    bench(prog_name="python -m tests.bench")
