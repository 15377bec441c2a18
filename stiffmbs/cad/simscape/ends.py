"""Ends of constraints and joints: points, lines, planes and frames of instances, as frames on their parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...reading.files.xml_nodes import Node
from ..assembly import CadFault, Frame, Seat, axes_along
from .instances import Instance, numbers, transform

POINT, LINE, PLANE, CIRCLE = "point", "line", "plane", "circle"
SHAPES = {
    "point": POINT, "sphere": POINT, "line": LINE, "cylinder": LINE, "cone": LINE, "axis": LINE, "plane": PLANE, "circle": CIRCLE,
    "arc": CIRCLE,
}  # fmt: skip
"""Shape of each type of geometry in the files: a point, a line, a plane, or a circle about a line."""


@dataclass(frozen=True)
class End:
    """End of a constraint: the part, the frame on it, and the same frame in the world; z along a line or normal."""

    shape: str
    seat: Seat
    drawn: Frame

    @property
    def z(self) -> np.ndarray:
        """Direction of the line, or of the normal, in the world."""
        axis: np.ndarray = self.drawn.axes[:, 2]
        return axis

    def moved(self, point: np.ndarray) -> End:
        """Return the end at another point of the world."""
        local = self.seat.frame.axes @ (self.drawn.axes.T @ (point - self.drawn.position))
        seat = Seat(self.seat.part, Frame(self.seat.frame.position + local, self.seat.frame.axes))
        return End(self.shape, seat, Frame(point, self.drawn.axes))


@dataclass(frozen=True)
class Ends:
    """Reader of the ends in one assembly. `length`: unit of length, m."""

    top: Instance
    owner: Instance
    length: float

    def geometry(self, where: str, node: Node) -> End:
        """Return the end that a <ConstraintGeometry> describes."""
        shape = SHAPES.get((node.get("geomType") or "").lower(), "")
        if not shape:
            node.find("InstancePath"), node.find("Position"), node.find("Axis")
            return End("", Seat(None, Frame(np.zeros(3), np.eye(3))), Frame(np.zeros(3), np.eye(3)))
        axes = np.eye(3)
        if shape != POINT or node.find("Axis") is not None:
            axis = numbers(where, node, "Axis", 3)
            size = float(np.linalg.norm(axis))
            if not 0 < size < np.inf:
                raise CadFault(f"{where}: found an axis of length {size:g}, expected a direction")
            axes = axes_along(axis / size)
        return self._end(where, node, shape, Frame(numbers(where, node, "Position", 3) * self.length, axes))

    def frame(self, where: str, node: Node | None) -> End:
        """Return the frame of a joint."""
        if node is None:
            raise CadFault(f"{where}: found fewer than two frames, expected <BaseFrame> and <FollowerFrame>")
        return self._end(where, node, "frame", transform(where, node, self.length))

    def _end(self, where: str, node: Node, shape: str, frame: Frame) -> End:
        one = self._instance(where, node)
        drawn = frame.on(one.frame)
        part = None if one is self.top else one.carrier()
        if part is None and one is not self.top:
            raise CadFault(
                f"{where}: no part is fixed in the subassembly {one.label}; ground a part in it, or mate to one of its parts"
            )
        if part is None:
            return End(shape, Seat(None, drawn), drawn)
        seat = Seat(part.label, frame if part is one else drawn.within(part.frame))
        return End(shape, seat, drawn)

    def _instance(self, where: str, node: Node) -> Instance:
        path = node.find("InstancePath")
        uids = tuple(uid.text for uid in path.findall("Uid")) if path is not None else ()
        found = self.owner.found(uids)
        if found is None and uids == (self.owner.entity,):
            return self.owner
        if found is None:
            raise CadFault(f"{where}: found the path {'/'.join(uids)}, expected the uids of an instance")
        return found
