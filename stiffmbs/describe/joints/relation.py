"""What gears, racks and couplers share: one linear equation between the coordinates of two joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from .. import si
from ..drawn import drawn
from ..element import Joint, JointName
from ..joint_reference import unfit_joints

if TYPE_CHECKING:
    from ..model import ModelData


class Relation(Joint):
    """Base of the joints that tie two joint coordinates together (it has no kind: scenes name its subclasses).

    Without an `offset` the bodies are taken as they are drawn: the offset is then the number with which the equation
    holds in the described poses, so that assembly turns no wheel.

    Attributes
    ----------
    wanted : mapping of str to type
        The class of joint that a field has to name, where not every joint with a coordinate will do.
    carried : bool
        Whether both joints must have the same body, the carrier, as their marker j.
    """

    wanted: ClassVar[Mapping[str, type[Joint]]] = {}
    carried: ClassVar[bool] = False

    offset: si.Anything | None = None

    def refused(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Joints without a coordinate or of the wrong kind, one joint named twice, two joints without a common carrier."""
        yield from unfit_joints(self, joints, self.wanted)
        (_, first), (field, second) = self.parts(JointName)
        if first == second:
            yield field, f"found '{second}' a second time, expected two different joints"
        if self.carried:
            yield from self._on_two_carriers(field, first, second, joints)

    @staticmethod
    def _on_two_carriers(field: str, first: str, second: str, joints: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
        carrier, other = joints[first].j.body, joints[second].j.body
        if carrier != other:
            yield (
                field,
                f"found marker j of '{second}' on '{other}' and that of '{first}' on '{carrier}', expected both "
                "on the carrier, the body in which both turn or slide",
            )

    def as_drawn(self, model: ModelData) -> Self:
        if self.offset is not None:
            return self
        (equation,) = self.position(drawn(self.model_copy(update={"offset": 0.0}), model))
        return self.model_copy(update={"offset": float(equation)})
