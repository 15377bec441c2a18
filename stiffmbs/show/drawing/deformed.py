"""Surfaces of flexible bodies, deformed by their modal coordinates."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from ...elements.spatial.flexible.bodies import FloatingFrame, ModalCoordinates
from ...elements.spatial.flexible.interface import FlexibleInterface
from ...errors import InputError
from ...flexible_bodies.finite_elements import FiniteElements
from ...flexible_bodies.reduced import reduced_body
from ...flexible_bodies.shapes import ELEMENTS
from ...flexible_bodies.shells.surfaces import Surfaces
from ...flexible_bodies.stress import PointsOfBoth, deviatoric, stress_points
from ...model.model_data import ModelData
from . import solids
from .poses import Poses
from .scene_graph import Drawing, Part, Solid

AT_ONCE = 1_000_000
"""Number of stresses computed at once."""


def deformed_body(name: str, frame: FloatingFrame) -> Part | None:
    """Return the surface of a flexible body with its mode shapes; None if its file has no elements.

    The displacement is linear in the modal coordinates and multiplied by the `deformation_scale` of the body. `name`:
    name of the floating frame. Raises InputError if a file of the body cannot be read, or has no mesh for stress
    colors.
    """
    body, folder = frame.source
    model, reduced = body.model(folder), reduced_body(body, folder)
    if body.stress_colors and not model.has_stresses:
        raise InputError(
            f"bodies.{name.rpartition('.')[0]}.stress_colors: found a body described by matrices, expected a mesh"
        )
    stressed = stress_points(model) if body.stress_colors else None
    if isinstance(stressed, Surfaces):
        faces, points = list(stressed.faces(model.cells)), model.nodes[stressed.nodes] + stressed.arms
        moved = stressed.displacements(reduced.modes)
    elif isinstance(stressed, PointsOfBoth):
        of_solids = [stressed.of_solids[face] for face in faces_of_solids(model)]
        faces = of_solids + [stressed.of_surfaces[face] for face in stressed.surfaces.faces(model.shell_cells)]
        points, moved = model.nodes[stressed.nodes] + stressed.arms(), stressed.displacements(reduced.modes)
    else:
        faces, points, moved = surface(model), model.nodes, np.moveaxis(reduced.displacements, -1, 0)
    if not faces:
        return None
    used, inverse = np.unique(np.concatenate(faces), return_inverse=True)
    ends = np.cumsum([len(face) for face in faces])[:-1]

    def by_coordinates(of_modes: np.ndarray) -> Mapping[str, np.ndarray]:
        every = np.zeros((3 * len(frame.modes), *of_modes.shape[1:]))
        every[: len(of_modes)] = np.sqrt(reduced.mass) * of_modes
        return {modal: every[3 * k : 3 * k + 3] for k, modal in enumerate(frame.modes)}

    solid = Solid(
        points[used] - reduced.centre, tuple(np.split(inverse, ends)), modes=by_coordinates(body.deformation_scale * moved[:, used]),
        stresses={} if stressed is None else by_coordinates(deviatoric(stressed.stresses(reduced.modes)[:, used])),
    )  # fmt: skip
    return Part(name, "body", name, (solids.edged(solid, math.inf) if len(faces) < solids.MOST_FACES else solid,))


def surface(model: FiniteElements) -> list[np.ndarray]:
    """Return the nodes around each face that belongs to one element only, counterclockwise as seen from outside.

    Faces of shells are their elements, in the order of the file.
    """
    return [face for cells in model.shell_cells.values() for face in cells] + faces_of_solids(model)


def faces_of_solids(model: FiniteElements) -> list[np.ndarray]:
    """Return the nodes around each face of the solids that belongs to one element only, as `surface`."""
    every: dict[int, list[tuple[np.ndarray, np.ndarray]]] = {}
    for kind, cells in model.solid_cells.items():
        middles = model.nodes[cells].mean(axis=1)
        for face in ELEMENTS[kind].faces:
            every.setdefault(len(face), []).append((cells[:, list(face)], middles))
    found: list[np.ndarray] = []
    for of_one_size in every.values():
        faces, inside = (np.concatenate(each) for each in zip(*of_one_size, strict=True))
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        for k in first[count == 1]:
            points = model.nodes[faces[k]]
            outward = solids.face_normal(points) @ (points.mean(axis=0) - inside[k]) >= 0
            found.append(faces[k] if outward else faces[k][::-1])
    return found


def largest_stress(parts: Iterable[Part], poses: Poses) -> float:
    """Return the largest von Mises stress of all bodies in stress colors over all instants, N/m^2; zero without."""
    found = 0.0
    for solid in (solid for part in parts for solid in part.solids if solid.stresses):
        for rows in np.array_split(np.arange(len(poses.time)), 1 + len(poses.time) * len(solid.vertices) // AT_ONCE):
            found = max(found, float(np.nanmax(poses.stresses(solid, rows), initial=0.0)))
    return found


def true_to_scale(drawing: Drawing) -> Drawing:
    """Return a drawing whose flexible bodies have their own deformation, and no stress colors."""

    def plain(solid: Solid, scale: float) -> Solid:
        return replace(solid, modes={body: of / scale for body, of in solid.modes.items()}, stresses={})

    parts = [
        replace(part, solids=tuple(plain(solid, drawing.deformations[name]) for solid in part.solids))
        if drawing.deformations.get(name := part.owner.rpartition(".")[0]) else part
        for part in drawing.parts
    ]  # fmt: skip
    return replace(drawing, parts=tuple(parts), deformations={}, stress=0.0)


def modal_bodies(data: ModelData) -> set[str]:
    """Return the bodies that hold modal coordinates and have no place in space."""
    return {name for name, body in data.bodies.items() if isinstance(body, ModalCoordinates)}


def interface_bodies(data: ModelData) -> dict[str, str]:
    """Return the floating frame of each body of an interface."""
    return {
        joint.j.body: joint.i.body for joint in data.joints.values() if isinstance(joint, FlexibleInterface)
    }  # fmt: skip


def deformation_scales(data: ModelData) -> dict[str, float]:
    """Return the factor of the drawn deformation of each flexible body."""
    return {
        name.rpartition(".")[0]: body.source[0].deformation_scale
        for name, body in data.bodies.items() if isinstance(body, FloatingFrame)
    }  # fmt: skip
