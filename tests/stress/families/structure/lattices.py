"""Large closed loops: lattices of rods on hinges, in the plane and in space, nets, rings and combs."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.check import check
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker

from ...case import Case, Verdict, measured
from ...framework import Framework, distance, in_plane, in_space
from ...simulation import simulation

SHEAR = 0.2
"""Of the cells: they are no squares, so that no two rods are in line across a hinge that is held."""


def lattice(*cells: int) -> Framework:
    """So many cells along each axis, each a parallelogram, or a box, with rods for edges; held at one corner."""
    counts = [count + 1 for count in cells]
    number = np.arange(np.prod(counts)).reshape(counts)
    grid = np.stack(np.meshgrid(*(np.arange(count, dtype=float) for count in counts), indexing="ij"), axis=-1)
    nodes = grid.reshape(-1, len(cells))
    nodes = nodes + SHEAR * np.roll(nodes, 1, axis=1) * np.arange(1, len(cells) + 1)
    rods = [
        pair
        for axis, count in enumerate(counts)
        for pair in zip(
            np.take(number, range(count - 1), axis).ravel().tolist(),
            np.take(number, range(1, count), axis).ravel().tolist(),
            strict=True,
        )
    ]
    return Framework(nodes, rods, (0,))


def ring(count: int) -> Framework:
    """A closed chain on a circle, held at one node."""
    angle = 2 * np.pi * np.arange(count) / count
    nodes = count / (2 * np.pi) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Framework(nodes, [(k, (k + 1) % count) for k in range(count)], (0,))


def comb(teeth: int, length: int) -> Framework:
    """A chain, held at both ends, from each node of which another one hangs aslant."""
    sag = np.arange(teeth + 1.0) / teeth
    spine = np.stack([np.arange(teeth + 1.0), -teeth * sag * (1 - sag)], axis=1)
    hanging = [spine[k] + step * np.array([0.3, -0.9]) for k in range(1, teeth) for step in range(1, length + 1)]
    rods = [(k, k + 1) for k in range(teeth)]
    for k in range(1, teeth):
        first = teeth + 1 + (k - 1) * length
        rods += [(k, first), *((node, node + 1) for node in range(first, first + length - 1))]
    return Framework(np.array([*spine, *hanging]), rods, (0, teeth))


def braced(cells: int) -> Framework:
    """A lattice of so many cells along each axis with a diagonal in each: a rigid plate, held more often than needed."""
    plain, side = lattice(cells, cells), cells + 1
    diagonals = [(i * side + j, (i + 1) * side + j + 1) for i in range(cells) for j in range(cells)]
    return Framework(plain.nodes, [*plain.rods, *diagonals], plain.held)


def plates(count: int, angle: float = 0.3) -> Model:
    """A square net of plates, hinged to their neighbours by their corners: neighbours turn in opposite ways.

    With its own three freedoms and the common turn it has four; most of its loops close by themselves.
    """
    model = Model("Net of plates")
    pitch = np.sqrt(2) * np.cos(angle)
    turn = {(i, j): angle * (-1) ** (i + j) for i in range(count) for j in range(count)}
    for (i, j), own in turn.items():
        model.add(f"plate{i}_{j}", Body(mass=1, inertia=1 / 6, position=(i * pitch, j * pitch), angle=own))
    corner = np.sqrt(0.5)
    for i, j in turn:
        for di, dj in ((1, 0), (0, 1)):
            if (i + di, j + dj) in turn:
                here = Marker(body=f"plate{i}_{j}", point=(corner * di, corner * dj))
                there = Marker(body=f"plate{i + di}_{j + dj}", point=(-corner * di, -corner * dj))
                model.add(f"hinge{i}_{j}_{di}", JOINTS["revolute"](i=here, j=there))
    return model


def _counted(model: Model, freedoms: int) -> Verdict:
    report = check(model)
    return measured(abs(report.degrees_of_freedom - freedoms), 0, f"{len(report.redundant)} redundant equations")


def _checked(name: str, what: str, model: Any, freedoms: int, quick: bool = True) -> Case:
    """Degrees of freedom by `check`, against their count by Maxwell's rule or by hand."""
    return Case(name, f"{what}; degrees of freedom: {freedoms}", lambda: _counted(model(), freedoms), quick=quick)


def _by_maxwell(framework: Framework) -> int:
    """Two freedoms of each node that is not held, less one for each rod."""
    free = len(framework.nodes) - len(framework.held)
    return framework.nodes.shape[1] * free - len(framework.rods)


def _check_of(cells: int, quick: bool) -> Case:
    framework = lattice(cells, cells)
    name = f"check of a lattice of {cells} x {cells} cells"
    return _checked(name, "no redundant equation", partial(in_plane, framework), _by_maxwell(framework), quick)


def _falls(name: str, what: str, framework: Framework, allowed: float = 1e-5, **how: Any) -> Case:
    """A framework let go, against its nodes' motion."""
    model = in_plane if framework.nodes.shape[1] == 2 else in_space
    return simulation(
        name, f"{what}; {len(framework.rods)} rods, middles of all against the motion of nodes", partial(model, framework),
        partial(distance, framework), allowed, **{"duration": 0.5, "points": 6, "rtol": 1e-7, **how},
    )  # fmt: skip


EXPLICIT: dict[str, Any] = {"solver": "projected", "scheme": "dop853"}

CASES = (
    _falls("lattice of 4 x 4 cells", "bdf", lattice(4, 4)),
    _falls("lattice of 14 x 14 cells", "bdf", lattice(14, 14), quick=False),
    _falls("lattice of 15 x 15 cells, dop853", "explicit", lattice(15, 15), quick=False, **EXPLICIT),
    _falls("lattice of 20 x 20 cells", "bdf", lattice(20, 20), quick=False),
    _falls("lattice of 20 x 20 cells, dop853", "explicit", lattice(20, 20), quick=False, **EXPLICIT),
    _falls("lattice of 30 x 30 cells", "bdf", lattice(30, 30), quick=False),
    _falls("lattice of 30 x 30 cells, dop853", "explicit", lattice(30, 30), quick=False, **EXPLICIT),
    _falls("lattice of 2 x 2 x 2 cells", "bdf, in space", lattice(2, 2, 2)),
    _falls("lattice of 4 x 4 x 4 cells", "bdf, in space", lattice(4, 4, 4), quick=False),
    _falls("lattice of 4 x 4 x 4 cells, dop853", "explicit, in space", lattice(4, 4, 4), quick=False, **EXPLICIT),
    _falls("ring of 1000 rods", "bdf", ring(1000), 1e-4, rtol=1e-8, quick=False),
    _falls("ring of 100 rods", "bdf", ring(100), rtol=1e-9),
    _falls("comb of 10 teeth of 5 rods", "bdf", comb(10, 5)),
    _falls("comb of 40 teeth of 10 rods", "bdf", comb(40, 10), quick=False),
    _check_of(20, quick=True),
    _check_of(30, quick=False),
    _checked("check of a braced lattice of 5 x 5 cells", "many redundant equations", lambda: in_plane(braced(5)), 1),
    _checked("check of a net of 6 x 6 plates", "loops that close by themselves", partial(plates, 6), 4),
)
