"""Shells of a mesh: flat triangles, and quadrilaterals of two pairs of triangles, with six components at each node.

A warped quadrilateral is projected to its mean plane. Rigid arms from its nodes lead to the corners there (R. L. Taylor, Finite
element analysis of linear shell problems, in The mathematics of finite elements and applications VI, 1988). With triangles along
both diagonals of the warped surface, thin twisted shells are far too stiff.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.sparse import bsr_array, csr_array, eye_array, kron

from ..materials import ElementMaterials
from ..solid import NodePairs
from .triangle import Sections, axes_of, slopes_of, strains

COMPONENTS: Final = 6
"""Components of a node of a shell: displacements and rotations."""
TRIANGLE, QUADRILATERAL = "triangle", "quad"
"""Kinds of shells by their names in meshio."""
DIVISION: Final = {TRIANGLE: ((0, 1, 2),), QUADRILATERAL: ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))}
"""Triangles of each element. Those of a quadrilateral, divided along both diagonals, have half of its stiffness and mass."""
LEAST_DRILLING = 0.01
"""Smallest factor beta_0 of the stiffness against drilling rotations: it is (1 - 4 nu^2) / 2, zero at nu = 0.5 (Felippa 2003)."""
WARPED = 0.5
"""Largest angle between the normals of the triangles of a quadrilateral and that of its mean plane, rad."""
AT_ONCE = 3_000
"""Triangles whose matrices are computed together; they take 80 MB."""


@dataclass(frozen=True, eq=False)
class Directors:
    """Displacements by rotations of points next to the middle surface, at distances of 1 m: inertia of rotations.

    A rotation of a corner about the normal moves no such point.
    """

    places: np.ndarray  # shape (m, 3): normals at the corners of triangles
    moments: csr_array  # shape (m, m), kg m^2: second moments of mass of the section between these corners
    turned: csr_array  # shape (3 m, 6 n): displacements by the components of the nodes

    def mass(self) -> csr_array:
        """Return the mass matrix of rotations, shape (6 n, 6 n)."""
        return csr_array(self.turned.T @ kron(self.moments, eye_array(3)) @ self.turned)


@dataclass(frozen=True, eq=False)
class Triangles:
    """Some triangles of a shell in their own axes."""

    places: np.ndarray  # of int, shape (triangles, 18): of the components of the nodes among those of the body
    areas: np.ndarray
    slopes: np.ndarray  # shape (triangles, 3 corners, 2): of the linear shape functions
    turned: np.ndarray  # shape (triangles, 3 corners, 6, 6): components of the corners by those of the nodes
    arms: np.ndarray  # shape (triangles, 3 corners, 3): from the nodes to the corners, m
    strains: np.ndarray  # shape (triangles, 3 points, 8, 18)
    sections: Sections
    weights: np.ndarray  # of each point, m^2

    def components(self, of_body: np.ndarray) -> np.ndarray:
        """Return the components of the corners in these axes from those of the body, shape (6 n, k), as (triangles, 18, k)."""
        count = len(self.areas)
        of_nodes = of_body[self.places].reshape(count, 3, COMPONENTS, -1)
        return (self.turned @ of_nodes).reshape(count, 3 * COMPONENTS, -1)  # type: ignore[no-any-return]

    def forces(self, local: np.ndarray) -> np.ndarray:
        """Return forces on the components of the nodes from those on the corners in these axes, both (triangles, 18)."""
        return np.einsum("tmab,tma->tmb", self.turned, local.reshape(-1, 3, COMPONENTS)).reshape(local.shape)

    def resultants(self, strains: np.ndarray) -> np.ndarray:
        """Return forces, moments and shear forces times the weights of the points, of strains (triangles, points, 8, ...)."""
        flat = strains.reshape(*strains.shape[:3], -1) * self.weights[:, None, None, None]
        found, membrane = np.empty_like(flat), self.sections.membrane()[:, None]
        found[:, :, :3] = membrane @ flat[:, :, :3]
        found[:, :, 3:6] = membrane @ flat[:, :, 3:6] * (self.sections.thickness**2 / 12)[:, None, None, None]
        found[:, :, 6:] = self.sections.shear()[:, None, None, None] * flat[:, :, 6:]
        return found.reshape(strains.shape)


@dataclass(frozen=True, eq=False)
class Shell:
    """Triangles of isotropic, linearly elastic shells. Each quadrilateral has four of half its thickness in stiffness and mass."""

    places: np.ndarray  # shape (n, 3): positions of the nodes, in the middle surface, m
    triangles: np.ndarray  # of int, shape (triangles, 3)
    # shape (triangles, 3, 3): from the nodes to the corners, m; zero unless a quadrilateral is warped
    offsets: np.ndarray
    shares: np.ndarray  # shape (triangles,): 1, or 1/2 in a quadrilateral
    materials: ElementMaterials  # of the triangles
    thickness: np.ndarray  # shape (triangles,), m
    elements: np.ndarray  # of int, shape (triangles,): numbers of the elements that the triangles are of

    @cached_property
    def pairs(self) -> NodePairs:
        """Pairs of nodes that share an element."""
        return NodePairs([self.triangles.T], len(self.places))

    def stiffness(self) -> csr_array:
        """Return the stiffness matrix, shape (6 n, 6 n)."""
        sums = self.pairs.zeros((COMPONENTS, COMPONENTS))
        for start in range(0, len(self.triangles), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            self.pairs.add(sums, 0, part, self._of_triangles(part))
        size = COMPONENTS * self.pairs.count
        return csr_array(bsr_array((sums, self.pairs.columns, self.pairs.starts), shape=(size, size)))

    def part(self, part: slice) -> Triangles:
        """Return some triangles with their strains."""
        nodes = self.triangles[part]
        axes, places, areas = axes_of(self.places[nodes] + self.offsets[part])
        modulus, poisson, _ = (each[part] for each in self.materials)
        sections = Sections(modulus, poisson, self.thickness[part])
        return Triangles(
            (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1), areas, slopes_of(places, areas),
            _turned(axes, self.offsets[part]), np.einsum("tab,tkb->tka", axes, self.offsets[part]),
            strains(places, areas, sections, LEAST_DRILLING), sections, self.shares[part] * areas / 3,
        )  # fmt: skip

    def _of_triangles(self, part: slice) -> np.ndarray:
        """Return stiffness matrices of triangles by pairs of corners, shape (triangles, 3, 3, 6, 6)."""
        found = self.part(part)
        local = found.strains.transpose(0, 3, 1, 2).reshape(len(found.areas), 3 * COMPONENTS, -1) @ found.resultants(
            found.strains
        ).reshape(len(found.areas), -1, 3 * COMPONENTS)
        by_corners = local.reshape(-1, 3, COMPONENTS, 3, COMPONENTS)
        return np.einsum("tmanb,tmac,tnbd->tmncd", by_corners, found.turned, found.turned, optimize=True)  # type: ignore[no-any-return]

    def mass(self) -> csr_array:
        """Return the consistent mass matrix, shape (6 n, 6 n), kg and kg m^2."""
        surface = self.shares * self.materials.density * self.thickness * self._areas()
        factors = np.broadcast_to(np.linalg.cholesky(np.ones((3, 3)) + np.eye(3)), (len(surface), 3, 3))
        between = self.pairs.matrix([(factors, (surface / 12)[:, None, None] * factors)])
        of_displacements = np.diag(np.repeat([1.0, 0.0], 3))
        found = csr_array(kron(between, csr_array(of_displacements)) + self.directors.mass())
        found.eliminate_zeros()
        return found

    @cached_property
    def directors(self) -> Directors:
        """Inertia of rotations of all corners: density t^3 / 12 for each area, with linear rotations."""
        axes, _, areas = axes_of(self.places[self.triangles])
        count, normals = len(self.triangles), np.repeat(axes[:, 2], 3, axis=0)
        moments = self.shares * self.materials.density * self.thickness**3 / 12 * areas
        matrix = csr_array(bsr_array(
            ((moments / 12)[:, None, None] * (np.ones((3, 3)) + np.eye(3)), np.arange(count), np.arange(count + 1))
        ))  # fmt: skip
        x, y, z = normals.T
        zero = np.zeros_like(x)
        across = np.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=1)  # of rotation x normal
        rows = np.repeat(np.arange(3 * len(normals)).reshape(-1, 3), 3, axis=1)
        columns = COMPONENTS * self.triangles.reshape(-1, 1) + 3 + np.tile(np.arange(3), 3)
        shape = (3 * len(normals), COMPONENTS * len(self.places))
        return Directors(normals, matrix, csr_array((across.ravel(), (rows.ravel(), columns.ravel())), shape=shape))

    def _areas(self) -> np.ndarray:
        return axes_of(self.places[self.triangles])[2]


def _turned(axes: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return components of corners in the axes of triangles by those of the nodes, shape (triangles, 3 corners, 6, 6).

    A rotation moves a corner at the end of its rigid arm, the offset.
    """
    found = np.zeros((*offsets.shape[:2], COMPONENTS, COMPONENTS))
    found[:, :, :3, :3] = found[:, :, 3:, 3:] = axes[:, None]
    found[:, :, :3, 3:] = np.einsum("tab,tmcb->tmac", axes, np.cross(np.eye(3), offsets[:, :, None]))
    return found


