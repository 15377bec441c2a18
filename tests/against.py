"""Compare the run times of this checkout with those of another one: ``python -m tests.against FOLDER [SCENE]...``.

Each of two processes holds one checkout.  They integrate the same examples in turns, so that what else the machine does
disturbs both alike; the ratio of a round is the median over the turns of this checkout's CPU time by the other's.  Processes
differ by the places of their memory, so there are several rounds.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import geometric_mean, median
from typing import Any

ROOT = Path(__file__).parents[1]
SETTINGS: tuple[dict[str, str], ...] = (
    {"solver": "bdf"},
    {"solver": "projected", "scheme": "dop853"},
    {"solver": "auto"},
)
FEWEST, MOST = 5, 200
"""Turns of a row in a round."""


@dataclass(frozen=True)
class Row:
    """The ratio of run times, this checkout's time, s, and the numbers of steps of both."""

    ratio: float
    seconds: float
    steps: tuple[int, int]


def serve() -> None:
    """Integrate what standard input names, and print CPU time, s, and number of steps; scenes stay prepared."""
    import time

    from stiffmbs.errors import StiffmbsError
    from stiffmbs.jobs.job import prepare

    jobs: dict[str, Any] = {}
    for line in sys.stdin:
        if line not in jobs:
            scene, settings = json.loads(line)
            try:
                jobs[line] = prepare(scene, **settings)
                jobs[line].integrate()
            except StiffmbsError:
                jobs[line] = None
        if jobs[line] is None:
            print("nan 0", flush=True)
            continue
        before = time.process_time()
        steps = jobs[line].integrate().statistics["steps"]
        print(time.process_time() - before, steps, flush=True)


class Checkout:
    """A process that runs the package of one checkout.

    Parameters
    ----------
    folder : Path
        Of the checkout.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._process = subprocess.Popen(
            [sys.executable, __file__, "--serve"], env={**os.environ, "PYTHONPATH": str(folder)}, cwd=folder,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip

    def measured(self, scene: str, settings: dict[str, str]) -> tuple[float, int]:
        """Return the CPU time, s, and the number of steps of an integration."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(json.dumps([str(self.folder / scene), settings]) + "\n")
        self._process.stdin.flush()
        seconds, steps = self._process.stdout.readline().split()
        return float(seconds), int(steps)


def ratio(own: Checkout, other: Checkout, scene: str, settings: dict[str, str], budget: float) -> Row | None:
    """Compare two checkouts on one scene; None where one of them refuses it."""
    first = [checkout.measured(scene, settings) for checkout in (own, other)]
    if not min(seconds for seconds, _ in first) > 0:
        return None
    turns = max(FEWEST, min(MOST, int(budget / sum(seconds for seconds, _ in first))))
    times: dict[Checkout, list[float]] = {own: [], other: []}
    for turn in range(turns):
        for checkout in (own, other)[:: 1 if turn % 2 else -1]:
            times[checkout].append(checkout.measured(scene, settings)[0])
    found = median(a / b for a, b in zip(times[own], times[other], strict=True))
    return Row(found, median(times[own]), (first[0][1], first[1][1]))


def compare(other: Path, scenes: list[str], budget: float, rounds: int) -> None:
    """Print a row for each scene and solver: the median over rounds, each with processes of its own."""
    rows: dict[tuple[str, str], list[Row]] = {}
    for _ in range(rounds):
        own, others = Checkout(ROOT), Checkout(other)
        for scene in scenes:
            for settings in SETTINGS:
                row = ratio(own, others, scene, settings, budget / rounds)
                if row:
                    rows.setdefault((Path(scene).stem, settings["solver"]), []).append(row)
    for (name, solver), found in rows.items():
        ratios = sorted(row.ratio for row in found)
        steps, base = found[0].steps
        print(
            f"{name:24} {solver:10} ratio {median(ratios):.3f} ({ratios[0]:.3f} to {ratios[-1]:.3f})  "
            f"steps {steps:6} {base:6}  {1e3 * median(row.seconds for row in found):9.2f} ms"
        )
    ratios = [median(row.ratio for row in found) for found in rows.values()]
    print(f"geometric mean of {len(ratios)} ratios: {geometric_mean(ratios):.3f}")


def main() -> None:
    """Compare with the checkout that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="the other checkout, such as a git worktree")
    parser.add_argument("scenes", nargs="*", help="from the repository's root; all examples without any")
    parser.add_argument("--seconds", type=float, default=6.0, help="CPU time of a row")
    parser.add_argument("--rounds", type=int, default=3, help="how often both processes are started anew")
    asked = parser.parse_args()
    examples = [path.relative_to(ROOT).as_posix() for path in sorted((ROOT / "examples").glob("**/*.yaml"))]
    known = [scene for scene in examples if (asked.folder / scene).exists()]
    compare(asked.folder.resolve(), asked.scenes or known, asked.seconds, asked.rounds)


if __name__ == "__main__":
    serve() if "--serve" in sys.argv else main()
