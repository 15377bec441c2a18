"""Constants of a cross section that is drawn by points, by the package sectionproperties."""

from __future__ import annotations

import math
from functools import lru_cache

Loop = tuple[tuple[float, float], ...]
ELEMENTS = 300
"""Triangles of the mesh: an error of 1e-4 of the torsion constant of a rectangle."""
PRINCIPAL = 1e-6
"""Largest product of inertia of principal axes, relative to the larger second moment."""
CENTRED = 0.01
"""Largest distance of the shear centre from the centroid, relative to the root of the area."""


@lru_cache(maxsize=32)
def constants_of(points: Loop, holes: tuple[Loop, ...]) -> tuple[float, float, float, float, float, float]:
    """Return A, I2, I3, J and the shear factors along axes 2 and 3, the latter for a Poisson ratio of zero.

    The warping function is solved by finite elements (Pilkey, Analysis and Design of Elastic Beams, 2002).

    Parameters
    ----------
    points : sequence of (float, float)
        Outline, along axes 2 and 3, m; the axis of the beam is the centroid.
    holes : sequence of such outlines

    Raises
    ------
    ValueError
        If the package is missing, the outlines cross, or axes 2 and 3 are not principal axes through the shear centre.
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
    if abs(product) > PRINCIPAL * max(I2, I3):
        angle = math.degrees(math.atan2(-2 * product, I2 - I3) / 2)
        raise ValueError(
            f"found principal axes at {angle:.4g} deg from axes 2 and 3, expected none; turn the points by {-angle:.4g} deg, and 'up' of the beam"
        )
    away = math.dist(section.get_sc(), section.get_c())
    if away > CENTRED * math.sqrt(A):
        raise ValueError(
            f"found a shear centre {away:.3g} m from the centroid, expected both at one point: bending would twist the beam"
        )
    along2, along3 = (float(value) for value in section.get_as())
    return A, I2, I3, float(section.get_j()), along2 / A, along3 / A
