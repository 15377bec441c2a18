"""Drawing of a model, from its description: shapes of its bodies and symbols of its elements."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from importlib import import_module
from typing import Any

import numpy as np

from ...elements.element import Element, Joint
from ...elements.spatial.flexible.bodies import FloatingFrame
from ...elements.spatial.flexible.interface import FlexibleInterface
from ...model.model_data import ModelData
from ...model.wheels import radius_of
from ...reading.formula.formula import Formula
from ...reading.joint_name import JointName
from ...reading.marker import GROUND, MarkerReference
from .bodies import derived_shape, given_shapes
from .deformed import deformation_scales, deformed_body, interface_bodies, largest_stress, modal_bodies
from .draft import Draft, Site
from .poses import Poses, described_poses, placed
from .scene_graph import Anchor, Drawing, Mark, Name, Part, body_colors
from .surroundings import with_surroundings

UNIT, CROWDED = 0.024, 10
"""Unit of symbols relative to the mechanism's size, and number of elements above which symbols become smaller."""
BEAM = "beam"
"""Symbol of the elements of beams."""
THICK = 5 / 6
"""Half the thickness of bars, in units of symbols."""
FRONT = 2.0
"""Distance of planar symbols in front of bodies, in units of symbols."""
Joints = dict[str, tuple[Any, Site | None, Site | None]]


def drawing_of(
    data: ModelData, marks: Mapping[str, Mark] | None = None, scale: float = 1.0, along: Poses | None = None
) -> Drawing:
    """Return the drawing of a model.

    `marks`: joints to mark. `scale`: factor on the usual size of symbols. `along`: motion along which a drawing in
    space shows the road or the floor. Raises InputError if a mesh cannot be read.
    """
    poses = described_poses(data)
    sites = _Sites(data, poses)
    wheels = _wheels(data)
    shaped = {
        name: given_shapes(name, body, data.dimensions, wheels.get(name, 0.0)) for name, body in data.bodies.items()
    }
    of_interfaces, modal = interface_bodies(data), modal_bodies(data)
    for name, body in data.bodies.items():
        if isinstance(body, FloatingFrame) and (surface := deformed_body(name, body)) is not None:
            shaped[name] = [surface]
    size = _size(data, sites, shaped)
    of_beams = _first_nodes(data)
    own = (name for name in data.bodies if name not in of_interfaces and name not in modal)
    colors = body_colors(name for name in own if of_beams.get(name, name) == name)
    colors |= {name: colors[first] for name, first in (of_interfaces | of_beams).items()}
    unit = scale * UNIT * size * math.sqrt(min(1.0, CROWDED / max(1, len(data.joints) + len(data.forces))))
    bare = {name for name, found in shaped.items() if not any(part.solids for part in found)}
    drafts = [_drawn(name, element, data, sites, size, colors, unit, bare) for name, element in _elements(data)]
    parts = [part for draft in drafts for part in draft.parts]
    having = {part.body for part in parts if part.role == "body"}
    points = sites.on_bodies()
    for name, body in data.bodies.items():
        if name in of_interfaces or name in modal:
            continue
        places = {tuple(np.round(point / (1e-3 * size)).astype(int)) for point in points[name]}
        if not shaped[name] and not wheels.get(name) and not (name in having and len(places) <= 1):
            shaped[name] = [derived_shape(name, body, data.dimensions, points[name], size, THICK * unit / scale)]
    bodies = [part for found in shaped.values() for part in found]
    gravity = np.zeros(3)
    gravity[: data.dimensions] = data.gravity
    masses = {name: body.mass for name, body in data.bodies.items() if name not in modal}
    weight = sum(masses.values()) * (float(np.linalg.norm(gravity)) or 1.0)
    heaviest = max(masses, key=lambda name: masses[name], default="")
    loads = {
        draft.owner: draft.i.anchor
        for draft in drafts  # an element drawn at a joint's point may act on its body as a whole
        if draft.i is not None and not (isinstance(draft.element, Joint) and any(draft.element.parts(JointName)))
    }
    drawing = Drawing(
        data.name, data.dimensions, size, unit, colors, (*bodies, *parts), tuple(link for d in drafts for link in d.links),
        tuple(_names(data, [name for name in masses if name not in of_interfaces], drafts)), loads, heaviest, gravity, weight, marks or {}, deformation_scales(data),
        largest_stress(bodies, poses if along is None else along),
    )  # fmt: skip
    return drawing if along is None else with_surroundings(drawing, data, along)


