"""Both surfaces of a shell, where bending stresses are largest, with the stresses there.

At a node, triangles that share an edge have common points on both surfaces if their normals and sections agree. Where they do not,
as at a fold or a step of thickness, the stress jumps: each side has its own points.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .shell import AT_ONCE, COMPONENTS, DIVISION, Shell, Triangles
from .stress import ShellStress, second_order_strains
from .triangle import MIDDLES, SIDES, axes_of

FOLD = 0.5
"""Largest angle between the normals of two triangles without a fold between them, rad; flat elements of curved shells have less.
Source: ``tests/flexible_bodies/shells/test_shell_stresses.py``."""
TO_CORNERS = np.linalg.inv(MIDDLES)
"""Values at the corners of a triangle by those in the middles of its sides; both are linear."""
PLANE = np.array([[[1, 0], [0, 0]], [[0, 0], [0, 1]], [[0, 1], [1, 0]]], dtype=float)
"""Tensors of unit stresses xx, yy, xy in the axes of a triangle."""
TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Entries of the stress tensor: xx, yy, zz, xy, yz, zx."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Points on both surfaces of a shell.

    - `nodes` of int, shape (points,): node of each point, not decreasing.
    - `arms` of shape (points, 3): from the nodes to the points, m.
    - `corners` of int, shape (triangles, 3, 2): points of each corner, the first along the normal of the triangle.
    """

    shell: Shell
    nodes: np.ndarray
    arms: np.ndarray
    corners: np.ndarray

    def displacements(self, of_nodes: np.ndarray) -> np.ndarray:
        """Return the displacements of the points, shape (k, points, 3), by those of the nodes, shape (6 n, k)."""
        of_points = of_nodes.T.reshape(of_nodes.shape[1], -1, COMPONENTS)[:, self.nodes]
        return of_points[..., :3] + np.cross(of_points[..., 3:], self.arms)  # type: ignore[no-any-return]

    def stresses(self, of_nodes: np.ndarray, first_order: np.ndarray | None = None) -> np.ndarray:
        """Return the stresses of displacements of the nodes, shape (6 n, k), at the points, N/m^2: the mean of the triangles there.

        The result has the shape (k, points, 6): xx, yy, zz, xy, yz, zx. `first_order`: parts of first order, of the same shape, whose
        strains of second order are added; none by default.
        """
        found = np.zeros((len(self.nodes), 6, of_nodes.shape[1]))
        weights = np.zeros(len(self.nodes))
        for number, triangles in enumerate(self._stress.parts()):
            part = slice(number * AT_ONCE, (number + 1) * AT_ONCE)
            shares = np.broadcast_to(self.shell.shares[part, None, None], self.corners[part].shape)
            np.add.at(weights, self.corners[part], shares)
            own = self._at_corners(part, triangles, of_nodes, first_order)
            np.add.at(found, self.corners[part], shares[..., None, None] * own)
        return np.moveaxis(found / weights[:, None, None], 2, 0)

    @cached_property
    def _stress(self) -> ShellStress:
        """Triangles with their strains."""
        return ShellStress(self.shell)

    def _at_corners(
        self, part: slice, triangles: Triangles, of_nodes: np.ndarray, first_order: np.ndarray | None
    ) -> np.ndarray:
        """Return the stresses of some triangles on both surfaces, shape (triangles, 3 corners, 2, 6, k)."""
        strains = triangles.strains[:, :, :COMPONENTS] @ triangles.components(of_nodes)[:, None]
        if first_order is not None:
            squares = [second_order_strains(triangles, each)[:, :, :COMPONENTS] for each in first_order.T]
            strains = strains + np.stack(squares, axis=-1)
        at_corners = np.einsum("cp,tpak->tcak", TO_CORNERS, strains)
        thickness = triangles.sections.thickness[:, None, None, None]
        bending = thickness / 2 * at_corners[:, :, 3:]
        both = np.stack([at_corners[:, :, :3] + bending, at_corners[:, :, :3] - bending], axis=2)
        modulus = triangles.sections.membrane() / thickness[..., 0]
        axes, _, _ = axes_of(self.shell.places[self.shell.triangles[part]] + self.shell.offsets[part])
        tensors = np.einsum("tba,sbc,tcd->tsad", axes[:, :2], PLANE, axes[:, :2])
        turned = np.stack([tensors[..., a, b] for a, b in TENSOR], axis=1) @ modulus
        return np.einsum("tis,tczsk->tczik", turned, both, optimize=True)  # type: ignore[no-any-return]

    def faces(self, cells: Mapping[str, np.ndarray]) -> Iterator[np.ndarray]:
        """Yield the points around each element on one surface, and then on the other one, counterclockwise as seen from outside.

        `cells`: nodes of the elements by kinds, as those of the shell.
        """
        start = 0
        for kind, own in cells.items():
            division, points = DIVISION[kind], np.empty((*own.shape, 2), dtype=int)
            for k, corners in reversed(list(enumerate(division))):
                first = start + k * len(own)
                points[:, list(corners)] = self.corners[first : first + len(own)]
            yield from points[:, :, 0]
            yield from points[:, ::-1, 1]
            start += len(division) * len(own)


