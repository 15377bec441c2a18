"""Finite element model of a free body: node positions, stiffness and mass matrix."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from ..errors import InputError
from .shells.shell import DIVISION, Shell
from .solid import Solid

DISPLACEMENTS: Final = 3
"""Displacements of a node."""
SYMMETRY = 1e-8
"""Tolerance of symmetry, relative to the largest entry."""
PRECISION = 1e-6
"""Relative precision of the data of a model. Places of nodes refer to the size of the body, or of a line of them. A mass
along x, y and z refers to the largest entry, and the force of a rigid displacement to the force of moving each node by itself."""


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Free elastic body in SI units: displacements x, y, z of node 0, in shells then its rotations; then those of node 1."""

    nodes: np.ndarray  # shape (n, 3): positions, m
    # stiffness, mass: shape (components n, components n): N/m and kg; with N m/rad and kg m^2 for rotations
    stiffness: csr_array
    mass: csr_array
    groups: Mapping[str, np.ndarray] = field(default_factory=dict)  # of int: named sets of nodes, numbered from 0
    # of int: nodes of the elements by type, in the names and order of meshio, for pictures; may be empty
    cells: Mapping[str, np.ndarray] = field(default_factory=dict)
    solid: Solid | None = None  # shape functions and material, for stresses and geometric stiffening
    # of int, shape (n,), optional: increasing numbers by which the file names the nodes; from 0 without them
    numbers: np.ndarray | None = None
    parts: str = ""  # names of parts of one material to which the file may give several
    unused: str = ""  # names of statements and elements of the file that are not used
    components: int = DISPLACEMENTS  # of a node: three displacements, or six with its rotation vector
    shell: Shell | None = None  # elements of shells: inertia of rotations

    @property
    def solid_cells(self) -> dict[str, np.ndarray]:
        """Nodes of the solids by kinds of elements."""
        return {kind: own for kind, own in self.cells.items() if kind not in DIVISION or self.shell is None}

    @property
    def shell_cells(self) -> dict[str, np.ndarray]:
        """Nodes of the shells by kinds of elements."""
        return {kind: own for kind, own in self.cells.items() if kind in DIVISION and self.shell is not None}

    def turns(self, nodes: np.ndarray) -> bool:
        """Return True if one of some nodes belongs to a shell, so that its rotation can be held."""
        return self.shell is not None and bool(np.isin(nodes, self.shell.triangles).any())

    @property
    def has_stresses(self) -> bool:
        """True if its elements are known, and with them stresses."""
        return self.solid is not None or self.shell is not None

    @property
    def size(self) -> int:
        """Number of the components of all nodes."""
        return self.components * len(self.nodes)

    def entries(self, nodes: np.ndarray) -> np.ndarray:
        """Return the places of all components of nodes among those of the body."""
        return (self.components * nodes[:, None] + np.arange(self.components)).ravel()

    def displacements(self, nodes: np.ndarray) -> np.ndarray:
        """Return the places of the displacements of nodes among the components of the body."""
        return (self.components * nodes[:, None] + np.arange(DISPLACEMENTS)).ravel()

    def rigid_modes(self, about: np.ndarray) -> np.ndarray:
        """Return the components of all nodes by unit translations and rotations about a point, shape (size, 6)."""
        return rigid_motions(self.nodes - about, self.components)

    def inertial_forces(self, uniform: np.ndarray, gradient: np.ndarray, about: np.ndarray) -> np.ndarray:
        """Return the products of the mass with fields of acceleration that are linear in space, shape (size, k).

        `uniform`, shape (3, k): accelerations at the point `about`. `gradient`, shape (3, 3, k): by components and axes.
        """
        count, k = len(self.nodes), uniform.shape[1]
        field = np.zeros((count, self.components, k))
        field[:, :DISPLACEMENTS] = uniform + np.einsum("abk,nb->nak", gradient, self.nodes - about)
        found = self.mass @ field.reshape(-1, k)
        if self.shell is not None:  # points next to the middle surface
            directors = self.shell.directors
            of_points = np.einsum("abk,nb->nak", gradient, directors.places).reshape(len(directors.places), -1)
            found += directors.turned.T @ (directors.moments @ of_points).reshape(-1, k)
        return found  # type: ignore[no-any-return]

    def check(self) -> None:
        """Refuse matrices that do not describe one free elastic body. Raises InputError."""
        size = self.size
        for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass)):
            if matrix.shape != (size, size):
                raise InputError(
                    f"{name}: found {matrix.shape[0]} x {matrix.shape[1]} entries for {len(self.nodes)} nodes, "
                    f"expected {size} x {size}: {self.components} components per node"
                )
            if not np.isfinite(matrix.data).all():
                raise InputError(f"{name}: found an entry that is not finite, expected numbers")
            largest = np.abs(matrix.data).max(initial=0.0)
            if largest == 0:
                raise InputError(f"{name}: found only zeros, expected the matrix of an elastic body")
            asymmetry = np.abs((matrix - matrix.T).data).max(initial=0.0)
            if asymmetry > SYMMETRY * largest:
                raise InputError(
                    f"{name}: found entries that differ from those across the diagonal by {asymmetry / largest:.2g} "
                    "of the largest entry, expected a symmetric matrix"
                )
        if not np.isfinite(self.nodes).all():
            raise InputError("nodes: found a position that is not finite, expected numbers")
        self._check_parts()
        self._check_diagonals()
        self._check_mass()
        self._check_rigid_modes()

    def _check_parts(self) -> None:
        joined = self.stiffness.tocoo()
        between = joined.row // self.components, joined.col // self.components
        pairs = csr_array((np.ones(joined.nnz), between), shape=(len(self.nodes),) * 2)
        count, part = connected_components(pairs, directed=False)
        if count > 1:
            smallest = np.bincount(part).argmin()
            loose = np.flatnonzero(part == smallest)
            raise InputError(
                f"nodes: found {count} parts that are not connected, the smallest with {len(loose)} of "
                f"{len(self.nodes)} nodes (node {loose[0]}), expected one connected body"
            )

    def _check_diagonals(self) -> None:
        for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass)):
            diagonal = matrix.diagonal()
            if diagonal.min() < 0 or (name == "stiffness" and diagonal.min() == 0):
                worst = int(diagonal.argmin())
                raise InputError(
                    f"{name}: found {diagonal[worst]:.3g} on the diagonal at node {worst // self.components}, "
                    "expected positive numbers; are its elements inverted?"
                )

    def _check_mass(self) -> None:
        """Refuse a mass matrix that is not the same along x, y and z: of beams, shells, or reduced to fewer nodes."""
        of_displacements = self.displacements(np.arange(len(self.nodes)))
        mass = self.mass[of_displacements][:, of_displacements]
        largest = np.abs(mass.data).max()
        along_x = mass[::3, ::3]
        for a in range(3):
            for b in range(3):
                block = mass[a::3, b::3]
                off = np.abs((block - along_x if a == b else block).data).max(initial=0.0)
                if off > PRECISION * largest:
                    raise InputError(
                        f"mass: found entries of {off / largest:.2g} of the largest that depend on the direction "
                        f"({'xyz'[a]}, {'xyz'[b]}), expected the mass matrix of solid elements, not reduced"
                    )

    def _check_rigid_modes(self) -> None:
        centre = self.nodes.mean(axis=0)
        size = np.abs(self.nodes - centre).max()
        if size == 0:
            raise InputError("nodes: found all nodes at one point, expected a body")
        # rotations are multiplied by the size, so that all forces and stiffnesses are those of displacements
        scale = np.tile(np.repeat([1.0, 1 / size], DISPLACEMENTS)[: self.components], len(self.nodes))
        rigid = self.rigid_modes(centre)
        rigid[:, 3:] /= size
        stiffest = np.abs(scale**2 * self.stiffness.diagonal()).max()
        force = np.abs(scale[:, None] * (self.stiffness @ rigid)).max(axis=0) / stiffest
        if force.max() > PRECISION:
            motions = [f"{motion} {axis}" for motion in ("translation along", "rotation about") for axis in "xyz"]
            raise InputError(
                f"stiffness: found a force of {force.max():.2g} of the largest stiffness under a rigid "
                f"{motions[int(force.argmax())]}, expected none: the matrix must belong to the free body without "
                "supports"
            )


