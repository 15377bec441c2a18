"""Solid elements of a mesh: gradients of their shape functions, stresses, and forces of second order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

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

    def second_order_forces(self, shapes: np.ndarray) -> np.ndarray:
        """Return the second derivatives of the nodal forces by the amplitudes of pairs of displacements.

        The strain is that of Green, E = sym G + G^T G / 2, with a linear elastic law (Saint Venant, Kirchhoff). Wu & Tiso,
        Nonlinear model order reduction for flexible multibody dynamics, Multibody System Dynamics 36 (2016), section 3.

        Parameters
        ----------
        shapes : ndarray, shape (3 n, p)

        Returns
        -------
        ndarray, shape (p, p, 3 n)
        """
        at, weights = self.gradients()
        slopes = [self.displacement_gradient(at, shape) for shape in shapes.T]
        stresses = [self.stress(slope) for slope in slopes]
        found = np.zeros((len(slopes), len(slopes), len(shapes)))
        entries = 3 * self.nodes[:, :, None] + np.arange(3)
        for i, (G, of_G) in enumerate(zip(slopes, stresses, strict=True)):
            for j in range(i + 1):
                H, of_H = slopes[j], stresses[j]
                nominal = (
                    self.stress(_product(G, H, "cae,cbe->abe"))
                    + _product(H, of_G, "ace,cbe->abe")
                    + _product(G, of_H, "ace,cbe->abe")
                )
                force = np.einsum("abep,nbep,ep->nea", nominal, at, weights, optimize=True)
                np.add.at(found[i, j], entries, force)
                found[j, i] = found[i, j]
        return found


def _product(A: np.ndarray, B: np.ndarray, indices: str) -> np.ndarray:
    flat = np.einsum(indices, A.reshape(3, 3, -1), B.reshape(3, 3, -1))
    return flat.reshape(A.shape)
