"""Force and torque by a Python function, with fields common to the plane and space."""

from __future__ import annotations

import math
from typing import Any, Generic

from pydantic import Field

from ...reading.formula.field import OfMotion
from ...reading.marker import M, Marker
from ...reading.python_function import PythonFunction
from ..element import Expr, Force, Symbolic
from .applied import AppliedTorque, force_at


def _example(x: Any) -> Any:
    return [x[0] ** 2, math.sin(x[0]), math.cos(x[0])]


class ForceOfFunction(Force, Generic[M]):
    """Base of the planar and the spatial force by a Python function."""

    kind = "python_force"

    i: M = Field(description="marker at which the force acts")
    j: M | None = Field(None, description="a second body, on which the opposite force acts at the same point")
    of: tuple[OfMotion, ...] = Field(min_length=1, description="arguments of the function: formulas")
    function: PythonFunction = Field(description="function of an array of the values of `of`; returns force and torque")


class PythonForce(ForceOfFunction[Marker]):
    """Force and torque by a Python function, for laws that no formula can express.

    The function takes an array of the values of the formulas `of`, in SI units, and returns three numbers. They are the
    force along the ground's x and y (N) and the torque (N m) on body i at marker i. With `j` a second body receives the
    opposite load at the same point of space.

    It is available only in models built in Python. Derivatives for the Jacobian are by central differences, or by a
    complex step (`stiffmbs.PythonFunction`). The function must be deterministic. Its breakpoints are not located, and
    it has no potential. An exception ends the run, which keeps the results so far.

    Examples
    --------
    Drag by an interpolated coefficient::

        def drag(x):
            speed = np.hypot(*x)
            return *(-np.interp(speed, speeds, coefficients) * speed * x), 0.0

        model.add("drag", PythonForce(i="ball", of=("ball.vx", "ball.vy"), function=drag))

    Together with `AppliedForce` and `AppliedTorque` this corresponds to Adams' GFOSUB.
    """

    forms = ({"of": ("a.vx",), "function": _example},)

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        fx, fy, torque = e.function(*e.of, count=3)
        return [*force_at(fx, fy, e.i, e.j), (torque, AppliedTorque.angle(e))]