def surfaces_of(shell: Shell) -> Surfaces:
    """Return the points on both surfaces of a shell."""
    axes, _, _ = axes_of(shell.places[shell.triangles] + shell.offsets)
    count, points = connected_components(_smooth(shell, axes[:, 2]), directed=False)
    of_sides = np.repeat(shell.triangles.ravel(), 2)
    first = np.unique(points, return_index=True)[1]
    order = np.argsort(of_sides[first], kind="stable")
    rank = np.empty(count, dtype=int)
    rank[order] = np.arange(count)
    points, reference = rank[points], first[order]
    arms = np.zeros((count, 3))
    np.add.at(arms, points, np.repeat(axes[:, 2], 6, axis=0) * np.tile([1.0, -1.0], 3 * len(axes))[:, None])
    arms *= (shell.thickness[reference // 6] / 2 / np.linalg.norm(arms, axis=1))[:, None]
    return Surfaces(shell, of_sides[reference], arms, points.reshape(-1, 3, 2))


def _smooth(shell: Shell, normals: np.ndarray) -> coo_array:
    """Return the graph of both sides of the corners of triangles: those that are one point, of shape (6 triangles, 6 triangles).

    Neighbours across an edge run along it in opposite directions if their normals are on one side. More than two elements
    at an edge are a junction, where the stress jumps.
    """
    ends = np.concatenate([shell.triangles[:, list(side)] for side in SIDES])
    places = np.concatenate([3 * np.arange(len(normals))[:, None] + list(side) for side in SIDES])
    swapped = ends[:, 0] > ends[:, 1]
    ends[swapped], places[swapped] = ends[swapped, ::-1], places[swapped, ::-1]
    edges = np.unique(ends, axis=0, return_inverse=True)[1].ravel()
    of_elements = np.unique(np.column_stack([edges, np.tile(shell.elements, len(SIDES))]), axis=0)[:, 0]
    junction = np.bincount(of_elements)[edges] > 2
    order = np.argsort(edges, kind="stable")
    edges, places, swapped, junction = edges[order], places[order], swapped[order], junction[order]
    sections = np.column_stack([*shell.materials, shell.thickness])
    pairs = []
    for apart in range(1, len(edges)):
        same = edges[apart:] == edges[:-apart]
        if not same.any():
            break
        one, other = places[:-apart][same], places[apart:][same]
        of_one, of_other = one[:, 0] // 3, other[:, 0] // 3
        within = shell.elements[of_one] == shell.elements[of_other]
        turned = ~within & (swapped[:-apart] == swapped[apart:])[same]
        cosines = np.where(turned, -1.0, 1.0) * np.einsum("pa,pa->p", normals[of_one], normals[of_other])
        alike = (cosines >= np.cos(FOLD)) & (sections[of_one] == sections[of_other]).all(axis=1)
        joined = alike & (within | ~junction[:-apart][same])
        for side in (0, 1):
            of_sides = 2 * one[joined] + side, 2 * other[joined] + (side ^ turned[joined])[:, None]
            pairs.append(np.column_stack([each.ravel() for each in of_sides]))
    rows, columns = np.concatenate(pairs).T if pairs else np.empty((2, 0), dtype=int)
    size = 6 * len(normals)
    return coo_array((np.ones(len(rows)), (rows, columns)), shape=(size, size))
