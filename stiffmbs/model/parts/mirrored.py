"""Elements of mirrored parts.

`Element.reflected` defines how the fields of an element change in a mirror image. Elements without it are refused,
because a wrong sign would give wrong results.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from ...elements.element import Element, Joint
from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import Described
from ...reading.formula.formula import Formula
from ...reading.formula.text import FormulaError
from ...reading.joint_name import JointName
from ...reading.marker import GROUND, MarkerReference
from ...reading.names import MOUNT
from ...reading.table import Table
from .mirrored_formula import MirroredNames, mirrored_law

if TYPE_CHECKING:
    from ...elements.body import AnyBody
    from .planar_frame import PlanarFrame
    from .spatial_frame import SpatialFrame

AnyState = TypeVar("AnyState", bound=Described)
ALONG_AXES = ("angle", "x", "y", "z", "about x", "about y", "about z")
"""Entries of `Element.reflected` that apply to laws."""


@dataclass(frozen=True)
class Mirror:
    """Mirror image of the elements of one instance of a part."""

    name: str  # name of the instance
    frame: PlanarFrame | SpatialFrame  # frame of the part in ground axes
    part: Any  # its validated sections, with local names, without mirroring
    mounts: Collection[str]  # local names of the bodies that it is mounted on

    def inside(self, marker: MarkerReference) -> bool:
        """Return True if a marker is on a body of the part, or is a marker of the part on its mount."""
        own = f"{marker.marker}.".startswith(f"{self.name}.") if marker.marker else marker.body in self.mounts
        return own or f"{marker.body}.".startswith(f"{self.name}.")

    def mirrored(self, element: Element, where: str) -> Element:
        """Return the mirror image of an element; InputError if that of the element or of a formula is not defined.

        Markers on `mount` are resolved when the part is placed.
        """
        if element.reflected is None:
            raise InputError(
                f"{where}: found the type {element.kind} in a mirrored part, expected one that can be mirrored"
            )
        changed: dict[str, object] = {}
        for name in type(element).model_fields:
            try:
                changed[name] = self._field(element, name, where)
            except FormulaError as error:
                alias = type(element).model_fields[name].alias or name
                raise InputError(f"{where}.{alias}: {error} (in {self.name})") from None
        return element.model_copy(update=changed)

    def mirrored_state(self, state: AnyState, where: str) -> AnyState:
        """Return a state or a system of states with mirrored coordinates in its formulas; its value is the same.

        InputError if the mirror image of a formula is not defined.
        """
        changed = {}
        for name in type(state).model_fields:
            try:
                changed[name] = self._image(getattr(state, name), 1.0, law=False)
            except FormulaError as error:
                raise InputError(f"{where}.{name}: {error} (in {self.name})") from None
        return state.model_copy(update=changed)

    def _field(self, element: Element, name: str, where: str) -> object:
        value, rule = getattr(element, name), (element.reflected or {}).get(name, "same")
        match value:
            case MarkerReference():
                return self._marker(value, rule)
            case (MarkerReference(), *_):
                return tuple(self._marker(marker, rule) for marker in value)
            case None | bool() | str():
                return value
        return self._image(value, self._signs(element, rule), rule in ALONG_AXES)

    def _signs(self, element: Element, rule: str) -> float | tuple[float, ...]:
        """Return the sign of a field, or the signs of its components."""
        if rule == "same":
            return 1.0
        forces, along = self._axes(element)
        rotations = self.frame.rotation_signs  # independent of the `axes` of a bushing
        match rule:
            case "vector":
                return forces
            case "rotations":
                return along
            case "components" | "matrix":
                return (*forces, *rotations)
            case "angle":
                return rotations[-1]
            case "pitch":
                return forces[-1] * rotations[-1]
            case "x" | "y" | "z":
                return forces["xyz".index(rule)]
            case "about x" | "about y" | "about z":
                return rotations["xyz".index(rule[-1])]
        sign = 1.0
        for joint in rule.split():
            sign *= self._coordinate(getattr(element, joint))
        return sign

    def _axes(self, element: Element) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the signs of forces and of rotations along the axes of an element's components."""
        own = {name: getattr(element, name) for name in ("frame", "axes") if name in type(element).model_fields}
        frame = own.get("frame")
        in_ground = own.get("axes") == "ground" and frame is None
        if frame is not None and not self._own(frame):
            raise FormulaError(f"found the frame '{frame.label}' outside of a mirrored part, expected a marker in it")
        signs = self.frame.ground_signs() if in_ground else self.frame.signs
        if signs is None:
            raise FormulaError("found axes: ground, to which the part's mirror is oblique, expected axes of the part")
        turned = (self.frame.handedness,) if len(signs) == 2 else tuple(self.frame.handedness * sign for sign in signs)
        return signs, turned

    def _own(self, marker: MarkerReference) -> bool:
        return marker.body in self.mounts or self.inside(marker)

    def _coordinate(self, joint: JointName | None) -> float:
        if joint is None:
            return 1.0
        own: Joint | None = self.part.joints.get(joint.joint.removeprefix(f"{self.name}."))
        if own is None:
            raise FormulaError(f"found the joint '{joint}' outside of a mirrored part, expected one in it")
        if joint.coordinate_of(own) == "angle":
            return float(self.frame.rotation_signs[-1])
        return float(self.frame.signs[0 if len(self.frame.signs) == 2 else 2])

    def _along_joint(self, joint: str, channel: str) -> float | None:
        """Return the sign of a free coordinate of a joint of the part, or of its rate; None for any other name."""
        own: Joint | None = self.part.joints.get(joint.removeprefix(f"{self.name}."))
        if own is None or channel not in own.channels:
            return None
        coordinate = channel.removesuffix("_rate")
        if coordinate == "angle":
            return float(self.frame.rotation_signs[-1])
        if coordinate.startswith("displacement"):
            axis = {"displacement_x": 0, "displacement_y": 1}.get(coordinate, len(self.frame.signs) - 1)
            along_x = coordinate == "displacement" and len(self.frame.signs) == 2
            return float(self.frame.signs[0 if along_x else axis])
        raise FormulaError(
            f"found '{joint}.{channel}' in a mirrored part, expected a displacement, or an angle about one axis"
        )

    def _image(self, value: object, signs: Any, law: bool) -> Any:
        """Return a value with its signs applied; laws also change the sign of their argument."""
        match value:
            case tuple() if value and isinstance(value[0], tuple):
                rows = zip(value, signs, strict=True)
                return tuple(
                    tuple(self._image(x, a * b, law) for x, b in zip(row, signs, strict=True)) for row, a in rows
                )
            case tuple():
                each = signs if isinstance(signs, tuple) else itertools.repeat(signs, len(value))
                return tuple(self._image(x, sign, law) for x, sign in zip(value, each, strict=True))
            case Formula() | Table():
                return mirrored_law(
                    value, MirroredNames(self.frame, self._own, self._along_joint), signs, signs if law else 1.0
                )
            case bool():
                return value
            case int() | float():
                return value if signs == 1.0 else signs * value or 0.0
        return value

    def _marker(self, marker: MarkerReference, rule: str) -> MarkerReference:
        """Return the mirror image of a marker on the part; `rule` is the axis whose direction matters, if any."""
        if rule in ("x", "y", "z") and self._own(marker) and self.frame.signs["xyz".index(rule)] < 0:
            marker = self.frame.half_turned(self._placed(marker), rule)
        if marker.body in (*self.mounts, GROUND) or marker.marker is not None or not self.inside(marker):
            return marker
        return marker if marker.placement() is None else self.frame.mirror().placed(marker)

    def _placed(self, marker: MarkerReference) -> MarkerReference:
        """Return the explicit marker at the position of a named one."""
        if marker.marker is None:
            return marker
        named = self.part.markers if marker.body == MOUNT else self._body(marker).markers
        if marker.marker not in named:
            near = did_you_mean(marker.marker, named)
            raise FormulaError(
                f"found '{marker.label}'{near}, expected one of its markers ({', '.join(named) or 'none'})"
            )
        where = named[marker.marker]
        return marker.model_copy(
            update={"marker": None, **{name: getattr(where, name) for name in type(where).model_fields}}
        )

    def _body(self, marker: MarkerReference) -> AnyBody:
        name = marker.body.removeprefix(f"{self.name}.")
        if name not in self.part.bodies:
            raise FormulaError(f"found '{marker.label}' of a part within the part, expected a marker on the spot")
        return self.part.bodies[name]
