"""Meshes of shells, and static solutions and frequencies with supports, for the tests of shells."""

from collections.abc import Callable, Iterable

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import eigsh, spsolve

from stiffmbs.flexible_bodies.materials import ElementMaterials
from stiffmbs.flexible_bodies.shells.shell import Shell, of_elements

KINDS = "quad", "triangle"


def surface(
    along: int, across: int, place: Callable[[float, float], Iterable[float]], kind: str = "quad"
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray]:
    """Return nodes at a function of two numbers from 0 to 1, the elements, and the nodes by rows and columns."""
    a, b = np.meshgrid(np.linspace(0, 1, along + 1), np.linspace(0, 1, across + 1), indexing="ij")
    nodes = np.array([tuple(place(*each)) for each in zip(a.ravel(), b.ravel(), strict=True)], dtype=float)
    numbers = np.arange(len(nodes)).reshape(along + 1, across + 1)
    corners = numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]
    quads = np.stack(corners, axis=-1).reshape(-1, 4)
    if kind == "quad":
        return nodes, {"quad": quads}, numbers
    return nodes, {"triangle": np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])}, numbers


def shell(nodes, cells, E, nu, thickness, density=1.0) -> Shell:
    """Return the shell of elements of one material and one thickness."""
    materials = {
        kind: ElementMaterials(*(np.full(len(own), each) for each in (E, nu, density))) for kind, own in cells.items()
    }
    return of_elements(nodes, cells, materials, {kind: np.full(len(own), thickness) for kind, own in cells.items()})


def places(nodes, components) -> np.ndarray:
    """Return the places of components (x, y, z, then rotations) of nodes."""
    return (6 * np.asarray(nodes).ravel()[:, None] + np.asarray(list(components))).ravel()


def under(stiffness: csr_array, held: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return the displacements and rotations under forces, shape (nodes, 6), with some components held."""
    free = np.setdiff1d(np.arange(len(forces)), held)
    found = np.zeros(len(forces))
    found[free] = spsolve(csc_array(stiffness[free][:, free]), forces[free])
    return found.reshape(-1, 6)


def pressure(of: Shell, per_area: Iterable[float]) -> np.ndarray:
    """Return the forces of a load per area on all components."""
    areas = np.zeros(len(of.places))
    corners = of.places[of.triangles]
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    np.add.at(areas, of.triangles, (of.shares * size / 3)[:, None])
    found = np.zeros((len(areas), 6))
    found[:, :3] = np.outer(areas, list(per_area))
    return found.ravel()


def frequencies(of: Shell, held: np.ndarray, count: int) -> np.ndarray:
    """Return the lowest angular frequencies with some components held."""
    stiffness, mass = of.stiffness(), of.mass()
    free = np.setdiff1d(np.arange(mass.shape[0]), held)
    matrices = (csc_array(each[free][:, free]) for each in (stiffness, mass))
    K, M = matrices
    return np.sqrt(np.sort(eigsh(K, count, M, sigma=0, return_eigenvectors=False)))
