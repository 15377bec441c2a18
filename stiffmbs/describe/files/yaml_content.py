"""Bounds on what a YAML text may stand for: a text of 1 kB can, by aliases, stand for more than fits into any memory."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from ...errors import InputError
from .quoted import quoted

MOST_NESTED = 40
"""Levels of mappings and lists; a scene has six."""
MOST_BY_ALIASES = 1_000_000
"""Values that aliases may stand for, beyond those that are written."""
LARGEST_INTEGER = 10**308
_NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")
"""What steers a terminal, and halves of surrogate pairs, which no file can hold."""


class _Refused(Exception):
    """What is wrong with a value: "found ..., expected ..."."""


@dataclass(frozen=True)
class _Extent:
    """How many values a value holds, each alias counted as what it stands for, and how deep they are nested."""

    values: int
    depth: int


@dataclass
class _Walk:
    """Looks at each value once, however many aliases stand for it."""

    extents: dict[int, _Extent | None] = field(default_factory=dict)
    written: int = 0

    def extent(self, found: Any, level: int) -> _Extent:
        """The extent of a value at a level."""
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
    """Refuse what no scene holds and no code could walk through.

    Parameters
    ----------
    found : mapping, list, number or text
        As YAML is read.
    source : str
        What messages call it.

    Raises
    ------
    InputError
        For aliases within themselves or without end, deep nesting, whole numbers beyond 1e308, and characters that no text
        has.
    """
    walk = _Walk()
    try:
        values = walk.extent(found, 0).values
        if values - walk.written > MOST_BY_ALIASES:
            raise _Refused(f"found aliases that stand for {values:.0e} values, expected at most {MOST_BY_ALIASES:.0e}")
    except _Refused as fault:
        raise InputError(f"{source}: {fault}") from None


def _check_scalar(found: Any) -> None:
    if isinstance(found, int) and abs(found) > LARGEST_INTEGER:
        raise _Refused("found a whole number beyond 1e308, expected a smaller one")
    if isinstance(found, str) and (sign := _NO_TEXT.search(found)):
        shown = quoted(_NO_TEXT.sub("?", found))
        raise _Refused(f"found the character U+{ord(sign[0]):04X} in '{shown}', expected text that can be printed")
