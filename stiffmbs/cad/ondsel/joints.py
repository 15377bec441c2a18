"""Joints of a scene with the equations of OndselSolver's joints.

OndselSolver measures displacements from marker I to marker J in the axes of I; the scene's joints measure those of their
marker i in the axes of j. A joint whose axes need not be parallel is therefore described with J as marker i.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..assembly import CadFault, Frame, Seat, Tie, at_angle, off_axis
from .tree import Item

SAME = {
    "FixedJoint": "fixed", "RevoluteJoint": "revolute", "CylindricalJoint": "cylindrical", "TranslationalJoint": "prismatic",
    "SphericalJoint": "spherical", "AtPointJoint": "spherical", "UniversalJoint": "universal", "NoRotationJoint": "orientation",
    "ConstantVelocityJoint": "constant_velocity", "ParallelAxesJoint": "parallel", "PerpendicularJoint": "perpendicular",
}  # fmt: skip
"""Joints with the equations of a scene's joint between the same markers."""


@dataclass(frozen=True)
class Ends:
    """Markers of a joint, and the other joints of the file by the parts that they connect.

    `drawn_i`, `drawn_j`: the markers in the world. `hinges`: the parts that revolute joints connect a part with.
    """

    i: Seat
    j: Seat
    drawn_i: Frame
    drawn_j: Frame
    hinges: Mapping[str | None, frozenset[str | None]]
    frames: Mapping[str | None, Frame]

    def offset(self, item: Item) -> Seat:
        """Return marker I moved by an offset along its z axis."""
        along = item.number("offset", 0.0) * self.i.frame.axes[:, 2]
        return Seat(self.i.part, Frame(self.i.frame.position + along, self.i.frame.axes))


