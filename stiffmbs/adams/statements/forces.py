"""Gravity and formula forces.  MSC Adams/Solver, ACCGRAV, SFORCE, VFORCE, VTORQUE and GFORCE statements."""

from __future__ import annotations

from dataclasses import dataclass

from ..functions.function import Function, read_function, required_function
from .arguments import Arguments, Numbered
from .constraints import ROTATIONAL, TRANSLATIONAL
from .text import Statement
from .units import Units


@dataclass(frozen=True)
class SingleForce(Numbered):
    """Force along the line between two markers, or torque about the z axis of the second.

    `sort`: rotational or translational. `action_only`: true if there is no reaction on the second marker's part; a
    force then acts along that marker's z axis.
    """

    i: int
    j: int
    sort: str
    action_only: bool
    function: Function


@dataclass(frozen=True)
class VectorForce(Numbered):
    """Force and torque at marker i in the axes of `axes`, with the reaction on the part of `floating`.

    `force` and `torque` hold three functions each, None if not given.
    """

    i: int
    floating: int
    axes: int | None
    force: tuple[Function | None, ...]
    torque: tuple[Function | None, ...]


def read_gravity(statement: Statement, units: Units) -> tuple[float, float, float]:
    """Return gravity in ground axes, m/s^2."""
    found = Arguments(statement, "ACCGRAV", ("IGRAV", "JGRAV", "KGRAV"))
    x, y, z = ((found.number(name) or 0.0) * units.of(length=1, time=-2) for name in ("IGRAV", "JGRAV", "KGRAV"))
    return x, y, z


def read_single_force(statement: Statement, units: Units) -> SingleForce:
    """Read a force or torque of one component."""
    names = ("I", "J", TRANSLATIONAL, ROTATIONAL, "ACTIONONLY", "REACTION", "FUNCTION", "ROUTINE")
    found = Arguments(statement, "SFORCE", names, ("FUNCTION",))
    sort = found.one_of(TRANSLATIONAL, ROTATIONAL)
    if sort is None:
        raise found.fault("found no kind of force, expected TRANSLATIONAL or ROTATIONAL")
    return SingleForce(
        *found.head(), found.required("I"), found.required("J"), sort,
        "ACTIONONLY" in found, required_function(found, "FUNCTION"),
    )  # fmt: skip


_FORCE, _TORQUE = ("FX", "FY", "FZ"), ("TX", "TY", "TZ")
_COMPONENTS = {"VFORCE": _FORCE, "VTORQUE": _TORQUE, "GFORCE": (*_FORCE, *_TORQUE)}


def read_vector_force(statement: Statement, units: Units, keyword: str) -> VectorForce:
    """Read a force of three components, a torque of three, or both."""
    names = _COMPONENTS[keyword]
    found = Arguments(statement, keyword, ("I", "JFLOAT", "RM", *names, "FUNCTION", "ROUTINE"), (*names, "FUNCTION"))
    read_function(found, "FUNCTION")  # refuses a user subroutine
    missing = [name for name in names if name not in found]
    if "FUNCTION" in found or (missing and keyword != "GFORCE"):
        raise found.fault(f"found no {', no '.join(missing)}, expected an expression for each of {', '.join(names)}")
    return VectorForce(
        *found.head(), found.required("I"), found.required("JFLOAT"),
        found.reference("RM"), *(tuple(_function_or_none(found, n, names) for n in kind) for kind in (_FORCE, _TORQUE)),
    )  # fmt: skip


def _function_or_none(found: Arguments, name: str, names: tuple[str, ...]) -> Function | None:
    return read_function(found, name) if name in names else None
