"""Compare radau with bdf at an equal error on the manoeuvres of cars, over stiffness and damping of their bushings.

    python -m tests.bench.solvers.manoeuvres [--car reference_car_bushings] [--stiffness 1e6 1e7 1e8 1e9] [--damping 0.01 0.2]
        [--manoeuvre sweep step bump] [--duration 10] [--rtol 1e-4]

Each line has the largest errors of radau, of positions, m, and of bushing forces, relative to the largest force, its processor
time, and that time over the time of bdf at the same error of positions and of forces. Times are the least of several
integrations, alternating between the solvers. The reference is radau at rtol 1e-8; its difference from bdf at 1e-7 is printed.
"""

from __future__ import annotations

import argparse
import math
from itertools import product
from typing import Any

from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.at_error import value_at_error
from stiffmbs.comparison.sweep import seconds_of

from ..drives import CARS, Car, Seen, seen

RTOLS = (3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
"""Relative tolerances of bdf."""
EXACT, CHECK = 1e-8, 1e-7
"""Those of the reference by radau, and of bdf, which confirms it."""
ROUNDS = 3


def line(car: Car, manoeuvre: str, changes: dict[str, str], how: dict[str, Any], rtol: float) -> str:
    """Return the line of a manoeuvre."""
    model = car.model(manoeuvre, **changes)
    exact = _run(model, "radau", EXACT, how)
    noise = _run(model, "bdf", CHECK, how).errors(exact)
    runs = [("radau", rtol), *(("bdf", one) for one in RTOLS)]
    errors = {run: _run(model, *run, how).errors(exact) for run in runs}
    seconds = dict.fromkeys(runs, math.inf)
    steps = {}
    for _ in range(ROUNDS):
        for name, one in runs:
            spent, found = seconds_of(prepare(model, rtol=one, solver=name, **how).integrate)
            seconds[name, one] = min(seconds[name, one], spent)
            steps[name, one] = found.statistics["steps"]
    of_radau, time = errors[runs[0]], seconds[runs[0]]
    ratios = []
    for quantity, error in of_radau.items():
        of_bdf = value_at_error([(errors[run][quantity], seconds[run]) for run in runs[1:]], error)
        ratios.append(f"{time / of_bdf:.2f}" if of_bdf else f"< {time / max(seconds[run] for run in runs[1:]):.2f}")
    shown = ", ".join(
        f"{quantity} {error:.1e} (reference {noise[quantity]:.0e})" for quantity, error in of_radau.items()
    )
    settings = ", ".join(f"{name} {value}" for name, value in changes.items())
    return (
        f"{manoeuvre}, {settings}: {shown}, {steps[runs[0]]} steps, {1e3 * time:.0f} ms, {' and '.join(ratios)} of bdf"
    )


def _run(model: Any, solver: str, rtol: float, how: dict[str, Any]) -> Seen:
    return seen(model, prepare(model, rtol=rtol, solver=solver, **how))


def main() -> None:
    """Print a line for each manoeuvre, stiffness and damping."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    with_bushings = {car.name: car for car in CARS if car.stiffness}
    parser.add_argument("--car", default=next(iter(with_bushings)), choices=with_bushings)
    parser.add_argument("--stiffness", nargs="+", default=["1e6", "1e7", "1e8", "1e9"], help="N/m")
    parser.add_argument("--damping", nargs="+", default=["0.01", "0.2"], help="damping ratio")
    parser.add_argument("--manoeuvre", nargs="+", help="by default all of the car")
    parser.add_argument("--duration", type=float, default=10.0, help="s")
    parser.add_argument("--rtol", type=float, default=1e-4, help="that of radau")
    given = parser.parse_args()
    car = with_bushings[given.car]
    for manoeuvre, k, zeta in product(given.manoeuvre or car.manoeuvres, given.stiffness, given.damping):
        changes = {car.stiffness: k, "zeta": zeta}
        try:
            print(line(car, manoeuvre, changes, {"duration": given.duration}, given.rtol), flush=True)
        except RuntimeError as stopped:  # links of soft, lightly damped suspensions turn over
            print(f"{manoeuvre}, {changes}: {stopped}", flush=True)


if __name__ == "__main__":
    main()
