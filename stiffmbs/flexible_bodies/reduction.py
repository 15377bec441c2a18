"""Hurty-Craig-Bampton reduction of a finite element model.

Interface coordinates and the lowest normal modes with the interfaces held span the displacements (Craig & Bampton,
AIAA Journal 6(7), 1968). The modes of the reduced body exclude its rigid motions. They are orthogonal to these in the
sense of the mass matrix. The frame is therefore the linear Tisserand (mean axes) frame (Zwoelfer & Gerstmayr,
Multibody System Dynamics 51, 2021).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.linalg import block_diag, eigh, inv, null_space

from ..errors import InputError
from .areas import UNIT_LOADS
from .finite_elements import DISPLACEMENTS, PRECISION, FiniteElements, rigid_displacements
from .interfaces import Interface, check_interfaces
from .second_order import SecondOrder, second_order
from .shells.curvature import coarseness
from .static_solver import StaticSolver

SAME_FREQUENCY = 1e-9
"""Relative difference of the squares of two frequencies that are equal apart from rounding."""
DIRECTIONS: Final = (1.0, 2.0, 3.0)
"""Different weights of kinetic energy along x, y and z."""
DEPENDENT = 1e-10
"""Relative bound below which a combination of unit-mass modes, or an equation of a held interface, is dependent. It is the
ratio of an eigenvalue of the mass matrix, or of a singular value, to the largest."""
ZERO = 10.0
"""Frequency of the lowest elastic mode that is refused as zero, relative to the highest of the rigid modes."""
FIRST_ORDER = {"tetra": "tetra10", "hexahedron": "hexahedron20", "wedge": "wedge15"}
"""Elements of first order, and those of second order in their place."""
COARSE = 1.0
"""Coarseness of shells above which a note tells so: the deflection of a hemisphere is 4 % too small."""
LEVI_CIVITA: Final = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(2, 0, 1)
"""Components of a cross product: a x b = sum over b and c of LEVI_CIVITA[:, b, c] a_b b_c."""
MORE_MODES = 20
"""Modes of the first search up to a frequency, doubled until one is above it."""


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """Flexible body with modal coordinates in its mean-axes frame at the centre of mass, SI units."""

    mass: float
    centre: np.ndarray  # shape (3,): centre of mass in the coordinates of the mesh
    inertia: np.ndarray  # shape (3, 3): about the centre of mass, in the axes of the mesh
    frequencies: np.ndarray  # shape (n,): natural frequencies of the free reduced body, Hz, without the six rigid modes
    # shape (components nodes, n): displacements, in shells also rotations, of these modes with unit modal mass
    modes: np.ndarray
    rigid_frequencies: np.ndarray  # shape (6,): computed frequencies of the rigid modes, Hz: zero but for rounding
    fixed_frequencies: np.ndarray  # shape (m,): natural frequencies with all interfaces held, Hz
    effective_mass: np.ndarray  # shape (m, 3): effective mass of these along x, y and z, as fraction of the mass
    condition: float  # condition number of the mass matrix of interface and normal modes of unit mass
    # shape (interfaces, 6, n): displacement and rotation of each interface's reference point by mode; zero rotations of
    # points
    markers: np.ndarray
    points: np.ndarray  # shape (interfaces, 3): reference points in the coordinates of the mesh
    sizes: np.ndarray  # of int, shape (interfaces,): number of coordinates of each interface, 6 or 3
    # shape (n, 3): first moments of mass of the modes, sum m psi_k; zero in the mean-axes frame but for rounding
    first: np.ndarray
    second: np.ndarray  # shape (n, 3, 3): sum m x psi_k^T, x from the centre of mass
    pairs: np.ndarray  # shape (n, n, 3, 3): sum m psi_l psi_k^T by l and k
    dependent: int  # number of combinations of modes left out as linearly dependent
    # of the unit loads on each surface (`stiffmbs.flexible_bodies.areas.unit_loads`): force and torque about the centre of mass,
    # shape (surfaces, 4, 6); forces on the modes (surfaces, 4, n); torques by the displacement of each mode (surfaces, 4, n, 3)
    wrenches: np.ndarray
    modal_loads: np.ndarray
    arms: np.ndarray
    second_order: SecondOrder  # terms of second order, of a mesh: geometric stiffening
    elements: str  # types of the elements of a mesh, in the words of meshio; empty for matrices
    parts: str  # names of parts of one material to which the file may give several; empty if there are none
    unused: str  # names of statements and elements of the file that are not used; empty if there are none
    components: int  # of a node in the modes: three displacements, or six with its rotation
    coarseness: (
        float  # square of the side of elements over radius and thickness of shells with two curvatures; zero for others
    )

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.modes) // self.components

    @property
    def displacements(self) -> np.ndarray:
        """Displacements of the nodes by the modes, shape (nodes, 3, n)."""
        return self.modes.reshape(self.nodes, self.components, -1)[:, :DISPLACEMENTS]

    @property
    def notes(self) -> tuple[str, ...]:
        """Return notes on elements that are too stiff in bending, and on one material of several parts.

        Solids of first order are too stiff by shear locking, large flat elements of curved shells by membrane locking.
        """
        found = []
        better = [FIRST_ORDER[kind] for kind in self.elements.split(", ") if kind in FIRST_ORDER]
        if better:
            found.append(
                f"its mesh has elements of first order ({self.elements}), which are too stiff in bending; expected elements of second "
                f"order ({', '.join(better)}), or several elements over each thickness"
            )
        if self.parts:
            found.append(
                f"the file of its mesh tells apart {self.parts}, which all have the one material of the description; "
                "'materials' gives each group of elements its own"
            )
        if self.unused:
            found.append(
                f"the file of its mesh has {self.unused}, which are not used: materials, thicknesses, supports and loads are those of "
                "the description and of the scene"
            )
        if self.coarseness > COARSE:
            found.append(
                f"its mesh has shells with two curvatures and elements of {np.sqrt(self.coarseness):.2g} times the root of radius and "
                "thickness, which may be too stiff in bending; expected less than 1"
            )
        return tuple(found)

    def of_material(self, stiffer: float, heavier: float) -> ReducedBody:
        """Return the body with other factors of its stiffness and its mass matrix."""
        of_rates, of_modes = np.sqrt(stiffer / heavier), 1 / np.sqrt(heavier)
        factors = {
            "mass": heavier, "inertia": heavier, "frequencies": of_rates, "rigid_frequencies": of_rates,
            "fixed_frequencies": of_rates, "modes": of_modes, "markers": of_modes, "first": 1 / of_modes,
            "second": 1 / of_modes, "modal_loads": of_modes, "arms": of_modes,
        }  # fmt: skip
        terms = self.second_order
        scaled = replace(terms, static=terms.static / of_rates, stretch=terms.stretch * np.sqrt(stiffer) / heavier)
        return replace(
            self, second_order=scaled, **{name: getattr(self, name) * factor for name, factor in factors.items()}
        )

    def in_basis(self, turn: np.ndarray) -> ReducedBody:
        """Return the body with other modes, which are orthogonal combinations of its own, shape (n, n), by columns.

        Frequencies remain those of its own modes.
        """
        terms, pairs = self.second_order, "lkab,lm,kn->mnab"
        moved = replace(
            terms, first=np.einsum("lka,lm,kn->mna", terms.first, turn, turn, optimize=True),
            moments=np.einsum(pairs, terms.moments, turn, turn, optimize=True), static=turn.T @ terms.static,
            stretch=turn.T @ terms.stretch @ turn,
        )  # fmt: skip
        return replace(
            self, modes=self.modes @ turn, markers=self.markers @ turn, first=turn.T @ self.first,
            second=np.einsum("kab,km->mab", self.second, turn), pairs=np.einsum(pairs, self.pairs, turn, turn, optimize=True),
            second_order=moved, modal_loads=self.modal_loads @ turn, arms=np.einsum("slka,km->slma", self.arms, turn),
        )  # fmt: skip

    def held_frequencies(self, held: Sequence[int]) -> np.ndarray:
        """Return the natural frequencies with some interfaces held, Hz. `held`: numbers of the interfaces.

        Rigid and elastic modes have unit mass, and rotations are multiplied by the radius of gyration. The rank of the
        held equations then does not depend on the size of the body.
        """
        _, free, stiffness = self._held(held)
        squares = eigh(free.T @ (stiffness[:, None] * free), eigvals_only=True)
        return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)

    def energy_under(self, load: np.ndarray, rigid: np.ndarray) -> float:
        """Return the strain energy by a static load on all nodes, shape (components nodes,), with all interfaces held, J.

        `rigid` of shape (components nodes, 6): rigid motions about the centre of mass.
        """
        of_unit_mass, free, stiffness = self._held(range(len(self.sizes)))
        along = free.T @ np.append(of_unit_mass.T @ (rigid.T @ load), self.modes.T @ load)
        values, vectors = eigh(free.T @ (stiffness[:, None] * free))
        elastic = values > DEPENDENT * values.max(initial=0.0)
        return float(np.sum((vectors.T @ along)[elastic] ** 2 / values[elastic]) / 2)

    def _held(self, held: Sequence[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return rigid modes of unit mass, all motions with some interfaces held, and the stiffness of all modes."""
        radius = np.sqrt(np.trace(self.inertia) / self.mass)
        of_unit_mass = block_diag(np.eye(3) / np.sqrt(self.mass), inv(np.linalg.cholesky(self.inertia)).T)
        scale = np.repeat([1.0, radius], 3)[:, None]
        rows = []
        for k in held:
            of_rigid = np.vstack([rigid_displacements((self.points[k] - self.centre)[None]), np.eye(6)[3:]])
            rows.append((scale * np.hstack([of_rigid @ of_unit_mass, self.markers[k]]))[: self.sizes[k]])
        free = null_space(np.vstack([np.empty((0, 6 + len(self.frequencies))), *rows]), rcond=DEPENDENT)
        return of_unit_mass, free, np.append(np.zeros(6), (2 * np.pi * self.frequencies) ** 2)


