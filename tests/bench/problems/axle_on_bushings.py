"""A double-wishbone axle whose arms have bushings of 1e6 to 1e8 N/m, shaken for a second; errors of places and of bushing forces."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs import spatial
from stiffmbs.analyses.job import prepare
from stiffmbs.model.model_data import ModelData
from stiffmbs.solve.trajectory import Outcome, Trajectory

from ..contestant import Contestant, Failed, Solve
from ..peers.mounted.mounted import GROUND, Mount, Mounted, Shaken, Solid, Strut
from ..problem import Problem

TIMES = np.linspace(0.0, 1.0, 201)
DAMPING_RATIO = 0.05
CONVERGED = 1e-12
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "radau": {"solver": "radau"},
    "auto": {"solver": "auto"},
}
PLACE, MOTION = 7, 6
"""Coordinates and velocities of a body."""


def axle(k_b: float) -> Mounted:
    """A body of 700 kg, and on each side a lower arm, an upper arm and an upright with its wheel."""
    solids = [Solid(np.array([0.0, 0.0, 0.55]), 700.0, np.array([240.0, 300.0, 350.0]))]
    mounts, struts = [], []
    for side in (1, -1):
        lower, upper, upright = range(len(solids), len(solids) + 3)
        solids += [
            Solid(np.array([0.0, 0.55 * side, 0.25]), 8.0, np.array([0.15, 0.15, 0.25])),
            Solid(np.array([0.0, 0.55 * side, 0.50]), 5.0, np.array([0.08, 0.08, 0.12])),
            Solid(np.array([0.0, 0.75 * side, 0.32]), 40.0, np.array([1.0, 1.6, 1.0])),
        ]
        points = [
            (lower, 0, (0.2, 0.40, 0.26)), (lower, 0, (-0.2, 0.40, 0.26)), (upper, 0, (0.15, 0.45, 0.52)),
            (upper, 0, (-0.15, 0.45, 0.52)), (upright, lower, (0.0, 0.72, 0.22)), (upright, upper, (-0.02, 0.68, 0.50)),
            (upright, 0, (0.15, 0.70, 0.28)),
        ]  # fmt: skip
        for k, (i, j, (x, y, z)) in enumerate(points):
            stiffness = np.array([1.0, 1.0, 1.0]) * k_b
            if k == len(points) - 1:  # a tie rod, which resists along itself
                stiffness = np.array([0.0, k_b, 0.0])
            damping = 2 * DAMPING_RATIO * np.sqrt(stiffness * 10.0)
            mounts.append(Mount(i, j, np.array([x, y * side, z]), stiffness, damping))
        struts.append(Strut(lower, 0, np.array([0.0, 0.6 * side, 0.24]), np.array([0.0, 0.5 * side, 0.75]), 6e4, 3e3))
        tyre = np.array([0.0, 0.76 * side, 0.0])
        mounts.append(Mount(upright, GROUND, tyre, np.array([2e5, 1e5, 2e5]), np.array([500.0, 500.0, 500.0])))
    return Mounted(tuple(solids), tuple(mounts), tuple(struts), 3, 2000.0, 18.0, TIMES)


def scene_of(m: Mounted) -> ModelData:
    """The bodies, bushings, springs and force of this package."""
    model = spatial.Model("axle on bushings")

    def marker(body: int, point: np.ndarray) -> spatial.Marker:
        name = "ground" if body == GROUND else f"solid{body}"
        return spatial.Marker(body=name, point=tuple(m.arm(body, point).tolist()))

    for k, solid in enumerate(m.solids):
        place, moments = tuple(solid.centre.tolist()), tuple(solid.moments.tolist())
        model.add(f"solid{k}", spatial.Body(mass=solid.mass, inertia=moments, position=place))
    for k, mount in enumerate(m.mounts):
        model.add(
            f"mount{k}",
            spatial.Bushing(
                i=marker(mount.i, mount.point), j=marker(mount.j, mount.point), axes="ground",
                stiffness=(*mount.stiffness.tolist(), 0, 0, 0), damping=(*mount.damping.tolist(), 0, 0, 0),
            ),
        )  # fmt: skip
    for k, strut in enumerate(m.struts):
        model.add(
            f"strut{k}",
            spatial.SpringDamper(
                i=marker(strut.i, strut.end), j=marker(strut.j, strut.other), stiffness=strut.stiffness,
                damping=strut.damping, free_length=float(np.linalg.norm(strut.end - strut.other)),
            ),
        )  # fmt: skip
    shaker = f"{m.amplitude}*sin({m.rate}*t)"
    model.add("shaker", spatial.AppliedForce(i=marker(m.shaken, m.solids[m.shaken].centre), force=("0", "0", shaker)))
    return model.data()


def places(x: np.ndarray, p: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Centres of mass, rows of (x1 y1 z1 x2 ...)."""
    return x.reshape(len(x), -1)


def relative_forces(m: Mounted, *states: np.ndarray) -> np.ndarray:
    """Forces of the bushings over the amplitude of the shaker, which is near the largest of them."""
    return m.forces(*states) / m.amplitude


def shaken(k_b: float, forces: bool) -> Shaken:
    """The axle, and whether forces or places are compared."""
    m = axle(k_b)
    return Shaken(m, partial(relative_forces, m) if forces else places)


def contestants(given: Shaken) -> list[Contestant]:
    """This package's integrators."""
    scene = scene_of(given.mounted)
    return [Contestant(name, False, partial(_solved, given, scene, settings)) for name, settings in SOLVERS.items()]


def _solved(given: Shaken, scene: ModelData, settings: dict[str, Any], rtol: float) -> Solve:
    job = prepare(scene, rtol=rtol, duration=float(TIMES[-1]), points=len(TIMES), **settings)
    return lambda: _shown(given, job.integrate())


def _shown(given: Shaken, trajectory: Trajectory) -> np.ndarray:
    if trajectory.outcome is not Outcome.DONE:
        raise Failed(trajectory.message)
    n, bodies = len(trajectory.q), len(given.mounted.solids)
    q = trajectory.q[:, : PLACE * bodies].reshape(n, bodies, PLACE)
    u = trajectory.u[:, : MOTION * bodies].reshape(n, bodies, MOTION)
    return given.shown(q[..., :3], q[..., 3:], u[..., :3], u[..., 3:])


def _problem(name: str, forces: bool) -> Problem:
    def given() -> Shaken:
        return shaken(float(name), forces)

    def reference() -> np.ndarray:
        """By dop853 at a far tighter tolerance; the tests compare it with CasADi's."""
        return _solved(given(), scene_of(given().mounted), SOLVERS["dop853"], CONVERGED)()

    full_name = f"axle_{name}_forces" if forces else f"axle_{name}"
    return Problem(full_name, reference, lambda: contestants(given()), (1e-3, 1e-10), 3, 5, in_space=given)


BENCHMARKS = tuple(_problem(name, forces) for name in ("1e6", "1e7", "1e8") for forces in (False, True))