def _wheels(data: ModelData) -> dict[str, float]:
    """Return the radius of the wheel that a tyre draws, by body, m."""
    return {tyre.i.body: radius_of(tyre) or 0.0 for tyre in data.forces.values() if tyre.symbol == "tyre"}  # type: ignore[attr-defined]


def _first_nodes(data: ModelData) -> dict[str, str]:
    """Return the first node of the beam of each node of a beam."""
    found: dict[str, str] = {}
    for element in data.forces.values():
        if element.symbol == BEAM:
            nodes = [marker.body for _, marker in element.markers()]
            first = next((found[node] for node in nodes if node in found), min(nodes, key=list(data.bodies).index))
            found |= dict.fromkeys(nodes, first)
    return found


def _elements(data: ModelData) -> Iterator[tuple[str, Element]]:
    """Yield all elements with a place in space: none that hold modal coordinates or interfaces."""
    modal = modal_bodies(data)
    for name, joint in data.joints.items():
        if not isinstance(joint, FlexibleInterface) and getattr(getattr(joint, "i", None), "body", "") not in modal:
            yield name, joint
    yield from data.forces.items()


class _Sites:
    """Markers of a model as places on its bodies."""

    def __init__(self, data: ModelData, poses: Poses) -> None:
        self.data, self.poses = data, poses
        self.used: dict[str, list[np.ndarray]] = {name: [] for name in (*data.bodies, GROUND)}
        for joint in data.joints.values():
            if isinstance(joint, FlexibleInterface):
                self.of(joint.i)

    def of(self, marker: MarkerReference) -> Site:
        """Return the place of a marker on its body and in ground axes."""
        point, axes = placed(self.data, marker)
        origin, turned = self.poses.pose(marker.body, 0)
        self.used[marker.body].append(point)
        return Site(marker.body, point, axes, origin + turned @ point, turned @ axes)

    def on_bodies(self) -> dict[str, list[np.ndarray]]:
        """Return the points of each body: those that elements use, and the body's own markers."""
        found = {}
        for name, body in self.data.bodies.items():
            own = [placed(self.data, MarkerReference(body=name, marker=marker))[0] for marker in body.markers]
            found[name] = [*self.used[name], *own]
        return found

    def in_ground(self) -> np.ndarray:
        """Return all points in ground axes, shape (n, 3)."""
        every, modal = {**self.on_bodies(), GROUND: self.used[GROUND]}, modal_bodies(self.data)
        return np.array(
            [
                self.poses.pose(name, 0)[0] + self.poses.pose(name, 0)[1] @ point
                for name, points in every.items()
                for point in points
            ]
            + [self.poses.pose(name, 0)[0] for name in self.data.bodies if name not in modal]
        )


def _size(data: ModelData, sites: _Sites, shaped: Mapping[str, list[Part]]) -> float:
    """Return the diagonal of the box around all points and given shapes, m."""
    for _, element in _elements(data):
        for marker in element.markers():
            sites.of(marker[1])
    points = [sites.in_ground()]
    for name, parts in shaped.items():
        origin, turned = sites.poses.pose(name, 0)
        points += [origin + solid.vertices @ turned.T for part in parts for solid in part.solids]
        points += [origin + line.points @ turned.T for part in parts for line in part.lines]
    for _, element in _elements(data):
        radius = getattr(element, "radius", None)  # radius of a circle in contact
        if isinstance(radius, float):
            points.append(points[0][:1] + radius * np.array([[1.0, 1, 0], [-1, -1, 0]]))
    every = np.vstack(points)
    spread = float(np.linalg.norm(every.max(axis=0) - every.min(axis=0)))
    return spread or _own_size(data)