def reduce(
    model: FiniteElements, interfaces: Sequence[Interface], count: int | None, highest: float | None = None,
    residual: bool = False, loads: Sequence[np.ndarray] = (),
) -> ReducedBody:  # fmt: skip
    """Reduce a model to its interfaces and normal modes.

    `count`: number of normal modes with all interfaces held. `highest`: frequency up to which these are kept, Hz, without
    a count. `residual`: add the static displacements, with all interfaces held, under the six uniform accelerations of
    the body. `loads`: forces on surfaces, each of shape (size, 4), whose static displacements are added too. Raises InputError.
    """
    check_interfaces(list(interfaces), model)
    mass, centre, inertia = rigid_body(model)
    rigid = model.rigid_modes(centre)
    by_rigid = model.mass @ rigid
    solver, held = static_solver(model, interfaces, rigid)
    squares, normal = _normal_modes(solver, count, highest)
    static = solver.static_modes()
    under_loads = [solver.held_response(by_rigid)] if residual else []
    for load in loads:
        moved = solver.held_response(load)
        under_loads.append(moved[:, moved.any(axis=0)])
    shapes = np.column_stack([static, *([] if held else [rigid]), normal, *under_loads])
    shapes /= np.sqrt(np.einsum("ij,ij->j", shapes, model.mass @ shapes))
    basis, condition = _independent(shapes, model)
    participation = (normal.T @ by_rigid)[:, :3]
    frequencies, modes = _free_modes(model, basis, rigid, by_rigid)
    zeros = _rigid_frequencies(model, basis)
    if len(frequencies) and frequencies[0] < ZERO * zeros.max():
        raise InputError(
            f"stiffness: found a seventh frequency of {frequencies[0]:.2g} Hz with six of up to {zeros.max():.2g} Hz, "
            "expected six zero frequencies: a part of the body moves freely"
        )
    return ReducedBody(
        mass, centre, inertia, frequencies, modes, zeros, np.sqrt(squares) / (2 * np.pi),
        participation**2 / mass, condition, _marker_modes(model, interfaces, modes),
        np.array([interface.point for interface in interfaces]).reshape(-1, 3),
        np.array([interface.size for interface in interfaces], dtype=int),
        *_moments(model, centre, modes), shapes.shape[1] - basis.shape[1],
        *_of_loads(model, centre, modes, loads), second_order(model, interfaces, solver, static, held, centre, modes), ", ".join(model.cells),
        model.parts, model.unused, model.components,
        0.0 if model.shell is None else coarseness(model.shell, model.shell_cells.values()),
    )  # fmt: skip


