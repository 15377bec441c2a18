"""Reading of YAML texts, and line numbers of their parts."""

from __future__ import annotations

import re
from io import StringIO
from typing import Any

from ...errors import InputError
from .quoted import quoted
from .yaml_content import check_content

_DECIMAL = re.compile(r"-?(0|[1-9][0-9]{0,14})(\.[0-9]{1,15})?")
"""Numbers that YAML and Python read alike."""
_OTHER_ENDS = re.compile("[\x85\u2028\u2029]")
"""Line ends of YAML 1.1 that YAML 1.2 does not have; it has only LF and CR."""


def read_yaml(text: str, source: str) -> Any:
    """Return the content of a text, called `source` in messages, as mappings, lists, numbers and text.

    Raises
    ------
    InputError
        If it is not YAML, contains a key twice, or is too large to be a scene; the message contains the line.
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
    return f"found text that is not YAML, or a value that does not fit its tag ({quoted(_first_line(error))})"


def _with_plain_ends(text: str) -> str:
    return _OTHER_ENDS.sub(" ", text)


def _first_line(error: Exception) -> str:
    return next(iter(str(error).split("\n")), "") or type(error).__name__


def _reason(error: Any) -> str:
    problem = _first_line(Exception(error.problem or ""))
    if "duplicate key" in problem:
        key = problem.split('"')[1]
        return f"found the name '{key}' twice, expected each name once"
    return f"found text that is not YAML ({problem})"


def line_of(text: str, path: tuple[Any, ...]) -> int | None:
    """Return the line of the deepest key of `path` in a text."""
    return line_and_depth(text, path)[0]


def line_and_depth(text: str, path: tuple[Any, ...]) -> tuple[int | None, int]:
    """Return the line of the deepest key of `path` in a text, and the number of keys found."""
    from ruamel.yaml import YAML

    try:
        place: Any = YAML().load(StringIO(_with_plain_ends(text)))
    except Exception:  # this reader, which keeps lines, refuses some texts that `read_yaml` accepts
        return None, 0
    line, depth = None, 0
    for depth, key in enumerate(path):
        marks = getattr(place, "lc", None)
        if isinstance(place, dict) and key in place and marks:
            line = _line_in(marks, key)
            place = place[key]
        elif isinstance(place, list) and key.isdigit() and int(key) < len(place) and marks:
            line = marks.item(int(key))[0] + 1
            place = place[int(key)]
        else:
            return line, depth
    return line, len(path)


def _line_in(marks: Any, key: Any) -> int | None:
    """Return the line of a key; None for a merged key."""
    try:
        return int(marks.key(key)[0]) + 1
    except (KeyError, TypeError):
        return None