def displacements_of(of_nodes: np.ndarray) -> np.ndarray:
    """Return the displacements of nodes from their six components, shapes (3 n, ...) and (6 n, ...)."""
    count, rest = len(of_nodes) // (2 * DISPLACEMENTS), of_nodes.shape[1:]
    return of_nodes.reshape(count, 2 * DISPLACEMENTS, *rest)[:, :DISPLACEMENTS].reshape(DISPLACEMENTS * count, *rest)


def rigid_motions(points: np.ndarray, components: int) -> np.ndarray:
    """Return displacements of points, and with six components their rotations, by unit rigid motions about the origin.

    The shape is (components n, 6): translations, then rotations.
    """
    found = np.zeros((len(points), components, 6))
    found[:, :DISPLACEMENTS] = rigid_displacements(points).reshape(-1, DISPLACEMENTS, 6)
    found[:, DISPLACEMENTS:, DISPLACEMENTS:] = np.eye(3)[: components - DISPLACEMENTS]
    return found.reshape(-1, 6)


def rigid_displacements(points: np.ndarray) -> np.ndarray:
    """Return displacements of points by unit translations, then rotations about the origin, shape (3 n, 6)."""
    count = len(points)
    found = np.zeros((count, 3, 6))
    found[:, :, :3] = np.eye(3)
    x, y, z = points.T
    found[:, 0, 4], found[:, 0, 5] = z, -y
    found[:, 1, 3], found[:, 1, 5] = -z, x
    found[:, 2, 3], found[:, 2, 4] = y, -x
    return found.reshape(3 * count, 6)
