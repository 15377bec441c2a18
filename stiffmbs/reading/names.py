"""Dotted names, such as ``front.left.arm.end``, and their division into body and marker."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import ValidationInfo

    from .formula.dimension import Known

GROUND = "ground"
MOUNT = "mount"
"""Local name of the body that a part is mounted on."""


@dataclass(frozen=True)
class Names:
    """Names available in the text of a scene."""

    # full names of all bodies of the scene. No name is a prefix of another (``front`` and ``front.arm``), so every text
    # is unambiguous.
    bodies: frozenset[str] = frozenset()
    local: Mapping[str, str] = field(default_factory=dict)  # within a part: full names by local name
    values: Mapping[str, ast.expr] = field(default_factory=dict)  # within a part: its parameters, as numbers with units
    # known dimensions of all states and inputs of the scene, by full name
    states: Mapping[str, Known] = field(default_factory=dict)
    inputs: frozenset[str] = frozenset()  # inputs among the states, which are available in formulas of time, too
    mounts: frozenset[str] = frozenset()  # within a part: local names of the bodies that it is mounted on

    @cached_property
    def dotted(self) -> bool:
        """True if any name has a dot or is local."""
        return bool(self.local) or any("." in name for name in self.bodies)

    def full(self, text: str) -> str:
        """Return a text with its leading local name expanded: ``arm.end`` as ``front.left.arm.end``."""
        for beginning, rest in beginnings(text):
            if beginning in self.local:
                return self.local[beginning] + rest
        return text

    def body_and_marker(self, text: str) -> tuple[str, str]:
        """Return the body and the marker that a text names; the marker is empty for the body alone."""
        text = self.full(text)
        for beginning, rest in beginnings(text):
            if beginning in self.bodies or beginning == GROUND:
                return beginning, rest[1:]
        body, _, marker = text.partition(".") if text.count(".") < 2 else text.rpartition(".")
        return body, marker


def beginnings(text: str) -> Iterator[tuple[str, str]]:
    """Yield the divisions of a dotted text, longest beginning first: ``a.b`` and nothing, ``a`` and ``.b``."""
    yield text, ""
    place = text.rfind(".")
    while place > 0:
        yield text[:place], text[place:]
        place = text.rfind(".", 0, place)


def names_of(info: ValidationInfo) -> Names:
    """Return the names in a validation context; none by default."""
    found = (info.context or {}).get("names")
    return found if isinstance(found, Names) else Names()


def owner_of(channel: str) -> str:
    """Return the owner of a channel: ``front.left.arm`` of ``front.left.arm.x``; a name without dots itself."""
    return channel.rpartition(".")[0] or channel