def joint(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    """Yield the joints of the scene for a joint of the file."""
    kind = kind_of(item)
    if kind in SAME:
        yield Tie(name, SAME[kind], ends.i, ends.j)
    elif kind in OTHERS:
        yield from OTHERS[kind](name, item, ends)
    else:
        raise CadFault(f"line {item.line}, {name}: found {item.label}, expected one of {', '.join((*SAME, *OTHERS))}")


def _point_in_line(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield Tie(name, "point_on_line", ends.j, ends.i)


def _point_in_plane(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield Tie(name, "point_on_plane", ends.j, ends.offset(item))


def _line_in_plane(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield from _point_in_plane(name, item, ends)
    yield Tie(f"{name}_axes", "perpendicular", ends.i, ends.j)


def _planar(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield Tie(name, "planar", ends.offset(item), ends.j)


def _spherical_rod(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    length = item.number("distanceIJ", 0.0)
    if length <= 0:
        raise CadFault(f"line {item.line}, {name}: found the distance {length:g}, expected one above 0")
    yield Tie(name, "distance", ends.i, ends.j, {"length": length})


def _off_axis(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    distance = item.number("distanceIJ", 0.0)
    if distance < 0:
        raise CadFault(f"line {item.line}, {name}: found the distance {distance:g}, expected 0 or more")
    yield off_axis(name, ends.j, ends.i, distance)


def _parallel_rod(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield from _off_axis(name, item, ends)
    yield Tie(f"{name}_axes", "parallel", ends.i, ends.j)


def _hinged_rod(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield from _off_axis(name, item, ends)
    yield Tie(f"{name}_axes", "planar", ends.i, ends.j)


def _angle(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield at_angle(name, ends.i, ends.j, float(np.cos(item.number("theIzJz", 0.0))))


def _screw(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    yield Tie(name, "thread", ends.i, ends.j, {"pitch": _not_zero(name, item, "pitch")})


def _rack(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    """Yield x + R theta = constant: J's displacement along x of the rack I, and its angle about z, as drawn at the start."""
    radius = _not_zero(name, item, "pitchRadius")
    aligned = Seat(
        ends.i.part, Frame(ends.i.frame.position, ends.i.frame.axes @ _seen_from(ends.drawn_i, ends.drawn_j))
    )
    x = float(ends.drawn_i.axes[:, 0] @ (ends.drawn_j.position - ends.drawn_i.position))
    formula = f"dx({{j}}, {{i}}, {{i}}) + {radius!r}*az({{j}}, {{zero}}) - {x!r}"
    yield Tie(name, "equation", ends.i, ends.j, equation=formula, others={"zero": aligned})


def _gear(name: str, item: Item, ends: Ends) -> Iterator[Tie]:
    """Yield theta_J + (r_I/r_J) theta_I = (s + r_I/r_J) phi, with s = 1 for z axes of one direction and -1 for opposite ones.

    The angles theta of the wheels and phi of the line of their centres start at zero. They are relative to the part on
    which both wheels turn by revolute joints. The angle phi remains zero; its gradient is the force between the teeth.
    """
    ratio = _not_zero(name, item, "radiusI") / _not_zero(name, item, "radiusJ")
    carriers = ends.hinges.get(ends.i.part, frozenset()) & ends.hinges.get(ends.j.part, frozenset())
    if len(carriers) != 1:
        raise CadFault(
            f"line {item.line}, {name}: found {len(carriers)} parts on which both wheels turn by revolute joints, expected one"
        )
    carrier = next(iter(carriers))
    z, line = ends.drawn_i.axes[:, 2], ends.drawn_j.position - ends.drawn_i.position
    x = line - z * (z @ line)
    length = float(np.linalg.norm(x))
    if length == 0:
        raise CadFault(f"line {item.line}, {name}: found the centres of both wheels on one axis, expected them apart")
    centres = Frame(ends.drawn_i.position, np.column_stack([x / length, np.cross(z, x) / length, z]))
    drawn = {"zero_i": ends.drawn_i, "zero_j": ends.drawn_j, "line": centres}
    others = {key: Seat(carrier, frame.within(ends.frames[carrier])) for key, frame in drawn.items()}
    sense = 1 if z @ ends.drawn_j.axes[:, 2] > 0 else -1
    phi = "atan2(dy({j}, {i}, {line}), dx({j}, {i}, {line}))"
    formula = f"az({{j}}, {{zero_j}}) + {ratio!r}*az({{i}}, {{zero_i}}) - {sense + ratio!r}*{phi}"
    yield Tie(name, "equation", ends.i, ends.j, equation=formula, others=others)


def _seen_from(outer: Frame, inner: Frame) -> np.ndarray:
    axes: np.ndarray = outer.axes.T @ inner.axes
    return axes


def _not_zero(name: str, item: Item, label: str) -> float:
    value = item.number(label, 0.0)
    if not value:
        raise CadFault(f"line {item.line}, {name}: found no {label}, expected a number other than 0")
    return value


OTHERS: dict[str, Callable[[str, Item, Ends], Iterator[Tie]]] = {
    "PointInLineJoint": _point_in_line, "PointInPlaneJoint": _point_in_plane, "LineInPlaneJoint": _line_in_plane,
    "PlanarJoint": _planar, "SphSphJoint": _spherical_rod, "CylSphJoint": _off_axis, "RevCylJoint": _parallel_rod,
    "RevRevJoint": _hinged_rod, "AngleJoint": _angle, "ScrewJoint": _screw, "RackPinionJoint": _rack, "GearJoint": _gear,
}  # fmt: skip
"""Joints that take other markers, lengths, or several joints of a scene."""


def kind_of(item: Item) -> str:
    """Return the kind of a joint, also for the truncated name that OndselSolver writes if compiled by GCC."""
    found = [kind for kind in (*SAME, *OTHERS) if item.label == f"N3MbD{len(kind) + 4}ASMT{kind}E"[CUT:]]
    return found[0] if len(found) == 1 else item.label


CUT = len("class MbD::ASMT")
"""Number of characters that OndselSolver removes from a class name: the prefix that MSVC writes."""
