"""Compare bdf, dop853, radau and auto on stiff, published and large problems: processor time, error and steps at two tolerances.

    python -m tests.bench.solvers.stiff_and_light [PROBLEM ...] [--rtol 1e-4 1e-7] [--longest 20]

Errors are the largest of the bodies' coordinates, m or rad, against radau at rtol 1e-10, or dop853 where no force is stiff.
Times are the least of several integrations, alternating between the solvers, without the set-up of a run.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import stiffmbs
from stiffmbs import Bushing
from stiffmbs.analyses.job import prepare
from stiffmbs.solve.trajectory import Outcome

from ...stress.mechanisms.parallelogram import parallelogram

EXAMPLES = Path(__file__).parents[3] / "examples"
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"}, "dop853": {"solver": "projected", "scheme": "dop853"}, "radau": {"solver": "radau"}, "auto": {"solver": "auto"},
}  # fmt: skip
REFERENCE, ROUNDS, ENOUGH = 1e-10, 5, 0.5
"""Relative tolerance of the reference; most timings of a solver, and processor time, s, after which there is no other."""

CAR_AXIS = """
name: Car axis of the Test Set for IVP Solvers
gravity: [0, -1]
parameters: {m: 5.0e-4}
bodies:
  left: {mass: m, inertia: m, position: [0, 0.5]}
  right: {mass: m, inertia: m, position: [1, 0.5]}
joints:
  axle: {type: equation, zero: (left.x - right.x)^2 + (left.y - right.y)^2 - 1}
  upright: {type: equation, zero: left.x*x_b + left.y*y_b}
forces:
  left_spring: {type: force, i: left, force: ["(0.5/sqrt(left.x^2 + left.y^2) - 1)*left.x", "(0.5/sqrt(left.x^2 + left.y^2) - 1)*left.y"]}
  right_spring:
    type: force
    i: right
    force:
      - (0.5/sqrt((right.x - x_b)^2 + (right.y - y_b)^2) - 1)*(right.x - x_b)
      - (0.5/sqrt((right.x - x_b)^2 + (right.y - y_b)^2) - 1)*(right.y - y_b)
run: {duration: 3 s, points: 301}
""".replace("x_b", "sqrt(1 - y_b^2)").replace("y_b", "(0.1*sin(10*t))")
NODE = """
name: Light overdamped node between a mass and the ground
gravity: [0, 0]
bodies:
  load: {mass: 1, inertia: 1, position: [1, 0], velocity: [1, 0]}
  node: {mass: 1.0e-6, inertia: 1, position: [0.5, 0]}
forces:
  spring: {type: force, i: load, j: node, force: ["-1e4*(load.x - node.x - 0.5)", 0]}
  damper: {type: force, i: node, force: ["-1e4*(node.x - 0.5) - 10*node.vx", 0]}
run: {duration: 2 s, points: 201}
"""


def closed_by_bushing(stiffness: float) -> Any:
    """Return a parallelogram of three cranks; a bushing replaces the redundant pin, with a damping ratio of about 0.02."""
    model = parallelogram(3)
    pin: Any = model.joints.pop("crank2_top")
    damping = 0.04 * math.sqrt(stiffness)
    model.add("bushing", Bushing(i=pin.i, j=pin.j, stiffness=(stiffness, stiffness, 0), damping=(damping, damping, 0)))
    return model


def example(name: str, *changes: tuple[str, str]) -> Callable[[], Any]:
    """Return a function that loads an example with changed parameters."""
    return lambda: stiffmbs.load_scene(EXAMPLES / f"{name}.yaml", list(changes))


PROBLEMS: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "half car, 1e9 N/m": (example("half_car", ("k_b", "1e9 N/m"), ("zeta", "0.02")), {}),
    "elastic bearing": (example("elastic_bearing"), {}),
    **{
        f"bushing for a joint, {k:.0e} N/m": (partial(closed_by_bushing, k), {"duration": 2.0, "points": 201})
        for k in (1e4, 1e6, 1e8, 1e10, 1e12)
    },
    "light overdamped node": (lambda: stiffmbs.read_scene(NODE), {}),
    "car axis": (lambda: stiffmbs.read_scene(CAR_AXIS), {}),
    "Andrews": (example("andrews"), {}),
    "four-bars (A02), N = 2": (example("four_bars", ("N", "2")), {"duration": 10.0}),
    "chain of 10": (example("chain", ("N", "10")), {"duration": 1.0}),
    "chain of 100": (example("chain", ("N", "100")), {"duration": 1.0}),
    "chain of 1000": (example("chain", ("N", "1000")), {"duration": 0.2}),
    "spatial chain": (example("spatial_chain"), {"duration": 1.0}),
}  # fmt: skip
"""Model and changed settings of each problem."""


class TooLong(Exception):
    """A run takes longer than the limit."""


def watched(longest: float) -> Callable[[float], None]:
    """Return a progress callback that ends a run after a processor time, s."""
    begun = time.process_time()

    def watch(t: float) -> None:
        if time.process_time() > begun + longest:
            raise TooLong

    return watch


def measured(model: Any, rtol: float, how: dict[str, Any], longest: float, rounds: int) -> tuple[float, Any]:
    """Return the least processor time of several integrations, s, and the trajectory; no trajectory if a run fails."""
    job = prepare(model, rtol=rtol, **how)
    least, spent = math.inf, 0.0
    for _ in range(rounds):
        begun = time.process_time()
        try:
            found = job.integrate(watched(longest))
        except TooLong:
            return math.inf, None
        seconds = time.process_time() - begun
        least, spent = min(least, seconds), spent + seconds
        if found.outcome is not Outcome.DONE:
            return math.inf, None
        if spent > ENOUGH:
            break
    return least, found


def rows(name: str, rtols: list[float], longest: float) -> Iterator[str]:
    """Yield a line for each tolerance of a problem: time, ms, error and steps of each solver."""
    make, settings = PROBLEMS[name]
    model = make()
    for how in (SOLVERS["dop853"], SOLVERS["radau"]):
        _, exact = measured(model, REFERENCE, {**how, **settings}, longest, 1)
        if exact is not None:
            break
    for rtol in rtols:
        cells = []
        for how in SOLVERS.values():
            seconds, found = measured(model, rtol, {**how, **settings}, longest, ROUNDS)
            error = math.nan if found is None or exact is None else float(np.abs(found.q - exact.q).max())
            steps = f"{found.statistics['steps']:7}" if found is not None else f"{'-':>7}"
            cells.append(
                f"{1e3 * seconds:9.2f} {error:8.1e} {steps}" if found is not None else f"{'-':>9} {'-':>8} {steps}"
            )
        yield f"{name:28} {rtol:7.0e} " + "  ".join(cells)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=", ".join(PROBLEMS))
    parser.add_argument("--rtol", nargs="+", type=float, default=[1e-4, 1e-7])
    parser.add_argument("--longest", type=float, default=20.0, help="processor time of a run, s")
    given = parser.parse_args()
    if unknown := [name for name in given.problems if name not in PROBLEMS]:
        parser.error(f"found the problem '{unknown[0]}', expected one of: {', '.join(PROBLEMS)}")
    print(f"{'':28} {'rtol':>7} " + "  ".join(f"{name + ', ms':>9} {'error':>8} {'steps':>7}" for name in SOLVERS))
    for name in given.problems or PROBLEMS:
        for row in rows(name, given.rtol, given.longest):
            print(row, flush=True)


if __name__ == "__main__":
    main()