def rigid_body(model: FiniteElements) -> tuple[float, np.ndarray, np.ndarray]:
    """Return mass, centre of mass and inertia about it of a model, from its mass matrix.

    Raises InputError if the mass is not the same along x, y and z.
    """
    about = model.nodes.mean(axis=0)
    rigid = model.rigid_modes(about)
    block = rigid.T @ (model.mass @ rigid)
    mass = float(np.trace(block[:3, :3])) / 3
    if mass <= 0 or np.abs(block[:3, :3] - mass * np.eye(3)).max() > PRECISION * mass:
        along = ", ".join(f"{part:.6g}" for part in np.diagonal(block[:3, :3]))
        raise InputError(f"mass: found {along} kg along x, y and z, expected one positive mass")
    first = block[3:, :3]  # m times the cross-product matrix of the centre
    offset = np.array([first[2, 1], first[0, 2], first[1, 0]]) / mass
    inertia = block[3:, 3:] - mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return mass, about + offset, (inertia + inertia.T) / 2


def _coordinates(model: FiniteElements, interfaces: Sequence[Interface], shapes: np.ndarray) -> list[np.ndarray]:
    return [interface.mean(model) @ shapes[interface.entries(model)] for interface in interfaces]


def _holds(model: FiniteElements, interfaces: Sequence[Interface], rigid: np.ndarray) -> bool:
    """Return True if held interfaces leave the body no rigid motion."""
    size = np.ptp(model.nodes, axis=0).max()
    scale = np.array([1.0] * 3 + [1 / size] * 3)
    held = [
        part[: interface.size] * scale
        for interface, part in zip(interfaces, _coordinates(model, interfaces, rigid), strict=True)
    ]
    return len(held) > 0 and np.linalg.matrix_rank(np.vstack(held), tol=1e-6) == 6


