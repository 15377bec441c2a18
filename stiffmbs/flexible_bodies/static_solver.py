"""Static solutions of a finite element model with prescribed interface coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import block_array, csc_array, csr_array, eye_array, hstack
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from ..errors import InputError
from .finite_elements import FiniteElements
from .interfaces import AVERAGE, Interface

DENSE = 400
"""Unknowns up to which eigenvalues are computed by a dense method."""


class StaticSolver:
    """Factors of the stiffness matrix with interfaces held.

    Displacements are u = T z. The coordinates of rigid and point interfaces replace the displacements of their nodes.
    Those of average interfaces are prescribed by constraints W z = q with multipliers. `supports` of shape (3 n, k):
    further functionals of the displacement that are held: those of a body that its interfaces do not hold. Raises
    InputError if the stiffness matrix is singular with the interfaces held.
    """

    def __init__(self, model: FiniteElements, interfaces: Sequence[Interface], supports: np.ndarray) -> None:
        self._interfaces = interfaces
        exact = [interface for interface in interfaces if interface.kind != AVERAGE]
        size = 3 * len(model.nodes)
        held = np.concatenate([np.empty(0, dtype=np.int64), *(interface.entries for interface in exact)])
        self.free = np.setdiff1d(np.arange(size), held)
        parts = [eye_array(size, format="csc")[:, self.free]]
        for interface in exact:
            rigid = interface.rigid(model)
            rows, columns = np.nonzero(rigid)
            parts.append(
                csc_array((rigid[rows, columns], (interface.entries[rows], columns)), shape=(size, interface.size))
            )
        self.shapes = csc_array(hstack(parts))
        self.stiffness = csc_array(self.shapes.T @ model.stiffness @ self.shapes)
        self.mass = csc_array(self.shapes.T @ model.mass @ self.shapes)
        self._n = len(self.free)
        self._functionals = self._held_functionals(model, supports)
        inner = self.stiffness[: self._n, : self._n]
        scale = np.abs(inner.diagonal()).max()
        self._scale = scale
        if len(self._functionals):
            rows = csr_array(scale * self._functionals)
            inner = csc_array(block_array([[inner, rows.T], [rows, None]]))
        options = {} if len(self._functionals) else {"SymmetricMode": True}
        try:
            self._factors = splu(
                inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01 if not options else 0.0, options=options
            )
        except RuntimeError:
            raise InputError(
                "stiffness: found a singular matrix with the interfaces held, expected the stiffness matrix of an elastic body"
            ) from None

    def _held_functionals(self, model: FiniteElements, supports: np.ndarray) -> np.ndarray:
        """Return the rows of average interfaces, then the supports, by free displacements."""
        rows = []
        for interface in self._interfaces:
            if interface.kind == AVERAGE:
                full = np.zeros((interface.size, self.shapes.shape[0]))
                full[:, interface.entries] = interface.mean(model)
                rows.append(full[:, self.free])
        return np.vstack([*rows, supports.T @ self.shapes[:, : self._n]])

    def _solve(self, force: np.ndarray, prescribed: np.ndarray) -> np.ndarray:
        """Return free displacements under forces, with prescribed values of the functionals."""
        return self._factors.solve(np.concatenate([force, self._scale * prescribed]))[: self._n]

    def held_response(self, force: np.ndarray) -> np.ndarray:
        """Return the displacements of all nodes under forces, with the interfaces held, shape (3 n,)."""
        own = self._solve((self.shapes.T @ force)[: self._n], np.zeros(len(self._functionals)))
        return self.shapes[:, : self._n] @ own  # type: ignore[no-any-return]

    def static_modes(self) -> np.ndarray:
        """Return displacements of all nodes by unit interface coordinates, shape (3 n, interface coordinates)."""
        columns, exact, functional = [], self._n, 0
        for interface in self._interfaces:
            for k in range(interface.size):
                prescribed = np.zeros(len(self._functionals))
                master = np.zeros(self.stiffness.shape[0] - self._n)
                force = np.zeros(self._n)
                if interface.kind == AVERAGE:
                    prescribed[functional + k] = 1.0
                else:
                    master[exact + k - self._n] = 1.0
                    force = -self.stiffness[: self._n, [exact + k]].toarray()[:, 0]
                columns.append(self.shapes @ np.concatenate([self._solve(force, prescribed), master]))
            if interface.kind == AVERAGE:
                functional += interface.size
            else:
                exact += interface.size
        return np.array(columns).reshape(len(columns), self.shapes.shape[0]).T

    def normal_modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest normal modes with all interfaces held.

        Returns
        -------
        ndarray, shape (count,)
            Squares of the angular frequencies, 1/s^2, in increasing order.
        ndarray, shape (3 n, count)
            Displacements with unit modal mass, kg.

        Raises
        ------
        InputError
            If the model has fewer modes.
        """
        most = self._n - len(self._functionals)
        if count > most:
            raise InputError(
                f"modes: found {count}, expected {most} or fewer: the model has no more with its interfaces held"
            )
        if count == 0:
            return np.empty(0), np.empty((self.shapes.shape[0], 0))
        n, none = self._n, np.zeros(len(self._functionals))
        mass = csr_array(self.mass[:n, :n])

        def compliance(force: np.ndarray) -> np.ndarray:
            return self._solve(np.asarray(force).ravel(), none)

        if count > n - 2 or n <= DENSE:
            squares, shapes = _dense_modes(np.column_stack([compliance(row) for row in mass.toarray()]), mass, count)
        else:
            inverse = LinearOperator((n, n), matvec=compliance, dtype=float)
            start = compliance(mass @ np.random.default_rng(0).standard_normal(n))
            stiffness = self.stiffness[:n, :n]
            squares, shapes = eigsh(stiffness, count, mass, sigma=0.0, OPinv=inverse, v0=start, tol=1e-13)
            order = np.argsort(squares)
            squares, shapes = squares[order], shapes[:, order]
        return squares, self.shapes[:, :n] @ shapes


def _dense_modes(flexibility: np.ndarray, mass: csr_array, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest modes from the compliance times the mass matrix, for small models."""
    from scipy.linalg import eigh

    by_mass = mass @ flexibility
    compliances, shapes = eigh((by_mass + by_mass.T) / 2, mass.toarray())
    highest = np.argsort(compliances)[::-1][:count]
    return 1.0 / compliances[highest], shapes[:, highest]
