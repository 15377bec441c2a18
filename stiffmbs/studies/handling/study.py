"""Handling tests of a car as a study: preliminary runs, then all manoeuvres on all processor cores."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...analyses.load_scene import load_scene
from ...analyses.run import run
from ...errors import InputError, SolverError, StiffmbsError, refuse_text
from ...model.scene import Scene
from ...model.settings import SteadyMotion
from ...processes import process_pool
from ...reading.did_you_mean import instead_of
from ..executors import refuse_workers
from ..targets import Metric, Target, judged
from .car import Car, Manoeuvre, car_of, with_manoeuvre
from .known import SEEN, Known, Metrics, Run
from .metrics import at_zero
from .parameters import SPEED, positive, with_changes
from .standards import TESTS
from .steady_state_cornering import TURNS, lag_of, probe, quasi_steady, ramp

WIDER = 0.2
"""Width of the body beyond the track, m, unless given: tyres and wings."""
OVERHANGS = 0.6
"""Length of the body beyond the wheelbase, in wheelbases, unless given: that of a compact car."""


@dataclass(frozen=True)
class Tested:
    """Result of one test."""

    # value and unit by name; empty if the test failed, those of its first run if a search did
    metrics: Metrics = field(default_factory=dict)
    runs: list[Run] = field(default_factory=list)  # channels of its runs
    message: str = ""  # why it failed; empty if it was done
    parameters: dict[str, Any] = field(default_factory=dict)  # parameters of the test, SI units


@dataclass(frozen=True)
class Handling:
    """Handling tests of a car.

    Attributes
    ----------
    name : str
        Name of the scene.
    car : Car
    ratio : float
        Steer angle of the wheels per steering, rad/rad or rad/m.
    tests : dict of str to Tested
    width : float
        Width of the vehicle, m, for which courses have their cones.
    length : float
        Length of the vehicle, m, whose corners the driver's path keeps between them.
    """

    name: str
    car: Car
    ratio: float
    tests: dict[str, Tested]
    width: float
    length: float

    def __getitem__(self, test: str) -> dict[str, float]:
        """Return the values of the metrics of a test."""
        return {name: value for name, (value, _) in self.tests[test].metrics.items()}

    def judged(self, targets: Mapping[str, str]) -> tuple[Target, ...]:
        """Return targets with the values of their metrics, ``step_steer.yaw_rate_overshoot`` (`stiffmbs.studies.targets`).

        Raises InputError if there is no such metric, or the text of a target is no range.
        """
        metrics = {
            f"{test}.{name}": Metric({"": value}, unit)
            for test, one in self.tests.items()
            for name, (value, unit) in one.metrics.items()
        }
        return judged(targets, metrics)

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs handling --json``; values without a number are null."""
        found = {
            test: {
                "message": one.message,
                "parameters": one.parameters,
                "metrics": {
                    name: {"value": value if np.isfinite(value) else None, "unit": unit}
                    for name, (value, unit) in one.metrics.items()
                },
            }
            for test, one in self.tests.items()
        }
        failed = [test for test, one in self.tests.items() if one.message]
        return {
            "scene": scene, "status": "stopped" if failed else "done",
            "message": "; ".join(f"{test}: {self.tests[test].message}" for test in failed),
            "wheelbase": self.car.wheelbase, "track": self.car.track, "steer_per_steering": self.ratio,
            "reference_point": list(self.car.reference), "tests": found,
        }  # fmt: skip


def handling(
    model: Scene | str | Path, tests: Sequence[str] | None = None, *, body: str | None = None, steering: str | None = None,
    width: float | str | None = None, length: float | str | None = None, workers: int | None = None, parameters: Mapping[str, float | str | Sequence[float]] | None = None,
) -> Handling:  # fmt: skip
    """Run handling and ride tests of the standards on a car.

    The car is the scene without its own driver, roads, start and drives of the steering joint; each test attaches the
    part `driver`, a level road and its steering or course. Preliminary runs at 5 m/s and slow ramps at 80 km/h and at
    the speeds of the tests scale the amplitudes to the lateral accelerations of the standards.

    Parameters
    ----------
    model : Scene, str or Path
        Scene in space with four tyres.
    tests : sequence of str, optional
        Names among `stiffmbs.studies.handling.standards.TESTS`; all by default.
    body, steering : str, optional
        Sprung body and joint that steers; see `stiffmbs.studies.handling.car.car_of`.
    width : float or str, optional
        Width of the vehicle, m, or text with a unit; by default the track and 0.2 m.
    length : float or str, optional
        Length of the vehicle, m, or text with a unit; by default 1.6 wheelbases. Its middle is halfway between the axles.
    workers : int, optional
        Number of processes; by default one for each core.
    parameters : mapping of str to number or str, optional
        Changed parameters of the tests: ``{"step_steer.speed": "100 km/h"}``, or ``speed`` for each test that has it.
        Numbers are in SI units; see `stiffmbs.studies.handling.parameters`.

    Returns
    -------
    Handling

    Raises
    ------
    InputError
        If the scene is not a car, or there is no such test or parameter.
    SolverError
        If a preliminary run stops.
    """
    if width is not None:
        width = positive("width", width, "length")
    if length is not None:
        length = positive("length", length, "length")
    refuse_workers(workers)
    refuse_text("tests", tests, "tests")
    scene = model if isinstance(model, Scene) else load_scene(model)
    names = list(TESTS if tests is None else tests)
    for name in names:
        if name not in TESTS:
            raise InputError(f"found the test '{name}'{instead_of(name, TESTS)}")
    changed = with_changes(parameters or {}, {name: TESTS[name].parameters for name in names})
    car = car_of(scene, body, steering)
    with ExitStack() as stack:
        count = workers or os.cpu_count() or 1
        pool = stack.enter_context(process_pool(count)) if count > 1 else None
        known = _preliminary(scene, car, width or car.track + WIDER, length or (1 + OVERHANGS) * car.wheelbase)
        found = _solved(scene, car, known, changed, pool)
        return Handling(scene.name, car, known.ratio, found, known.width, known.length)


