"""Size of flat elements relative to the curvature of a shell."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .shell import Shell
from .triangle import axes_of


def coarseness(shell: Shell, cells: Iterable[np.ndarray]) -> float:
    """Return h^2 / (R t), the median over the nodes within a shell, with the side h of elements and the thickness t.

    1 / R^2 is the size of the Gaussian curvature: the angle by which the sum of angles at a node differs from a full turn, for its
    area. It is zero for surfaces that can be unrolled. Bending of such a shell without membrane strains needs elements below 1:
    the sides of flat ones change their lengths by h^2 / (12 R) for a unit of bending. `cells`: nodes of the elements, by kinds.
    """
    corners = shell.places[shell.triangles]
    areas = shell.shares * axes_of(corners)[2] / 3
    angles, size, volume = np.zeros((3, len(shell.places)))
    for k in range(3):
        one, other = (corners[:, end] - corners[:, k] for end in (k - 1, k - 2))
        cosines = np.einsum("ta,ta->t", one, other) / np.sqrt((one**2).sum(axis=1) * (other**2).sum(axis=1))
        node = shell.triangles[:, k]
        np.add.at(angles, node, shell.shares * np.arccos(np.clip(cosines, -1.0, 1.0)))
        np.add.at(size, node, areas)
        np.add.at(volume, node, areas * shell.thickness)
    inside = np.setdiff1d(shell.triangles, _on_edges(cells))
    if not len(inside):
        return 0.0
    turn = np.abs(2 * np.pi - angles[inside])
    return float(np.median(np.sqrt(turn * size[inside]) * size[inside] / volume[inside]))


def _on_edges(cells: Iterable[np.ndarray]) -> np.ndarray:
    """Return the nodes on edges that belong to one element alone."""
    edges = np.sort(np.concatenate([own[:, [k - 1, k]] for own in cells for k in range(own.shape[1])]), axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(found[count == 1])
