"""A tree in this package's bodies, joints and forces."""

from __future__ import annotations

import numpy as np

from stiffmbs import spatial
from stiffmbs.model.model_data import ModelData

from .tree import GROUND, Tree


def scene_of(tree: Tree) -> ModelData:
    """The model; hinges through one point, of links without a mass, are a spherical joint.

    Parameters
    ----------
    tree : Tree
        With one or three hinges between two links that have a mass.
    """
    model = spatial.Model("tree", gravity=_listed(tree.gravity))
    omega, velocity = tree.motion_at_start()
    carrier = {GROUND: GROUND}
    for k, link in enumerate(tree.links):
        if not link.mass:
            carrier[k] = carrier[link.parent]
            continue
        model.add(
            _name(k),
            spatial.Body(
                mass=link.mass, inertia=link.inertia.tolist(), position=_listed(link.centre), omega=_listed(omega[k]),
                velocity=_listed(velocity[k] + np.cross(omega[k], link.centre - link.hinge)),
            ),
        )  # fmt: skip
        before = carrier[link.parent]
        spherical = before != link.parent
        i, j = (_marker(tree, body, k, not spherical) for body in (k, before))
        model.add(f"hinge{k}", (spatial.Spherical if spherical else spatial.Revolute)(i=i, j=j))
        if link.damping:
            model.add(f"damper{k}", spatial.TorsionSpring(i=i, j=j, stiffness=0, damping=link.damping))
        carrier[k] = k
    return model.data()


def _marker(tree: Tree, body: int, k: int, turned: bool) -> spatial.Marker:
    """The marker of a link's hinge on a body, its z axis along the hinge where that matters."""
    link = tree.links[k]
    origin = np.zeros(3) if body == GROUND else tree.links[body].centre
    name = "ground" if body == GROUND else _name(body)
    point = _listed(link.hinge - origin)
    if not turned:
        return spatial.Marker(body=name, point=point)
    return spatial.Marker(body=name, point=point, orientation={"z": _listed(link.axis)})


def _name(k: int) -> str:
    return f"link{k}"


def _listed(numbers: np.ndarray) -> tuple[float, ...]:
    return tuple(float(number) for number in numbers)
