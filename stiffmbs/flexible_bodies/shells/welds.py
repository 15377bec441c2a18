"""Shells and solids of one mesh: rotations of the nodes of solids, and shells that are connected to solids.

The displacements of solids determine no rotation at a node. Its rotation vector follows the mean rotation w of the displacements u of
nodes around it: the antisymmetric part of the affine field that fits these best,

    w = sum b x u / 2,   b = (sum d d^T)^-1 d,   d: places about their mean.

A spring between both takes no force in a rigid motion or a constant strain. It is soft at nodes of solids alone, whose rotation moves
nothing else. Where the edge of a shell is welded to a solid, the spring is stiff. The nodes around are those of all solids at the node, and
all within half of the thickness of the shell. Its bending moment acts on them, as in Abaqus' shell-to-solid coupling. A shell on a face of
a solid follows it by the displacements of all its nodes. Its rotations remain its own, because they contain no shear strain of the solid.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.spatial import KDTree

from ..solid import Solid
from .shell import COMPONENTS, Shell

SOFT = 1e-6
"""Stiffness of the rotation of a node of solids alone, relative to Young's modulus and the cube of the size of an element."""
STIFF = 1e3
"""Stiffness of the rotation of a shell welded to solids, relative to Young's modulus and the cube of the size of the nodes around."""


class Patch(NamedTuple):
    """Nodes around some nodes: their numbers, (m,), those around, (m, k), and the stiffness of the springs, N m, (m,)."""

    nodes: np.ndarray
    around: np.ndarray
    stiffness: np.ndarray


def rotations(solid: Solid, shell: Shell) -> csr_array:
    """Return the stiffness of the springs between the rotations of the nodes of solids and their displacements, (6 n, 6 n)."""
    welded = welded_nodes(solid, shell)
    found = csr_array((COMPONENTS * len(shell.places),) * 2)
    patches = [*_of_elements(solid, shell, welded), *_of_welds(solid, shell, welded)]
    for patch in patches:
        found = found + _springs(patch, shell.places)
    return found


def welded_nodes(solid: Solid, shell: Shell) -> np.ndarray:
    """Return the common nodes of solids and shells, without those of shells on a face of a solid."""
    touched = np.zeros(len(shell.places), dtype=bool)
    for block in solid.blocks:
        touched[block.nodes] = True
    shared = np.unique(shell.triangles[touched[shell.triangles]])
    on_faces = np.zeros(len(shell.places), dtype=bool)
    for corners in np.unique(shell.triangles[touched[shell.triangles].all(axis=1)], axis=0):
        if _elements_with(solid, corners):
            on_faces[corners] = True
    return shared[~on_faces[shared]]


def _elements_with(solid: Solid, nodes: np.ndarray) -> bool:
    """Return True if a solid has all of some nodes."""
    return any((np.isin(block.nodes, nodes).sum(axis=0) == len(nodes)).any() for block in solid.blocks)


def _of_elements(solid: Solid, shell: Shell, welded: np.ndarray) -> list[Patch]:
    """Return soft springs at the nodes of solids that no shell has; around each are the nodes of one element."""
    done = np.zeros(len(shell.places), dtype=bool)
    done[shell.triangles] = True
    done[welded] = True
    found = []
    for block in solid.blocks:
        nodes, first = np.unique(block.nodes.T, return_index=True)
        new = ~done[nodes]
        elements = first[new] // len(block.nodes)
        done[nodes] = True
        around = block.nodes.T[elements]
        found.append(_patch(nodes[new], around, SOFT * block.materials.modulus[elements], shell.places))
    return found


def _of_welds(solid: Solid, shell: Shell, welded: np.ndarray) -> list[Patch]:
    """Return stiff springs at welded nodes."""
    thickness, modulus = np.zeros(len(shell.places)), np.zeros(len(shell.places))
    np.maximum.at(thickness, shell.triangles, np.repeat(shell.thickness[:, None], 3, axis=1))
    for block in solid.blocks:
        np.maximum.at(modulus, block.nodes, np.tile(block.materials.modulus, (len(block.nodes), 1)))
    of_solids = np.flatnonzero(modulus)
    within = KDTree(shell.places[of_solids]).query_ball_point(shell.places[welded], thickness[welded] / 2)
    found = []
    for node, near in zip(welded.tolist(), within, strict=True):
        own = [block.nodes[:, (block.nodes == node).any(axis=0)].ravel() for block in solid.blocks]
        around = np.unique(np.concatenate([of_solids[near], *own]))
        found.append(_patch(np.array([node]), around[None], STIFF * modulus[[node]], shell.places))
    return found


def _patch(nodes: np.ndarray, around: np.ndarray, modulus: np.ndarray, places: np.ndarray) -> Patch:
    apart = places[around] - places[around].mean(axis=1, keepdims=True)
    size = np.sqrt((apart**2).sum(axis=2).mean(axis=1))
    return Patch(nodes, around, modulus * size**3)


def _springs(patch: Patch, places: np.ndarray) -> csr_array:
    """Return the stiffness of springs between rotations and the mean rotations of the nodes around."""
    count, size = len(patch.nodes), COMPONENTS * len(places)
    apart = places[patch.around] - places[patch.around].mean(axis=1, keepdims=True)
    slopes = apart @ np.linalg.inv(apart.swapaxes(1, 2) @ apart)
    x, y, z = np.moveaxis(slopes, 2, 0)
    zero = np.zeros_like(x)
    turned = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3) / 2  # of b x u / 2
    rows = 3 * np.arange(count)[:, None, None, None] + np.arange(3)[:, None] + np.zeros_like(turned, dtype=int)
    columns = COMPONENTS * patch.around[:, :, None, None] + np.arange(3) + np.zeros_like(turned, dtype=int)
    own = COMPONENTS * patch.nodes[:, None] + 3 + np.arange(3)
    values = np.concatenate([np.ones(3 * count), -turned.ravel()])
    at = np.concatenate([np.arange(3 * count), rows.ravel()]), np.concatenate([own.ravel(), columns.ravel()])
    relative = csr_array((values, at), shape=(3 * count, size))
    return csr_array(relative.T @ diags_array(np.repeat(patch.stiffness, 3)) @ relative)


def edges_on_solids(shells: Mapping[str, np.ndarray], solids: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return pairs of elements that are connected: a shell, and a solid that has both ends of one of its edges.

    `shells`, `solids`: nodes of the elements by kinds. Elements are numbered in their order, those of shells and those of solids from 0.
    """
    by_node: dict[int, set[int]] = {}
    first = 0
    for cells in solids.values():
        for number, nodes in enumerate(cells.tolist(), first):
            for node in nodes:
                by_node.setdefault(node, set()).add(number)
        first += len(cells)
    found, first = [], 0
    for cells in shells.values():
        for number, nodes in enumerate(cells.tolist(), first):
            for k, node in enumerate(nodes):
                common = by_node.get(node, set()) & by_node.get(nodes[k - 1], set())
                found += [(number, element) for element in common]
        first += len(cells)
    return np.array(found, dtype=np.int64).reshape(-1, 2)
