"""Measure the time of auto over that of the best of bdf, dop853 and radau at an equal error, on cars, on all examples or on any scene.

    python -m tests.bench.solvers.choice half_car|car|examples|published|SCENE [--stiffness 1e6 1e8] [--damping 0.02] [--duration 1 10] [--rtol 1e-3 1e-5]

`examples` are the scenes in the folder of examples, `published` the problems of `tests.bench.solvers.stiff_and_light`.
Errors are the largest of the bodies' coordinates, m or rad, against dop853 at rtol 1e-10, or radau if that takes too long.
A motion is left out as chaotic if the same at 1e-9 differs from that by more than a tenth of the error of auto. Times are
the least processor times of several integrations, alternating between the solvers, without the set-up of a run.

The last lines are the ratios beyond the limit of the target, the largest first. An excess of less than 0.3 ms is within it:
it does not grow with the motion, and the set-up of a run takes tens of ms.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple

import numpy as np

import stiffmbs
from stiffmbs.comparison.at_error import value_at_error

from ..drives import CARS
from .stiff_and_light import EXAMPLES, PROBLEMS, SOLVERS, measured

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
EXACT, CHECK, RESOLVED = 1e-10, 1e-9, 0.1
"""Relative tolerances of the reference and of its check, and their largest difference, in errors of auto."""
DURATIONS = (1.0, 3.0, 10.0)
"""Times of the motion of the cars, s."""
ROUNDS, LONGEST, PATIENCE = 5, 4.0, 20.0
"""Timings of each solver; longest run, in the least time of the solvers before it; longest run of the reference, s."""
POINTS = 1001
"""Output times of scenes that store the steps of the solver."""
OF_CARS, OF_SCENES, NEGLIGIBLE = 1.2, 1.5, 3e-4
"""Limits of the ratio on cars and on other scenes, and the excess, s, below which there is none."""


class Choice(NamedTuple):
    """Comparison of auto with the best of the others at the error of auto.

    `seconds`, `best`: processor times, s. `name`: the best solver; empty if the motion is chaotic or no other is as accurate.
    """

    rtol: float
    error: float
    seconds: float
    best: float
    name: str

    def __str__(self) -> str:
        """Return the comparison as a line."""
        ratio = f"{self.ratio:.2f} of {self.name}" if self.name else "not comparable"
        return f"rtol {self.rtol:.0e}: {1e3 * self.seconds:.2f} ms, error {self.error:.1e}, {ratio}"

    @property
    def ratio(self) -> float:
        """Return the ratio of the times."""
        return self.seconds / self.best

    def exceeds(self, limit: float) -> bool:
        """Return True if the ratio exceeds a limit by a time that matters."""
        return bool(self.name) and self.ratio > limit and self.seconds - self.best > NEGLIGIBLE


def model_of(name: str, stiffness: str, damping: str) -> Any:
    """Return the half car, or the reference car with a sine sweep, with bushings."""
    if name == "half_car":
        return stiffmbs.load_scene(EXAMPLES / "half_car.yaml", [("k_b", stiffness), ("zeta", damping)])
    return CARS[0].model("sweep", **{CARS[0].stiffness: stiffness, "zeta": damping})


def targets(
    name: str, stiffness: list[str], damping: list[str], durations: list[float] | None
) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield name, model and changed settings of each motion of a target."""
    if name == "examples":
        for path in sorted(EXAMPLES.rglob("*.yaml")):
            if "parts" not in path.parts:
                model = stiffmbs.load_scene(path)
                by_steps = {"points": POINTS} if model.run.points == "steps" else {}
                yield str(path.relative_to(EXAMPLES)), model, by_steps
    elif name == "published":
        for title, (make, settings) in PROBLEMS.items():
            yield title, make(), settings
    elif name in ("half_car", "car"):
        for duration, k, zeta in product(durations or DURATIONS, stiffness, damping):
            yield f"{name}, {k} N/m, damping {zeta}, {duration:g} s", model_of(name, k, zeta), {"duration": duration}
    else:
        for settings in [{"duration": one} for one in durations or ()] or [{}]:
            yield name, stiffmbs.load_scene(name), settings


def reference(model: Any, settings: dict[str, Any]) -> tuple[np.ndarray, float] | None:
    """Return the coordinates of the reference and their largest difference from its check; None if they take too long."""
    for solver in ("dop853", "radau"):
        how = {**SOLVERS[solver], **settings}
        found = [measured(model, rtol, how, PATIENCE, 1)[1] for rtol in (CHECK, EXACT)]
        if all(found):
            return found[1].q, float(np.abs(found[1].q - found[0].q).max())
    return None


def compared(model: Any, settings: dict[str, Any], given: list[float], rounds: int) -> Iterator[Choice]:
    """Yield the comparison at each tolerance of auto."""
    known = reference(model, settings)
    if known is None:
        return
    exact, noise = known
    seconds: dict[tuple[str, float], float] = {}
    errors: dict[tuple[str, float], float] = {}
    for rtol in given:
        seconds["auto", rtol], found = measured(model, rtol, {**SOLVERS["auto"], **settings}, math.inf, 1)
        errors["auto", rtol] = float(np.abs(found.q - exact).max()) if found else 0.0
    rtols = [rtol for rtol in given if noise < RESOLVED * errors["auto", rtol]]
    tolerances = {name: rtols if name == "auto" else sorted({*TOLERANCES, *rtols}) for name in SOLVERS if rtols}
    for _ in range(rounds):
        for name, rtol in [(solver, rtol) for solver in tolerances for rtol in tolerances[solver]]:
            if seconds.get((name, rtol)) == math.inf:
                continue
            longest = max(1.0, LONGEST * min(seconds.values(), default=math.inf))
            least, found = measured(model, rtol, {**SOLVERS[name], **settings}, longest, rounds)
            seconds[name, rtol] = min(least, seconds.get((name, rtol), math.inf))
            if found is not None:
                errors[name, rtol] = float(np.abs(found.q - exact).max())
    for rtol in given:
        error = errors["auto", rtol]
        best = [
            (value_at_error([(errors[key], seconds[key]) for key in errors if key[0] == name], error), name)
            for name in SOLVERS
            if name != "auto"
        ]
        least, name = min([(value, name) for value, name in best if value is not None], default=(math.inf, ""))
        yield Choice(rtol, error, seconds["auto", rtol], least, name if rtol in rtols else "")


def main() -> None:
    """Print the comparisons, and those beyond the limit."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("target", help="half_car, car, examples, published, or the file of a scene")
    parser.add_argument(
        "--stiffness", nargs="+", default=["1e5", "1e6", "1e7", "1e8", "1e9", "1e10"], help="of cars, N/m"
    )
    parser.add_argument("--damping", nargs="+", default=["0.01", "0.05", "0.2"], help="of cars")
    parser.add_argument("--duration", nargs="+", type=float, help="s; by default 1, 3 and 10, or that of the scene")
    parser.add_argument("--rtol", nargs="+", type=float, default=list(TOLERANCES[1:]))
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="timings of each solver")
    given = parser.parse_args()
    limit = OF_CARS if given.target in ("half_car", "car") else OF_SCENES
    beyond = []
    for name, model, settings in targets(given.target, given.stiffness, given.damping, given.duration):
        for choice in compared(model, settings, given.rtol, given.rounds):
            print(f"{name}, {choice}", flush=True)
            if choice.exceeds(limit):
                beyond.append((choice.ratio, f"{name}, {choice}"))
    print(f"beyond {limit:g}: {len(beyond)}")
    for _, line in sorted(beyond, reverse=True):
        print(line)


if __name__ == "__main__":
    main()
