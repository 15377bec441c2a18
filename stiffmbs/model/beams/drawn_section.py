"""Constants of a cross section that is drawn by points, by the package sectionproperties."""

from __future__ import annotations

import math
from functools import lru_cache

from .section import Properties

Loop = tuple[tuple[float, float], ...]
ELEMENTS = 300
"""Triangles of the mesh: an error of 1e-4 of the torsion constant of a rectangle."""
SYMMETRIC = 1e-3
"""Offset of the shear centre over the root of the area, and coupling of both shears, that are errors of the mesh."""


@lru_cache(maxsize=32)
def constants_of(points: Loop, holes: tuple[Loop, ...]) -> Properties:
    """Return the constants, those of shear for a Poisson ratio of zero.

    The warping function is solved by finite elements (Pilkey, Analysis and Design of Elastic Beams, 2002).

    Parameters
    ----------
    points : sequence of (float, float)
        Outline, along axes 2 and 3, m; the axis of the beam is the centroid.
    holes : sequence of such outlines

    Raises
    ------
    ValueError
        If the package is missing or the outlines cross.
    """
    try:
        from sectionproperties.analysis import Section
        from sectionproperties.pre.geometry import Geometry
        from shapely import Polygon
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
    y, z = (
        float(a - b) if abs(a - b) > SYMMETRIC * math.sqrt(A) else 0.0
        for a, b in zip(section.get_sc(), section.get_c(), strict=True)
    )
    along2, along3 = (float(value) for value in section.get_as())
    coupling = A / float(section.section_props.a_sxy or math.inf)
    coupling = coupling if abs(coupling) > SYMMETRIC else 0.0
    return Properties(A, I2, I3, float(section.get_j()), along2 / A, along3 / A, product, (y, z), coupling)
