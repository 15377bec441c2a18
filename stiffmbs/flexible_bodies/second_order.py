"""Displacements of second order in the modal coordinates, which contain geometric stiffening.

The displacement is u = sum psi_k q_k + 1/2 sum theta_kl q_k q_l. The static modal derivatives theta_kl make the strain
energy of the nonlinear body a quadratic function up to the third order: they contain the foreshortening of a bent
beam. The work of all forces on them is the geometric stiffness: of centrifugal forces as of those at interfaces
(Wallrapp & Schwertassek, Representation of geometric stiffening in multibody system simulation, Int. J. Numer. Methods
Eng. 32 (1991); Wu & Tiso, Multibody System Dynamics 36 (2016)).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .finite_elements import FiniteElements
from .interfaces import RIGID, Interface
from .static_solver import StaticSolver


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """Second derivatives of displacements by pairs of the lowest p modes with unit modal mass.

    Attributes
    ----------
    nodes : ndarray, shape (3 nodes, p, p)
        1/(kg m).
    markers : ndarray, shape (interfaces, 6, p, p)
        Displacement and rotation vector of each interface.
    moments : ndarray, shape (p, p, 3, 3)
        sum m x theta_kl^T, x from the centre of mass.
    """

    nodes: np.ndarray
    markers: np.ndarray
    moments: np.ndarray


def second_order(
    model: FiniteElements, interfaces: Sequence[Interface], solver: StaticSolver, static: np.ndarray, rigid: np.ndarray,
    modes: np.ndarray, count: int,
) -> SecondOrder:  # fmt: skip
    """Return the displacements of second order.

    Parameters
    ----------
    model : FiniteElements
    interfaces : sequence of Interface
    solver : StaticSolver
    static : ndarray, shape (3 n, k)
        Modes that span the interface coordinates and the rigid motions.
    rigid : ndarray, shape (3 n, 6)
        Rigid motions about the centre of mass.
    modes : ndarray, shape (3 n, elastic modes)
    count : int
        Number p of modes of which pairs are taken; none without the shape functions of a mesh.
    """
    p = min(count, modes.shape[1]) if model.solid is not None else 0
    nodes = np.zeros((len(modes), p, p))
    if model.solid is not None and p:
        forces = model.solid.second_order_forces(modes[:, :p])
        free = _FreeBody(model, solver, static, rigid)
        for k in range(p):
            for l in range(k + 1):
                turned = _turned_interfaces(model, interfaces, modes[:, k], modes[:, l])
                nodes[:, k, l] = nodes[:, l, k] = free.response(-forces[k, l], turned)
    markers = np.zeros((len(interfaces), 6, p, p))
    for own, interface in zip(markers, interfaces, strict=True):
        own[: interface.size] = np.einsum("ij,jkl->ikl", interface.mean(model), nodes[interface.entries])
    by_mass = (model.mass @ nodes.reshape(len(nodes), p * p)).reshape(len(nodes) // 3, 3, p, p)
    points = np.column_stack([rigid[1::3, 5], rigid[2::3, 3], rigid[0::3, 4]])
    return SecondOrder(nodes, markers, np.einsum("ia,ibkl->klab", points, by_mass))


def _turned_interfaces(
    model: FiniteElements, interfaces: Sequence[Interface], first: np.ndarray, second: np.ndarray
) -> np.ndarray:
    """Return the second derivative of the displacements of rigid interfaces by two rotations, shape (3 n,)."""
    found = np.zeros(len(first))
    for interface in interfaces:
        if interface.kind == RIGID:
            mean = interface.mean(model)[3:]
            a, b = mean @ first[interface.entries], mean @ second[interface.entries]
            arm = model.nodes[interface.nodes] - interface.point
            turned = np.cross(a, np.cross(b, arm)) + np.cross(b, np.cross(a, arm))
            found[interface.entries] = turned.ravel() / 2
    return found


class _FreeBody:
    """Static displacements of the free body under forces balanced by its rigid acceleration (inertia relief)."""

    def __init__(self, model: FiniteElements, solver: StaticSolver, static: np.ndarray, rigid: np.ndarray) -> None:
        self._model, self._solver = model, solver
        self._rigid = rigid
        self._by_mass = model.mass @ rigid
        self._inertia = rigid.T @ self._by_mass
        self._static = static / np.sqrt(np.einsum("ij,i,ij->j", static, model.stiffness.diagonal(), static))
        stiffness = self._static.T @ (model.stiffness @ self._static)
        held = self._static.T @ self._by_mass
        held /= np.linalg.norm(held, axis=0)
        self._factor = np.linalg.pinv(stiffness + held @ held.T)

    def response(self, force: np.ndarray, prescribed: np.ndarray) -> np.ndarray:
        """Return the displacement that is orthogonal to rigid motions and contains prescribed relative displacements."""
        force = force - self._model.stiffness @ prescribed
        force = force - self._by_mass @ np.linalg.solve(self._inertia, self._rigid.T @ force)
        found = self._solver.held_response(force)
        rest = self._static.T @ (force - self._model.stiffness @ found)
        found = prescribed + found + self._static @ (self._factor @ rest)
        return found - self._rigid @ np.linalg.solve(self._inertia, self._by_mass.T @ found)  # type: ignore[no-any-return]
