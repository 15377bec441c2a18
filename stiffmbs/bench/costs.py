"""What a step of each integrator costs, for the constants of `stiffmbs.solve.cost`.

Run it by ``python -m stiffmbs.bench.costs``: the examples are solved at several tolerances, so that what a run costs
but for its steps drops out of the differences; the constants are a least-squares fit of relative errors, none below 0.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.optimize import nnls

from ..describe.model_data import ModelData
from ..jobs.job import Job, prepare
from ..solve import cost
from .error_control import scene

SCENES = {
    "cart_pendulum": scene("cart_pendulum"),
    "andrews": scene("andrews"),
    "four_bars_2": scene("four_bars", ("N", "2")),
    "four_bars_40": scene("four_bars", ("N", "40")),
    "half_car": scene("half_car", ("k_b", "1e5")),
    "chain_10": scene("chain"),
    "chain_100": scene("chain", ("N", "100")),
}
RTOLS = (1e-4, 1e-6, 1e-8)
SECONDS = 2.0
"""For which the runs of one scene and solver are repeated; the shortest times count."""

Run = tuple[float, Mapping[str, Any]]


def runs(model: ModelData, **settings: Any) -> tuple[Job, list[Run]]:
    """A job of the scene, and for each tolerance the shortest time (microseconds of the processor) and the counters."""
    jobs = [prepare(model, rtol=rtol, **settings) for rtol in RTOLS]
    shortest, statistics = [np.inf] * len(jobs), [job.integrate().statistics for job in jobs]
    begun = time.process_time()
    while time.process_time() - begun < SECONDS:
        for k, job in enumerate(jobs):
            at = time.process_time()
            job.integrate()
            shortest[k] = min(shortest[k], 1e6 * (time.process_time() - at))
    return jobs[0], list(zip(shortest, statistics, strict=True))


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
    for make in SCENES.values():
        job, found = runs(make(), solver="bdf")
        n = cost.unknowns((job.subsystems[0] if job.subsystems else job).dynamics)
        for residuals, matrices, spent in differences(found, "residuals", "jacobians"):
            implicit[0].append([residuals, residuals * n, matrices, matrices * n])
            implicit[1].append(spent)
        job, found = runs(make(), solver="projected", scheme="dop853")
        values = (job.subsystems[0] if job.subsystems else job).dynamics.system.n_values("acceleration")
        for steps, rejected, spent in differences(found, "steps", "rejected"):
            explicit[0].append([steps + rejected, (steps + rejected) * values])
            explicit[1].append(spent)
    for names, data in ((("EXPLICIT_STEP",), explicit), (("RESIDUAL", "MATRIX"), implicit)):
        costs, told = fit(*data)
        for name, pair in zip(names, costs.reshape(-1, 2), strict=True):
            print(f"{name} = ({pair[0]:.3f}, {pair[1]:.4f})")
        print(f"times told within {told.min():.2f} .. {told.max():.2f} of what they are")


if __name__ == "__main__":
    main()
