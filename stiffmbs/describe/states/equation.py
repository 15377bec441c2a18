"""What states bring into the equations of a model; made by the model from its section `states`."""

from __future__ import annotations

from typing import Any, ClassVar

from ..element import Element, Symbolic
from ..formula.field import OfMotion
from .name import StateName


class StateEquation(Element):
    """The equation of a state: what its rate is, or what is zero for an algebraic one."""

    kind: ClassVar[str] = ""

    state: StateName

    @staticmethod
    def rate(e: Symbolic) -> Any:
        """x' of the state x, or what is zero in place of it."""
        raise NotImplementedError


class FormulaOfRate(StateEquation):
    """The equation of a state by a formula: x' = formula, or 0 = formula of an algebraic one."""

    formula: OfMotion

    @staticmethod
    def rate(e: Symbolic) -> Any:
        return e.formula


class Reported(Element):
    """A formula that is reported under the name of its element, as the output of a transfer function is."""

    kind: ClassVar[str] = ""

    formula: OfMotion