def static_solver(
    model: FiniteElements, interfaces: Sequence[Interface], rigid: np.ndarray
) -> tuple[StaticSolver, bool]:
    """Return the static solver of a body, and whether its interfaces hold it; otherwise its mean motion is held, too.

    `rigid` of shape (size, 6): rigid motions about the centre of mass. Raises InputError.
    """
    held, supports = _holds(model, interfaces, rigid), np.empty((len(rigid), 0))
    if not held:
        by_rigid = model.mass @ rigid
        supports = by_rigid / np.sqrt(np.einsum("ij,ij->j", rigid, by_rigid)) / np.sqrt(model.mass.diagonal().max())
    return StaticSolver(model, interfaces, supports), held


def _normal_modes(solver: StaticSolver, count: int | None, highest: float | None) -> tuple[np.ndarray, np.ndarray]:
    if count is not None:
        return solver.normal_modes(count)
    assert highest is not None
    tried = MORE_MODES
    while True:
        squares, shapes = solver.normal_modes(tried)
        kept = int(np.searchsorted(squares, (2 * np.pi * highest) ** 2, side="right"))
        if kept < len(squares):
            return squares[:kept], shapes[:, :kept]
        tried *= 2


def _independent(shapes: np.ndarray, model: FiniteElements) -> tuple[np.ndarray, float]:
    """Return orthonormal combinations of unit-mass modes, and the condition number of their mass matrix."""
    values, vectors = eigh(shapes.T @ (model.mass @ shapes))
    kept = values > DEPENDENT * values[-1]
    condition = float(values[-1] / values[0]) if values[0] > 0 else np.inf
    return shapes @ (vectors[:, kept] / np.sqrt(values[kept])), condition


