"""Solid elements of a mesh: gradients of their shape functions, stresses, and initial stress."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import bsr_array, csr_array, eye_array, kron

from .materials import ElementMaterials
from .shapes import ELEMENTS

LARGEST_PART = 10_000_000
"""Numbers in the element matrices that are computed together; they take 80 MB."""


@dataclass(frozen=True, eq=False)
class Block:
    """Isoparametric elements of one kind."""

    kind: str
    places: np.ndarray  # shape (n, 3): positions of all nodes of the body, m
    nodes: np.ndarray  # of int, shape (nodes of an element, elements)
    materials: ElementMaterials

    def gradients(self, at_nodes: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the gradients of the shape functions, 1/m, and the weights of the points, m^3.

        Their shapes are (nodes of an element, 3, elements, points) and (elements, points). `at_nodes`: take the nodes of
        each element as points instead of those of the quadrature.
        """
        element = ELEMENTS[self.kind]
        points, weights = (element.nodes.T, np.ones(len(element.nodes))) if at_nodes else element.rule()
        slopes = element.slopes(points)
        jacobians = self.jacobians(points)
        at = np.einsum("nbp,epba->naep", slopes, np.linalg.inv(jacobians), optimize=True)
        return at, np.linalg.det(jacobians) * weights

    def jacobians(self, points: np.ndarray) -> np.ndarray:
        """Return the derivatives of positions by reference coordinates, shape (elements, points, 3, 3)."""
        slopes = ELEMENTS[self.kind].slopes(points)
        return np.einsum("nea,nbp->epab", self.places[self.nodes], slopes, optimize=True)

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """Return the stress of displacement gradients or symmetric tensors, shape (3, 3, elements, points)."""
        shear, lame = self.constants()
        trace = strain[0, 0] + strain[1, 1] + strain[2, 2]
        return lame[:, None] * trace * np.eye(3)[:, :, None, None] + shear[:, None] * (strain + strain.swapaxes(0, 1))

    def constants(self) -> tuple[np.ndarray, np.ndarray]:
        """Return Lame's constants mu and lambda of the elements, N/m^2."""
        modulus, poisson, _ = self.materials
        return modulus / (2 * (1 + poisson)), modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))

    def displacement_gradient(self, gradients: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """Return du_a/dx_b of nodal displacements, shape (3 n,), as shape (3, 3, elements, points)."""
        of_nodes = displacement.reshape(-1, 3)[self.nodes]
        return np.einsum("nea,nbep->abep", of_nodes, gradients, optimize=True)


@dataclass(frozen=True, eq=False)
class Solid:
    """Isoparametric elements of isotropic, linearly elastic materials, by kinds of elements."""

    blocks: tuple[Block, ...]

    @cached_property
    def pairs(self) -> NodePairs:
        """Pairs of nodes that share an element."""
        return NodePairs([block.nodes for block in self.blocks], len(self.blocks[0].places))

    def stiffness(self) -> csr_array:
        """Return the stiffness matrix, shape (3 n, 3 n), N/m.

        Zienkiewicz & Taylor, The finite element method, volume 1, section on the displacement approximation.
        """
        sums = self.pairs.zeros((3, 3))
        for number, block in enumerate(self.blocks):
            constants = block.constants()
            gradients, weights = block.gradients()
            functions, _, elements, points = gradients.shape
            at_points = gradients.transpose(2, 0, 1, 3).reshape(elements, 3 * functions, points)
            for part in self.pairs.parts(number):
                shear, lame = (each[part].reshape(-1, 1, 1, 1, 1) for each in constants)
                products = (at_points[part] * weights[part, None]) @ at_points[part].swapaxes(1, 2)
                products = products.reshape(-1, functions, 3, functions, 3)
                same = np.einsum("enama->enm", products)[..., None, None] * np.eye(3)
                own = lame * products.swapaxes(2, 3) + shear * (products.transpose(0, 1, 3, 4, 2) + same)
                self.pairs.add(sums, number, part, own)
        size = 3 * self.pairs.count
        return csr_array(bsr_array((sums, self.pairs.columns, self.pairs.starts), shape=(size, size)))

    def mass(self) -> csr_array:
        """Return the consistent mass matrix, shape (3 n, 3 n), kg."""
        factors = []
        for block in self.blocks:
            points, weights = ELEMENTS[block.kind].rule()
            values = np.broadcast_to(
                ELEMENTS[block.kind].values(points), (block.nodes.shape[1], len(block.nodes), points.shape[1])
            )
            volumes = np.linalg.det(block.jacobians(points)) * weights
            factors.append((values, (block.materials.density[:, None] * volumes)[:, None] * values))
        return csr_array(kron(self.pairs.matrix(factors), eye_array(3)))


class InitialStress:
    """Work of the stress of a body on its strains of second order."""

    def __init__(self, solid: Solid) -> None:
        self._solid = solid
        self._gradients = [block.gradients() for block in solid.blocks]

    def matrix(self, displacement: np.ndarray) -> csr_array:
        """Return the integral of grad N_a . sigma . grad N_b by nodes a, b, with the stress of a displacement.

        The matrix, N/m, has the shape (n, n) and applies to each component of displacements, shape (3 n,). Zienkiewicz &
        Taylor, The finite element method, volume 2, section on geometric stiffness.
        """
        factors = []
        for block, (at, weights) in zip(self._solid.blocks, self._gradients, strict=True):
            stress = block.stress(block.displacement_gradient(at, displacement)) * weights
            pulled = sum(stress[:, b] * at[:, None, b] for b in range(3))
            rows = (
                (each.transpose(2, 0, 1, 3).reshape(block.nodes.shape[1], len(block.nodes), -1))
                for each in (at, pulled)
            )
            factors.append(tuple(rows))
        return self._solid.pairs.matrix(factors)

    def works(self, displacements: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """Return the work of the stress of displacements, shape (3 n, k), on strains of second order, shape (k, m, m).

        These are twice the coefficients of products of the coordinates of modes, shape (3 n, m).
        """
        m, found = modes.shape[1], []
        for displacement in displacements.T:
            by_nodes = self.matrix(displacement)
            found.append(modes.T @ (by_nodes @ modes.reshape(-1, 3 * m)).reshape(-1, m))
        return np.array(found).reshape(-1, m, m)

    def second_order_force(self, displacement: np.ndarray) -> np.ndarray:
        """Return the nodal forces of the strain of second order G^T G / 2 of a displacement, shape (3 n,)."""
        found = np.zeros(len(displacement))
        for block, (at, weights) in zip(self._solid.blocks, self._gradients, strict=True):
            slope = block.displacement_gradient(at, displacement)
            stress = block.stress(np.einsum("caep,cbep->abep", slope, slope) / 2)
            force = np.einsum("abep,nbep,ep->nea", stress, at, weights, optimize=True)
            np.add.at(found, 3 * block.nodes[:, :, None] + np.arange(3), force)
        return found


class NodePairs:
    """Pairs of nodes that share an element: the entries of the assembled matrices.

    `nodes`: nodes of the elements of each block, shape (nodes of an element, elements). `count`: number n of the nodes of the body,
    some of which may have no element. `starts`, shape (n + 1,), and `columns`, shape (pairs,): second nodes of the pairs, by first nodes (the format CSR).
    """

    def __init__(self, nodes: Sequence[np.ndarray], count: int) -> None:
        self.count = count
        every = [(each.T[:, :, None] * self.count + each.T[:, None, :]).reshape(each.shape[1], -1) for each in nodes]
        pairs, place = np.unique(np.concatenate([each.ravel() for each in every]), return_inverse=True)
        ends = np.cumsum([each.size for each in every])[:-1]
        self._places = [part.reshape(own.shape) for part, own in zip(np.split(place.ravel(), ends), every, strict=True)]
        first, self.columns = np.divmod(pairs, self.count)
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(first, minlength=self.count))])

    def zeros(self, shape: tuple[int, ...]) -> np.ndarray:
        """Return a block of zeros for each pair."""
        return np.zeros((len(self.columns), *shape))

    def parts(self, block: int) -> Iterator[slice]:
        """Yield parts of the elements of a block whose matrices fit into memory together."""
        elements, pairs = self._places[block].shape
        most = max(1, LARGEST_PART // (9 * pairs))
        yield from (slice(start, start + most) for start in range(0, elements, most))

    def add(self, sums: np.ndarray, block: int, part: slice, of_elements: np.ndarray) -> None:
        """Add the blocks of some elements, shape (elements, functions, functions, ...), to the sums of their pairs."""
        width = sums[0].size
        entries = width * self._places[block][part].reshape(-1, 1) + np.arange(width)
        np.add.at(sums.reshape(-1), entries.ravel(), of_elements.ravel())

    def matrix(self, factors: Sequence[tuple[np.ndarray, ...]]) -> csr_array:
        """Return the assembled products left right^T of each block's elements, both of shape (elements, functions, points)."""
        sums = self.zeros(())
        for block, (left, right) in enumerate(factors):
            for part in self.parts(block):
                self.add(sums, block, part, left[part] @ right[part].swapaxes(1, 2))
        return csr_array((sums, self.columns, self.starts), shape=(self.count, self.count))
