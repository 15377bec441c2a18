"""Shape functions and quadrature of isoparametric solid elements, with nodes in the order of meshio and VTK.

A shape function is the polynomial that is 1 at one node and 0 at the others. Hexahedra of 20 nodes have the serendipity space
(Zienkiewicz & Taylor, The finite element method, volume 1, chapter on shape functions).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy.special import roots_jacobi

from ..errors import needs


@dataclass(frozen=True, eq=False)
class Shape:
    """Corners of a kind of solid, in reference coordinates, with its edges and faces by their corners."""

    corners: np.ndarray
    edges: tuple[tuple[int, int], ...]
    triangles: tuple[tuple[int, ...], ...] = ()
    quadrilaterals: tuple[tuple[int, ...], ...] = ()


TETRAHEDRON = Shape(
    np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]), ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)),
    ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
)  # fmt: skip
HEXAHEDRON = Shape(
    np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]),
    ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    quadrilaterals=((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)),
)
WEDGE = Shape(
    np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]),
    ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)), ((0, 1, 2), (3, 4, 5)),
    ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
)  # fmt: skip
PYRAMID = Shape(  # from the apex at 0 to the base at z = 1
    np.array([(-1, -1, 1), (-1, 1, 1), (1, 1, 1), (1, -1, 1), (0, 0, 0)]),
    ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)), ((0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    ((0, 1, 2, 3),),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Element:
    """Kind of element.

    `on_edges`, `on_faces`, `inside`: true if it has nodes in the middle of its edges, of its quadrilaterals, and of itself.
    `powers` of shape (nodes, 3): exponents of the monomials of its space. `rule`: points, shape (3, points), and weights of
    the quadrature that integrates the mass of an undistorted element exactly.
    """

    shape: Shape
    powers: np.ndarray
    rule: Callable[[], tuple[np.ndarray, np.ndarray]]
    on_edges: bool = False
    on_faces: bool = False
    inside: bool = False

    @property
    def middles(self) -> tuple[tuple[int, ...], ...]:
        """Corners between which the nodes that are no corners are in the middle, in the order of these nodes."""
        inside = (tuple(range(len(self.shape.corners))),) if self.inside else ()
        return (
            *(self.shape.edges if self.on_edges else ()),
            *(self.shape.quadrilaterals if self.on_faces else ()), *inside,
        )  # fmt: skip

    @cached_property
    def nodes(self) -> np.ndarray:
        """Reference coordinates of the nodes, shape (nodes, 3)."""
        corners = self.shape.corners
        return np.array([*corners, *(corners[list(between)].mean(axis=0) for between in self.middles)])

    @cached_property
    def faces(self) -> tuple[tuple[int, ...], ...]:
        """Nodes around each face."""
        first = len(self.shape.corners)
        middle = {frozenset(ends): (first + k,) for k, ends in enumerate(self.shape.edges)} if self.on_edges else {}
        return tuple(
            sum(((a, *middle.get(frozenset((a, b)), ())) for a, b in zip(face, (*face[1:], face[0]), strict=True)), ())
            for face in (*self.shape.triangles, *self.shape.quadrilaterals)
        )

    def nodes_of(self, face: tuple[int, ...]) -> list[int]:
        """Return the nodes on a face given by its corners; the shape functions of all others are zero there."""
        first = len(self.shape.corners)
        return [*face, *(first + k for k, between in enumerate(self.middles) if set(between) <= set(face))]

    @cached_property
    def _coefficients(self) -> np.ndarray:
        return np.linalg.inv(_monomials(self.nodes.T, self.powers))

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return the shape functions at reference points, shape (3, points), as shape (nodes, points)."""
        return self._coefficients.T @ _monomials(points, self.powers).T

    def slopes(self, points: np.ndarray) -> np.ndarray:
        """Return the derivatives of the shape functions by the reference coordinates, shape (nodes, 3, points)."""
        found = np.empty((len(self.powers), 3, points.shape[1]))
        for k in range(3):
            lower = self.powers - np.eye(3, dtype=int)[k]
            found[:, k] = self._coefficients.T @ (self.powers[:, k] * _monomials(points, lower)).T
        return found