def mean_normals(corners: np.ndarray) -> np.ndarray:
    """Return the normals of the mean planes of quadrilaterals, across both diagonals, of the length of twice their areas.

    `corners` of shape (quadrilaterals, 4, 3).
    """
    return np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])


def _to_mean_plane(corners: np.ndarray) -> np.ndarray:
    """Return displacements from the corners of elements to their mean planes, shape (elements, corners, 3)."""
    if corners.shape[1] == 3:
        return np.zeros_like(corners)
    normals = mean_normals(corners)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heights = np.einsum("ena,ea->en", corners - corners.mean(axis=1, keepdims=True), normals)
    return -heights[:, :, None] * normals[:, None]  # type: ignore[no-any-return]


def of_elements(
    nodes: np.ndarray, cells: Mapping[str, np.ndarray], materials: Mapping[str, ElementMaterials],
    thickness: Mapping[str, np.ndarray],
) -> Shell:  # fmt: skip
    """Return the shell of elements by kinds: nodes, shape (elements, 3 or 4), materials and thickness, m, of each."""
    triangles, shares, offsets = [], [], []
    for kind, own in cells.items():
        to_plane = _to_mean_plane(nodes[own])
        for corners in DIVISION[kind]:
            triangles.append(own[:, list(corners)])
            offsets.append(to_plane[:, list(corners)])
            shares.append(np.full(len(own), 1.0 if kind == TRIANGLE else 0.5))
    times = {kind: len(DIVISION[kind]) for kind in cells}
    properties = zip(*(materials[kind] for kind in cells), strict=True)
    of_triangles = (
        np.concatenate([np.tile(own, times[kind]) for kind, own in zip(cells, each, strict=True)])
        for each in properties
    )
    of_kinds = [np.tile(thickness[kind], times[kind]) for kind in cells]
    numbers = np.split(np.arange(sum(map(len, cells.values()))), np.cumsum([len(own) for own in cells.values()])[:-1])
    elements = [np.tile(own, times[kind]) for kind, own in zip(cells, numbers, strict=True)]
    return Shell(
        nodes, np.concatenate(triangles), np.concatenate(offsets), np.concatenate(shares), ElementMaterials(*of_triangles),
        np.concatenate(of_kinds), np.concatenate(elements),
    )  # fmt: skip
