"""Stresses at the nodes of a mesh, or on both surfaces of its shells."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from .finite_elements import DISPLACEMENTS, FiniteElements, displacements_of
from .shells.surfaces import TENSOR, Surfaces, surfaces_of
from .solid import Solid


class NodalStresses:
    """Stresses at the nodes of solids: the mean of the elements there, of the stiffest material alone.

    Between materials, the stress jumps. `nodes` of shape (points,): nodes of the points with stresses, here all.
    """

    def __init__(self, solid: Solid, count: int) -> None:
        self._solid, self.nodes = solid, np.arange(count)
        stiffest = np.zeros(count)
        for block in solid.blocks:
            np.maximum.at(stiffest, block.nodes, np.tile(block.materials.modulus, (len(block.nodes), 1)))
        self._gradients = [block.gradients(at_nodes=True)[0] for block in solid.blocks]
        self._counted = [block.materials.modulus == stiffest[block.nodes] for block in solid.blocks]
        self._elements = np.zeros(count)
        for block, counted in zip(solid.blocks, self._counted, strict=True):
            np.add.at(self._elements, block.nodes, counted)

    def stresses(self, displacements: np.ndarray, first_order: np.ndarray | None = None) -> np.ndarray:
        """Return the stresses of displacements, shape (size, k): xx, yy, zz, xy, yz, zx, N/m^2, shape (k, points, 6).

        `first_order`: the parts of first order, of the same shape, whose strains of second order are added; none by default.
        """
        found = np.zeros((displacements.shape[1], len(self.nodes), 6))
        for block, gradients, counted in zip(self._solid.blocks, self._gradients, self._counted, strict=True):
            for number, own in enumerate(found):
                strain = block.displacement_gradient(gradients, displacements[:, number])
                if first_order is not None:
                    slope = block.displacement_gradient(gradients, first_order[:, number])
                    strain = strain + np.einsum("caep,cbep->abep", slope, slope) / 2
                stress = block.stress(strain)
                for k, (a, b) in enumerate(TENSOR):
                    np.add.at(
                        own[:, k], block.nodes, counted * stress[a, b].T
                    )  # (elements, nodes) by (nodes, elements)
        return found / np.maximum(self._elements, 1)[:, None]


class PointsOfBoth:
    """Points with stresses of a mesh with solids and shells: nodes of the solids, and both surfaces of the shells.

    - `nodes` of int, shape (points,): node of each point, not decreasing.
    - `of_solids`, `of_surfaces` of int: point of each node, -1 for those of shells alone, and of each point of the surfaces.
    """

    def __init__(self, solid: Solid, surfaces: Surfaces, count: int) -> None:
        self._solid, self.surfaces = NodalStresses(solid, count), surfaces
        self._inside = np.unique(np.concatenate([block.nodes.ravel() for block in solid.blocks]))
        every = np.concatenate([self._inside, surfaces.nodes])
        self._order = np.argsort(every, kind="stable")
        self.nodes = every[self._order]
        place = np.empty(len(every), dtype=int)
        place[self._order] = np.arange(len(every))
        self.of_solids = np.full(count, -1)
        self.of_solids[self._inside], self.of_surfaces = np.split(place, [len(self._inside)])

    def stresses(self, displacements: np.ndarray, first_order: np.ndarray | None = None) -> np.ndarray:
        """Return the stresses of displacements and rotations, shape (6 n, k), as `NodalStresses.stresses`."""
        second = None if first_order is None else displacements_of(first_order)
        of_solids = self._solid.stresses(displacements_of(displacements), second)[:, self._inside]
        of_shells = self.surfaces.stresses(displacements, first_order)
        return np.concatenate([of_solids, of_shells], axis=1)[:, self._order]

    def displacements(self, of_nodes: np.ndarray) -> np.ndarray:
        """Return the displacements of the points, shape (k, points, 3), by those of the nodes, shape (6 n, k)."""
        of_solids = np.moveaxis(displacements_of(of_nodes).reshape(-1, DISPLACEMENTS, of_nodes.shape[1]), 2, 0)
        both = np.concatenate([of_solids[:, self._inside], self.surfaces.displacements(of_nodes)], axis=1)
        return both[:, self._order]  # type: ignore[no-any-return]

    def arms(self) -> np.ndarray:
        """Return the vectors from the nodes to the points, m, shape (points, 3); zero for those of solids."""
        return np.concatenate([np.zeros((len(self._inside), 3)), self.surfaces.arms])[self._order]  # type: ignore[no-any-return]


StressPoints = NodalStresses | Surfaces | PointsOfBoth


def stress_points(model: FiniteElements) -> StressPoints:
    """Return the points of a model that have stresses: the nodes of solids, and both surfaces of shells at each node.

    Raises InputError if the model has no shape functions.
    """
    if model.shell is not None:
        surfaces = surfaces_of(model.shell)
        return surfaces if model.solid is None else PointsOfBoth(model.solid, surfaces, len(model.nodes))
    if model.solid is None:
        raise InputError("found a body described by matrices, expected a mesh: stresses need its shape functions")
    return NodalStresses(model.solid, len(model.nodes))


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Return the von Mises stress; the last axis of the argument has the six components."""
    return np.linalg.norm(deviatoric(stress), axis=-1)  # type: ignore[no-any-return]


def deviatoric(stress: np.ndarray) -> np.ndarray:
    """Return five components of the stress deviator, on the last axis, whose Euclidean norm is the von Mises stress."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack([zz - (xx + yy) / 2, *(np.sqrt(3) * part for part in ((xx - yy) / 2, xy, yz, zx))], axis=-1)


def principal_stresses(stress: np.ndarray) -> np.ndarray:
    """Return the three principal stresses, the largest first, on the last axis."""
    tensor = np.empty((*stress.shape[:-1], 3, 3))
    for k, (a, b) in enumerate(TENSOR):
        tensor[..., a, b] = tensor[..., b, a] = stress[..., k]
    return np.linalg.eigvalsh(tensor)[..., ::-1]  # type: ignore[no-any-return]
