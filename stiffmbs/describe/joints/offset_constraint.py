"""One equation that holds from the initial poses on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

from ..element import Joint, Symbolic
from ..initial_pose import initial_element
from ..units import si

if TYPE_CHECKING:
    from ..model_data import ModelData


class OffsetConstraint(Joint):
    """Base of the joints with an `offset` in their one equation (it has no kind: scenes name its subclasses).

    Without an `offset` the bodies are taken as they are drawn: the offset is then the number with which the equation
    holds in the described poses, so that assembly moves nothing.
    """

    offset: si.Anything | None = None

    @staticmethod
    def relation(e: Symbolic) -> Any:
        """What stays zero, with the offset taken from it."""
        raise NotImplementedError

    @classmethod
    def position(cls, e: Symbolic) -> Any:
        return [cls.relation(e)]

    def at_initial_pose(self, model: ModelData) -> Self:
        if self.offset is not None:
            return self
        at_start = self.relation(initial_element(self.model_copy(update={"offset": 0.0}), model))
        return self.model_copy(update={"offset": float(at_start)})
