"""Compare bdf and radau on the half car: run time and errors over stiffness and tolerance.

    python -m tests.bench.solvers.radau [--stiffness 1e5 1e7 1e9 1e11] [--rtol 1e-3 1e-4 1e-6 1e-8] [--damping 0.02] [--repeats 7]

Errors are the largest of the bodies' positions, m, and of the bushing forces, relative to the largest force, against bdf
at rtol 1e-11.  The time is the least of several runs in one process, alternating between the solvers.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import stiffmbs

SCENE = Path(__file__).parents[3] / "examples" / "half_car.yaml"
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "radau 5": {"solver": "radau", "stages": 3},
    "radau 9": {"solver": "radau", "stages": 5},
    "radau 13": {"solver": "radau", "stages": 7},
    "radau": {"solver": "radau"},
}
REFERENCE = 1e-11
"""Relative tolerance of the reference."""


def channels(solution: stiffmbs.Solution, kinds: tuple[str, ...]) -> np.ndarray:
    """Return the channels whose names end in one of the kinds."""
    names = [name for name in solution if name.endswith(kinds) and not name.startswith(("energy", "constraint"))]
    return np.array([solution[name] for name in names])


def rows(stiffness: str, damping: str, rtols: list[float], repeats: int) -> Iterator[str]:
    """Yield a line for each tolerance and solver."""
    scene = stiffmbs.load_scene(SCENE, [("k_b", f"{stiffness} N/m"), ("zeta", damping)])
    exact = stiffmbs.run(scene, solver="bdf", rtol=REFERENCE)
    positions, forces = channels(exact, (".x", ".y")), channels(exact, (".fx", ".fy"))
    for rtol in rtols:
        runs = {name: [stiffmbs.run(scene, rtol=rtol, **how)] for name, how in SOLVERS.items()}
        for _ in range(repeats - 1):
            for name, how in SOLVERS.items():
                runs[name].append(stiffmbs.run(scene, rtol=rtol, **how))
        for name, solutions in runs.items():
            found, least = solutions[0], min(float(each.solver["seconds"]) for each in solutions)
            of_positions = np.abs(channels(found, (".x", ".y")) - positions).max()
            of_forces = np.abs(channels(found, (".fx", ".fy")) - forces).max() / np.abs(forces).max()
            work = [found.solver[key] for key in ("steps", "residuals", "factorizations", "newton_failures")]
            yield f"{stiffness:>6} {rtol:7.0e}  {name:8} {1e3 * least:8.2f} ms  {of_positions:8.1e} {of_forces:8.1e}  " + " ".join(f"{int(number):6d}" for number in work)  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--stiffness", nargs="+", default=["1e5", "1e7", "1e9", "1e11"])
    parser.add_argument("--rtol", nargs="+", type=float, default=[1e-3, 1e-4, 1e-6, 1e-8])
    parser.add_argument("--damping", default="0.02")
    parser.add_argument("--repeats", type=int, default=7)
    given = parser.parse_args()
    print("   N/m    rtol  solver       time     m        force    steps residuals factors failures")
    for stiffness in given.stiffness:
        for row in rows(stiffness, given.damping, given.rtol, given.repeats):
            print(row, flush=True)


if __name__ == "__main__":
    main()
