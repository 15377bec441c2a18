"""A force and a torque by a Python function: its fields are the same in the plane and in space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import Field

from ..element import Force, Symbolic
from ..formula.field import OfMotion
from ..marker import Marker, MarkerReference
from ..python_function import PythonFunction
from .applied import AppliedTorque, force_at

M = TypeVar("M", bound=MarkerReference)


def _example(x: Any) -> Any:
    """Of one number."""
    return [x[0] ** 2, math.sin(x[0]), math.cos(x[0])]


class ForceOfFunction(Force, Generic[M]):
    """Fields of the forces by a Python function in the plane and in space, which are made of it."""

    kind: ClassVar[str] = "python_force"

    i: M = Field(description="marker at which the force acts")
    j: M | None = Field(None, description="a second body, which takes the opposite force at the same point")
    of: tuple[OfMotion, ...] = Field(min_length=1, description="what the function is given: formulas")
    function: PythonFunction = Field(description="takes an array of the values of `of`, returns force and torque")


class PythonForce(ForceOfFunction[Marker]):
    """A force and a torque that a Python function gives, for laws that no formula can express.

    The function takes an array of what the formulas `of` measure, in SI units, and returns three numbers: the force along
    the ground's x and y (N) and the torque (N m) on body i at marker i.  With `j` a second body takes the opposite at the
    same point of space.

    Only a model built in Python can have it.  Each call takes some microseconds, and the derivatives for the Jacobian are
    by central differences, or by a complex step (`stiffmbs.PythonFunction`).  It must give the same for the same numbers.
    Its breakpoints are not located, and it has no potential.  An exception ends the run, which keeps what was computed.

    Examples
    --------
    Drag by an interpolated coefficient::

        def drag(x):
            speed = np.hypot(*x)
            return *(-np.interp(speed, speeds, coefficients) * speed * x), 0.0

        model.add("drag", PythonForce(i="ball", of=("ball.vx", "ball.vy"), function=drag))

    Together with `AppliedForce` and `AppliedTorque` this is what Adams' GFOSUB is for.
    """

    forms: ClassVar[tuple[Mapping[str, Any], ...]] = ({"of": ("a.vx",), "function": _example},)

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        fx, fy, torque = e.function(*e.of, count=3)
        return [*force_at(fx, fy, e.i, e.j), (torque, AppliedTorque.angle(e))]

    def in_space(self, angles: Any) -> dict[str, Any]:
        from ..spatial.embedding.forces import python_force

        return python_force(self, angles)
