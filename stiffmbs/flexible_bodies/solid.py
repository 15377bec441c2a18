"""Solid elements of a mesh: gradients of their shape functions, stresses, and initial stress."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import bsr_array, csr_array, eye_array, kron

from ..errors import needs

if TYPE_CHECKING:
    import skfem

LARGEST_PART = 10_000_000
"""Numbers in the element matrices that are computed together; they take 80 MB."""


@dataclass(frozen=True, eq=False)
class Solid:
    """Isoparametric elements of isotropic, linearly elastic materials."""

    mesh: skfem.Mesh
    element: skfem.Element
    order: int  # order of quadrature
    # of int, shape (nodes of an element, elements): nodes of the body in the order of the shape functions
    nodes: np.ndarray
    # of shape (elements,): Young's modulus, N/m^2, and Poisson's ratio
    modulus: np.ndarray
    poisson: np.ndarray

    @cached_property
    def pairs(self) -> NodePairs:
        """Pairs of nodes that share an element."""
        return NodePairs(self.nodes)

    def stiffness(self) -> csr_array:
        """Return the stiffness matrix, shape (3 n, 3 n), N/m.

        Zienkiewicz & Taylor, The finite element method, volume 1, section on the displacement approximation.
        """
        shear, lame = self._constants()
        gradients, weights = self.gradients()
        functions, _, elements, points = gradients.shape
        blocks = self.pairs.zeros((3, 3))
        at_points = gradients.transpose(2, 0, 1, 3).reshape(elements, 3 * functions, points)
        for part in self.pairs.parts(elements):
            products = (at_points[part] * weights[part, None]) @ at_points[part].swapaxes(1, 2)
            products = products.reshape(-1, functions, 3, functions, 3)
            same = np.einsum("enama->enm", products)[..., None, None] * np.eye(3)
            own_shear, own_lame = (x[part].reshape(-1, 1, 1, 1, 1) for x in (shear, lame))
            own = own_lame * products.swapaxes(2, 3) + own_shear * (products.transpose(0, 1, 3, 4, 2) + same)
            self.pairs.add(blocks, part, own)
        return csr_array(bsr_array((blocks, self.pairs.columns, self.pairs.starts)))

    def mass(self, density: np.ndarray) -> csr_array:
        """Return the consistent mass matrix for densities of the elements, kg/m^3, shape (3 n, 3 n), kg."""
        basis = self._basis()
        at_points = np.array([np.asarray(basis.basis[k][0]) for k in range(len(self.nodes))]).transpose(1, 0, 2)
        return csr_array(
            kron(self.pairs.matrix(at_points, (density[:, None] * basis.dx)[:, None] * at_points), eye_array(3))
        )

    def _constants(self) -> tuple[np.ndarray, np.ndarray]:
        """Return Lame's constants mu and lambda of the elements, N/m^2, of shape (elements, 1)."""
        shear = self.modulus / (2 * (1 + self.poisson))
        lame = self.modulus * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
        return shear[:, None], lame[:, None]

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """Return the stress of displacement gradients or symmetric tensors, shape (3, 3, elements, points)."""
        shear, lame = self._constants()
        identity = np.eye(3)[:, :, None, None]
        trace = strain[0, 0] + strain[1, 1] + strain[2, 2]
        return lame * trace * identity + shear * (strain + strain.swapaxes(0, 1))

    def gradients(self, at_nodes: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the gradients of the shape functions, 1/m, and the weights of the points, m^3.

        Their shapes are (nodes of an element, 3, elements, points) and (elements, points). `at_nodes`: take the nodes of
        each element as points instead of those of the quadrature.
        """
        basis = self._basis(at_nodes)
        return np.array([basis.basis[k][0].grad for k in range(len(self.nodes))]), basis.dx

    def _basis(self, at_nodes: bool = False) -> skfem.CellBasis:
        with needs("skfem", "flexible"):
            import skfem
        rule: dict[str, object] = {"intorder": self.order}
        if at_nodes:
            places = self.element.doflocs.T
            rule = {"quadrature": (places, np.ones(places.shape[1]))}
        return skfem.Basis(self.mesh, self.element, **rule)

    def displacement_gradient(self, gradients: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """Return du_a/dx_b of nodal displacements, shape (3 n,), as shape (3, 3, elements, points)."""
        of_nodes = displacement.reshape(-1, 3)[self.nodes]
        return np.einsum("nea,nbep->abep", of_nodes, gradients, optimize=True)

    def second_order_force(self, displacement: np.ndarray) -> np.ndarray:
        """Return the nodal forces of the strain of second order G^T G / 2 of a displacement, shape (3 n,)."""
        at, weights = self.gradients()
        slope = self.displacement_gradient(at, displacement)
        stress = self.stress(np.einsum("caep,cbep->abep", slope, slope) / 2)
        found = np.zeros(len(displacement))
        force = np.einsum("abep,nbep,ep->nea", stress, at, weights, optimize=True)
        np.add.at(found, 3 * self.nodes[:, :, None] + np.arange(3), force)
        return found


class InitialStress:
    """Matrices of initial stress of a body."""

    def __init__(self, solid: Solid) -> None:
        self._solid = solid
        self._gradients, self._weights = solid.gradients()

    def matrix(self, displacement: np.ndarray) -> csr_array:
        """Return the integral of grad N_a . sigma . grad N_b by nodes a, b, with the stress of a displacement.

        The matrix, N/m, has the shape (n, n) and applies to each component of displacements, shape (3 n,). Zienkiewicz &
        Taylor, The finite element method, volume 2, section on geometric stiffness.
        """
        at, nodes = self._gradients, self._solid.nodes
        stress = self._solid.stress(self._solid.displacement_gradient(at, displacement)) * self._weights
        pulled = sum(stress[:, b] * at[:, None, b] for b in range(3))
        left, right = (each.transpose(2, 0, 1, 3).reshape(nodes.shape[1], len(nodes), -1) for each in (at, pulled))
        return self._solid.pairs.matrix(left, right)


class NodePairs:
    """Pairs of nodes that share an element: the entries of the assembled matrices.

    `nodes` of shape (functions, elements): nodes of the shape functions of the elements. `starts`, shape (n + 1,), and
    `columns`, shape (pairs,): second nodes of the pairs, by first nodes (the format CSR).
    """

    def __init__(self, nodes: np.ndarray) -> None:
        count = int(nodes.max()) + 1
        pairs, place = np.unique(nodes.T[:, :, None] * count + nodes.T[:, None, :], return_inverse=True)
        self._count, self._place = count, place.reshape(nodes.shape[1], -1)
        first, self.columns = np.divmod(pairs, count)
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(first, minlength=count))])

    def zeros(self, shape: tuple[int, ...]) -> np.ndarray:
        """Return a block of zeros for each pair."""
        return np.zeros((len(self.columns), *shape))

    def parts(self, elements: int) -> Iterator[slice]:
        """Yield parts of the elements whose matrices fit into memory together."""
        most = max(1, LARGEST_PART // (9 * self._place.shape[1]))
        yield from (slice(start, start + most) for start in range(0, elements, most))

    def add(self, sums: np.ndarray, part: slice, of_elements: np.ndarray) -> None:
        """Add the blocks of some elements, shape (elements, functions, functions, ...), to the sums of their pairs."""
        width = sums[0].size
        entries = width * self._place[part].reshape(-1, 1) + np.arange(width)
        np.add.at(sums.reshape(-1), entries.ravel(), of_elements.ravel())

    def matrix(self, left: np.ndarray, right: np.ndarray) -> csr_array:
        """Return the assembled products left right^T of the elements, each of shape (elements, functions, points)."""
        sums = self.zeros(())
        for part in self.parts(len(left)):
            self.add(sums, part, left[part] @ right[part].swapaxes(1, 2))
        return csr_array((sums, self.columns, self.starts), shape=(self._count, self._count))
