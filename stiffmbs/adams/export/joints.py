"""Export of joints as Adams/Solver statements."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import singledispatchmethod

from ...elements.element import Joint
from ...elements.joints.constraint_equation import ConstraintEquation
from ...elements.joints.coupler import Coupler
from ...elements.joints.drive import Drive
from ...elements.joints.point_on_curve import Curve
from ...elements.joints.velocity_equation import VelocityEquation
from ...elements.spatial.joints.parallel import Parallel
from ...elements.spatial.joints.shared import Distance
from ...elements.spatial.joints.tangent_to_curve import TangentToCurve
from ...elements.spatial.joints.thread import Thread
from ...model.spatial_model import SpatialData
from ...reading.files.written_fields import written
from ...reading.joint_name import JointName
from ..scene.joints import KINDS
from .curves import Curves
from .formulas import Functions
from .numbering import Numbering, Refusal, number, statement

PRIMITIVES = ("INLINE", "INPLANE", "ORIENTATION", "PARALLEL_AXES", "PERPENDICULAR")
TYPES = {kind: name for name, kind in KINDS.items() if name != "ATPOINT"}
"""Adams names of the joints that use their two markers unchanged."""
TURNS = {"angle": "ROTATIONAL", "displacement": "TRANSLATIONAL"}


def reactions(model: SpatialData) -> dict[str, tuple[str, int]]:
    """Return function (JOINT or JPRIM) and number of the joints whose reactions can be measured, by name."""
    return {
        name: ("JPRIM" if TYPES.get(joint.kind) in PRIMITIVES else "JOINT", k)
        for k, (name, joint) in enumerate(_plain(model).items(), 1)
    }


def _plain(model: SpatialData) -> dict[str, Joint]:
    """Return the joints exported as JOINT or JPRIM statements in the order of their numbers."""
    return {name: joint for name, joint in model.joints.items() if joint.kind in (*TYPES, Thread.kind)}


class Joints:
    """Exporter of the joints of one scene."""

    def __init__(self, model: SpatialData, numbering: Numbering, functions: Functions) -> None:
        self._model, self._numbering, self._functions = model, numbering, functions
        self._numbers = {name: k for k, name in enumerate(_plain(model), 1)}
        self._other_numbers = itertools.count(1)
        self._curves = Curves(model, numbering)

    @singledispatchmethod
    def statements(self, joint: Joint, name: str) -> Iterator[str]:
        """Yield the statements of a joint.

        Raises Refusal if Adams has no such joint.
        """
        if joint.kind not in TYPES:
            raise Refusal(f"found a joint of the type {joint.kind}, expected one that Adams has")
        kind = TYPES[joint.kind]
        yield statement(
            "JPRIM" if kind in PRIMITIVES else "JOINT", self._numbers[name], kind, *self._numbering.ends(joint)
        )

    @statements.register
    def _parallel(self, joint: Parallel, name: str) -> Iterator[str]:
        if name not in self._curves.parts_of_a_pair:
            yield statement("JPRIM", self._numbers[name], "PARALLEL_AXES", *self._numbering.ends(joint))

    @statements.register
    def _on_curve(self, joint: Curve, name: str) -> Iterator[str]:
        yield from self._curves.pair(name) if isinstance(joint, TangentToCurve) else self._curves.point(joint)

    @statements.register
    def _thread(self, joint: Thread, name: str) -> Iterator[str]:
        if name not in self._numbers:
            raise Refusal(f"found a joint of the type {joint.kind}, expected a thread and a cylindrical joint")
        if joint.offset is not None:
            raise Refusal("found an offset of a thread, expected none: it starts as drawn")
        yield statement(
            "JOINT", self._numbers[name], "SCREW", *self._numbering.ends(joint), f"PITCH = {number(joint.pitch)}"
        )

    @statements.register
    def _coupler(self, joint: Coupler, name: str) -> Iterator[str]:
        tied = (joint.joint_1, joint.joint_2)
        if joint.offset is not None:
            first, second = (self._measured(one) for one in tied)
            zero = f"{first}-({number(joint.scale)})*{second}-({number(joint.offset)})"
            yield statement("GCON", next(self._other_numbers), f"FUNCTION = {zero}")
            return
        sorts = ":".join(TURNS[self._coordinate(one)][0] for one in tied)
        idents = ", ".join(str(self._number(one)) for one in tied)
        scales = f"1, {number(-joint.scale)}"
        yield statement(
            "COUPLER", next(self._other_numbers), f"JOINTS = {idents}", f"TYPE = {sorts}", f"SCALES = {scales}"
        )

    @statements.register
    def _distance(self, joint: Distance, name: str) -> Iterator[str]:
        i, j = self._numbering.marker(joint.i), self._numbering.marker(joint.j)
        yield statement("GCON", next(self._other_numbers), f"I = {i}", f"FUNCTION = DM({i},{j})-{number(joint.length)}")

    @statements.register
    def _equation(self, joint: ConstraintEquation | VelocityEquation, name: str) -> Iterator[str]:
        written(joint, "j")  # only the axes of requests for its reaction
        reported = [] if joint.i is None else [f"I = {self._numbering.marker(joint.i)}"]
        for formula in joint.zero:
            yield statement("GCON", next(self._other_numbers), *reported, f"FUNCTION = {self._functions.text(formula)}")

    @statements.register
    def _drive(self, joint: Drive, name: str) -> Iterator[str]:
        if joint.joint is None:
            raise Refusal("found a drive of a formula, expected one of a joint")
        law, order = (
            (joint.prescribed_position, "DISPLACEMENT")
            if joint.prescribed_velocity is None
            else (joint.prescribed_velocity, "VELOCITY")
        )
        assert law is not None
        sort = TURNS[self._coordinate(joint.joint)]
        yield statement(
            "MOTION",
            next(self._other_numbers),
            f"JOINT = {self._number(joint.joint)}",
            sort,
            order,
            f"FUNCTION = {self._functions.text(law)}",
        )

    def _measured(self, name: JointName) -> str:
        """Return a joint coordinate as a function of its markers."""
        joint = self._model.joints[name.joint]
        i, j = (self._numbering.marker(marker) for marker in (joint.i, joint.j))  # type: ignore[attr-defined]
        return f"AZ({i},{j})" if self._coordinate(name) == "angle" else f"DZ({i},{j},{j})"

    def _coordinate(self, name: JointName) -> str:
        coordinate = name.coordinate_of(self._model.joints[name.joint])
        if coordinate is None:
            raise Refusal(f"found the joint {name}, expected one with a coordinate")
        return coordinate

    def _number(self, name: JointName) -> int:
        kind = TYPES.get(self._model.joints[name.joint].kind)
        if name.joint not in self._numbers or kind in PRIMITIVES:
            raise Refusal(f"found the joint {name.joint}, expected one that is a JOINT of Adams")
        return self._numbers[name.joint]
