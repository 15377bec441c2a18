"""YAML texts: reading with line numbers of their parts, and writing of scenes."""

from __future__ import annotations

import re
import sys
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass, field
from io import StringIO
from typing import TYPE_CHECKING, Any, TypeAlias

from ...errors import InputError, prefixed
from .quoted import first_line, quoted

if TYPE_CHECKING:
    from ruamel.yaml.error import MarkedYAMLError

_DECIMAL = re.compile(r"-?(0|[1-9][0-9]{0,14})(\.[0-9]{1,15})?")
"""Numbers that YAML and Python read in the same way."""
_PART_OF_FORMULA = re.compile(r"^[-+.]?\d|\)$")
_OTHER_ENDS = re.compile("[\x85\u2028\u2029]")
"""Line ends of YAML 1.1 that YAML 1.2 does not have; it has only LF and CR."""

Content: TypeAlias = dict[str, Any]
"""Content of a scene or of an entry of one by key, as read or as to be written: numbers, texts, lists and such mappings."""


def read_yaml(text: str, source: str) -> Any:
    """Return the content of a text, called `source` in messages, as mappings, lists, numbers and text.

    Raises InputError if it is not YAML, contains a key twice, or is too large to be a scene; the message contains the
    line.
    """
    if _DECIMAL.fullmatch(text):
        return float(text) if "." in text else int(text)
    found = _content(_with_plain_ends(text), source)
    check_content(found, source)
    return found


def _content(text: str, source: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError

    try:
        return YAML(typ="safe", pure=True).load(StringIO(text))
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(f"{source}{line}: {_reason(error)}") from None
    except RecursionError:
        raise InputError(f"{source}: found values nested too deep, expected a scene") from None
    except Exception as error:  # a value that does not match its tag (!!bool abc) may raise any error
        raise InputError(f"{source}: {_unlocated(error)}") from None


def _unlocated(error: Exception) -> str:
    """Return the reason of a fault for which the reader gives no line."""
    if "digits" in str(error):
        return "found a whole number of more than 4300 digits, expected a smaller one"
    return f"found text that is not YAML, or a value that does not fit its tag ({quoted(first_line(error))})"


def _with_plain_ends(text: str) -> str:
    return _OTHER_ENDS.sub(" ", text if text.isascii() else unicodedata.normalize("NFC", text))


def quotes_hint(key: object) -> str:
    """Return a hint if a key looks like a part of a formula whose commas a mapping in braces has split."""
    return ": a formula with commas needs quotes between braces" if _PART_OF_FORMULA.search(str(key)) else ""


def _reason(error: MarkedYAMLError) -> str:
    problem = first_line(Exception(error.problem or ""))
    if "duplicate key" in problem:
        key = problem.split('"')[1]
        return f"found the name '{key}' twice, expected each name once{quotes_hint(key)}"
    return f"found text that is not YAML ({problem})"


def line_of(text: str, path: tuple[object, ...]) -> int | None:
    """Return the line of the deepest key of `path` in a text."""
    return line_and_depth(text, path)[0]


def line_and_depth(text: str, path: tuple[object, ...]) -> tuple[int | None, int]:
    """Return the line of the deepest key of `path` in a text, and the number of keys found."""
    from ruamel.yaml import YAML

    try:
        place: object = YAML().load(StringIO(_with_plain_ends(text)))
    except Exception:  # this reader, which keeps lines, refuses some texts that `read_yaml` accepts
        return None, 0
    line, depth = None, 0
    for depth, key in enumerate(path):
        marks = getattr(place, "lc", None)
        if isinstance(place, dict) and key in place and marks:
            line = _line_in(marks, key)
            place = place[key]
        elif isinstance(place, list) and isinstance(key, str) and key.isdigit() and int(key) < len(place) and marks:
            line = marks.item(int(key))[0] + 1
            place = place[int(key)]
        else:
            return line, depth
    return line, len(path)


def _line_in(marks: Any, key: object) -> int | None:
    """Return the line of a key; None for a merged key."""
    try:
        return int(marks.key(key)[0]) + 1
    except (KeyError, TypeError):
        return None


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

    def extent(self, found: object, level: int) -> _Extent:
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

    def _opened(self, found: Collection[object], level: int) -> _Extent:
        if level > MOST_NESTED:
            raise _Refused(f"found values nested {level} deep or more, expected at most {MOST_NESTED}")
        self.extents[id(found)] = None
        parts = [*found, *found.values()] if isinstance(found, dict) else list(found)
        inner = [self.extent(part, level + 1) for part in parts]
        extent = _Extent(1 + sum(x.values for x in inner), 1 + max((x.depth for x in inner), default=0))
        self.extents[id(found)] = extent
        self.written += 1
        return extent


def check_content(found: object, source: str) -> None:
    """Refuse content that is too large or too deeply nested for a scene.

    Raises InputError for recursive or too many aliases, deep nesting, integers beyond 1e308, and control characters.
    """
    walk = _Walk()
    with prefixed(f"{source}: ", _Refused):
        values = walk.extent(found, 0).values
        if values - walk.written > MOST_BY_ALIASES:
            raise _Refused(f"found aliases that stand for {values:.0e} values, expected at most {MOST_BY_ALIASES:.0e}")


def _check_scalar(found: object) -> None:
    if isinstance(found, int) and abs(found) > sys.float_info.max:
        raise _Refused("found a whole number beyond 1e308, expected a smaller one")
    if isinstance(found, str) and (sign := _NO_TEXT.search(found)):
        shown = quoted(_NO_TEXT.sub("?", found))
        raise _Refused(f"found the character U+{ord(sign[0]):04X} in '{shown}', expected text that can be printed")


WIDTH = 140


def scene_text(found: dict[str, object]) -> str:
    """Return a mapping as the text of a scene file; innermost lists and mappings are in flow style."""
    from ruamel.yaml import YAML

    yaml, out = YAML(), StringIO()
    yaml.default_flow_style, yaml.width = None, WIDTH
    yaml.dump(found, out)
    return out.getvalue()
