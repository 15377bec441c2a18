"""Spatial force and torque by a Python function."""

from __future__ import annotations

import math
from typing import Any

from ...element import Symbolic
from ...forces.python_force import ForceOfFunction
from ..marker import Marker
from ..wrench import Pairs, force_at, torque_on


def _example(x: Any) -> Any:
    return [x[0] ** 2, math.sin(x[0]), math.cos(x[0]), x[0], 1 - x[0], x[0] ** 3]


class PythonForce(ForceOfFunction[Marker]):
    """Force and torque by a Python function, for laws that no formula can express.

    The function takes an array of the values of the formulas `of`, in SI units, and returns six numbers. They are the
    force (N) and the torque (N m) along the ground's x, y and z on body i at marker i. With `j` a second body receives
    the opposite load at the same point of space.

    The notes on the planar `stiffmbs.PythonForce` apply.
    """

    forms = ({"of": ("a.vx",), "function": _example},)

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        values = e.function(*e.of, count=6)
        return [*force_at(e, values[:3], e.i, e.j), *torque_on(values[3:], e.i, e.j)]
