"""Models in the pose of a saved state, in which a restarted run sets up its joints and forces."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from ..elements.element import Element
from ..elements.turns import WithinHalfATurn

if TYPE_CHECKING:
    from .model_data import ModelData

Data = TypeVar("Data", bound="ModelData")


@dataclass(frozen=True)
class CurrentPose:
    """Pose of a restart, and what is known of the elements that acted before.

    - `described`: model in its described pose.
    - `acted`: names of the elements that acted before.
    - `angles`: angles of joints with full turns by channel, and those of joints that count their own by name, rad.
    - `turns`: full turns by which rotations of elements were reduced when they were set up after the start, by name;
      also those of joints for elements that read them in another turn, by `read_by`.
    """

    described: ModelData
    acted: Container[str]
    angles: Mapping[str, float] = field(default_factory=dict)
    turns: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    def set_up(self, name: str, element: Any, model: ModelData) -> Element:
        """Return an element as it is set up in a restart.

        One that did not act before starts in the current pose. Of one that acted, fields that the current pose
        determines as any earlier one did follow from that; those that count turns are kept.
        """
        if name in self.turns and not element.same_in_each_pose:
            return element.without_turns(model, self.turns[name])  # type: ignore[no-any-return]
        if name not in self.acted:
            return element.at_current_pose(model)  # type: ignore[no-any-return]
        return element.at_initial_pose(model if element.same_in_each_pose else self.described)  # type: ignore[no-any-return]

    def set_up_for(self, reader: str, name: str, joint: Any, model: ModelData) -> Element:
        """Return a joint as an element reads it: with its turns before a drive selected others, if that acted before."""
        kept = self.turns.get(read_by(reader, name))
        return self.set_up(name, joint, model) if kept is None else joint.without_turns(model, kept)  # type: ignore[no-any-return]

    def turns_set_up(self, model: ModelData) -> dict[str, tuple[int, ...]]:
        """Return `turns` of all elements, including those that are set up now."""
        elements = {**model.joints, **model.forces}
        new = {name: element for name, element in elements.items() if name not in self.acted}
        counting = {name: element for name, element in new.items() if isinstance(element, WithinHalfATurn)}
        return {**{name: element.relative_turns(model) for name, element in counting.items()}, **self.turns}


def read_by(reader: str, joint: str) -> str:
    """Return the name of the turns in which an element reads a joint."""
    return f"{reader} reads {joint}"


def in_current_pose(model: Data, bodies: Mapping[str, Any], pose: CurrentPose) -> Data:
    """Return a model with its bodies in another pose, in which it sets up its elements."""
    found = model.model_copy(update={"bodies": bodies})
    found._current_pose = pose
    return found
