"""Time benchmark problems and examples by two versions of the package in turn, so that what slows the machine slows both.

    python .ci/beside.py OTHER [PROBLEM]...

OTHER is the folder of another checkout, as `git worktree add` makes one.  A PROBLEM is a name that `python -m tests.bench` knows, a
file such as `examples/chain.yaml`, or `examples` for all of these; all problems by default, cars on their manoeuvres among them.
A line for each solver and tolerance: the median of the ratios of two solutions that follow each other, this version's processor
time over the other's, and the least times of both.  Last the geometric mean of all ratios.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve()
RTOLS = (1e-3, 1e-4, 1e-6, 1e-8)
SHORTEST, FEWEST, MOST = 1.0, 4, 60
"""Time for a line, s, and pairs of solutions."""
LONGEST = 25.0
"""Time, s, after which a line ends with fewer pairs."""


class Version:
    """A process with one version of the package, which solves what it is asked for."""

    def __init__(self, checkout: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(HERE), "--serve"], env={**os.environ, "PYTHONPATH": str(checkout), "STIFFMBS_DRAFTS": "0"}, cwd=checkout,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def ask(self, *question: Any) -> Any:
        """The answer of `answers`."""
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(question) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())


def compared(this: Version, other: Version, problem: str, solver: str, rtol: float) -> float | None:
    """Print a line of the table, and return its ratio."""
    seconds: dict[Version, list[float]] = {this: [], other: []}
    begun, pairs = time.monotonic(), 0
    while pairs < FEWEST or (time.monotonic() - begun < SHORTEST and pairs < MOST):
        for version in (this, other) if pairs % 2 else (other, this):
            taken = version.ask(problem, solver, rtol)
            if taken is None:
                print(f"{problem} {solver} {rtol:g}: does not come to its end")
                return None
            seconds[version].append(taken)
        pairs += 1
        if time.monotonic() - begun > LONGEST:
            break
    ratio = statistics.median(a / b for a, b in zip(seconds[this], seconds[other], strict=True))
    least = [1e3 * min(seconds[version]) for version in (this, other)]
    print(f"{problem} {solver} {rtol:g}: {ratio:.3f}, {least[0]:.2f} ms beside {least[1]:.2f} ms", flush=True)
    return ratio


def answers() -> None:
    """Answer questions on standard input: the problems, the solvers of one, or the time of one of its solutions, s."""
    from stiffmbs.errors import StiffmbsError

    failed = _of_bench("contestant").Failed

    problems = dict(_problems())
    known: dict[str, dict[str, Callable[[float], Callable[[], Any]]]] = {}
    at_hand: tuple[Any, Callable[[], Any]] = (None, lambda: None)
    for line in sys.stdin:
        question = json.loads(line)
        answer: Any = list(problems)
        try:
            if question:
                name = question[0]
                known[name] = known.get(name) or problems[name]()
                answer = list(known[name])
            if len(question) > 1:
                if at_hand[0] != question:
                    at_hand = question, known[question[0]][question[1]](question[2])
                    at_hand[1]()
                begun = time.process_time()
                at_hand[1]()
                answer = time.process_time() - begun
        except (failed, StiffmbsError):
            answer = None
        print(json.dumps(answer), flush=True)


def _of_bench(module: str) -> Any:
    """Import a module of the benchmarks, which older versions have in the package."""
    try:
        return importlib.import_module(f"tests.bench.{module}")
    except ModuleNotFoundError:
        return importlib.import_module(f"stiffmbs.bench.{module}")


def _problems() -> Any:
    """Names, and what makes the solvers of each: functions of a tolerance that prepare a solution."""
    from stiffmbs.analyses.job import prepare

    families, solvers = _of_bench("benchmark").families, _of_bench("drives").SOLVERS

    def by_all(scene: Callable[[], Any]) -> dict[str, Any]:
        def at(how: dict[str, Any]) -> Callable[[float], Callable[[], Any]]:
            return lambda rtol: prepare(scene(), rtol=rtol, **how).integrate

        return {solver: at(how) for solver, how in solvers.items()}

    for family in families().values():
        for problem in family:
            kind = type(problem).__name__  # classes may have moved between the versions
            if kind == "Problem":
                yield problem.name, lambda p=problem: {c.solver: c.at for c in p.contestants() if not c.peer}
            elif kind == "Drive":
                yield problem.name, lambda d=problem: by_all(lambda: d.car.model(d.manoeuvre))
    for example in sorted(Path("examples").glob("**/*.yaml")):
        yield example.as_posix(), lambda path=example: by_all(lambda: path)


def main() -> None:
    """Compare what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, help="folder of another checkout")
    parser.add_argument("problems", nargs="*", metavar="PROBLEM")
    asked = parser.parse_args()
    this, other = Version(HERE.parents[1]), Version(asked.other.resolve())
    both = [name for name in this.ask() if name in other.ask()]
    examples = [name for name in both if name.startswith("examples/")]
    wanted = [each for name in asked.problems for each in (examples if name == "examples" else [name])]
    for name in wanted:
        if name not in both:
            parser.error(f"found the problem '{name}', expected one of {', '.join(both)}")
    ratios = []
    for name in wanted or both:
        solvers = other.ask(name)
        for solver in this.ask(name):
            for rtol in RTOLS if solver in solvers else ():
                ratios.append(compared(this, other, name, solver, rtol))
    known = [ratio for ratio in ratios if ratio]
    print(f"geometric mean of {len(known)} ratios: {statistics.geometric_mean(known):.3f}")


if __name__ == "__main__":
    answers() if sys.argv[1:] == ["--serve"] else main()
