"""Drive: a prescribed motion (Adams: MOTION)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import FunctionType

from pydantic import Field, field_validator, model_validator

from ...reading.fields import exactly_one
from ...reading.files.quoted import quoted
from ...reading.formula.dimension import UNKNOWN, Known, measured_in, product
from ...reading.formula.field import OfPosition, OfTimeAndStates
from ...reading.formula.formula import Formula
from ...reading.formula.text import FormulaError
from ...reading.joint_name import JointReference
from ...reading.marker import MarkerReference
from ...reading.table import Table
from ...reading.units.quantity import refuse_cycles
from ...reading.units.units import in_its_unit, named_unit
from ..element import Expr, Joint, Matrix, Symbolic
from .relation import unfit_joints

SORTS = {"angle": "angle", "displacement": "length", None: "value"}
"""Dimensions of joint coordinates by name."""
ANGULAR_VELOCITY = measured_in("angular velocity")


class Drive(Joint):
    """Motor that prescribes a joint's coordinate, or a formula of body coordinates, as a function of time or of states.

    With a position s(t): coordinate - s(t) = 0. With a velocity v(t): d(coordinate)/dt - v(t) = 0; this equation has no
    position form, so the coordinate starts at its described value. Both may depend on states; the rate of a state in a
    position must not depend on velocities. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989),
    section 3.5.

    The reaction is the action of the motor on its first body: ``motor.torque`` on an angle, ``motor.fx motor.fy`` along
    a displacement. The first body is that of the joint's marker i, or for a formula that of the drive's own marker `i`.
    Without `i` it is the first body that the formula names, and the torque's point is its centre of mass. As for every
    joint the reaction is -J^T lam: the torque on a driven angle is minus the multiplier. The channel ``motor.effort`` is
    the torque, N m, on an angle, or the force, N, along a displacement, positive in the direction of the coordinate.

    Full revolutions of angles are counted, so angles can be driven over any number of them. In space the initial pose
    defines an angle up to full turns; it starts in the turn nearest to s(0). For a joint with two coordinates, name the
    driven one: ``sleeve.angle``.
    """

    kind = "drive"
    known_as = ("motor", "motion", "actuator")
    reflected = {"prescribed_position": "joint", "prescribed_velocity": "joint"}
    equations = ("motion",)
    channels = ("effort",)
    forms = (
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
    j: MarkerReference | None = Field(None, description="marker for requests of the reaction")
    joint: JointReference | None = Field(
        None, description="joint whose coordinate is driven, or one of its coordinates"
    )
    driven: OfPosition | None = Field(
        None, alias="coordinate", description="driven quantity, instead of a joint: crank.angle, dm(bar.end, ground)"
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
            raise ValueError("found a joint with markers i or j, expected the joint only, which has its own")
        exactly_one(("position", self.prescribed_position), ("velocity", self.prescribed_velocity))
        return self

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        unfit = list(unfit_joints(self, joints))
        yield from unfit or self._of_another_dimension(joints)

    def _of_another_dimension(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield the prescribed motion if its unit differs from that of the driven coordinate or of its rate."""
        driven = UNKNOWN if self.driven is None else self.driven.dimension
        if self.joint is not None:
            driven = measured_in(SORTS[self.joint.coordinate_of(joints[self.joint.joint])])
        rate = product(driven, measured_in("time"), -1)
        for field, law, expected in (
            ("position", self.prescribed_position, driven), ("velocity", self.prescribed_velocity, rate),
        ):  # fmt: skip
            if law is not None and (reason := _unfit(field, law, expected)):
                yield field, reason

    @classmethod
    def measured(cls, e: Symbolic) -> list[Expr]:
        """Return the effort of the motor along the driven coordinate: its power is effort times rate."""
        return [-e.lam[0]]

    @staticmethod
    def position(e: Symbolic) -> list[Expr]:
        if e.prescribed_position is None:
            return []
        return [_driven(e) - _at(e.prescribed_position, e.t)]

    @staticmethod
    def velocity(e: Symbolic) -> list[Expr]:
        return [] if e.prescribed_velocity is None else [e.rate(_driven(e)) - _at(e.prescribed_velocity, e.t)]

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        """Return the joint's point; without a joint that of marker i, or the first body's centre of mass."""
        if e.joint is not None:
            return e.joint.i.point
        return e.frames[0].origin if e.i is None else e.i.point


def _unfit(field: str, law: Formula | Table, expected: Known) -> str:
    """Return why a law of time does not have the expected dimension; empty if it has, or contains no unit."""
    what = f"'{quoted(law.text)}', which is" if isinstance(law, Formula) else "the table's values"
    found = law.dimension if isinstance(law, Formula) else law.dimensions[1]
    if not found.agrees_with(expected):
        assert found.exponents is not None and expected.exponents is not None
        unit = named_unit(expected.exponents) if any(expected.exponents) else "rad"
        return f"found {what} {in_its_unit(found.exponents)}, expected a {field} in {unit}"
    if isinstance(law, Formula) and expected.exponents == ANGULAR_VELOCITY.exponents:
        try:
            refuse_cycles(law.text, law.tree)
        except FormulaError as error:
            return str(error)
    return ""


def _driven(e: Symbolic) -> Expr:
    return e.driven if e.joint is None else e.joint.coordinate


def _at(law: object, t: Expr) -> Expr:
    """Return the value of a law of time, a function for a table and an expression for a formula."""
    return law(t) if isinstance(law, FunctionType) else law
