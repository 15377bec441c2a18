"""Equations of states, created by the model from its section `states`."""

from __future__ import annotations

from typing import Any, ClassVar

from ..element import Element, Symbolic
from ..formula.field import OfMotion
from .name import StateName


class StateEquation(Element):
    """Equation of a state: its rate, or the residual of an algebraic state."""

    kind: ClassVar[str] = ""

    state: StateName

    @staticmethod
    def rate(e: Symbolic) -> Any:
        """Return x' of the state x, or the residual of an algebraic state."""
        raise NotImplementedError


class FormulaOfRate(StateEquation):
    """Equation of a state by a formula: x' = formula, or 0 = formula for an algebraic state."""

    formula: OfMotion

    @staticmethod
    def rate(e: Symbolic) -> Any:
        return e.formula


class Reported(Element):
    """Formula reported under the name of its element, such as the output of a transfer function."""

    kind: ClassVar[str] = ""

    formula: OfMotion
