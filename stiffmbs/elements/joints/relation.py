"""Base of gears, racks and couplers: a linear equation between two joint coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

from ...reading.joint_name import JointName
from ...reading.units import si
from ..element import Expr, Joint, Symbolic
from ..initial_pose import initial_element
from .unfit_joints import unfit_joints

if TYPE_CHECKING:
    from ...model.model_data import ModelData


class OffsetConstraint(Joint):
    """Base of the joints with an `offset` in their single equation; scenes use its subclasses.

    The default `offset` is the value for which the equation holds in the described poses, so assembly does not move the
    bodies.
    """

    offset: si.Anything | None = None

    @staticmethod
    def relation(e: Symbolic) -> Expr:
        """Return the residual of the equation, including the offset."""
        raise NotImplementedError

    @classmethod
    def position(cls, e: Symbolic) -> list[Expr]:
        return [cls.relation(e)]

    def at_initial_pose(self, model: ModelData) -> Self:
        if self.offset is not None:
            return self
        at_start = self.relation(initial_element(self.model_copy(update={"offset": 0.0}), model))
        return self.model_copy(update={"offset": float(at_start)})


class Relation(OffsetConstraint):
    """Base of the joints that relate two joint coordinates; scenes use its subclasses.

    Attributes
    ----------
    wanted : mapping of str to str
        Required coordinate, ``angle`` or ``displacement``, of a field, if not every coordinate is possible.
    carried : bool
        Whether both joints must have the same body, the carrier, as their marker j.
    """

    wanted: ClassVar[Mapping[str, str]] = {}
    carried: ClassVar[bool] = False

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield joints without the required coordinate, repeated coordinates, and joints without a common carrier."""
        yield from unfit_joints(self, joints, self.wanted)
        (_, first), (field, second) = self.parts(JointName)
        one, two = (cast(Any, joints[name.joint]) for name in (first, second))
        if one is two and first.coordinate_of(one) == second.coordinate_of(two):
            yield field, f"found '{second}' a second time, expected two different joints"
        if self.carried and one.j.body != two.j.body:
            yield (
                field,
                f"found marker j of '{second}' on '{two.j.body}' and that of '{first}' on '{one.j.body}', expected both "
                "on the carrier, the body in which both turn or slide",
            )
