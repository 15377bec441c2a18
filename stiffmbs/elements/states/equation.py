"""Elements that the model and the presolve create: equations of states, reported formulas, and counters of turns."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

from ...reading.formula.field import OfMotion, OfPosition
from ...reading.marker import MarkerReference
from ...reading.names import Names
from ..element import Element, Expr, Symbolic
from .state_name import StateName


class StateEquation(Element):
    """Equation of a state: its rate, or the residual of an algebraic state."""

    kind = ""

    state: StateName

    @staticmethod
    def rate(e: Symbolic) -> Expr:
        """Return x' of the state x, or the residual of an algebraic state."""
        raise NotImplementedError


class FormulaOfRate(StateEquation):
    """Equation of a state by a formula: x' = formula, or 0 = formula for an algebraic state."""

    formula: OfMotion

    @staticmethod
    def rate(e: Symbolic) -> Expr:
        return e.formula


class SampledUpdate(StateEquation):
    """Next value of a sampled state; it has no rate, and changes of the formula are no events."""

    formula: OfMotion


class Reported(Element):
    """Formula reported under the name of its element, such as the output of a transfer function."""

    kind = ""

    formula: OfMotion


class SpinAngle(StateEquation):
    """Angle, rad, of a body's spin about a principal axis, which its quaternion excludes; created by the presolve."""

    kind = ""

    i: MarkerReference
    axis: Literal["x", "y", "z"]

    @staticmethod
    def rate(e: Symbolic) -> Expr:
        return e.i.body.u[3 + "xyz".index(e.axis)]


class AngleCounter(Element):
    """Request for the integration to count the turns of a spatial angle, ``az(i, j)``; created by the model."""

    kind = ""

    counted: OfPosition


@lru_cache
def counter_of(angle: str, bodies: frozenset[str]) -> AngleCounter:
    """Return the counter of an angle between markers of these bodies, by the angle's text, which every run of a model needs."""
    return AngleCounter.model_validate({"counted": angle}, context={"names": Names(bodies)})
