"""Checks of the shells of a mesh: areas, warped quadrilaterals, repeated elements."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..mesh_checks import FLAT, check_repeated, refuse
from .shell import DIVISION, QUADRILATERAL, TRIANGLE, WARPED, mean_normals


def check_shells(nodes: np.ndarray, cells: Mapping[str, np.ndarray]) -> None:
    """Refuse elements without an area, and warped, concave or repeated ones.

    `cells`: nodes of the elements by kinds.
    """
    for kind, own in cells.items():
        _check_areas(nodes, own, kind)
        check_repeated(own)
    if QUADRILATERAL in cells:
        _check_warped(nodes, cells[QUADRILATERAL])
    if len(cells) > 1:
        _check_kinds(cells[TRIANGLE], cells[QUADRILATERAL])


def _check_areas(nodes: np.ndarray, cells: np.ndarray, kind: str) -> None:
    flat = np.zeros(len(cells), dtype=bool)
    for corners in DIVISION[kind]:
        a, b, c = (nodes[cells[:, k]] for k in corners)
        sides = np.stack([b - a, c - b, a - c], axis=1)
        longest = np.linalg.norm(sides, axis=2).max(axis=1)
        flat |= np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) <= FLAT * longest**2
    refuse(flat, "shells without an area", cells, "corners that are not on one line")


def _check_warped(nodes: np.ndarray, cells: np.ndarray) -> None:
    """Refuse quadrilaterals one of whose triangles has another direction than their mean plane."""
    corners = nodes[cells]
    mean = mean_normals(corners)
    mean /= np.linalg.norm(mean, axis=1)[:, None] + np.finfo(float).tiny
    smallest = np.ones(len(cells))
    for a, b, c in DIVISION[QUADRILATERAL]:
        normal = np.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, b])
        cosine = np.einsum("ea,ea->e", normal, mean) / np.linalg.norm(normal, axis=1)
        smallest = np.minimum(smallest, cosine)
    refuse(smallest <= 0, "concave or crossed quadrilaterals", cells, "corners in order around a convex one")
    refuse(
        smallest < np.cos(WARPED), "warped quadrilaterals", cells,
        f"corners within {np.degrees(WARPED):.0f} deg of one plane; divide these into triangles",
    )  # fmt: skip


def _check_kinds(triangles: np.ndarray, quadrilaterals: np.ndarray) -> None:
    """Refuse triangles between three nodes of a quadrilateral."""
    halves = np.concatenate([quadrilaterals[:, list(corners)] for corners in DIVISION[QUADRILATERAL]])
    rows = np.concatenate([np.unique(np.sort(halves, axis=1), axis=0), np.sort(triangles, axis=1)])
    _, own, count = np.unique(rows, axis=0, return_inverse=True, return_counts=True)
    on_others = count[own.ravel()][-len(triangles) :] > 1
    refuse(on_others, "triangles on quadrilaterals", triangles, "each part of the surface once")
