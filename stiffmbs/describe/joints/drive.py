"""Drive: a prescribed motion (Adams: motion)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import Any, ClassVar

from pydantic import Field, field_validator, model_validator

from ..element import Joint, Symbolic
from ..exactly_one import exactly_one
from ..files.quoted import quoted
from ..formula.dimension import UNKNOWN, Known, measured_in, product
from ..formula.field import OfPosition, OfTimeAndStates
from ..formula.formula import Formula
from ..formula.text import FormulaError
from ..joint_name import JointReference
from ..joint_reference import unfit_joints
from ..marker import MarkerReference
from ..table import Table
from ..units.quantity import refuse_cycles
from ..units.units import named_unit

SORTS = {"angle": "angle", "displacement": "length", None: "value"}
"""The dimensions of joint coordinates by name."""
ANGULAR_VELOCITY = measured_in("angular velocity")


class Drive(Joint):
    """A motor that moves a joint's coordinate, or a formula of body coordinates, as a function of time, or of states, prescribes.

    With a position s(t): coordinate - s(t) = 0; with a velocity v(t): d(coordinate)/dt - v(t) = 0, an equation that has
    no position form, so that the coordinate starts where it is drawn.  Both may follow states; the rate of one in a position must
    not follow velocities.  Haug, Computer Aided Kinematics and Dynamics of
    Mechanical Systems (1989), section 3.5.

    The reaction is what the motor does to its first body: ``motor.torque`` on an angle, ``motor.fx motor.fy`` along a
    displacement.  That is the body of marker i of the joint; for a formula the body of the drive's own marker `i`, or
    without one the first body that the formula names, whose centre of mass is then the torque's point.  As for every
    joint the reaction is -J^T lam: the torque on a driven angle is minus the multiplier.

    Angles count whole turns, so that they may be driven over any number of them.  In space a drawing tells an angle up to
    whole turns; it starts in the turn that is nearest to s(0).  A joint with two coordinates is named with the one to
    drive, ``sleeve.angle``.
    """

    kind: ClassVar[str] = "drive"
    reflected: ClassVar[dict[str, str] | None] = {"prescribed_position": "joint", "prescribed_velocity": "joint"}
    equations: ClassVar[tuple[str, ...]] = ("motion",)
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = (
        *({"joint": "pin", "position": law} for law in ("2*t", "0.1 + 2*t", "0.1 - 2*t", "0.1*sin(2*t)", "0.1")),
        {"joint": "pin", "position": {"table": [[0, 0], [1, 0.1], [2, 0]]}},
        {"joint": "pin", "velocity": "2"},
        *({"joint": "slider", "position": law} for law in ("0.1*sin(2*t)", "2*t")),
        {"joint": "slider", "velocity": "0.1"},
        {"coordinate": "a.x", "i": "a", "j": "b", "position": "0.1*sin(2*t)"},
        {"coordinate": "a.x", "i": "a", "j": "b", "velocity": "0.1"},
    )

    i: MarkerReference | None = Field(
        None, description="marker of the body on which the action of a driven coordinate is reported"
    )
    j: MarkerReference | None = Field(None, description="marker on which requests may ask for the reaction")
    joint: JointReference | None = Field(
        None, description="joint whose coordinate is driven, or one of its coordinates"
    )
    driven: OfPosition | None = Field(
        None, alias="coordinate", description="what is driven, in place of a joint: crank.angle, dm(bar.end, ground)"
    )
    prescribed_position: OfTimeAndStates | None = Field(
        None, alias="position", description="angle, rad, or displacement, m, over time"
    )
    prescribed_velocity: OfTimeAndStates | None = Field(
        None, alias="velocity", description="rate over time, rad/s or m/s"
    )

    @field_validator("driven")
    @classmethod
    def _names_a_body(cls, driven: Formula | None) -> Formula | None:
        if driven is not None and not any(True for _ in driven.bodies()):
            raise ValueError(f"found '{driven.text}', expected a formula with a body's coordinate such as crank.angle")
        return driven

    @model_validator(mode="after")
    def _one_of_each(self) -> Drive:
        exactly_one(("joint", self.joint), ("coordinate", self.driven))
        if self.joint is not None and (self.i is not None or self.j is not None):
            raise ValueError("found the markers i or j beside a joint, expected those of the joint alone")
        exactly_one(("position", self.prescribed_position), ("velocity", self.prescribed_velocity))
        return self

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        unfit = list(unfit_joints(self, joints))
        yield from unfit or self._of_another_dimension(joints)

    def _of_another_dimension(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """A prescribed motion in a unit that the driven coordinate, or its rate, does not have."""
        driven = UNKNOWN if self.driven is None else self.driven.dimension
        if self.joint is not None:
            driven = measured_in(SORTS[self.joint.coordinate_of(joints[self.joint.joint])])
        rate = product(driven, measured_in("time"), -1)
        for field, law, expected in (
            ("position", self.prescribed_position, driven), ("velocity", self.prescribed_velocity, rate),
        ):  # fmt: skip
            if law is not None and (reason := _unfit(field, law, expected)):
                yield field, reason

    @staticmethod
    def position(e: Symbolic) -> Any:
        if e.prescribed_position is None:
            return []
        return [_driven(e) - _at(e.prescribed_position, e.t)]

    @staticmethod
    def velocity(e: Symbolic) -> Any:
        return [] if e.prescribed_velocity is None else [e.rate(_driven(e)) - _at(e.prescribed_velocity, e.t)]

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The joint's point; without a joint that of marker i, or the first body's centre of mass."""
        if e.joint is not None:
            return e.joint.i.point
        return e.frames[0].origin if e.i is None else e.i.point


def _unfit(field: str, law: Formula | Table, expected: Known) -> str:
    """Why a law of time has not the expected dimension; empty where it has, or carries no unit."""
    what = f"'{quoted(law.text)}', which is" if isinstance(law, Formula) else "the table's values"
    found = law.dimension if isinstance(law, Formula) else law.dimensions[1]
    if not found.agrees_with(expected):
        assert found.exponents is not None and expected.exponents is not None
        unit = named_unit(expected.exponents) if any(expected.exponents) else "rad"
        return f"found {what} in {named_unit(found.exponents)}, expected a {field} in {unit}"
    if isinstance(law, Formula) and expected.exponents == ANGULAR_VELOCITY.exponents:
        try:
            refuse_cycles(law.text, law.tree)
        except FormulaError as error:
            return str(error)
    return ""


def _driven(e: Symbolic) -> Any:
    return e.driven if e.joint is None else e.joint.coordinate


def _at(law: Any, t: Any) -> Any:
    """A law of time, which is a function if it is a table and an expression if it is a formula."""
    return law(t) if isinstance(law, FunctionType) else law
