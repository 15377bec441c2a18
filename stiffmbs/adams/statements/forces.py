"""Gravity and formula forces.  MSC Adams/Solver, ACCGRAV, SFORCE, VFORCE, VTORQUE and GFORCE statements."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function, read_function
from .arguments import Arguments
from .constraints import ROTATIONAL, TRANSLATIONAL
from .declared import Numbered, constant, expression, expressions, given, ident, ident_or_none, one_of
from .text import Statement
from .units import Units

FORCE, TORQUE = ("FX", "FY", "FZ"), ("TX", "TY", "TZ")


def read_gravity(statement: Statement, units: Units) -> tuple[float, float, float]:
    """Return gravity in ground axes, m/s^2."""
    found = Arguments(statement, "ACCGRAV", ("IGRAV", "JGRAV", "KGRAV"))
    x, y, z = ((found.number(name) or 0.0) * units.of(length=1, time=-2) for name in ("IGRAV", "JGRAV", "KGRAV"))
    return x, y, z


@dataclass(frozen=True)
class SingleForce(Numbered):
    """Force along the line between two markers, or torque about the z axis of the second.

    `action_only`: true if there is no reaction on the second marker's part; a force then acts along that marker's z
    axis.
    """

    i: int = ident("I")
    j: int = ident("J")
    sort: str = one_of(
        TRANSLATIONAL, ROTATIONAL, missing="found no kind of force, expected TRANSLATIONAL or ROTATIONAL"
    )
    action_only: bool = given("ACTIONONLY")
    function: Function = expression("FUNCTION")
    others = ("REACTION", "ROUTINE")


@dataclass(frozen=True)
class VectorForce(Numbered):
    """Force and torque at marker i in the axes of `axes`, with the reaction on the part of `floating`."""

    i: int = ident("I")
    floating: int = ident("JFLOAT")
    axes: int | None = ident_or_none("RM")
    force: tuple[Function | None, ...] = expressions(*FORCE)
    torque: tuple[Function | None, ...] = expressions(*TORQUE)
    others = ("FUNCTION", "ROUTINE")

    @classmethod
    def check(cls, found: Arguments) -> None:
        """Refuse a user's subroutine, and a VFORCE or VTORQUE without all three components."""
        read_function(found, "FUNCTION")
        names = {"VFORCE": FORCE, "VTORQUE": TORQUE}.get(found.keyword, (*FORCE, *TORQUE))
        missing = [name for name in names if name not in found]
        if "FUNCTION" in found or (missing and found.keyword != "GFORCE"):
            raise found.fault(
                f"found no {', no '.join(missing)}, expected an expression for each of {', '.join(names)}"
            )


@dataclass(frozen=True)
class ForceAlone(VectorForce):
    """Force of three components."""

    torque: tuple[Function | None, ...] = constant((None, None, None))


@dataclass(frozen=True)
class TorqueAlone(VectorForce):
    """Torque of three components."""

    force: tuple[Function | None, ...] = constant((None, None, None))
