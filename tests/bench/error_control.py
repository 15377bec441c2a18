"""A study of error control: which unknowns IDA tests, and how far, over stiff, closed, redundant and hard problems.

Run it by ``python -m tests.bench.error_control [PROBLEM...]``; it prints the table of ``docs/error_control.md``.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.elements.body import Body
from stiffmbs.elements.forces.bushing import Bushing
from stiffmbs.elements.joints.revolute import Revolute
from stiffmbs.model.model import Model
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.model.model_data import ModelData
from stiffmbs.reading.marker import Marker
from stiffmbs.solve.bdf import solve
from stiffmbs.solve.error_control.error_test import ErrorControl
from stiffmbs.solve.trajectory import Outcome

CONTROLS = {
    "huge, 0.33": ErrorControl(margin=1.0, newton=0.33, renewal=0.25, predicted_residual=False),
    "huge, 0.03": ErrorControl(margin=1.0, newton=0.03, renewal=0.25, predicted_residual=False),
    "huge, by stiffness": ErrorControl(margin=1.0, renewal=0.25, predicted_residual=False),
    "IDA's test": ErrorControl(margin=0.3, predicted_residual=False),
    "present": None,
}
"""How far Newton's iteration is taken, and whether it believes rates of convergence that were measured long ago."""
RTOLS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
REFERENCE = 1e-12
LONGEST = 4.0
"""Time, s, after which a run counts as stopped; a reference may take ten times as long."""
EXAMPLES = Path(__file__).parents[2] / "examples"


@dataclass(frozen=True)
class Problem:
    """A model, and the duration over which errors stay comparable, s."""

    model: Callable[[], ModelBuilder | ModelData]
    duration: float


def scene(name: str, *changes: tuple[str, str]) -> Callable[[], ModelData]:
    """An example with some values changed."""
    return partial(load_scene, EXAMPLES / f"{name}.yaml", changes)


def bushing_in_place(stiffness: float) -> Model:
    """A coupler on three cranks, the middle one of which holds it by a bushing in place of a redundant joint."""
    model = Model("Parallelogram", gravity=(0, -9.81))
    angle = np.radians(-60)
    c, s = np.cos(angle), np.sin(angle)
    model.add("coupler", Body(mass=2, inertia=1, position=(1 + c, s)))
    for name, x in (("a", 0.0), ("b", 1.0), ("c", 2.0)):
        model.add(name, Body(mass=1, inertia=1 / 12, position=(x + c / 2, s / 2), angle=angle))
        model.add(f"{name}_foot", Revolute(i=Marker(body=name, point=(-0.5, 0)), j=Marker(body="ground", point=(x, 0))))
        i, j = Marker(body=name, point=(0.5, 0)), Marker(body="coupler", point=(x - 1, 0))
        damping = 0.2 * np.sqrt(stiffness)
        bushing = Bushing(i=i, j=j, stiffness=(stiffness, stiffness, 0), damping=(damping, damping, 0))
        model.add(f"{name}_head", bushing if name == "b" else Revolute(i=i, j=j))
    return model


PROBLEMS = {
    "cart_pendulum": Problem(scene("cart_pendulum"), 10.0),
    "bar_pendulum": Problem(scene("bar_pendulum"), 3.0),
    "crank_slider": Problem(scene("crank_slider"), 0.2),
    "four_bars_2": Problem(scene("four_bars", ("N", "2")), 5.0),
    "four_bars_40": Problem(scene("four_bars", ("N", "40")), 0.6),
    "andrews": Problem(scene("andrews"), 0.03),
    "half_car_1e5": Problem(scene("half_car", ("k_b", "1e5")), 1.0),
    "half_car_1e7": Problem(scene("half_car", ("k_b", "1e7")), 1.0),
    "half_car_1e9": Problem(scene("half_car", ("k_b", "1e9")), 1.0),
    "chain_10": Problem(scene("chain"), 0.8),
    "chain_100": Problem(scene("chain", ("N", "100")), 0.3),
    "bouncing_ball": Problem(scene("bouncing_ball"), 0.8),
    "stick_slip": Problem(scene("stick_slip"), 1.0),
    "governor": Problem(scene("governor"), 2.0),
    "bricard": Problem(scene("bricard"), 5.0),
    "spatial_slider_crank": Problem(scene("spatial_slider_crank"), 2.0),
    "heavy_top": Problem(scene("heavy_top"), 1.0),
    "spatial_chain_100": Problem(scene("spatial_chain", ("N", "100")), 0.3),
    "bushing_1e6": Problem(partial(bushing_in_place, 1e6), 2.0),
    "bushing_1e8": Problem(partial(bushing_in_place, 1e8), 1.0),
}


def _patience(longest: float) -> Callable[[float], None]:
    """Ends a run that takes too long, as a user would."""
    begun = time.perf_counter()

    def watch(t: float) -> None:
        if time.perf_counter() - begun > longest:
            raise KeyboardInterrupt

    return watch


def last(job: Job, control: ErrorControl | None, longest: float = LONGEST) -> tuple[np.ndarray | None, int, int]:
    """Coordinates at the end (None for a run that stopped), steps and residuals."""
    trajectory = solve(job.dynamics, job.start, job.grid, job.settings, _patience(longest), control)
    done = trajectory.outcome is Outcome.DONE
    steps, residuals = (int(trajectory.statistics[name]) for name in ("steps", "residuals"))
    return trajectory.q[-1] if done else None, steps, residuals


def rows(name: str) -> list[str]:
    """The table's rows of one problem: steps, residuals and error by tolerance, one row for each control."""
    problem = PROBLEMS[name]
    model = problem.model()

    def job(rtol: float) -> Job:
        return prepare(model, solver="bdf", presolve=False, duration=problem.duration, points=3, rtol=rtol)

    expected = last(job(REFERENCE), None, 10 * LONGEST)[0]
    jobs = {rtol: job(rtol) for rtol in RTOLS}
    found = []
    for label, control in CONTROLS.items():
        cells = []
        for own in jobs.values():
            end, steps, residuals = last(own, control)
            error = "?" if end is None or expected is None else f"{np.max(np.abs(end - expected)):.0e}"
            cells.append("stopped" if end is None else f"{steps} / {residuals} / {error}")
        found.append(f"| {name} | {label} | {' | '.join(cells)} |")
    return found


def main(names: list[str]) -> None:
    """Print the table, in the form of a page."""
    print(f"| problem | control | {' | '.join(f'rtol {rtol:g}' for rtol in RTOLS)} |")
    print("|---" * (2 + len(RTOLS)) + "|")
    for name in names or PROBLEMS:
        for row in rows(name):
            print(row, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
