"""Stresses at the nodes of a mesh."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from .finite_elements import FiniteElements

PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Entries of the stress tensor: xx, yy, zz, xy, yz, zx."""


def nodal_stresses(model: FiniteElements, displacements: np.ndarray) -> np.ndarray:
    """Return the stresses of displacements at the nodes: the mean of the elements there, of the stiffest material alone.

    Between materials, the stress jumps. `displacements` of shape (3 n, k). The result of shape (k, n, 6): xx, yy, zz, xy, yz, zx, N/m^2. Raises InputError
    if the model has no shape functions.
    """
    solid = model.solid
    if model.shell is not None:
        raise InputError("found a body of shells, expected a mesh of solids: stresses of shells are not computed")
    if solid is None:
        raise InputError("found a body described by matrices, expected a mesh: stresses need its shape functions")
    stiffest = np.zeros(len(model.nodes))
    for block in solid.blocks:
        np.maximum.at(stiffest, block.nodes, np.tile(block.materials.modulus, (len(block.nodes), 1)))
    found, count = np.zeros((displacements.shape[1], len(model.nodes), 6)), np.zeros(len(model.nodes))
    for block in solid.blocks:
        gradients, _ = block.gradients(at_nodes=True)
        counted = block.materials.modulus == stiffest[block.nodes]
        np.add.at(count, block.nodes, counted)
        for own, displacement in zip(found, displacements.T, strict=True):
            stress = block.stress(block.displacement_gradient(gradients, displacement))
            for k, (a, b) in enumerate(PLACES):
                np.add.at(own[:, k], block.nodes, counted * stress[a, b].T)  # (elements, nodes) by (nodes, elements)
    found /= count[:, None]
    return found


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
    for k, (a, b) in enumerate(PLACES):
        tensor[..., a, b] = tensor[..., b, a] = stress[..., k]
    return np.linalg.eigvalsh(tensor)[..., ::-1]  # type: ignore[no-any-return]
