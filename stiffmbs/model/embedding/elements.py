"""Spatial counterparts of planar elements, by class."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import singledispatch
from typing import Any

import numpy as np

from ...elements.element import Element, Joint
from ...elements.forces.applied import AppliedForce, AppliedTorque
from ...elements.forces.bushing import Bushing
from ...elements.forces.contact import Contact
from ...elements.forces.exact_beam import BeamSection, ExactBeam
from ...elements.forces.python_force import PythonForce
from ...elements.forces.torsion_spring import TorsionSpring
from ...elements.joints.point_on_line import PointOnLine
from ...elements.joints.prismatic import Prismatic
from ...elements.joints.revolute import Revolute
from ...elements.spatial.branches import FARTHEST
from ...elements.spatial.spatial_kinds import FORCES, JOINTS
from ...elements.turns import TURN, full_turns
from ...errors import InputError
from ...reading.python_function import PythonFunction
from .fields import oriented, plain, same
from .formulas import QUARTER, Angles, Written, across, along, turned


@singledispatch
def element_in_space(element: Element, angles: Angles) -> Written:
    """Return the fields of the equivalent spatial element in the x-y plane.

    By default that is the spatial kind of the same name, with fields of the same meaning. `element`: planar element.
    `angles`: angles of its model. Raises InputError if there is no equivalent.
    """
    kinds = JOINTS if isinstance(element, Joint) else FORCES
    if element.kind not in kinds:
        raise InputError(
            f"found the type {element.kind}, which has no counterpart in space, expected one of {', '.join(sorted(kinds))}"
        )
    return same(element, angles)


SURFACES = {"circle": "sphere", "hole": "hollow"}


@element_in_space.register(AppliedForce)
def force(element: AppliedForce, angles: Angles) -> Written:
    """Return a force without a component along the normal."""
    return same(element, angles, force=[*plain(element.force, angles), 0])


@element_in_space.register(AppliedTorque)
def torque(element: AppliedTorque, angles: Angles) -> Written:
    """Return a torque about the normal."""
    return same(element, angles, torque=[0, 0, plain(element.torque, angles)])


@element_in_space.register(TorsionSpring)
def torsion_spring(element: TorsionSpring, angles: Angles) -> Written:
    """Return a torsion spring, with a large initial angle subtracted from its marker and free angle."""
    initial = angles.initial(element.i, element.j)
    if angles.later or abs(initial) <= QUARTER:
        return same(element, angles)
    i = oriented(element.i, angles, lambda angle: turned(angle - initial))
    return same(element, angles, i=i, free_angle=element.free_angle - initial)


@element_in_space.register(Bushing)
def bushing(element: Bushing, angles: Angles) -> Written:
    """Return a bushing of six components, three of them without stiffness and damping."""
    matrices = {name: _six_by_six(getattr(element, name)) for name in ("stiffness", "damping")}
    preload = _six(element.preload, 0) if any(element.preload) else None
    law = None if element.law_angle is None else plain(element.law_angle, angles)
    return same(element, angles, **matrices, preload=preload, law_angle=None, law_about_z=law)


def _six(three: Any, nothing: object) -> list[object]:
    """Return six components with the given ones along x, along y and about z."""
    x, y, angle = three
    return [x, y, nothing, nothing, nothing, angle]


def _six_by_six(three: Iterable[Iterable[float | None]]) -> list[object] | None:
    """Return a matrix, by its diagonal if it is diagonal; None if it is zero."""
    rows = [[part or None for part in row] for row in three]
    if not any(part for row in rows for part in row):
        return None
    diagonal = [row[k] for k, row in enumerate(rows)]
    if any(part for k, row in enumerate(rows) for part in (*row[:k], *row[k + 1 :])):
        return _six([_six(row, None) for row in rows], [None] * 6)
    return _six(diagonal, None)


@element_in_space.register(ExactBeam)
def exact_beam(element: ExactBeam, angles: Angles) -> Written:
    """Return a beam element without stiffness across the plane."""
    gains = None if element.bowing is None else [*element.bowing, 0]
    K = _six_by_six(element.stiffness)
    return same(element, angles, stiffness=K, unloaded=_six(element.unloaded, 0), bowing=gains)


@element_in_space.register(BeamSection)
def beam_section(element: BeamSection, angles: Angles) -> Written:
    """Return a section of a beam without stiffness across the plane."""
    rows = _six([_six(row, 0.0) for row in element.stiffness], [0.0] * 6)
    return same(element, angles, stiffness=rows, unloaded=_six(element.unloaded, 0))


@element_in_space.register(Contact)
def contact(element: Contact, angles: Angles) -> Written:
    """Return a sphere in place of a circle; their contacts in the plane are equivalent."""
    if element.surface == "line":
        plane = oriented(element.j, angles, across)
        written = same(element, angles, surface=None, surface_radius=None, j=plane)
    else:
        written = same(element, angles, surface=SURFACES[element.surface])
    return written | {"type": "sphere_contact"}


@element_in_space.register(PythonForce)
def python_force(element: PythonForce, angles: Angles) -> Written:
    """Return a force whose function returns six components."""
    planar = element.function

    def function(x: np.ndarray) -> list[object]:
        return _six(planar.function(x), 0.0)

    return same(element, angles, function=PythonFunction(function, planar.derivatives))


@element_in_space.register(Revolute)
def revolute(joint: Revolute, angles: Angles) -> Written:
    """Return a joint whose angle starts in the turn of the described angles."""
    turns = 0 if angles.later else full_turns(angles.initial(joint.i, joint.j))
    return same(joint, angles, turns=turns or None)


@element_in_space.register(Prismatic)
def prismatic(joint: Prismatic, angles: Angles) -> Written:
    """Return a joint along z of rotated markers, which would keep a half turn between the markers if drawn so."""
    apart = math.degrees(abs(math.remainder(angles.initial(joint.i, joint.j), TURN)))
    if apart >= FARTHEST:
        raise InputError(f"found its markers drawn {apart:.4g} degrees apart, expected less than {FARTHEST:g} in space")
    return point_on_line(joint, angles)


@element_in_space.register(PointOnLine)
def point_on_line(joint: PointOnLine | Prismatic, angles: Angles) -> Written:
    """Return a joint along z of rotated markers."""
    return same(joint, angles, i=oriented(joint.i, angles, along), j=oriented(joint.j, angles, along))
