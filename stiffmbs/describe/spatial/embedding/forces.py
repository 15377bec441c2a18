"""Planar forces in space."""

from __future__ import annotations

import math
from typing import Any

from ....errors import InputError
from ...python_function import PythonFunction
from .angles import QUARTER, Angles
from .fields import oriented, plain, same
from .markers import Written, across, turned

PLANE = (0, 1, 5)
"""Indices of the in-plane components: along x, along y, about z."""
SURFACES = {"circle": "sphere", "hole": "hollow"}


def force(element: Any, angles: Angles) -> Written:
    """Return a force without a component along the normal."""
    return same(element, angles, force=[*plain(element.force, angles), 0])


def torque(element: Any, angles: Angles) -> Written:
    """Return a torque about the normal."""
    return same(element, angles, torque=[0, 0, plain(element.torque, angles)])


def torsion_spring(element: Any, angles: Angles) -> Written:
    """Return a torsion spring, with a large initial angle subtracted from its marker and free angle."""
    initial = angles.initial(element.i, element.j)
    if abs(initial) <= QUARTER:
        return same(element, angles)
    i = oriented(element.i, angles, lambda angle: turned(angle - initial))
    return same(element, angles, i=i, free_angle=element.free_angle - initial)


def bushing(element: Any, angles: Angles) -> Written:
    """Return a bushing of six components, three of them without stiffness and damping."""
    initial = angles.initial(element.i, element.j)
    if (element.stiffness[2][2] or element.law_angle is not None) and abs(initial) >= math.pi:
        raise InputError(
            f"found its markers drawn {math.degrees(initial):.4g} degrees apart, expected less than half a turn in space"
        )
    law = element.law_angle
    return same(
        element,
        angles,
        stiffness=_six_by_six(element.stiffness),
        damping=_six_by_six(element.damping),
        preload=_six(element.preload, 0) if any(element.preload) else None,
        law_angle=None,
        law_about_z=None if law is None else plain(law, angles),
    )


def _six(three: Any, nothing: Any) -> list[Any]:
    values = dict(zip(PLANE, three, strict=True))
    return [values.get(k, nothing) for k in range(6)]


def _six_by_six(three: Any) -> list[Any] | None:
    """Return a matrix, by its diagonal if it is diagonal; None if it is zero."""
    rows = [[part or None for part in row] for row in three]
    if not any(part for row in rows for part in row):
        return None
    diagonal = [row[k] for k, row in enumerate(rows)]
    if any(part for k, row in enumerate(rows) for part in (*row[:k], *row[k + 1 :])):
        return _six([_six(row, None) for row in rows], [None] * 6)
    return _six(diagonal, None)


def contact(element: Any, angles: Angles) -> Written:
    """Return a sphere in place of a circle; their contacts in the plane are equivalent."""
    if element.surface == "line":
        plane = oriented(element.j, angles, across)
        written = same(element, angles, surface=None, surface_radius=None, j=plane)
    else:
        written = same(element, angles, surface=SURFACES[element.surface])
    return written | {"type": "sphere_contact"}


def python_force(element: Any, angles: Angles) -> Written:
    """Return a force whose function returns six components."""
    planar = element.function

    def function(x: Any) -> list[Any]:
        return _six(planar.function(x), 0.0)

    return same(element, angles, function=PythonFunction(function, planar.derivatives))
