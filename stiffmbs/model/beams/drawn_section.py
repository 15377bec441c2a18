"""Constants of a cross section that is drawn by points, by the package sectionproperties."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from .section import Properties, wagner_coefficients

if TYPE_CHECKING:
    from shapely import Polygon

Loop = tuple[tuple[float, float], ...]
ELEMENTS = 300
"""Triangles of the mesh: an error of 1e-4 of the torsion constant of a rectangle."""
SYMMETRIC = 1e-3
"""Offset of the shear centre over the root of the area, and coupling of both shears, that are errors of the mesh."""


@lru_cache(maxsize=32)
def constants_of(points: Loop, holes: tuple[Loop, ...]) -> Properties:
    """Return the constants, those of shear for a Poisson ratio of zero.

    The warping function is solved by finite elements (Pilkey, Analysis and Design of Elastic Beams, 2002).

    `points`: outline, along axes 2 and 3, m; the axis of the beam is the centroid. Raises ValueError if the package is
    missing or the outlines cross.
    """
    try:
        from sectionproperties.analysis import Section
        from sectionproperties.pre.geometry import Geometry
        from shapely import Polygon
        from shapely.geometry.polygon import orient
    except ImportError:
        raise ValueError("found no package for drawn sections, expected it: pip install 'stiffmbs[sections]'") from None
    outline = Polygon(points, holes)
    if not outline.is_valid or not outline.area:
        raise ValueError("found outlines that cross, touch or enclose no area, expected one outline around its holes")
    geometry = Geometry(outline)
    geometry.create_mesh(mesh_sizes=[outline.area / ELEMENTS])
    section = Section(geometry)
    section.calculate_geometric_properties()
    section.calculate_warping_properties()
    A = float(section.get_area())
    I2, I3, product = (float(value) for value in section.get_ic())
    offset = [float(a - b) for a, b in zip(section.get_sc(), section.get_c(), strict=True)]
    y, z = (_without_error(part, A) for part in offset)
    third = _third_moments(orient(outline), np.array(section.get_c()))
    wagner = wagner_coefficients((I2, I3, product), third, (y, z))
    along2, along3 = (float(value) for value in section.get_as())
    coupling = A / float(section.section_props.a_sxy or math.inf)
    coupling = coupling if abs(coupling) > SYMMETRIC else 0.0
    return Properties(
        A, I2, I3, float(section.get_j()), along2 / A, along3 / A, product, (y, z), coupling,
        (_without_error(wagner[0], A), _without_error(wagner[1], A)),
    )  # fmt: skip


def _third_moments(outline: Polygon, centroid: np.ndarray) -> list[float]:
    """Return the integrals of each coordinate times the square of the distance from the centroid, m^5.

    Each edge, with the area on its left, adds that of the triangle to the centroid: 2/5 of the area times the mean along
    the edge, as the integrand is homogeneous of degree three. Simpson's rule is exact for this mean.
    """
    total = np.zeros(2)
    for ring in (outline.exterior, *outline.interiors):
        points = np.array(ring.coords) - centroid
        a, b = points[:-1], points[1:]
        mean = sum(w * x * (x**2).sum(axis=1)[:, None] for w, x in ((1, a), (4, (a + b) / 2), (1, b))) / 6
        total += (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) @ mean / 5
    return total.tolist()


def _without_error(length: float, A: float) -> float:
    """Return a length of the section, or zero if it is an error of the mesh."""
    return length if abs(length) > SYMMETRIC * math.sqrt(A) else 0.0