def _free_modes(
    model: FiniteElements, basis: np.ndarray, rigid: np.ndarray, by_rigid: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies (Hz) and unit-mass modes in the part of a basis that is orthogonal to rigid motions."""
    size = np.sqrt(np.einsum("ij,ij->j", rigid, by_rigid))
    orthogonal = basis @ null_space((by_rigid / size).T @ basis, rcond=1e-6)
    orthogonal -= rigid @ np.linalg.solve(rigid.T @ by_rigid, by_rigid.T @ orthogonal)  # rounding of the null space
    stiffness = orthogonal.T @ (model.stiffness @ orthogonal)
    squares, vectors = eigh(stiffness, orthogonal.T @ (model.mass @ orthogonal))
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi), _separated(model, squares, orthogonal @ vectors)


def _separated(model: FiniteElements, squares: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """Return modes whose combinations at equal frequencies have extreme kinetic energies along the axes of the mesh.

    Such combinations are determined by rounding otherwise. These are symmetric or antisymmetric if the body is.
    """
    of_node = np.append(DIRECTIONS, np.zeros(model.components - DISPLACEMENTS))
    weights = np.tile(of_node, len(model.nodes))[:, None]
    found, last = modes.copy(), 0
    ends = np.flatnonzero(np.diff(squares, append=np.inf) > SAME_FREQUENCY * squares) + 1
    for end in ends.tolist():
        if end - last > 1:
            shapes = modes[:, last:end]
            found[:, last:end] = shapes @ eigh(shapes.T @ (weights * (model.mass @ shapes)))[1]
        last = end
    return found


def _rigid_frequencies(model: FiniteElements, basis: np.ndarray) -> np.ndarray:
    """Return the six lowest frequencies of the reduced body with its rigid motions, Hz."""
    squares = eigh(basis.T @ (model.stiffness @ basis), basis.T @ (model.mass @ basis), eigvals_only=True)
    return np.sqrt(np.abs(squares[:6])) / (2 * np.pi)


def _marker_modes(model: FiniteElements, interfaces: Sequence[Interface], modes: np.ndarray) -> np.ndarray:
    found = np.zeros((len(interfaces), 6, modes.shape[1]))
    for own, part in zip(found, _coordinates(model, interfaces, modes), strict=True):
        own[: len(part)] = part
    return found


def _moments(model: FiniteElements, centre: np.ndarray, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return first moments, moments with the position, and moments of pairs of modes by their nodes' masses."""
    count, n = len(model.nodes), modes.shape[1]
    by_mass, shapes = (
        each.reshape(count, model.components, n)[:, :DISPLACEMENTS] for each in (model.mass @ modes, modes)
    )
    points = model.nodes - centre
    between = model.mass[:: model.components, :: model.components]
    weighted = (between @ shapes.reshape(count, 3 * n)).reshape(count, 3, n)
    moments = np.einsum("ia,ibk->kab", points, by_mass)
    pairs = np.einsum("ial,ibk->lkab", shapes, weighted, optimize=True)
    if model.shell is not None:  # points next to the middle surface move by rotations
        directors = model.shell.directors
        turned = (directors.turned @ modes).reshape(len(directors.places), DISPLACEMENTS * n)
        weighted = (directors.moments @ turned).reshape(len(directors.places), DISPLACEMENTS, n)
        moments += np.einsum("ia,ibk->kab", directors.places, weighted, optimize=True)
        pairs += np.einsum("ial,ibk->lkab", turned.reshape(*weighted.shape), weighted, optimize=True)
    return by_mass.sum(axis=0).T, moments, pairs


def _of_loads(
    model: FiniteElements, centre: np.ndarray, modes: np.ndarray, loads: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the wrenches of loads, their forces on modes, and their torques by the displacements of modes."""
    count, n = len(model.nodes), modes.shape[1]
    forces = np.array(loads).reshape(len(loads), model.size, UNIT_LOADS)
    at_nodes = forces.reshape(len(loads), count, model.components, UNIT_LOADS)[:, :, :DISPLACEMENTS]
    shapes = modes.reshape(count, model.components, n)[:, :DISPLACEMENTS]
    wrenches = np.einsum("snl,nw->slw", forces, model.rigid_modes(centre))
    arms = np.einsum("abc,ibk,sicl->slka", LEVI_CIVITA, shapes, at_nodes, optimize=True)
    return wrenches, np.einsum("snl,nk->slk", forces, modes), arms
