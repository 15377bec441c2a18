"""What states bring into the equations of a model; made by the model from its section `states`."""

from __future__ import annotations

from typing import ClassVar

from ..element import Element
from ..formula.field import OfMotion
from .name import StateName


class StateEquation(Element):
    """The equation of a state: x' = formula, or 0 = formula of an algebraic one."""

    kind: ClassVar[str] = ""

    state: StateName
    formula: OfMotion


class Reported(Element):
    """A formula that is reported under the name of its element, as the output of a transfer function is."""

    kind: ClassVar[str] = ""

    formula: OfMotion
