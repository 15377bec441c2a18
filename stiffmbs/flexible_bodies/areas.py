"""Areas of the nodes on the surface of a mesh, or of the shells between them."""

from __future__ import annotations

import numpy as np

from .finite_elements import FiniteElements
from .shapes import ELEMENTS, face_rule
from .shells.shell import DIVISION
from .shells.triangle import axes_of


def nodal_areas(model: FiniteElements, nodes: np.ndarray) -> np.ndarray:
    """Return the integrals of the shape functions of some nodes over the faces between these, m^2.

    Their sums with a field at the nodes are the integrals of that field. Zero for nodes without such faces; of a shape function
    of second order they may be negative. `nodes`: numbers of the nodes.
    """
    chosen, areas = np.zeros(len(model.nodes), dtype=bool), np.zeros(len(model.nodes))
    chosen[nodes] = True
    faces: dict[tuple[int, ...], list[tuple[np.ndarray, np.ndarray]]] = {}
    if model.shell is not None:
        for kind, cells in model.cells.items():
            inside = cells[chosen[cells].all(axis=1)]
            for corners in DIVISION[kind]:
                triangles = inside[:, list(corners)]
                share = axes_of(model.nodes[triangles])[2] / (3 * max(1, len(DIVISION[kind]) // 2))
                np.add.at(areas, triangles, share[:, None])
        return areas[nodes]
    for kind, cells in model.cells.items():
        element = ELEMENTS[kind]
        for face in (*element.shape.triangles, *element.shape.quadrilaterals):
            points, along, weights = face_rule(element.shape.corners[list(face)])
            values, slopes = element.values(points), element.slopes(points)
            own = element.nodes_of(face)
            for cell in cells[chosen[cells[:, own]].all(axis=1)]:
                sides = np.einsum("na,nbp,bkp->kpa", model.nodes[cell], slopes, along, optimize=True)
                size = np.linalg.norm(np.cross(*sides), axis=1) * weights
                faces.setdefault(tuple(sorted(cell[list(face)].tolist())), []).append((cell[own], values[own] @ size))
    for sharing in faces.values():
        if len(sharing) == 1:  # others are within the body
            np.add.at(areas, *sharing[0])
    return areas[nodes]
