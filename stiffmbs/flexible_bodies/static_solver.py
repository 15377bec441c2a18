"""Static solutions of a finite element model with prescribed interface coordinates."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import coo_array, csc_array, csr_array

from ..errors import InputError
from .cholesky import Cholesky
from .finite_elements import DISPLACEMENTS, FiniteElements
from .interfaces import AVERAGE, Interface

LOGGER = logging.getLogger(__name__)
DENSE = 400
"""Unknowns up to which eigenvalues are computed by a dense method."""
BLOCK = 8
"""Right-hand sides of a static solution in Lanczos' method: the factors are read once for all of them."""
CONVERGED = 1e-13
"""Residual of a normal mode, relative to its compliance, at which Lanczos' method ends."""
DEPENDENT = 1e-15
"""Square of a size, relative to the largest, below which a combination of shapes is zero apart from rounding."""


class StaticSolver:
    """Factors of the stiffness matrix with interfaces held.

    Nodes of rigid and point interfaces are prescribed. Coordinates of average interfaces, and of points whose nodes have
    rotations, are prescribed by equations W u = g of the free displacements u, with multipliers mu:

        K u + W^T mu = f,  K = K_s - E s E^T

    The springs s at three nodes, the columns of E, hold the body that average interfaces alone do not, so that K_s is
    positive definite. Their forces r = s E^T u are further unknowns of the small system for mu and r.

    `supports` of shape (size, k): further functionals of the displacement that are held, those of a body that its
    interfaces do not hold. Raises InputError if the stiffness matrix is not positive definite with the interfaces held.
    """

    def __init__(self, model: FiniteElements, interfaces: Sequence[Interface], supports: np.ndarray) -> None:
        LOGGER.info("factoring the stiffness matrix of %d nodes", len(model.nodes))
        self._model, self._interfaces = model, interfaces
        held = [interface.nodes for interface in interfaces if self._holds_nodes(interface)]
        inner = np.setdiff1d(np.arange(len(model.nodes)), np.concatenate([np.empty(0, dtype=np.int64), *held]))
        self.free = model.entries(inner)
        self._functionals = self._held_functionals(supports)
        stiffness = csc_array(model.stiffness[self.free][:, self.free])
        points, springs = model.nodes[inner], np.empty(0, dtype=np.int64)
        if len(self._functionals):
            springs = model.displacements(_apart(points))
            spring = stiffness.diagonal()[model.displacements(np.arange(len(inner)))].max()
            at = (np.full(len(springs), spring), (springs, springs))
            stiffness = csc_array(stiffness + coo_array(at, shape=stiffness.shape))
        try:
            self._factors = Cholesky(stiffness, points)
            if len(self._functionals):
                self._take_border(springs, spring)
        except np.linalg.LinAlgError:
            raise InputError(
                "stiffness: found a matrix that is not positive definite with the interfaces held, expected the stiffness matrix of an "
                "elastic body"
            ) from None

    def _holds_nodes(self, interface: Interface) -> bool:
        """Return True if an interface prescribes all components of its nodes."""
        turned = interface.turns_nodes or self._model.components == DISPLACEMENTS
        return interface.kind != AVERAGE and turned

    def _held_functionals(self, supports: np.ndarray) -> np.ndarray:
        """Return the rows W of average interfaces, then those of the supports, by free displacements."""
        rows = [np.empty((0, self._model.size))]
        for interface in self._interfaces:
            if not self._holds_nodes(interface):
                rows.append(np.zeros((interface.size, rows[0].shape[1])))
                rows[-1][:, interface.entries(self._model)] = interface.mean(self._model)
        return np.vstack([*rows, supports.T])[:, self.free]

    def _take_border(self, springs: np.ndarray, spring: float) -> None:
        """Factor the small system for the multipliers and the forces of the springs."""
        rows = np.vstack([self._functionals, np.zeros((len(springs), len(self.free)))])
        rows[len(self._functionals) + np.arange(len(springs)), springs] = -1.0
        self._border, self._by_border = rows, self._factors.solve(rows.T)
        flexibility = rows @ self._by_border
        own = np.arange(len(self._functionals), len(rows))
        flexibility[own, own] -= 1.0 / spring
        self._inverse = np.linalg.inv(flexibility)

    def _solve(self, force: np.ndarray, prescribed: np.ndarray | None = None) -> np.ndarray:
        """Return free displacements under forces, shape (free,) or (free, k), with values of the functionals or zero."""
        found = self._factors.solve(force)
        if not len(self._functionals):
            return found
        gap = self._border @ found
        if prescribed is not None:
            gap[: len(self._functionals)] -= prescribed
        return found - self._by_border @ (self._inverse @ gap)  # type: ignore[no-any-return]

    def held_response(self, force: np.ndarray) -> np.ndarray:
        """Return the displacements of all nodes under forces with the interfaces held, both (size,) or (size, k)."""
        found = np.zeros_like(force)
        found[self.free] = self._solve(force[self.free])
        return found

    def static_modes(self) -> np.ndarray:
        """Return displacements of all nodes by unit interface coordinates, shape (size, interface coordinates)."""
        total = sum(interface.size for interface in self._interfaces)
        found, prescribed = np.zeros((self._model.size, total)), np.zeros((len(self._functionals), total))
        column = row = 0
        for interface in self._interfaces:
            columns = slice(column, column + interface.size)
            if not self._holds_nodes(interface):
                prescribed[row : row + interface.size, columns] = np.eye(interface.size)
                row += interface.size
            else:
                found[interface.entries(self._model), columns] = interface.rigid(self._model)
            column += interface.size
        found[self.free] = self._solve(-(self._model.stiffness @ found)[self.free], prescribed)
        return found

    def normal_modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest normal modes with all interfaces held.

        These are the squares of their angular frequencies, 1/s^2, in increasing order, shape (count,), and displacements
        with unit modal mass, kg, shape (size, count). Raises InputError if the model has fewer modes.
        """
        n, mass = len(self.free), self._model.mass[self.free][:, self.free]
        most = n - len(self._functionals) - self._massless(mass)
        if count > most:
            raise InputError(
                f"modes: found {count}, expected {most} or fewer: the model has no more with its interfaces held"
            )
        found = np.zeros((self._model.size, count))
        if count == 0:
            return np.empty(0), found
        LOGGER.info("computing %d normal modes", count)
        if n <= max(DENSE, 3 * count):
            squares, shapes = _dense_modes(self._solve(mass.toarray()), mass, count)
        else:
            squares, shapes = _lanczos_modes(self._solve, mass, count)
        found[self.free] = shapes
        return squares, found

    def _massless(self, mass: csr_array) -> int:
        """Return the largest number of rotations without mass: one at each node of a shell, all of a node of solids alone."""
        if self._model.components == DISPLACEMENTS:
            return 0
        nodes, zeros = self.free // self._model.components, mass.diagonal() == 0
        alone = np.bincount(nodes[zeros], minlength=len(self._model.nodes))
        return int(np.maximum(alone, np.bincount(nodes, minlength=len(alone)) > 0).sum())


def _apart(points: np.ndarray) -> np.ndarray:
    """Return three points, by number, that are far from one line."""
    first = int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    away = points - points[first]
    second = int(np.argmax(np.linalg.norm(away, axis=1)))
    third = int(np.argmax(np.linalg.norm(np.cross(away, away[second]), axis=1)))
    return np.array([first, second, third])


def _dense_modes(by_mass: np.ndarray, mass: csr_array, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest modes from the static displacements by the columns of the mass matrix, for small models.

    Rotations of shells about their normals have no mass: they follow the motion of all others.
    """
    work = mass @ by_mass
    work = (work + work.T) / 2
    values, moving = eigh(mass.toarray())
    massive = values > DEPENDENT * values[-1]
    if massive.all():
        compliances, shapes = eigh(work, mass.toarray())
    else:
        moving = moving[:, massive] / np.sqrt(values[massive])
        compliances, shapes = eigh(moving.T @ work @ moving)
    highest = np.argsort(compliances)[::-1][:count]
    compliances, shapes = compliances[highest], shapes[:, highest]
    return 1.0 / compliances, shapes if massive.all() else by_mass @ (moving @ shapes) / compliances


