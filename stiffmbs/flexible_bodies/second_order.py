"""Geometric stiffening: displacements of second order with held interfaces, and the stretch that interfaces must follow.

The displacement is u = sum psi_k q_k + 1/2 sum theta_kl q_k q_l. The displacements theta_kl relax the strain of second
order, E = G^T G / 2 by displacement gradients G, inside of the body. Rigid interfaces turn by finite rotations. The work
of inertial forces and of weight on theta_kl is their geometric stiffness. The strain of second order in equilibrium with
interface forces remains: such as the foreshortening of a bent beam with held ends. Its energy is complete,

    U = 1/2 p^T K p,  p = q + sum_i b_i g_i,  g_i = 1/2 q^T Gamma_i q,

with the static shapes b_i of the interfaces, orthonormal in the strain energy. The forces (b_i . K p) Gamma_i q are the
geometric stiffness of interface forces. All matrices are those of initial stress, integrals of grad psi_k . sigma . grad
psi_l, with the stress of static solutions: of twelve inertial loads and of the shapes b_i (Wallrapp & Schwertassek,
Representation of geometric stiffening in multibody system simulation, Int. J. Numer. Methods Eng. 32 (1991)).
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg import eigh

from .finite_elements import DISPLACEMENTS, FiniteElements, displacements_of
from .interfaces import Interface
from .shells.shell import COMPONENTS, Shell
from .shells.stress import ShellStress
from .solid import InitialStress, Solid
from .static_solver import StaticSolver

LOGGER = logging.getLogger(__name__)
RIGID_MOTIONS: Final = 6


class StressOfBoth:
    """Work of the stress of solids and shells of one mesh on their strains of second order."""

    def __init__(self, solid: Solid, shell: Shell) -> None:
        self._solid, self._shell = InitialStress(solid), ShellStress(shell)

    def works(self, displacements: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """Return the work of the stress of displacements, shape (6 n, k), by modes, shape (6 n, m), as (k, m, m)."""
        of_solids = self._solid.works(displacements_of(displacements), displacements_of(modes))
        return self._shell.works(displacements, modes) + of_solids

    def second_order_force(self, displacement: np.ndarray) -> np.ndarray:
        """Return the forces on all components of the strains of second order of a displacement, shape (6 n,)."""
        found = self._shell.second_order_force(displacement)
        of_solids = self._solid.second_order_force(displacements_of(displacement))
        found.reshape(-1, COMPONENTS)[:, :DISPLACEMENTS] += of_solids.reshape(-1, DISPLACEMENTS)
        return found


Stress = InitialStress | ShellStress | StressOfBoth
"""Work of the stress of a body on strains of second order."""


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """Terms of second order by pairs of n modes with unit modal mass; without entries for bodies without a mesh."""

    first: np.ndarray  # shape (n, n, 3): sum m theta_kl
    moments: np.ndarray  # shape (n, n, 3, 3): sum m x theta_kl^T, x from the centre of mass
    # shape (n, r): modal coordinates b_i of the static shapes of interfaces with unit strain energy b_i^T K b_i
    static: np.ndarray
    stretch: np.ndarray  # shape (r, n, n): gamma_i


def second_order(
    model: FiniteElements, interfaces: Sequence[Interface], solver: StaticSolver, static: np.ndarray, held: bool,
    centre: np.ndarray, modes: np.ndarray,
) -> SecondOrder:  # fmt: skip
    """Return the terms of second order of modes in the mean-axes frame, shape (size, n).

    `static` of shape (size, coordinates): displacements by unit interface coordinates. `held`: true if held
    interfaces leave the body no rigid motion. `centre` of shape (3,): centre of mass.
    """
    n = modes.shape[1]
    if (model.solid is None and model.shell is None) or n == 0:
        return SecondOrder(np.zeros((n, n, 3)), np.zeros((n, n, 3, 3)), np.zeros((n, 0)), np.zeros((0, n, n)))
    LOGGER.info("computing the geometric stiffening of %d modes", n)
    work = _WorkOfStress(model, interfaces, modes)
    fields = np.einsum("fg,bc->bgfc", np.eye(4), np.eye(3)).reshape(3, 4, 12)  # constant, or linear along one axis
    loads = model.inertial_forces(fields[:, 0], fields[:, 1:], centre)
    relaxed = solver.held_response(-loads)
    first, *moments = work.of(relaxed, loads).reshape(4, 3, n, n)
    shapes = _static_shapes(model, interfaces, static, held, centre)
    return SecondOrder(
        first.transpose(1, 2, 0), np.array(moments).transpose(2, 3, 0, 1), modes.T @ (model.mass @ shapes),
        work.of(shapes),
    )  # fmt: skip


def displacement_of_second_order(
    model: FiniteElements,
    stress: Stress,
    interfaces: Sequence[Interface],
    solver: StaticSolver,
    displacement: np.ndarray,
) -> np.ndarray:
    """Return the part of second order of a displacement, shape (size,), with held interfaces. `stress`: `stress_of` the model."""
    turned = np.zeros(len(displacement))
    for interface in interfaces:
        if interface.size == RIGID_MOTIONS:
            turn = interface.mean(model)[3:] @ displacement[interface.entries(model)]
            arm = model.nodes[interface.nodes] - interface.point
            turned[model.displacements(interface.nodes)] = np.cross(turn, np.cross(turn, arm)).ravel() / 2
    force = stress.second_order_force(displacement) + model.stiffness @ turned
    return turned - solver.held_response(force)


def stress_of(model: FiniteElements) -> Stress:
    """Return what computes the work of stress on strains of second order."""
    if model.shell is not None:
        return ShellStress(model.shell) if model.solid is None else StressOfBoth(model.solid, model.shell)
    assert model.solid is not None
    return InitialStress(model.solid)


def _static_shapes(
    model: FiniteElements, interfaces: Sequence[Interface], static: np.ndarray, held: bool, centre: np.ndarray
) -> np.ndarray:
    """Return combinations of static displacements with unit strain energies, without rigid motions, shape (size, r)."""
    if held:  # rotations are multiplied by the size, so that the coordinates of all motions can be compared
        size = np.ptp(model.nodes, axis=0).max()
        scale = np.concatenate([np.repeat([1.0, 1 / size], 3)[: each.size] for each in interfaces])
        rigid = model.rigid_modes(centre) / np.repeat([1.0, size], 3)
        moved = np.vstack([each.mean(model) @ rigid[each.entries(model)] for each in interfaces]) / scale[:, None]
        _, _, across = np.linalg.svd(moved.T)
        static = static @ (scale[:, None] * across[RIGID_MOTIONS:].T)
    if not static.shape[1]:
        return static
    stiffness = static.T @ (model.stiffness @ static)
    scale = 1 / np.sqrt(stiffness.diagonal())
    energies, vectors = eigh(scale[:, None] * stiffness * scale)
    return static @ (scale[:, None] * vectors / np.sqrt(energies))  # type: ignore[no-any-return]


class _WorkOfStress:
    """Work of the stress of displacements on the strains of second order of pairs of modes."""

    def __init__(self, model: FiniteElements, interfaces: Sequence[Interface], modes: np.ndarray) -> None:
        self._model, self._modes, self._stress = model, modes, stress_of(model)
        self._turning = [
            (model.displacements(each.nodes), model.nodes[each.nodes] - each.point, each.mean(model)[3:] @ modes[each.entries(model)])
            for each in interfaces
            if each.size == RIGID_MOTIONS
        ]  # fmt: skip

    def of(self, displacements: np.ndarray, loads: np.ndarray | float = 0.0) -> np.ndarray:
        """Return sigma : grad psi_k^T grad psi_l, and the work at turned interfaces of forces there, shape (m, n, n).

        Each displacement, shape (size, m), causes a stress sigma; its elastic forces and the load act at the interfaces.
        """
        works = self._stress.works(displacements, self._modes)
        for found, force in zip(works, (self._model.stiffness @ displacements + loads).T, strict=True):
            for entries, arm, turn in self._turning:
                moment = arm.T @ force[entries].reshape(-1, 3)
                found += turn.T @ ((moment + moment.T) / 2 - np.trace(moment) * np.eye(3)) @ turn
        return (works + works.swapaxes(1, 2)) / 2  # type: ignore[no-any-return]
