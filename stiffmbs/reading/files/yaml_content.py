"""Bounds on the content of a YAML text; by aliases a text of 1 kB can expand beyond any memory."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from typing import Any

from ...errors import InputError
from .quoted import quoted

MOST_NESTED = 40
"""Largest number of nested mappings and lists; a scene has six levels."""
MOST_BY_ALIASES = 1_000_000
"""Largest number of values from expanded aliases, in addition to written ones."""
_NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")
"""Control characters, and halves of surrogate pairs, which no file can contain."""


class _Refused(Exception):
    """Fault of a value: "found ..., expected ..."."""


@dataclass(frozen=True)
class _Extent:
    """Number of nested values, with aliases expanded, and depth of nesting."""

    values: int
    depth: int


@dataclass
class _Walk:
    """Traversal that visits each value once, however many aliases refer to it."""

    extents: dict[int, _Extent | None] = field(default_factory=dict)
    written: int = 0

    def extent(self, found: Any, level: int) -> _Extent:
        """Return the extent of a value at a level."""
        if not isinstance(found, dict | list | tuple | set | frozenset):
            _check_scalar(found)
            self.written += 1
            return _Extent(1, 0)
        known = self.extents.get(id(found), _Extent(0, 0))
        if known is None:
            raise _Refused("found an alias within what it stands for, expected one outside of it")
        if known.values == 0:
            known = self._opened(found, level)
        if level + known.depth > MOST_NESTED:
            raise _Refused(f"found values nested {level + known.depth} deep or more, expected at most {MOST_NESTED}")
        return known

    def _opened(self, found: Any, level: int) -> _Extent:
        if level > MOST_NESTED:
            raise _Refused(f"found values nested {level} deep or more, expected at most {MOST_NESTED}")
        self.extents[id(found)] = None
        parts = [*found, *found.values()] if isinstance(found, dict) else list(found)
        inner = [self.extent(part, level + 1) for part in parts]
        extent = _Extent(1 + sum(x.values for x in inner), 1 + max((x.depth for x in inner), default=0))
        self.extents[id(found)] = extent
        self.written += 1
        return extent


def check_content(found: Any, source: str) -> None:
    """Refuse content that is too large or too deeply nested for a scene.

    Raises
    ------
    InputError
        For recursive or too many aliases, deep nesting, integers beyond 1e308, and control characters.
    """
    walk = _Walk()
    try:
        values = walk.extent(found, 0).values
        if values - walk.written > MOST_BY_ALIASES:
            raise _Refused(f"found aliases that stand for {values:.0e} values, expected at most {MOST_BY_ALIASES:.0e}")
    except _Refused as fault:
        raise InputError(f"{source}: {fault}") from None


def _check_scalar(found: Any) -> None:
    if isinstance(found, int) and abs(found) > sys.float_info.max:
        raise _Refused("found a whole number beyond 1e308, expected a smaller one")
    if isinstance(found, str) and (sign := _NO_TEXT.search(found)):
        shown = quoted(_NO_TEXT.sub("?", found))
        raise _Refused(f"found the character U+{ord(sign[0]):04X} in '{shown}', expected text that can be printed")
