"""Rotate and translate a scene as a whole, with markers of the ground, roads and gravity."""

from __future__ import annotations

import ast
import copy
import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import conjugate, from_matrix, matrix, product
from stiffmbs.reading.formula.field import FormulaOf

from ..random_scenes.draft import GROUND, Content
from .change import MODAL, VECTORS, Change, Channels, vector, with_vector
from .formulas import call_of, coordinate_of, replaced, with_other_formulas
from .typed import Mapper, NotLegitimate, class_of, has_road, mapped

LAB = "lab"
"""Marker of the ground at its original origin."""
ALONG = ("dx", "dy", "dz", "vx", "vy", "vz", "wx", "wy", "wz", "accx", "accy", "accz", "wdtx", "wdty", "wdtz")
"""Measures along the axes of the ground or of a third marker."""


@dataclass(frozen=True)
class Placing:
    """Pose of the ground axes of the scene in those of the transformed scene.

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
    translation : ndarray, shape (3,)
    dimensions : int
    """

    rotation: np.ndarray
    translation: np.ndarray
    dimensions: int

    @property
    def angle(self) -> float:
        """Angle of the rotation about z."""
        return math.atan2(self.rotation[1, 0], self.rotation[0, 0])

    def point(self, place: list[float]) -> list[float]:
        """Return a point in the transformed scene."""
        return self.listed(self.rotation @ _three(place) + self.translation)

    def direction(self, components: list[float]) -> list[float]:
        """Return a vector in the transformed scene."""
        return self.listed(self.rotation @ _three(components))

    def listed(self, components: np.ndarray) -> list[float]:
        """Return the components of a planar or spatial scene."""
        return [float(part) for part in components[: self.dimensions]]

    def lab(self) -> Content:
        """Return the placement of the marker `LAB` on the ground."""
        return self.marker({"body": GROUND})

    def marker(self, marker: Content) -> Content:
        """Return the placement of a marker of the ground."""
        point = self.point(marker.get("point", [0.0, 0.0, 0.0][: self.dimensions]))
        if self.dimensions == 2:
            return {"point": point, "angle": marker.get("angle", 0.0) + self.angle}
        return {"point": point, "orientation": self.orientation(marker.get("orientation", [1.0, 0.0, 0.0, 0.0]))}

    def orientation(self, found: list[Any]) -> list[float]:
        """Return an orientation, a quaternion or a matrix, in the transformed scene."""
        axes = matrix(found) if len(found) == 4 else np.array(found)
        return [float(part) for part in from_matrix(self.rotation @ axes)]


def placed(content: Content, placing: Placing, what: str) -> Change:
    """Return a rotated and translated scene.

    Raises
    ------
    NotLegitimate
        When an element has numbers along the ground's axes that cannot be rotated.
    """
    replace = _replace(placing, content.get("joints", ()))
    mapper = _Moved(placing, replace)
    found = with_other_formulas(copy.deepcopy(content), replace)
    dimensions = placing.dimensions
    if "gravity" in content:
        found["gravity"] = placing.direction(content["gravity"])
    found["markers"] = {LAB: placing.lab()}
    found["bodies"] = {name: _body(body, placing) for name, body in found["bodies"].items()}
    for section in ("joints", "forces"):
        for name, entry in found.get(section, {}).items():
            described = class_of(section, entry, dimensions)
            changed = mapped(entry, described, mapper)
            if has_road(described):
                changed.setdefault("j", f"{GROUND}.{LAB}")
            _turn_components(changed, described, placing)
            found[section][name] = changed
    return Change(what, found, lambda channels, _: _back(channels, placing, content.get("use", ())))


def _body(body: Content, placing: Placing) -> Content:
    found = dict(body)
    if "start" in body:
        found |= {end: placing.point(body[end]) for end in ("start", "end")}
        return found | ({"up": placing.direction(body["up"])} if "up" in body else {})
    found["position"] = placing.point(body.get("position", [0.0, 0.0, 0.0][: placing.dimensions]))
    if "velocity" in body:
        found["velocity"] = placing.direction(body["velocity"])
    if placing.dimensions == 2:
        return found | {"angle": body.get("angle", 0.0) + placing.angle}
    return found | {"orientation": placing.orientation(body.get("orientation", [1.0, 0.0, 0.0, 0.0]))}