def _monomials(points: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """Return x^a y^b z^c at points, shape (3, points), as shape (points, functions).

    At zero, those with a negative exponent are 0: the limit of a pyramid's functions along its axis.
    """
    at = points.T[:, None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        factors = np.where((at == 0) & (powers < 0), 0.0, np.asarray(at, dtype=float) ** powers)
    return factors.prod(axis=2)  # type: ignore[no-any-return]


def _powers(highest: int, keep: Callable[[int, int, int], bool]) -> np.ndarray:
    return np.array([each for each in product(range(highest + 1), repeat=3) if keep(*each)])


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points and weights between 0 and 1."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return (points + 1) / 2, weights / 2


def _simplex(shape: str, order: int) -> tuple[np.ndarray, np.ndarray]:
    with needs("skfem", "flexible"):
        from skfem import quadrature, refdom
    points, weights = quadrature.get_quadrature(getattr(refdom, shape), order)
    return points, weights


def _of_tetrahedron(order: int) -> tuple[np.ndarray, np.ndarray]:
    return _simplex("RefTet", order)


def _of_hexahedron(count: int) -> tuple[np.ndarray, np.ndarray]:
    points, weights = _gauss(count)
    return np.array(list(product(points, repeat=3))).T, np.array(list(product(weights, repeat=3))).prod(axis=1)


def _of_wedge(order: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    (across, areas), (along, lengths) = _simplex("RefTri", order), _gauss(count)
    points = np.vstack([np.tile(across, count), np.repeat(along, across.shape[1])])
    return points, np.outer(lengths, areas).ravel()


def _of_pyramid(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the conical product: sections parallel to the base have an area of 4 z^2."""
    (side, lengths), (along, heights) = np.polynomial.legendre.leggauss(count), roots_jacobi(count, 0, 2)
    height = (along + 1) / 2
    x, y, z = (each.ravel() for each in np.meshgrid(side, side, height, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", lengths, lengths, heights / 8).ravel()
    return np.array([x * z, y * z, z]), weights


def face_rule(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points, two directions at each and weights of a quadrature on a face with corners in reference coordinates.

    Their shapes are (3, points), (3, 2, points) and (points,).
    """
    if len(corners) == 3:
        (x, y), weights = _simplex("RefTri", 4)
        values, slopes = np.array([1 - x - y, x, y]), np.array([[-1, -1], [1, 0], [0, 1]])[:, :, None] + 0 * x
    else:
        at, lengths = _gauss(3)
        x, y = (each.ravel() for each in np.meshgrid(at, at))
        weights = np.outer(lengths, lengths).ravel()
        values = np.array([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
        slopes = np.array([[y - 1, x - 1], [1 - y, -x], [y, x], [-y, 1 - x]])
    return corners.T @ values, np.einsum("na,nkp->akp", corners, slopes), weights


def _tetra(order: int) -> np.ndarray:
    return _powers(order, lambda a, b, c: a + b + c <= order)


def _wedge(order: int) -> np.ndarray:
    return _powers(order, lambda a, b, _: a + b <= order)


ELEMENTS = {
    "tetra": Element(TETRAHEDRON, _tetra(1), lambda: _of_tetrahedron(2)),
    "tetra10": Element(TETRAHEDRON, _tetra(2), lambda: _of_tetrahedron(4), on_edges=True),
    "hexahedron": Element(HEXAHEDRON, _powers(1, lambda *_: True), lambda: _of_hexahedron(2)),
    "hexahedron20": Element(
        HEXAHEDRON, _powers(2, lambda *each: each.count(2) <= 1), lambda: _of_hexahedron(3), on_edges=True
    ),
    "hexahedron27": Element(
        HEXAHEDRON, _powers(2, lambda *_: True), lambda: _of_hexahedron(3), on_edges=True, on_faces=True, inside=True
    ),
    "wedge": Element(WEDGE, _wedge(1), lambda: _of_wedge(2, 2)),
    "wedge15": Element(
        WEDGE, _powers(2, lambda a, b, c: a + b + max(c - 1, 0) <= 2), lambda: _of_wedge(4, 3), on_edges=True
    ),
    "wedge18": Element(WEDGE, _wedge(2), lambda: _of_wedge(4, 3), on_edges=True, on_faces=True),
    "pyramid": Element(
        PYRAMID, np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, -1)]), lambda: _of_pyramid(3)
    ),
}
"""Kinds of solid elements by their names in meshio."""
TOGETHER = (
    {"tetra", "hexahedron", "wedge", "pyramid"}, {"tetra10", "hexahedron20", "wedge15"}, {"tetra10", "hexahedron27", "wedge18"},
)  # fmt: skip
"""Kinds that share the nodes of their common faces."""
