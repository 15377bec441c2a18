"""What a step of each integrator costs, for the constants of `stiffmbs.solve.cost`.

Run it by ``python -m tests.bench.costs``: scenes without events are solved at several tolerances; the constants are a
least-squares fit of relative errors, none below 0, in which what fits badly counts less.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import nnls

from stiffmbs.analyses.job import Job, prepare
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.model.model_data import ModelData
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve import cost
from stiffmbs.solve.ida.choice import driven
from stiffmbs.solve.subsystems import Subsystem

from .drives import CARS
from .error_control import scene
from .problems.axle_on_bushings import axle, scene_of
from .problems.chain_in_space import SCENE


def chain_in_space(rods: int) -> ModelData:
    """Rods on hinges with upright and level axes by turns."""
    return read_scene(SCENE.format(rods=rods))


HUB = """
name: Hub with arms
dimensions: 3
parameters: {N: 60}
gravity: [0, 0, -9.81]
bodies:
  hub: {mass: 10, inertia: [1, 1, 1]}
  arm{k}:
    for: k in 1..N
    mass: 0.5
    inertia: [0.1, 0.1, 0.01]
    position: [cos(2*pi*k/N), sin(2*pi*k/N), -0.5]
    markers: {top: {point: [0, 0, 0.5]}}
joints:
  ball{k}:
    for: k in 1..N
    type: spherical
    i: arm{k}.top
    j: {body: hub, point: [cos(2*pi*k/N), sin(2*pi*k/N), 0]}
run: {duration: 1 s, output: 10 ms}
"""
"""So many joints at one body that its LU takes less than elimination."""

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
    "governor": scene("governor"),
    "door": scene("door"),
    "four_bar": scene("four_bar"),
    "elastic_bearing": scene("elastic_bearing"),
    "front_axle": scene("vehicles/front_axle"),
    "chain_in_space_10": partial(chain_in_space, 10),
    "chain_in_space_100": partial(chain_in_space, 100),
    "axle": lambda: scene_of(axle(1e6)),
    "hub": partial(read_scene, HUB),
    **{car.name: partial(car.model, "sweep") for car in CARS},
}
RTOLS = (1e-4, 1e-5, 1e-6)
SECONDS, LONGEST = 2.0, 2.0
"""For which the runs of one scene and solver are repeated; the shortest times count. The motions of cars are cut off."""
MANY = 10_000
"""Multiplications of an elimination from which on its blocks are taken for large ones."""
ROUNDS, NEAR = 15, 0.15
"""Of the fit with new weights, and the logarithm of a ratio up to which a time counts as fitted well."""

EXPLICIT = (
    "explicit_step", "explicit_operation", "explicit_equation", "multiplication", "large_blocks",
    "large_block_multiplication", "multiplication of the LU",
)  # fmt: skip
IMPLICIT = ("residual", "residual_unknown", "matrix_operation", "matrix_solver")
"""Fields of `stiffmbs.solve.cost.CostParameters`, in the order of the features."""
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


def fit(features: list[np.ndarray], times: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """The costs of the features, and what they make of each time, relative to it."""
    scaled, weights = np.array(features) / np.array(times)[:, None], np.ones(len(times))
    for _ in range(ROUNDS):
        costs = nnls(scaled * weights[:, None], weights)[0]
        weights = np.maximum(np.abs(np.log(scaled @ costs)), NEAR) ** -0.5
    return costs, scaled @ costs


def linear(dynamics: Dynamics) -> tuple[float, float, float, float]:
    """What its share of an explicit step is counted by: elimination in small blocks, in large ones, or the LU."""
    if not dynamics.eliminated.serves:
        return 0.0, 0.0, 0.0, dynamics.lu_updates
    count = dynamics.eliminated.multiplications
    return (0.0, 1.0, count, 0.0) if count > MANY else (count, 0.0, 0.0, 0.0)


def main() -> None:
    """Print the constants, and how well they tell the times; the first is for a whole run."""
    implicit: tuple[list[np.ndarray], list[float]] = ([], [])
    explicit: tuple[list[np.ndarray], list[float]] = ([], [])
    for name, make in SCENES.items():
        model, duration = make(), {"duration": LONGEST} if name.endswith(("_bushings", "_ideal")) else {}
        job, found = runs(model, solver="bdf", **duration)
        residual = np.array([1.0, cost.unknowns(job.dynamics)])
        factors = 1e-3 * driven(job.dynamics, RunSettings()).cost
        matrix = np.array([job.dynamics.system.n_operations("tangent"), factors])
        for spent, counted in found:
            implicit[0].append(np.r_[1.0, counted["residuals"] * residual, counted["jacobians"] * matrix])
            implicit[1].append(spent)
        job, found = runs(model, solver="projected", scheme="dop853", **duration)
        system = job.dynamics.system
        step = np.array([1.0, system.n_operations("acceleration"), system.n_c, *linear(job.dynamics)])
        for spent, counted in found:
            explicit[0].append(np.r_[1.0, (counted["steps"] + counted["rejected"]) * step])
            explicit[1].append(spent)
    for names, data in ((EXPLICIT, explicit), (IMPLICIT, implicit)):
        costs, told = fit(*data)
        print(
            f"{', '.join(f'{n} = {each:.3g}' for n, each in zip(names, costs[1:], strict=True))}, {costs[0]:.0f} us a run"
        )
        print(f"times told within {told.min():.2f} .. {told.max():.2f} of what they are")


if __name__ == "__main__":
    main()
