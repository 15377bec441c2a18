"""Trees of links on hinges in space: chains with tilted hinges, an arm of seven joints, a heavy top."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.job import prepare

from ..contestant import Contestant, Solve, own
from ..peers.trees.scene import scene_of
from ..peers.trees.tree import GROUND, Link, Tree
from ..problem import Problem

TIMES = np.linspace(0.0, 2.0, 201)
DOWN = np.array([0.0, 0.0, -9.81])
CONVERGED = 1e-13
WIDTH = 0.02
"""Of rods, m."""
PER_BODY = 7
"""Coordinates: place and Euler parameters."""
OUTPUT: dict[str, Any] = {"duration": float(TIMES[-1]), "points": len(TIMES)}
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
    "auto": {"solver": "auto"},
}


def tilted_chain(rods: int) -> Tree:
    """Rods of 1 m and 0.1 kg let go from the horizontal; no two neighbouring hinges are parallel, none is along y or z."""
    tilted = [np.array(axis) / np.linalg.norm(axis) for axis in ([0.1, 0.8, 0.6], [-0.1, -0.5, 0.9], [0.2, 0.9, -0.3])]
    links = []
    for k in range(rods):
        hinge, centre = np.array([k, 0.0, 0.0]), np.array([k + 0.5, 0.0, 0.0])
        links.append(Link(k - 1, tilted[k % 3], hinge, centre, 0.1, rod(0.1, 1.0, 0)))
    return Tree(tuple(links), DOWN, TIMES)


def arm() -> Tree:
    """Seven joints about z and y by turns with damping, stretched out sideways, all turning by 1 rad/s."""
    lengths, masses = (0.33, 0.32, 0.31, 0.30, 0.20, 0.15, 0.10), (4.0, 4.0, 3.0, 3.0, 2.0, 1.5, 0.7)
    links, hinge = [], np.zeros(3)
    for k, (length, mass) in enumerate(zip(lengths, masses, strict=True)):
        axis = np.array([0.0, 1.0, 0.0] if k % 2 else [0.0, 0.0, 1.0])
        along = np.array([length, 0.05 * (-1) ** k, 0.0])
        inertia = rod(mass, length, 0) + 0.002 * np.eye(3)
        links.append(Link(k - 1, axis, hinge, hinge + along / 2, mass, inertia, 2.0 - 0.25 * k, 1.0))
        hinge = hinge + along
    return Tree(tuple(links), DOWN, TIMES)


def heavy_top() -> Tree:
    """A top of 1 kg on its tip, leaning by 60 degrees, let go with a spin of 100 rad/s; its hinges are those of a gimbal."""
    lean = np.pi / 3
    spin = np.array([np.sin(lean), 0.0, np.cos(lean)])
    inertia = 0.01 * np.outer(spin, spin) + 0.02 * (np.eye(3) - np.outer(spin, spin))
    tip, none = np.zeros(3), np.zeros((3, 3))
    outer = Link(GROUND, np.array([0.0, 0.0, 1.0]), tip, tip, 0.0, none)
    inner = Link(0, np.array([0.0, 1.0, 0.0]), tip, tip, 0.0, none)
    return Tree((outer, inner, Link(1, spin, tip, 0.2 * spin, 1.0, inertia, rate=100.0)), DOWN, TIMES)


def rod(mass: float, length: float, along: int) -> np.ndarray:
    """Inertia of a rod along one axis about its middle, kg m^2."""
    across = mass * (length**2 + WIDTH**2) / 12
    return np.diag([mass * WIDTH**2 / 6 if axis == along else across for axis in range(3)])


def contestants(tree: Tree) -> list[Contestant]:
    """This package's integrators, by the centres of mass."""
    scene = scene_of(tree)
    return [
        Contestant(name, False, partial(_centres, tree, own(scene, **OUTPUT, **settings)))
        for name, settings in SOLVERS.items()
    ]


def _centres(tree: Tree, at: Callable[[float], Solve], rtol: float) -> Solve:
    solve = at(rtol)
    return lambda: centres(tree, solve())


def centres(tree: Tree, rows: np.ndarray) -> np.ndarray:
    """Places without orientations, and without the angles that dampers count."""
    bodies = sum(1 for link in tree.links if link.mass)
    places = rows[:, : PER_BODY * bodies].reshape(len(rows), bodies, PER_BODY)[:, :, :3]
    return np.asarray(places.reshape(len(rows), -1))


def reference(tree: Tree) -> np.ndarray:
    """By dop853 at a far tighter tolerance; the tests compare it with Pinocchio's accelerations in SciPy's DOP853."""
    return centres(tree, prepare(scene_of(tree), rtol=CONVERGED, **OUTPUT, **SOLVERS["dop853"]).integrate().q)


def _problem(name: str, make: Callable[[], Tree]) -> Problem:
    return Problem(name, lambda: reference(make()), lambda: contestants(make()), (1e-3, 1e-11), 4, 5, in_space=make)


BENCHMARKS = (
    _problem("heavy_top", heavy_top),
    _problem("arm", arm),
    _problem("tilted_chain_10", partial(tilted_chain, 10)),
    _problem("tilted_chain_100", partial(tilted_chain, 100)),
)
