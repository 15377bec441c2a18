"""Count the evaluations that runs of the examples and equilibria need.

``python -m tests.solve.efforts.measure`` records them in `recorded.csv`, which the tests compare with.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

import stiffmbs
from stiffmbs.analyses.run import prepare
from stiffmbs.equilibria.equilibrium import find_equilibrium
from tests.stress.random_statics import random_statics

ROOT = Path(__file__).parents[3]
RECORDED = Path(__file__).with_name("recorded.csv")
RUNS = ("bdf", "dop853", "dopri5")
TOLERANCES = (1e-3, 1e-5, 1e-7)
LONG = {"car", "governor", "stick_slip"}
"""Examples whose explicit runs take more than 5000 steps."""
UNSURE = {"four_bars", "half_car"}
"""Examples with bars that become parallel, and with a long rest: rounding decides how many steps that takes."""
SEEDS = range(40)
"""Of random mechanisms whose equilibria are sought, in turns in the plane and in space."""


def cases() -> list[tuple[str, str, float]]:
    """Return what is counted: scene, analysis, and relative tolerance (0 for an equilibrium)."""
    names = sorted(path.stem for path in (ROOT / "examples").glob("*.yaml") if path.stem not in UNSURE)
    runs = [
        (name, solver, rtol)
        for name in names
        for solver in RUNS
        for rtol in TOLERANCES
        if solver == "bdf" or name not in LONG
    ]
    car = [("vehicles/leaf_sprung_car", solver, 1e-6) for solver in RUNS]
    return [*runs, *car, *((f"random_statics {seed}", "equilibrium", 0.0) for seed in SEEDS)]


def evaluations(name: str, analysis: str, rtol: float) -> int:
    """Return the number of residuals or accelerations of a run, or of Newton moves to an equilibrium.

    Parameters
    ----------
    name : str
        Of the example, without its ending; or ``random_statics`` with a seed.
    analysis : {'bdf', 'dop853', 'dopri5', 'equilibrium'}
    rtol : float
        Relative tolerance of the run.
    """
    if analysis == "equilibrium":
        seed = int(name.split()[1])
        dynamics = prepare(random_statics(np.random.default_rng(seed), in_space=seed % 2 == 1)).dynamics
        dynamics.assemble(0.0)
        return find_equilibrium(dynamics, 0.0).moves
    scene = stiffmbs.load_scene(ROOT / "examples" / f"{name}.yaml")
    if analysis == "bdf":
        return int(prepare(scene, solver="bdf", rtol=rtol).integrate().statistics["residuals"])
    return int(prepare(scene, solver="projected", scheme=analysis, rtol=rtol).integrate().statistics["accelerations"])


def main() -> None:
    """Record the evaluations of all cases."""
    with RECORDED.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["scene", "analysis", "rtol", "evaluations"])
        table.writerows([*case, evaluations(*case)] for case in cases())


if __name__ == "__main__":
    main()
