"""Measure the time of auto over that of the best of bdf, dop853 and radau at an equal error, on the half car, the reference car or any scene.

    python -m tests.bench.solvers.choice half_car|car|SCENE [--stiffness 1e6 1e8] [--damping 0.02] [--duration 1 10] [--rtol 1e-3 1e-5]

Errors are the largest of the bodies' coordinates, m or rad, against radau at rtol 1e-10. A motion is left out as chaotic if radau
at 1e-9 differs from that by more than a tenth of the error of auto. Times are the least processor times of several integrations,
alternating between the solvers, without the set-up of a run.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.at_error import value_at_error

from ..drives import CARS
from .stiff_and_light import EXAMPLES, SOLVERS, measured

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
EXACT, CHECK, RESOLVED = 1e-10, 1e-9, 0.1
"""Relative tolerances of the reference and of its check, and their largest difference, in errors of auto."""
DURATIONS = (1.0, 3.0, 10.0)
"""Times of the motion of the cars, s."""
ROUNDS, LONGEST = 5, 4.0
"""Timings of each solver, and longest run, in the least time of the solvers before it."""


def model_of(name: str, stiffness: str, damping: str) -> Any:
    """Return the half car, or the reference car with a sine sweep, with bushings."""
    if name == "half_car":
        return stiffmbs.load_scene(EXAMPLES / "half_car.yaml", [("k_b", stiffness), ("zeta", damping)])
    return CARS[0].model("sweep", **{CARS[0].stiffness: stiffness, "zeta": damping})


def compared(model: Any, duration: float | None, rtols: list[float]) -> Iterator[str]:
    """Yield a line for each tolerance of auto: time, error, and the ratio to the best of the others at this error."""
    settings: dict[str, Any] = {} if duration is None else {"duration": duration}
    exact, check = (prepare(model, rtol=rtol, **settings, solver="radau").integrate().q for rtol in (EXACT, CHECK))
    noise = float(np.abs(exact - check).max())
    seconds: dict[tuple[str, float], float] = {}
    errors: dict[tuple[str, float], float] = {}
    tolerances = {name: rtols if name == "auto" else sorted({*TOLERANCES, *rtols}) for name in SOLVERS}
    for _ in range(ROUNDS):
        for name, rtol in [(solver, rtol) for solver in SOLVERS for rtol in tolerances[solver]]:
            if seconds.get((name, rtol)) == math.inf:
                continue
            longest = max(1.0, LONGEST * min(seconds.values(), default=math.inf))
            least, found = measured(model, rtol, {**SOLVERS[name], **settings}, longest, ROUNDS)
            seconds[name, rtol] = min(least, seconds.get((name, rtol), math.inf))
            if found is not None:
                errors[name, rtol] = float(np.abs(found.q - exact).max())
    for rtol in rtols:
        error = errors["auto", rtol]
        best = {
            name: value_at_error([(errors[key], seconds[key]) for key in errors if key[0] == name], error)
            for name in SOLVERS
            if name != "auto"
        }
        least, name = min((value, name) for name, value in best.items() if value is not None)
        ratio = f"{seconds['auto', rtol] / least:.2f} of {name}" if noise < RESOLVED * error else "chaotic"
        yield f"rtol {rtol:.0e}: {1e3 * seconds['auto', rtol]:.2f} ms, error {error:.1e}, {ratio}"


def main() -> None:
    """Print the ratios."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("model", help="half_car, car, or the file of a scene, which has its own stiffness and damping")
    parser.add_argument("--stiffness", nargs="+", default=["1e5", "1e6", "1e7", "1e8", "1e9", "1e10"], help="N/m")
    parser.add_argument("--damping", nargs="+", default=["0.01", "0.05", "0.2"])
    parser.add_argument("--duration", nargs="+", type=float, help="s; by default 1, 3 and 10, or that of the scene")
    parser.add_argument("--rtol", nargs="+", type=float, default=list(TOLERANCES[1:]))
    given = parser.parse_args()
    if given.model not in ("half_car", "car"):
        for duration in given.duration or [None]:
            for line in compared(stiffmbs.load_scene(given.model), duration, given.rtol):
                print(f"{given.model}, {line}", flush=True)
        return
    for duration, stiffness, damping in product(given.duration or DURATIONS, given.stiffness, given.damping):
        for line in compared(model_of(given.model, stiffness, damping), duration, given.rtol):
            print(f"{given.model}, {stiffness} N/m, damping {damping}, {duration:g} s, {line}", flush=True)


if __name__ == "__main__":
    main()
