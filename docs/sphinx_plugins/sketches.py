"""Sketches of joints and forces: each kind between two bars, by the symbols that drawings show."""

from __future__ import annotations

from typing import Any

import numpy as np

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.element import Element, Force
from stiffmbs.elements.samples import Samples
from stiffmbs.model import model as plane
from stiffmbs.model import spatial_model as space
from stiffmbs.reading.joint_name import JointName
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.picture import Shown, picture
from stiffmbs.show.drawing.poses import described_poses
from stiffmbs.show.drawing.view import view_named

LEFT, RIGHT = (-0.5, 0.0, 0.0), (0.5, 0.0, 0.0)
"""The ends of a bar."""
FIELDS: dict[str, dict[str, Any]] = {
    "spring_damper": {"damping": 1},
    "contact": {"radius": 0.25},
    "sphere_contact": {"radius": 0.25},
    "force": {"force": (0, -1)},
    "gear": {"ratio": 2},
    "rack_and_pinion": {"pitch_radius": 0.3},
    "point_on_curve": {"radius": "0.5 m*(1 + 0.2*cos(2*angle))"},
    "tangent_to_curve": {"radius": "0.5 m*(1 + 0.2*cos(2*angle))"},
}
"""Fields with which a sketch tells more."""
TURNED = {"universal": {"z": (0, 1, 0)}, "perpendicular": {"z": (0, 1, 0)}, "planar": {"z": (0, 0, 1)}}
"""The orientation of marker j where it is not that of its body."""
LARGE = 2.8
"""The scale of symbols."""


class _InSketch(Samples):
    """Markers at the ends that two bars turn to each other."""

    def __init__(self, model: Any, dimensions: int) -> None:
        ends = (("a", RIGHT), ("b", LEFT))
        super().__init__(lambda k: {"body": ends[k % 2][0], "point": ends[k % 2][1][:dimensions]}, model.joints)


def _bars(dimensions: int, gap: float, turn: float) -> Any:
    """Two bars whose ends are apart by a gap, the second one turned, rad."""
    if dimensions == 2:
        model: Any = stiffmbs.Model(gravity=(0, -9.81))
        model.add("a", stiffmbs.Body(mass=1, inertia=1 / 12, position=(-0.5 - gap / 2, 0)))
        b = np.array([gap / 2, 0]) + 0.5 * np.array([np.cos(turn), np.sin(turn)])
        model.add("b", stiffmbs.Body(mass=1, inertia=1 / 12, position=tuple(b), angle=turn))
        return model
    model = spatial.Model(gravity=(0, 0, -9.81))
    moments = (0.001, 1 / 12, 1 / 12)
    model.add("a", spatial.Body(mass=1, inertia=moments, position=(-0.5 - gap / 2, 0, 0)))
    axes = {"x": (np.cos(turn), np.sin(turn), 0), "z": (0, 0, 1)}
    b = (gap / 2 + 0.5 * np.cos(turn), 0.5 * np.sin(turn), 0)
    model.add("b", spatial.Body(mass=1, inertia=moments, position=b, orientation=axes))
    return model


def _held(model: Any, dimensions: int) -> None:
    """Joints with ground for kinds that name joints."""
    family = stiffmbs if dimensions == 2 else spatial
    ends = {name: {"body": name, "point": end[:dimensions]} for name, end in (("a", RIGHT), ("b", LEFT))}
    for name, (_, marker) in zip(("pin", "second_pin"), ends.items(), strict=True):
        at = model.data_type.model_construct(**model._content()).initial_marker(family.Marker(**marker)).point
        model.add(name, family.Revolute(i=marker, j={"body": "ground", "point": tuple(float(x) for x in at)}))
    model.add("slider", family.Prismatic(i="b", j="ground"))


def sketch(dimensions: int, kind: str) -> None:
    """Draw one kind as a figure of pyplot's."""
    family = plane if dimensions == 2 else space
    element: type[Element] = {**family.JOINTS, **family.FORCES}[kind]
    apart = issubclass(element, Force) and kind not in (
        "bushing",
        "joint_friction",
        "torsion_spring",
        "force",
        "torque",
    )
    gap = 1.0 if apart or kind in ("distance", "gear", "revolute_spherical", "coupler") else 0.0
    model = _bars(dimensions, gap, 0.0 if kind == "prismatic" else 0.6)
    refers = any("JointName" in str(field.annotation) for field in element.model_fields.values())
    if refers:
        _held(model, dimensions)
    given = FIELDS.get(kind) or {name: value for name, value in element.forms[0].items() if name not in ("i", "j")}
    if kind == "force" and dimensions == 3:
        given = {"force": (0, 0, -1)}
    if dimensions == 3 and kind in TURNED:
        given = {"j": {"body": "b", "point": LEFT, "orientation": TURNED[kind]}}
    made = _InSketch(model, dimensions).made(element, given)
    named = {name.joint for _, name in made.parts(JointName)}
    model.joints = {name: joint for name, joint in model.joints.items() if name in named}
    (model.forces if isinstance(made, Force) else model.joints)[kind] = made
    used = {marker.body for element in (*model.joints.values(), made) for _, marker in element.markers()}
    model.bodies = {name: body for name, body in model.bodies.items() if name in used}
    data = model.data_type.model_construct(**model._content())
    drawing = drawing_of(data, scale=LARGE)
    sheet = picture(
        drawing, described_poses(data), view_named("", dimensions, drawing.gravity), Shown(False, False), on_screen=True
    )
    sheet.set_size_inches(4.2, 4.2 * sheet.get_figheight() / sheet.get_figwidth())
