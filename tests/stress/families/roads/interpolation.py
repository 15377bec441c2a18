"""Tables with steep segments between distant points: the default does not overshoot; splines that do are noted."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...simulation import simulation

TABLES: dict[str, list[list[float]]] = {
    "bump": [[-100, 0], [12, 0], [12.3, 5], [12.6, 5], [12.9, 0], [200, 0]],
    "kerb": [[-50, 0], [20, 0], [20.02, 8], [150, 8]],
    "pothole": [[-50, 0], [10, 0], [10.1, -6], [10.6, -6], [10.7, 0], [200, 0]],
    "stop": [[-10, 20], [0, 0], [30, 0], [30.1, -40], [31, -80]],
    "uneven": [[0, 0], [1, 1], [1.5, 3], [12, 3.5], [12.1, 0], [40, 1], [41, 1], [90, -2]],
}
"""Forces over displacement, N over m."""
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "auto": {"solver": "auto"},
}
SPEED = 25.0
"""m/s."""


def pushed(table: str, how: str = "") -> Scene:
    """Return a scene of 1 kg pushed along x by a force given by a table."""
    return read_scene(
        f"gravity: [0, 0]\ntables: {{p: {{table: {TABLES[table]}{how}}}}}\nbodies: {{b: {{mass: 1, inertia: 1, velocity: [{SPEED}, 0]}}}}\n"
        "forces: {f: {type: force, i: b, force: ['p(b.x)', 0]}}"
    )


def sprung(table: str, how: str = "") -> Scene:
    """Return the same along a rail in space, by the spring law of an element whose length is the displacement."""
    law = [[x, -force] for x, force in TABLES[table]]
    return read_scene(
        f"dimensions: 3\ngravity: [0, 0, 0]\nbodies: {{b: {{mass: 1, inertia: [1, 1, 1], velocity: [{SPEED}, 0, 0]}}}}\n"
        "joints: {g: {type: prismatic, i: {body: b, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}}\n"
        "forces: {f: {type: spring_damper, i: b, j: {body: ground, point: [-1, 0, 0]}, free_length: 1, "
        f"spring_law: {{table: {law}{how}}}}}}}"
    )


def _off(solution: Solution, table: str) -> float:
    """Compare the final speed with the work of the force, integrated from SciPy's monotone cubics."""
    work = PchipInterpolator(*np.array(TABLES[table], dtype=float).T).antiderivative()
    speed = np.sqrt(SPEED**2 + 2 * (work(solution["b.x"]) - work(0.0)))
    return float(np.abs(solution["b.vx"] / speed - 1).max())


CASES = (
    *(
        simulation(
            f"{name} by a {table}, {solver}", "speed against the work of monotone cubics", partial(scene, table), partial(_off, table=table),
            1e-5, duration=1.2, points=61, rtol=1e-8, quick=solver == "auto", **how,
        )
        for name, scene in (("pushed", pushed), ("sprung", sprung))
        for table in TABLES
        for solver, how in SOLVERS.items()
    ),
    *(
        simulation(
            f"{name} by a spline through a {table}", "the spline is noted", partial(scene, table, ", spline: true"), lambda _: 0.0, 0.0,
            names=("but its points are between",), noted=("but its points are between",), expected=Outcome.TOLD, duration=1e-3,
        )
        for name, scene in (("pushed", pushed), ("sprung", sprung))
        for table in TABLES
    ),
)  # fmt: skip
