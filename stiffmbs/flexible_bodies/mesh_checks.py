"""Checks of the elements of a mesh: volumes, and nodes that neighbours share."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..errors import InputError
from .shapes import ELEMENTS
from .shells.welds import edges_on_solids
from .solid import Block

FLAT = 1e-9
"""Smallest volume of an element, relative to the product of its edges, and smallest density of volume relative to the largest."""


def check_volumes(nodes: np.ndarray, cells: np.ndarray, kind: str) -> None:
    """Refuse inverted and flat elements, by the volume between the edges at the corners."""
    shape = ELEMENTS[kind].shape
    linear = next(each for each in ELEMENTS.values() if each.shape is shape)
    edges = np.einsum(
        "enb,nap->epab", nodes[cells[:, : len(shape.corners)]], linear.slopes(linear.nodes.T), optimize=True
    )
    flat = np.linalg.det(edges) <= FLAT * np.linalg.norm(edges, axis=3).prod(axis=2)
    refuse(flat.any(axis=1), "inverted or flat elements", cells[:, : len(shape.corners)], "elements of positive volume")


def check_repeated(corners: np.ndarray) -> None:
    """Refuse elements between the same nodes as others: their mass and stiffness would count twice.

    `corners` of shape (elements, corners): nodes at the corners of elements of one kind.
    """
    cells, corners = corners, np.sort(corners, axis=1)
    repeated = np.ones(len(cells), dtype=bool)
    repeated[np.unique(corners, axis=0, return_index=True)[1]] = False
    refuse(repeated, "elements between the same nodes as others", cells, "each element once")


def check_jacobians(block: Block) -> None:
    """Refuse elements with curved edges that are inverted in parts: at a node or a point of the quadrature."""
    element = ELEMENTS[block.kind]
    volumes = np.linalg.det(block.jacobians(np.column_stack([element.nodes.T, element.rule()[0]])))
    bad = ~(volumes > FLAT * np.abs(volumes).max(axis=1, keepdims=True)).all(axis=1)
    expected = "elements of positive volume; are nodes on their edges misplaced?"
    refuse(bad, "elements that are inverted or flat in places", block.nodes.T, expected)


def refuse(bad: np.ndarray, what: str, nodes: np.ndarray, expected: str) -> None:
    """Refuse elements that are bad, if there are any; the message names the nodes of the first."""
    if bad.any():
        raise InputError(
            f"found {bad.sum()} {what}, the first with nodes {', '.join(map(str, nodes[bad.argmax()]))}, expected {expected}"
        )


def check_shared(cells: Mapping[str, np.ndarray]) -> None:
    """Refuse elements whose common edges and faces do not have the same nodes. `cells`: nodes of the elements by kinds."""
    corners, rows = [], []
    for kind, of_kind in cells.items():
        element, first = ELEMENTS[kind], len(ELEMENTS[kind].shape.corners)
        corners.append(of_kind[:, :first].ravel())
        shared = element.middles[: len(element.middles) - element.inside]
        rows += [_rows(of_kind, between, node) for between, node in zip(shared, of_kind.T[first:], strict=False)]
    middles = np.unique(np.concatenate([np.empty((0, 5), dtype=np.int64), *rows]), axis=0)
    _, start, count = np.unique(middles[:, :4], axis=0, return_index=True, return_counts=True)
    apart = np.flatnonzero(count > 1)
    of_one = np.unique(middles[:, 4], return_counts=True)[1]
    if of_one.max(initial=1) > 1 or np.isin(middles[:, 4], np.concatenate(corners)).any():
        raise InputError(
            "found elements that share nodes on edges or faces but not their corners, expected both or neither"
        )
    if len(apart):
        one, other = middles[start[apart[0]] : start[apart[0]] + 2, 4]
        raise InputError(
            f"found the nodes {one} and {other} at the same place of an edge or face that elements share, expected one node"
        )
    _check_faces(cells)


def _rows(cells: np.ndarray, between: tuple[int, ...], node: np.ndarray) -> np.ndarray:
    """Return the sorted corners of an edge or face of all elements, and a node, shape (elements, 5)."""
    padded = np.full((len(cells), 4), -1)
    padded[:, : len(between)] = np.sort(cells[:, list(between)], axis=1)
    return np.column_stack([padded, node])


def check_connected(cells: Mapping[str, np.ndarray], shells: Mapping[str, np.ndarray]) -> None:
    """Refuse parts that could rotate about common corners and edges: solids share faces, and shells edges with others.

    `cells`, `shells`: nodes of solids and shells by kinds.
    """
    first, rows = 0, []
    for kind, of_kind in cells.items():
        shape, numbers = ELEMENTS[kind].shape, first + np.arange(len(of_kind))
        for face in (*shape.triangles, *shape.quadrilaterals):
            rows.append(_rows(of_kind, face, numbers))
        first += len(of_kind)
    solids = first
    for own in shells.values():
        numbers = first + np.arange(len(own))
        rows += [_rows(own, (k - 1, k), numbers) for k in range(own.shape[1])]
        first += len(own)
    common = np.concatenate(rows)
    _, place = np.unique(common[:, :4], axis=0, return_inverse=True)
    of_shells, of_solids = edges_on_solids(shells, cells).T
    ends = np.concatenate([common[:, 4], solids + of_shells]), np.concatenate([first + place.ravel(), of_solids])
    graph = coo_array((np.ones(len(ends[0])), ends), shape=(first + len(place),) * 2)
    parts = len(np.unique(connected_components(graph, directed=False)[1][:first]))
    if parts > 1:
        of_others = "edges of elements" if not cells else "faces of elements" + " or edges of shells" * bool(shells)
        raise InputError(
            f"found {parts} parts{' of shells' * (not cells)} that are not connected by {of_others}, expected one body"
        )


def _check_faces(cells: Mapping[str, np.ndarray]) -> None:
    """Refuse quadrilaterals of one element that meet triangles of others, which do not fit together."""
    quadrilaterals = _alone(cells, 4)
    across = np.concatenate([quadrilaterals[:, list(three)] for three in combinations(range(4), 3)])
    triangles = _alone(cells, 3)
    _, count = np.unique(np.concatenate([np.unique(across, axis=0), triangles]), axis=0, return_counts=True)
    if (count > 1).any():
        raise InputError(
            f"found {(count > 1).sum()} triangular faces of elements on quadrilateral ones of others, expected pyramids between them"
        )


def _alone(cells: Mapping[str, np.ndarray], count: int) -> np.ndarray:
    """Return the sorted corners of the faces with a number of corners that belong to one element only."""
    every = [np.empty((0, count), dtype=np.int64)]
    for kind, of_kind in cells.items():
        shape = ELEMENTS[kind].shape
        every += [
            np.sort(of_kind[:, list(face)], axis=1)
            for face in (shape.triangles if count == 3 else shape.quadrilaterals)
        ]
    found, times = np.unique(np.concatenate(every), axis=0, return_counts=True)
    return found[times == 1]
