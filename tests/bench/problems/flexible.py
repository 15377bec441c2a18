"""Beams and a reduced flexible body that fall from rest; errors of the position of their ends."""

from __future__ import annotations

import tempfile
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs import BeamBody, Fixed, Model, Revolute
from stiffmbs.analyses.job import Job, prepare
from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.solve.trajectory import Outcome

from ..contestant import Contestant, Failed, Solve
from ..peers.flexible.tasks import GRAVITY, HungBeam, HungBody
from ..problem import Problem

TIMES = np.linspace(0.0, 1.0, 6)
BEAMS = {"rubber_pendulum": HungBeam(0.02, 5e6, False, TIMES), "falling_cantilever": HungBeam(0.01, 2e8, True, TIMES)}
ELEMENTS, AT, ORDER = 12, 2e-3, 4
"""Elements with which a beam has an error of about this size, m, and the order of the error."""
LOOSEST = 1e-2
"""Tolerance of the integration, of at most ten times the error of the elements."""
SETTINGS = tuple(float(10.0**exponent) for exponent in np.arange(-1.5, -7.1, -1 / 3))
SMALLEST = 1e-7
"""Error that no setting goes below."""
SOLVERS: dict[str, dict[str, Any]] = {
    "radau": {"solver": "radau"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
}
CONVERGED = (128, 256)
"""Elements of the two beams whose extrapolation is the reference, for errors of second order with so many."""
E, NU, DENSITY, DAMPING, NORMAL = 2e9, 0.3, 1200.0, 1e-4, 8
BAR = f"""
dimensions: 3
gravity: [0, 0, {-GRAVITY}]
bodies:
  bar:
    type: flexible
    mesh: bar.vtu
    units: {{length: 1 m}}
    material: {{E: {E}, nu: {NU}, density: {DENSITY}}}
    interfaces:
      hinge: {{plane: {{point: [0, 0, 0], normal: [1, 0, 0]}}}}
      end: {{plane: {{point: [1, 0, 0], normal: [1, 0, 0]}}}}
    modes: {NORMAL}
    stiffening: false
    damping: {{stiffness: {DAMPING} s}}
joints:
  hinge: {{type: revolute, i: {{body: bar.hinge, orientation: {{z: [0, 1, 0]}}}}, j: {{body: ground, orientation: {{z: [0, 1, 0]}}}}}}
run: {{duration: 1 s, points: {len(TIMES)}}}
"""
"""A bar of plastic, 1 m long, as a mesh of 20 x 2 x 2 hexahedra, with linear strains as those of other tools."""


def beam(task: HungBeam, elements: int) -> Model:
    """Return the beam as a model of this package."""
    model = Model("beam", gravity=(0, -GRAVITY))
    mass, inertia = task.mass
    body = BeamBody(
        start=(0, 0), end=(1, 0), elements=elements, stiffness=task.stiffness, mass_per_length=mass,
        inertia_per_length=inertia,
    )  # fmt: skip
    made = model.add("beam", body)
    model.add("support", (Fixed if task.clamped else Revolute)(i=made.start, j="ground"))
    return model


def of_beam(task: HungBeam, settings: dict[str, Any], error: float) -> Solve:
    """Solve with elements and a tolerance for errors of about this size, m."""
    error = max(error, SMALLEST)
    elements = max(4, round(ELEMENTS * (AT / error) ** (1 / ORDER)))
    rtol = min(LOOSEST, 10 * error)
    job = prepare(beam(task, elements).data(), rtol=rtol, duration=float(TIMES[-1]), points=len(TIMES), **settings)
    return partial(_solved, job, "beam.end", (0, 1))


def of_bar(settings: dict[str, Any], rtol: float) -> Solve:
    """Solve the bar at a tolerance."""
    return partial(_solved, prepare(bar(), rtol=rtol, **settings), "bar.end", (0, 2))


def _solved(job: Job, body: str, axes: tuple[int, int]) -> np.ndarray:
    """Return two coordinates of a body at the output times."""
    trajectory, system = job.integrate(), job.dynamics.system
    if trajectory.outcome is not Outcome.DONE:
        raise Failed(trajectory.message)
    first = list(system.bodies).index(body) * (len(trajectory.q[0]) // len(system.bodies))
    return trajectory.q[:, first + np.array(axes)]


@cache
def bar() -> Scene:
    """Return the scene of the bar; it keeps its folder."""
    from ..solvers.flexible_bodies import box

    folder = Path(tempfile.mkdtemp(prefix="stiffmbs-bench-"))
    box(folder / "bar.vtu", (0, 1, 20), (-0.025, 0.025, 2), (-0.015, 0.015, 2))
    return read_scene(BAR, file=folder / "bar.yaml")


def hung_bar() -> HungBody:
    """Return the reduced bar as it is put to other tools, with the modes of this package."""
    body, folder = bar().bodies["bar.frame"].source
    model = from_mesh(folder / "bar.vtu", 1.0, Material(E=E, nu=NU, density=DENSITY))
    hinge, end = (np.flatnonzero(np.abs(model.nodes[:, 0] - x) < 1e-9) for x in (0.0, 1.0))
    return HungBody(model, reduced_body(body, folder).modes, (hinge, end), DAMPING, TIMES)


def converged_beam(task: HungBeam) -> np.ndarray:
    """Return positions extrapolated to any number of elements."""
    coarse, fine = (of_elements(task, n)() for n in CONVERGED)
    return fine + (fine - coarse) / 3


def of_elements(task: HungBeam, elements: int) -> Solve:
    """Solve with a number of elements at a tight tolerance."""
    job = prepare(beam(task, elements).data(), rtol=1e-6, duration=float(TIMES[-1]), points=len(TIMES), solver="radau")
    return partial(_solved, job, "beam.end", (0, 1))


def _of_beam(name: str, task: HungBeam) -> Problem:
    def contestants() -> list[Contestant]:
        return [
            Contestant(solver, False, partial(of_beam, task, settings), "error", SETTINGS)
            for solver, settings in SOLVERS.items()
        ]

    return Problem(name, lambda: converged_beam(task), contestants, (1e-2, 1e-6), 2, 5, in_space=lambda: task)


def _of_bar() -> Problem:
    def contestants() -> list[Contestant]:
        return [
            Contestant(solver, False, partial(of_bar, {"solver": solver}), settings=SETTINGS)
            for solver in ("radau", "bdf")
        ]

    return Problem(
        "hung_bar", lambda: of_bar({"solver": "radau"}, 1e-9)(), contestants, (1e-2, 1e-7), 2, 5, in_space=hung_bar
    )


BENCHMARKS = (*(_of_beam(name, task) for name, task in BEAMS.items()), _of_bar())
