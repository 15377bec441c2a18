"""Random mechanisms that have an equilibrium: trees of random joints with closed loops, springs, bushings and a floor."""

from __future__ import annotations

from typing import Any

import numpy as np

from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.elements.spatial.orientation import conjugate, rotated
from stiffmbs.elements.spatial.spatial_kinds import FORCES as SPATIAL_FORCES
from stiffmbs.elements.spatial.spatial_kinds import JOINTS as SPATIAL_JOINTS
from stiffmbs.model.model import Model
from stiffmbs.model.spatial_model import Model as SpatialModel

from .random_space import random_space_tree
from .random_tree import random_tree

MOST_BODIES, MOST_SPRINGS, MOST_LOOPS = 6, 4, 3
SMALL = 0.3


def random_statics(rng: np.random.Generator, in_space: bool) -> Model | SpatialModel:
    """A mechanism at whose bodies springs to the ground pull, so that its potential energy has a least value.

    Parameters
    ----------
    rng : numpy.random.Generator
    in_space : bool
    """
    count, springs = int(rng.integers(1, MOST_BODIES + 1)), int(rng.integers(0, MOST_SPRINGS))
    model: Any
    if in_space:
        model = random_space_tree(rng, count, min(springs, count))
    else:
        model = random_tree(rng, count, True, True, min(springs, count))
    statics = _Statics(rng, model, in_space)
    for k in range(int(rng.integers(0, MOST_LOOPS))):
        statics.close(k)
    for name in list(model.bodies):
        statics.hold(name)
        if rng.random() < SMALL:
            statics.rest(name)
    return statics.model


class _Statics:
    """Adds to a model, in the plane or in space, what its equilibrium depends on."""

    def __init__(self, rng: np.random.Generator, model: Any, in_space: bool) -> None:
        self.model = model
        self._rng, self._in_space = rng, in_space
        self._forces, self._joints = (SPATIAL_FORCES, SPATIAL_JOINTS) if in_space else (FORCES, JOINTS)
        self._dimensions = 3 if in_space else 2

    def close(self, k: int) -> None:
        """Close a loop between two bodies as they are drawn: by a rod, or where they are hinged to each other."""
        names = [*self.model.bodies, "ground"]
        one, other = (str(name) for name in self._rng.choice(names, 2, replace=False))
        point = self._point() + self._place(one)
        if self._rng.random() < 0.5:
            there = self._point() + self._place(other)
            fields = {"i": self._marker(one, point), "j": self._marker(other, there)}
            self.model.add(f"loop{k}", self._joints["distance"](**fields, length=float(np.linalg.norm(point - there))))
            return
        hinge = "spherical" if self._in_space else "revolute"
        self.model.add(f"loop{k}", self._joints[hinge](i=self._marker(one, point), j=self._marker(other, point)))

    def hold(self, body: str) -> None:
        """A spring or bushing from a body to the ground."""
        rng, here = self._rng, self._marker(body, self._place(body) + 0.3 * self._point())
        to = self._marker("ground", self._place(body) + self._point())
        if rng.random() < 0.5:
            spring = self._forces["spring_damper"](
                i=here,
                j=to,
                stiffness=rng.uniform(20, 2000),
                free_length=rng.uniform(0, 0.5),
                damping=rng.choice([0, 5]),
            )
            self.model.add(f"holds_{body}", spring)
            return
        straight = 10 ** rng.uniform(2, 7, self._dimensions)
        turning = 10 ** rng.uniform(0, 4, 3 if self._in_space else 1) * (rng.random() < 0.7)
        stiffness = (*straight, *turning)
        self.model.add(f"holds_{body}", self._forces["bushing"](i=here, j=to, stiffness=stiffness))

    def rest(self, body: str) -> None:
        """A floor that a body may come to rest on."""
        rng, fields = self._rng, {"radius": 0.1, "stiffness": 10 ** self._rng.uniform(3, 6)}
        low = rng.uniform(-1.5, -0.1)
        below = self._place(body) + low * np.eye(self._dimensions)[-1]
        kind = "sphere_contact" if self._in_space else "contact"
        floor = self._marker("ground", below)
        contact = self._forces[kind](
            i=self._marker(body, self._place(body)), j=floor, friction=0.3 if rng.random() < 0.3 else None, **fields
        )
        self.model.add(f"floor_{body}", contact)

    def _point(self) -> np.ndarray:
        return np.asarray(self._rng.uniform(-0.5, 0.5, self._dimensions))

    def _place(self, body: str) -> np.ndarray:
        return np.array(self.model.bodies[body].position) if body != "ground" else np.zeros(self._dimensions)

    def _marker(self, body: str, at: np.ndarray) -> dict[str, Any]:
        """A marker of a body at a point of the ground."""
        if body == "ground":
            return {"body": body, "point": at.tolist()}
        held = self.model.bodies[body]
        way = at - np.array(held.position)
        if self._in_space:
            own = rotated(conjugate(held.orientation), tuple(way.tolist()))
            return {"body": body, "point": np.asarray(own).tolist()}
        c, s = np.cos(held.angle), np.sin(held.angle)
        return {"body": body, "point": [float(c * way[0] + s * way[1]), float(c * way[1] - s * way[0])]}
