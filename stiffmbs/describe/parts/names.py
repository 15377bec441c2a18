"""Names with dots, such as ``front.left.arm``: which part of ``front.left.arm.end`` is a body, and which its marker."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..formula.dimension import Known

GROUND = "ground"
MOUNT = "mount"
"""What a part calls the body that it is placed on."""


@dataclass(frozen=True)
class Names:
    """The names that text in a scene may use.

    Attributes
    ----------
    bodies : frozenset of str
        All bodies of the scene, by their full names.  None is the beginning of another (``front`` and ``front.arm``), so
        that a text has one meaning.
    local : mapping of str to str
        Within a part: its own short names, and the full names that they stand for.
    values : mapping of str to ast.expr
        Within a part: its own parameters, as the numbers with units that stand in their places outside of it.
    states : mapping of str to Known
        All states and inputs of the scene, by their full names, and what is known of their dimensions.
    inputs : frozenset of str
        The inputs among them, which formulas of time may use too.
    mounts : frozenset of str
        Within a part: what it calls the bodies that it is placed on.
    """

    bodies: frozenset[str] = frozenset()
    local: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, ast.expr] = field(default_factory=dict)
    states: Mapping[str, Known] = field(default_factory=dict)
    inputs: frozenset[str] = frozenset()
    mounts: frozenset[str] = frozenset()

    @cached_property
    def dotted(self) -> bool:
        """Whether any name has a dot, or stands for another one."""
        return bool(self.local) or any("." in name for name in self.bodies)

    def full(self, text: str) -> str:
        """A text with the short name that it starts with in full: ``arm.end`` as ``front.left.arm.end``."""
        for beginning, rest in beginnings(text):
            if beginning in self.local:
                return self.local[beginning] + rest
        return text

    def body_and_marker(self, text: str) -> tuple[str, str]:
        """The body that a text names, and the marker, or an empty text for the body alone."""
        text = self.full(text)
        for beginning, rest in beginnings(text):
            if beginning in self.bodies or beginning == GROUND:
                return beginning, rest[1:]
        body, _, marker = text.partition(".") if text.count(".") < 2 else text.rpartition(".")
        return body, marker


def beginnings(text: str) -> Iterator[tuple[str, str]]:
    """Where a text with dots may be cut, its longest beginning first: ``a.b`` and nothing, ``a`` and ``.b``."""
    yield text, ""
    place = text.rfind(".")
    while place > 0:
        yield text[:place], text[place:]
        place = text.rfind(".", 0, place)


def names_of(info: Any) -> Names:
    """The names that a validation was given; none where it was given none."""
    found = (info.context or {}).get("names")
    return found if isinstance(found, Names) else Names()


def owner_of(channel: str) -> str:
    """The body or element of a channel: ``front.left.arm`` of ``front.left.arm.x``; a name without dots itself."""
    return channel.rpartition(".")[0] or channel
