"""Reading YAML: its content, and the lines that parts of it stand in."""

from __future__ import annotations

import re
from contextlib import suppress
from io import StringIO
from typing import Any

from ...errors import InputError
from .quoted import quoted
from .yaml_content import check_content

_DECIMAL = re.compile(r"-?(0|[1-9][0-9]{0,14})(\.[0-9]{1,15})?")
"""Numbers that are read alike by YAML and Python."""
LONG = 8000
"""Characters of a text, from which on it pays to load libyaml."""
_OTHER_ENDS = re.compile("[\x85\u2028\u2029]")
"""What ended a line in YAML 1.1; since 1.2 that is LF and CR alone."""


def read_yaml(text: str, source: str) -> Any:
    """What stands in a text, as mappings, lists, numbers and text.

    Parameters
    ----------
    text : str
    source : str
        What messages call it.

    Raises
    ------
    InputError
        When it is not YAML, holds a name twice, or is too large to be a scene; names the line.
    """
    if _DECIMAL.fullmatch(text):
        return float(text) if "." in text else int(text)
    found = _content(_with_plain_ends(text), source)
    check_content(found, source)
    return found


def _content(text: str, source: str) -> Any:
    """What stands in a text; errors as for `read_yaml`."""
    if len(text) >= LONG:
        from .libyaml import NotSureError, read_by_libyaml

        with suppress(NotSureError):
            return read_by_libyaml(text)
    return _read_by_python(text, source)


def _read_by_python(text: str, source: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError

    try:
        return YAML(typ="safe", pure=True).load(StringIO(text))
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(f"{source}{line}: {_reason(error)}") from None
    except RecursionError:
        raise InputError(f"{source}: found values nested too deep, expected a scene") from None
    except Exception as error:  # a value that doesn't fit its tag (!!bool abc) raises whatever Python does
        raise InputError(f"{source}: {_unlocated(error)}") from None


def _unlocated(error: Exception) -> str:
    """What is wrong where the reader doesn't say in which line."""
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
    """The line of the deepest key of `path` that the file holds."""
    return line_and_depth(text, path)[0]


def line_and_depth(text: str, path: tuple[Any, ...]) -> tuple[int | None, int]:
    """The line of the deepest key of `path` that the file holds, and how many of its keys that are."""
    from ruamel.yaml import YAML

    try:
        place: Any = YAML().load(StringIO(_with_plain_ends(text)))
    except Exception:  # what `read_yaml` takes, this reader, which keeps lines, may not
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
    """The line of a key; None for one that is merged in from elsewhere."""
    try:
        return int(marks.key(key)[0]) + 1
    except (KeyError, TypeError):
        return None
