"""A force by a Python function: what its kinds in the plane and in space share."""

from __future__ import annotations

from typing import Generic, TypeVar

from pydantic import Field

from ..element import Force
from ..formula.field import OfMotion
from ..marker import MarkerReference
from ..python_function import PythonFunction

M = TypeVar("M", bound=MarkerReference)


class ForceOfFunction(Force, Generic[M]):
    """Base of the forces by a Python function in the plane and in space (it has no kind: scenes name its subclasses)."""

    i: M = Field(description="marker at which the force acts")
    j: M | None = Field(None, description="a second body, which takes the opposite force at the same point")
    of: tuple[OfMotion, ...] = Field(min_length=1, description="what the function is given: formulas")
    function: PythonFunction = Field(description="takes an array of the values of `of`, returns force and torque")