def _own_size(data: ModelData) -> float:
    """Return the size of bodies at one point, from their moments of inertia."""
    moments = [
        (body.inertia if data.dimensions == 2 else max(body.principal_moments())) / body.mass
        for body in data.bodies.values()
    ]
    return 6 * math.sqrt(max(moments))


def _drawn(
    name: str, element: Element, data: ModelData, sites: _Sites, size: float, colors: Mapping[str, str], unit: float,
    bare: Collection[str],
) -> Draft:  # fmt: skip
    """Return the symbol of one element. `bare`: bodies without solids; an element between other nodes of a beam needs no symbol."""
    joints: Joints = {
        other: (joint, *_ends(joint, data, sites)) for _, ref in element.parts(JointName) if (other := ref.joint)
        for joint in [data.joints[other]]
    }  # fmt: skip
    i, j = _ends(element, data, sites)
    if i is None and joints:
        _, i, j = next(iter(joints.values()))
    if i is None:
        i = _of_formula(element, data, sites)
    down = np.zeros(3)
    down[: data.dimensions] = data.gravity
    length = float(np.linalg.norm(down))
    fallback = np.array([0.0, -1.0, 0.0]) if data.dimensions == 2 else np.array([0.0, 0.0, -1.0])
    below = down / length if length else fallback
    front = FRONT * unit if data.dimensions == 2 else 0.0
    draft = Draft(name, element, unit, size, i, j, joints, front, below, dict(colors))
    symbols = import_module(f".symbols.{'planar' if data.dimensions == 2 else 'spatial'}", __package__).SYMBOLS
    usual = symbols["joint" if isinstance(element, Joint) else "any_force"]
    if element.symbol != BEAM or any(marker.body in bare for _, marker in element.markers()):
        symbols.get(element.symbol or element.kind, usual)(draft)
    return draft


def _ends(element: Element, data: ModelData, sites: _Sites) -> tuple[Site | None, Site | None]:
    found = (getattr(element, end, None) for end in ("i", "j"))
    i, j = (sites.of(marker) if isinstance(marker, MarkerReference) else None for marker in found)
    return i, j


def _of_formula(element: Element, data: ModelData, sites: _Sites) -> Site | None:
    """Return the centre of mass of the first body that an element's formulas name."""
    for _, formula in element.parts(Formula):
        for body in formula.bodies():
            if body in data.joints:
                return sites.of(data.joints[body].i)
            if body != GROUND:
                origin, turned = sites.poses.pose(body, 0)
                return Site(body, np.zeros(3), np.eye(3), origin, turned)
    return None


def _names(data: ModelData, bodies: Iterable[str], drafts: Iterable[Draft]) -> Iterator[Name]:
    for name in bodies:
        shown = name.rpartition(".")[0] if isinstance(data.bodies[name], FloatingFrame) else name
        yield Name(shown, "body", Anchor(name, np.zeros(3)))
    for draft in drafts:
        if draft.i is not None:
            role = "joint" if isinstance(draft.element, Joint) else "force"
            yield Name(draft.owner, role, _middle(draft) if role == "force" else draft.i.anchor)  # type: ignore[arg-type]


def _middle(draft: Draft) -> Anchor:
    """Return the place of a force's name: halfway between its points in the initial drawing."""
    assert draft.i is not None
    if draft.j is None or not draft.links:
        return draft.i.anchor
    half = (draft.j.in_ground - draft.i.in_ground) / 2
    return Anchor(draft.i.body, draft.i.point + draft.i.axes @ draft.i.turned.T @ half)