class _Moved(Mapper):
    def __init__(self, placing: Placing, replace: Any) -> None:
        self._placing, self._replace = placing, replace

    def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
        return replaced(value, self._replace)

    def marker(self, value: Any) -> Any:
        """Place a marker of the ground in the moved axes."""
        if value == GROUND:
            return f"{GROUND}.{LAB}"
        if isinstance(value, dict) and value["body"] == GROUND:
            return {"body": GROUND, **self._placing.marker(value)}
        return value


def _turn_components(entry: Content, described: type[Any], placing: Placing) -> None:
    """Rotate the components of an element along the ground's axes."""
    field = described.model_fields.get("axes")
    axes = entry.get("axes", field.default if field is not None else None)
    if axes != GROUND or "frame" in entry:
        return
    for name, how in (described.reflected or {}).items():
        if name not in entry or how == "angle":
            continue
        if how not in ("vector", "rotations"):
            raise NotLegitimate(f"{name} along the ground's axes")
        if isinstance(entry[name], list):
            entry[name] = _turned(entry[name], placing)


def _turned(components: list[Any], placing: Placing) -> list[Any]:
    """Return formulas, or numbers, of the components along other axes."""
    rows = placing.rotation[: placing.dimensions, : placing.dimensions]
    return [
        " + ".join(f"({float(part)!r})*({each})" for part, each in zip(row, components, strict=True)) for row in rows
    ]


def _replace(placing: Placing, joints: Collection[str]) -> Any:
    """Return the substitution for coordinates, measures and reactions."""
    axes = "xyz"[: placing.dimensions]

    def mixed(names: list[str], axis: str) -> str:
        column = placing.rotation[: placing.dimensions, "xyz".index(axis)]
        return "(" + " + ".join(f"({float(part)!r})*{name}" for part, name in zip(column, names, strict=True)) + ")"

    def replace(node: ast.expr) -> str | None:
        """Return the text of a coordinate, measure or reaction in the axes before the motion; None to keep it."""
        coordinate, call = coordinate_of(node), call_of(node)
        if coordinate:
            body, name = coordinate
            if name in axes:
                moved = zip(axes, placing.translation, strict=False)
                return mixed([f"({body}.{axis} - ({float(part)!r}))" for axis, part in moved], name)
            if name[0] == "v" and name[1:] in axes:
                return mixed([f"{body}.v{axis}" for axis in axes], name[1:])
            is_of_body = name == "angle" and body not in joints
            return f"({body}.angle - ({placing.angle!r}))" if is_of_body else None
        if call is None:
            return None
        name, markers = call
        if name[0] in "ft":
            return (
                mixed([f"{name[0]}{axis}({markers[0]})" for axis in axes], name[1:])
                if placing.dimensions == 3 or name[0] == "f"
                else None
            )
        lab = f"{GROUND}.{LAB}"
        markers = [lab if marker == GROUND else marker for marker in markers]
        markers += [lab] if len(markers) == 1 else []
        markers += [lab] if len(markers) == 2 and name in ALONG else []
        return f"{name}({', '.join(markers)})"

    return replace


def _back(channels: Channels, placing: Placing, parts: Collection[str]) -> Channels:
    """Return channels along the axes of the original, relative to its origin; those of a part itself are its states."""
    found, inverse = dict(channels), placing.rotation.T
    for owner in dict.fromkeys(name.rpartition(".")[0] for name in channels):
        if owner in parts:
            continue
        for kind, labels in VECTORS.items():
            values = vector(channels, owner, labels)
            if values is not None:
                moved = values - placing.translation[:, None] if kind == "{}" else values
                with_vector(found, owner, labels, inverse @ moved)
        if {f"{owner}.angle", f"{owner}.omega"} <= channels.keys():  # bodies; joints have angles too
            found[f"{owner}.angle"] = channels[f"{owner}.angle"] - placing.angle
        if f"{owner}.q0" in channels and not MODAL.search(owner):
            turned = conjugate(from_matrix(placing.rotation))
            rows = np.array([channels[f"{owner}.q{k}"] for k in range(4)]).T
            for k, series in enumerate(np.array([product(turned, row) for row in rows]).T):
                found[f"{owner}.q{k}"] = series
    return found


def _three(components: list[float]) -> np.ndarray:
    return np.array([*components, 0.0][:3])