def _lanczos_modes(
    solve: Callable[[np.ndarray], np.ndarray], mass: csr_array, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest modes by block Lanczos iterations with static solutions and full orthogonalisation.

    R. G. Grimes, J. G. Lewis, H. D. Simon, SIAM J. Matrix Anal. Appl. 15 (1994) 228-272.
    """
    random = np.random.default_rng(0)
    block = basis = np.empty((mass.shape[0], 0))
    projected = np.empty((0, 0))
    while True:
        while not block.shape[1]:  # at the start, and where static solutions of the modes so far are among these
            block = solve(mass @ random.standard_normal((mass.shape[0], BLOCK)))
            block -= basis @ (basis.T @ (mass @ block))
            block, _ = _orthonormal(block, mass)
        basis = np.column_stack([basis, block])
        following = solve(mass @ block)
        column = np.zeros((basis.shape[1], block.shape[1]))
        for _ in range(2):  # rounding leaves a part after the first time
            part = basis.T @ (mass @ following)
            following -= basis @ part
            column += part
        known = len(projected)
        projected = np.block([[projected, column[:known]], [column[:known].T, column[known:]]])
        compliances, vectors = eigh((projected + projected.T) / 2)
        block, sizes = _orthonormal(following, mass)
        residuals = np.linalg.norm(sizes @ vectors[known:, -count:], axis=0)
        if len(compliances) >= count and (residuals <= CONVERGED * compliances[-count:]).all():
            highest = slice(None, -count - 1, -1)
            return 1.0 / compliances[highest], basis @ vectors[:, highest]


def _orthonormal(shapes: np.ndarray, mass: csr_array) -> tuple[np.ndarray, np.ndarray]:
    """Return independent shapes of unit modal mass, and the factors R of the given ones, shapes = found @ R."""
    found, factors = shapes, np.eye(shapes.shape[1])
    for _ in range(2):  # rounding leaves a part after the first time
        values, vectors = eigh(found.T @ (mass @ found))
        vectors = vectors[:, values > DEPENDENT * values[-1]]
        sizes = np.sqrt(values[-vectors.shape[1] :])
        found, factors = found @ (vectors / sizes), sizes[:, None] * vectors.T @ factors
    return found, factors