def _preliminary(scene: Scene, car: Car, width: float, length: float) -> Known:
    first = solved(with_manoeuvre(scene, car, probe(car)))
    curvature = first["vehicle.yaw_rate"][-1] / first["vehicle.speed"][-1]
    low = float(first["handling_steer_seen"][-1] / curvature)
    slow = quasi_steady(solved(with_manoeuvre(scene, car, ramp(car, low))))
    ay, curvature = slow["vehicle.ay"], slow["vehicle.yaw_rate"] / slow["vehicle.speed"]
    linear = at_zero(ay, slow[SEEN])[1] / at_zero(ay, curvature)[1]
    at = int(np.argmax(ay >= min(4.0, 0.7 * ay[-1])))
    over = SPEED**2 - TURNS.probe**2
    at_no_speed, driven = low - (linear - low) / over * TURNS.probe**2, float(slow[SEEN][at] / curvature[at])
    return Known(car, at_no_speed, (driven - low) / over, width, slow, lag_of(slow), length)


def _solved(scene: Scene, car: Car, known: Known, tests: Mapping[str, Any], pool: Executor | None) -> dict[str, Tested]:
    waiting: dict[str, tuple[Known, list[Any]]] = {}
    found = {name: Tested(parameters=asdict(parameters)) for name, parameters in tests.items()}

    @cache
    def at_speed(speed: float) -> Known:
        """Return `Known` with the slow ramp at a speed."""
        if speed == SPEED:
            return known
        return replace(known, ramp=quasi_steady(solve(ramp(car, known.per_curvature, speed))))

    def solve(manoeuvre: Manoeuvre) -> Run:
        return solved(with_manoeuvre(scene, car, manoeuvre))

    for name, parameters in tests.items():
        try:
            of_test = at_speed(parameters.speed) if TESTS[name].ramped else known
            scenes = [with_manoeuvre(scene, car, each) for each in TESTS[name].manoeuvres(of_test, parameters)]
        except StiffmbsError as error:
            found[name] = replace(found[name], message=str(error))
            continue
        waiting[name] = of_test, [pool.submit(solved, each) if pool else each for each in scenes]
    for name, (of_test, jobs) in waiting.items():
        test, parameters = TESTS[name], tests[name]
        try:
            runs = [job.result() if pool else solved(job) for job in jobs]
            metrics = test.metrics(of_test, parameters, runs)
            found[name] = replace(found[name], metrics=metrics, runs=runs or [of_test.ramp])
            if test.search:
                searched = test.search(of_test, parameters, metrics, solve)
                found[name] = replace(found[name], metrics=metrics | searched)
        except StiffmbsError as error:
            found[name] = replace(found[name], message=str(error))
    return found


def solved(scene: Scene) -> Run:
    """Return the channels of a run, with its times.

    Raises SolverError if it stops early, or InputError if the steady motion at its start is not that of the test.
    """
    solution = run(scene, errors=False)
    if not solution.success:
        raise SolverError(solution.message)
    assert isinstance(scene.start, SteadyMotion)
    found, expected = float(solution["vehicle.speed"][0]), scene.start.velocity[0]
    if abs(found - expected) > TURNS.slower * expected:
        raise InputError(
            f"found a steady speed of {found:.3g} m/s, expected {expected:.3g} m/s: the engine, or a driver with a small "
            "'strongest', does not keep it"
        )
    return {**{name: np.array(values) for name, values in solution.items()}, "time": np.array(solution.time)}
