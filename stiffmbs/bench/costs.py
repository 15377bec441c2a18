"""What a step of each integrator costs, for the constants of `stiffmbs.solve.cost`.

Run it by ``python -m stiffmbs.bench.costs``: the examples are solved at several tolerances, so that what a run costs
but for its steps drops out of the differences; the constants are a least-squares fit of relative errors, none below 0.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import nnls

from ..describe.model_data import ModelData
from ..describe.settings import RunSettings
from ..jobs.job import Job, prepare
from ..solve import bdf, cost
from ..solve.subsystems import Subsystem
from .drives import CARS
from .error_control import scene

SCENES: dict[str, Callable[[], ModelData]] = {
    "cart_pendulum": scene("cart_pendulum"),
    "andrews": scene("andrews"),
    "four_bars_2": scene("four_bars", ("N", "2")),
    "four_bars_40": scene("four_bars", ("N", "40")),
    "half_car": scene("half_car", ("k_b", "1e5")),
    "chain_10": scene("chain"),
    "chain_100": scene("chain", ("N", "100")),
    "heavy_top": scene("heavy_top"),
    "bricard": scene("bricard"),
    "spatial_slider_crank": scene("spatial_slider_crank"),
    **{car.name: partial(car.model, "sweep") for car in CARS},
}
RTOLS = (1e-4, 1e-6, 1e-8)
SECONDS, LONGEST = 2.0, 2.0
"""For which the runs of one scene and solver are repeated; the shortest times count. The motions of cars are cut off."""

Run = tuple[float, Mapping[str, Any]]


def runs(model: ModelData, **settings: Any) -> tuple[Job | Subsystem, list[Run]]:
    """A job of the scene or of its first part, and for each tolerance the shortest time (microseconds of the processor) and the counters."""
    jobs = [prepare(model, rtol=rtol, **settings) for rtol in RTOLS]
    shortest, statistics = [np.inf] * len(jobs), [job.integrate().statistics for job in jobs]
    begun = time.process_time()
    while time.process_time() - begun < SECONDS:
        for k, job in enumerate(jobs):
            at = time.process_time()
            job.integrate()
            shortest[k] = min(shortest[k], 1e6 * (time.process_time() - at))
    return (jobs[0].subsystems or jobs)[0], list(zip(shortest, statistics, strict=True))


def differences(found: list[Run], *counters: str) -> list[list[float]]:
    """From each tolerance to the next: the counters, then the time."""
    return [
        [*(float(b[name]) - float(a[name]) for name in counters), after - before]
        for (before, a), (after, b) in itertools.pairwise(found)
    ]


def fit(features: list[list[float]], times: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """The costs of the features, and what they make of each time, relative to it."""
    scaled = np.array(features) / np.array(times)[:, None]
    costs = nnls(scaled, np.ones(len(times)))[0]
    return costs, scaled @ costs


def main() -> None:
    """Print the constants, and how well they tell the times."""
    implicit: tuple[list[list[float]], list[float]] = ([], [])
    explicit: tuple[list[list[float]], list[float]] = ([], [])
    for name, make in SCENES.items():
        model, duration = make(), {"duration": LONGEST} if name.endswith(("_bushings", "_ideal")) else {}
        job, found = runs(model, solver="bdf", **duration)
        n, operations = cost.unknowns(job.dynamics), job.dynamics.system.n_operations("tangent")
        factors = bdf.Integrator(job.dynamics, RunSettings()).factors
        for residuals, matrices, spent in differences(found, "residuals", "jacobians"):
            implicit[0].append([residuals, residuals * n, matrices * operations, matrices * factors])
            implicit[1].append(spent)
        job, found = runs(model, solver="projected", scheme="dop853", **duration)
        system, by_lu = job.dynamics.system, not job.dynamics.eliminated.serves
        each = np.array([1.0, system.n_operations("acceleration"), system.n_c, by_lu * system.n_c**2])
        for steps, rejected, spent in differences(found, "steps", "rejected"):
            explicit[0].append([*((steps + rejected) * each)])
            explicit[1].append(spent)
    for names, data in ((("EXPLICIT_STEP", "BY_LU"), explicit), (("RESIDUAL", "MATRIX"), implicit)):
        costs, told = fit(*data)
        print(f"{', '.join(names)} = {np.array2string(costs, precision=3, separator=', ')}")
        print(f"times told within {told.min():.2f} .. {told.max():.2f} of what they are")


if __name__ == "__main__":
    main()
