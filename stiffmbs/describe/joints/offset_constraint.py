"""Base of joints with one equation and an offset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

from ..element import Joint, Symbolic
from ..initial_pose import initial_element
from ..units import si

if TYPE_CHECKING:
    from ..model_data import ModelData


class OffsetConstraint(Joint):
    """Base of the joints with an `offset` in their single equation; scenes use its subclasses.

    The default `offset` is the value for which the equation holds in the described poses, so assembly does not move the
    bodies.
    """

    offset: si.Anything | None = None

    @staticmethod
    def relation(e: Symbolic) -> Any:
        """Return the residual of the equation, including the offset."""
        raise NotImplementedError

    @classmethod
    def position(cls, e: Symbolic) -> Any:
        return [cls.relation(e)]

    def at_initial_pose(self, model: ModelData) -> Self:
        if self.offset is not None:
            return self
        at_start = self.relation(initial_element(self.model_copy(update={"offset": 0.0}), model))
        return self.model_copy(update={"offset": float(at_start)})
