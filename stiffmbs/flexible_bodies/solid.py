"""Solid elements of a mesh: gradients of their shape functions, stresses, and initial stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from ..errors import needs


@dataclass(frozen=True, eq=False)
class Solid:
    """Isoparametric elements of an isotropic, linearly elastic material.

    Attributes
    ----------
    mesh : skfem.Mesh
    element : skfem.Element
    order : int
        Order of quadrature.
    nodes : ndarray of int, shape (nodes of an element, elements)
        Nodes of the body in the order of the shape functions.
    modulus, poisson : float
        Young's modulus, N/m^2, and Poisson's ratio.
    """

    mesh: Any
    element: Any
    order: int
    nodes: np.ndarray
    modulus: float
    poisson: float

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """Return the stress of displacement gradients or symmetric tensors, shape (3, 3, ...)."""
        shear = self.modulus / (2 * (1 + self.poisson))
        lame = self.modulus * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
        identity = np.eye(3).reshape(3, 3, *(1,) * (strain.ndim - 2))
        trace = strain[0, 0] + strain[1, 1] + strain[2, 2]
        return lame * trace * identity + shear * (strain + strain.swapaxes(0, 1))

    def gradients(self, at_nodes: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the gradients of the shape functions and the weights of the points.

        Parameters
        ----------
        at_nodes : bool
            Take the nodes of each element as points instead of those of the quadrature.

        Returns
        -------
        ndarray, shape (nodes of an element, 3, elements, points)
            1/m.
        ndarray, shape (elements, points)
            m^3.
        """
        with needs("skfem", "flexible"):
            import skfem
        rule: dict[str, Any] = {"intorder": self.order}
        if at_nodes:
            places = self.element.doflocs.T
            rule = {"quadrature": (places, np.ones(places.shape[1]))}
        basis = skfem.Basis(self.mesh, self.element, **rule)
        return np.array([basis.basis[k][0].grad for k in range(len(self.nodes))]), basis.dx

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

    def initial_stress(self) -> InitialStress:
        """Return the matrices of initial stress of this body."""
        return InitialStress(self, *self.gradients())


class InitialStress:
    """Matrices of initial stress of a body, with gradients and weights from `Solid.gradients`."""

    def __init__(self, solid: Solid, gradients: np.ndarray, weights: np.ndarray) -> None:
        self._solid, self._gradients, self._weights = solid, gradients, weights

    def matrix(self, displacement: np.ndarray) -> csr_array:
        """Return the integral of grad N_a . sigma . grad N_b by nodes a, b, with the stress of a displacement.

        The matrix applies to each component of displacements. Zienkiewicz & Taylor, The finite element method, volume 2,
        section on geometric stiffness.

        Parameters
        ----------
        displacement : ndarray, shape (3 n,)

        Returns
        -------
        csr_array, shape (n, n)
            N/m.
        """
        at, nodes = self._gradients, self._solid.nodes
        stress = self._solid.stress(self._solid.displacement_gradient(at, displacement)) * self._weights
        pulled = sum(stress[:, b] * at[:, None, b] for b in range(3))
        left, right = (each.transpose(2, 0, 1, 3).reshape(nodes.shape[1], len(nodes), -1) for each in (at, pulled))
        of_elements = left @ right.swapaxes(1, 2)  # (elements, nodes, nodes)
        count = len(displacement) // 3
        rows, columns = (
            np.broadcast_to(each, of_elements.shape).ravel() for each in (nodes.T[:, :, None], nodes.T[:, None, :])
        )
        return csr_array((of_elements.ravel(), (rows, columns)), shape=(count, count))
