"""Faces on the surface of a mesh, or shells: areas of their nodes, and loads on these."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ..errors import InputError
from .finite_elements import DISPLACEMENTS, PRECISION, FiniteElements
from .shapes import ELEMENTS, face_rule
from .shells.shell import DIVISION

UNIT_LOADS: Final = 4
"""Loads on a surface: pressure, and traction along x, y and z."""


class Face(NamedTuple):
    """Face of an element with a quadrature."""

    nodes: np.ndarray  # of int, shape (k,)
    values: np.ndarray  # shape (k, points): shape functions of these nodes
    normals: np.ndarray  # shape (points, 3): out of the element, with the length of the weight, m^2
    of_shell: bool = False


def nodal_areas(model: FiniteElements, nodes: np.ndarray) -> np.ndarray:
    """Return the integrals of the shape functions of some nodes over the faces between these, m^2.

    Their sums with a field at the nodes are the integrals of that field. Zero for nodes without such faces; of a shape function
    of second order they may be negative. `nodes`: numbers of the nodes.
    """
    areas = np.zeros(len(model.nodes))
    for face in _faces(model, nodes):
        np.add.at(areas, face.nodes, face.values @ np.linalg.norm(face.normals, axis=1))
    return areas[nodes]


def unit_loads(model: FiniteElements, nodes: np.ndarray, outside: np.ndarray | None, hand: float) -> np.ndarray:
    """Return consistent nodal forces on the faces between some nodes, shape (size, 4).

    They are those of a pressure of 1 Pa, against the outer normals, and of tractions of 1 Pa along x, y and z. `outside`: direction of
    the outer normals of shells; by default they follow from the order of the nodes in the file. `hand`: -1 if the model is
    the mirror image of its file. Raises InputError if there are no faces, or the outer normals of neighbouring shells
    are opposite.
    """
    found = np.zeros((len(model.nodes), model.components, UNIT_LOADS))
    faces = list(_faces(model, nodes))
    if not faces:
        raise InputError("found no face of an element between its nodes, expected a surface of a mesh")
    shells = [face for face in faces if face.of_shell]
    signs = [_outward(face, outside, hand) for face in shells]
    _check_normals(shells, signs, outside is not None)
    shells = [face._replace(normals=face.normals * sign) for face, sign in zip(shells, signs, strict=True)]
    for face in (*(face for face in faces if not face.of_shell), *shells):
        sizes = np.linalg.norm(face.normals, axis=1)
        loads = np.concatenate([-face.normals[:, :, None], sizes[:, None, None] * np.eye(3)], axis=2)
        found[face.nodes, :DISPLACEMENTS] += np.einsum("np,pal->nal", face.values, loads)
    return found.reshape(model.size, UNIT_LOADS)


def _outward(face: Face, outside: np.ndarray | None, hand: float) -> float:
    """Return the sign of the outer normal of a shell. Raises InputError if the outer direction is in its plane."""
    if outside is None:
        return hand
    along = float(face.normals.sum(axis=0) @ outside)
    if abs(along) <= PRECISION * np.linalg.norm(face.normals) * np.linalg.norm(outside):
        raise InputError("found an element whose plane contains the direction 'outside', expected another direction")
    return float(np.sign(along))


def _check_normals(faces: list[Face], signs: list[float], stated: bool) -> None:
    """Refuse shells whose neighbours have opposite outer normals: each common edge has opposite directions in both.

    `signs`: those of the outer normals by the order of the nodes. With a stated direction, edges of three and more
    shells may have any.
    """
    loops = [face.nodes.tolist()[:: int(sign)] for face, sign in zip(faces, signs, strict=True)]
    edges = Counter(edge for own in loops for edge in zip(own, [*own[1:], own[0]], strict=True))
    for (start, end), count in edges.items():
        if count > 1 and not stated:
            raise InputError(
                "found neighbouring shells with opposite normals, expected one outer side: state 'outside', a direction to it"
            )
        if count == 2 and not edges[end, start]:
            raise InputError(
                "found neighbouring shells with opposite sides in the direction 'outside', expected another direction, or one "
                "surface for each of them"
            )


def _faces(model: FiniteElements, nodes: np.ndarray) -> Iterator[Face]:
    """Yield the faces on the surface of solids without those under shells, and the shells, all of whose nodes are among some nodes."""
    chosen = np.zeros(len(model.nodes), dtype=bool)
    chosen[nodes] = True
    shells = list(_shells(model, chosen))
    yield from shells
    at_nodes: dict[int, list[set[int]]] = {}
    for shell in shells:
        at_nodes.setdefault(int(shell.nodes.min()), []).append(set(shell.nodes.tolist()))
    sharing: dict[tuple[int, ...], list[Face]] = {}
    for kind, cells in model.solid_cells.items():
        element = ELEMENTS[kind]
        for corners in (*element.shape.triangles, *element.shape.quadrilaterals):
            points, along, weights = face_rule(element.shape.corners[list(corners)])
            values, slopes = element.values(points), element.slopes(points)
            own = element.nodes_of(corners)
            for cell in cells[chosen[cells[:, own]].all(axis=1)]:
                places = model.nodes[cell]
                sides = np.einsum("na,nbp,bkp->kpa", places, slopes, along, optimize=True)
                normals = np.cross(*sides) * weights[:, None]
                to_face = places[own].mean(axis=0) - places[: len(element.shape.corners)].mean(axis=0)
                normals *= np.sign(normals.sum(axis=0) @ to_face)
                face = Face(cell[own], values[own], normals)
                sharing.setdefault(tuple(sorted(cell[list(corners)].tolist())), []).append(face)
    for faces in sharing.values():
        around = set(faces[0].nodes.tolist())
        is_covered = any(shell <= around for node in around for shell in at_nodes.get(node, ()))
        if len(faces) == 1 and not is_covered:  # others are within the body
            yield faces[0]


def _shells(model: FiniteElements, chosen: np.ndarray) -> Iterator[Face]:
    """Yield the shells, each as the triangles along both diagonals with half of their areas, by the order of its nodes."""
    for kind, cells in model.shell_cells.items():
        for cell in cells[chosen[cells].all(axis=1)]:
            corners = np.array(DIVISION[kind])
            places = model.nodes[cell][corners]
            share = 0.5 / max(1, len(corners) // 2)
            normals = share * np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
            values = np.zeros((len(cell), len(corners)))
            np.add.at(values, (corners, np.arange(len(corners))[:, None]), 1 / 3)
            yield Face(cell, values, normals, of_shell=True)
