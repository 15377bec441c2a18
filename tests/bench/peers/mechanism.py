"""A scene as plain numbers: what a user of any tool starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stiffmbs.model.model_data import ModelData
from stiffmbs.reading.marker import Marker

from ..by_hand import half_car

GROUND = -1
TYRES = {"front_tyre": (6307.466667, 0.0), "rear_tyre": (6249.333333, half_car.WHEELBASE)}
"""Load at rest, N, and distance to the bump's begin, m, of the half car's tyres (`tests.bench.by_hand.half_car`)."""


@dataclass(frozen=True)
class Place:
    """A point fixed to a body, in the body's axes; body -1 is ground."""

    body: int
    a: float
    b: float


@dataclass(frozen=True)
class Spring:
    """Pushes its ends apart with ``load - stiffness (length - free) - damping rate``."""

    i: Place
    j: Place
    stiffness: float
    damping: float
    free: float
    load: float


@dataclass(frozen=True)
class Cushion:
    """A bushing with ground axes: force and torque on i are ``preload - stiffness d - damping d'``, for (x, y, phi)."""

    i: Place
    j: Place
    stiffness: tuple[float, float, float]
    damping: tuple[float, float, float]
    preload: tuple[float, float, float]


@dataclass(frozen=True)
class Tyre:
    """A wheel's point on the road with its bump: `half_car.TYRE`, `half_car.TYRE_RATE`."""

    wheel: Place
    load: float
    behind: float


@dataclass(frozen=True)
class Mechanism:
    """Bodies and what acts between them.

    Attributes
    ----------
    mass : ndarray, shape (3 n,)
        Masses and inertias in the order of the coordinates (x1 y1 phi1 x2 ...).
    start : ndarray, shape (3 n,)
        Coordinates at the start; all is at rest.
    gravity : float
        Along y, m/s^2.
    pins : tuple of (Place, Place)
    on_x_axis : tuple of int
        Bodies that slide along the x axis without turning.
    springs, cushions, tyres : tuples
    torques : tuple of (int, float)
        Body and its torque, N m.
    """

    mass: np.ndarray
    start: np.ndarray
    gravity: float
    pins: tuple[tuple[Place, Place], ...]
    on_x_axis: tuple[int, ...]
    springs: tuple[Spring, ...]
    cushions: tuple[Cushion, ...]
    tyres: tuple[Tyre, ...]
    torques: tuple[tuple[int, float], ...]

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.start)


def mechanism_of(scene: ModelData) -> Mechanism:
    """The numbers of a benchmark's scene."""
    place, forces = _Places(scene), scene.forces
    return Mechanism(
        mass=np.array([m for b in scene.bodies.values() for m in (b.mass, b.mass, b.inertia)]),
        start=np.array([x for b in scene.bodies.values() for x in (*b.position, b.angle)]),
        gravity=scene.gravity[1],
        pins=tuple((place(p.i), place(p.j)) for p in scene.joints.values() if p.type == "revolute"),
        on_x_axis=tuple(place(p.i).body for p in scene.joints.values() if p.type == "prismatic"),
        springs=tuple(
            Spring(place(f.i), place(f.j), f.stiffness, f.damping, f.free_length, -f.preload)
            for f in forces.values()
            if f.type == "spring_damper"
        ),
        cushions=tuple(
            Cushion(place(f.i), place(f.j), _diagonal(f.stiffness), _diagonal(f.damping), f.preload)
            for f in forces.values()
            if f.type == "bushing"
        ),
        tyres=tuple(Tyre(place(forces[name].i), *TYRES[name]) for name in TYRES if name in forces),
        torques=tuple(
            (place(f.i).body, float(f.torque.text)) for f in forces.values() if f.type == "torque"
        ),
    )  # fmt: skip


class _Places:
    """Finds the point of a marker."""

    def __init__(self, scene: ModelData) -> None:
        self._scene = scene
        self._number = {name: number for number, name in enumerate(scene.bodies)}

    def __call__(self, marker: Marker) -> Place:
        point = self._scene.place(marker).point
        return Place(GROUND if marker.body == "ground" else self._number[marker.body], *point)


def _diagonal(rows: tuple[tuple[float | None, ...], ...]) -> tuple[float, float, float]:
    return rows[0][0] or 0.0, rows[1][1] or 0.0, rows[2][2] or 0.0
