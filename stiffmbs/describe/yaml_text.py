"""Reading YAML: its content, and the lines that parts of it stand in."""

from __future__ import annotations

from io import StringIO
from typing import Any

from ..errors import InputError


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
        When it is not YAML, or holds a name twice; names the line.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return YAML(typ="safe", pure=True).load(StringIO(text))
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(f"{source}{line}: {_reason(error)}") from None
    except (YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{source}: found text that is not YAML ({str(error).splitlines()[0]})") from None


def _reason(error: Any) -> str:
    problem = str(error.problem or "").splitlines()[0]
    if "duplicate key" in problem:
        key = problem.split('"')[1]
        return f"found the name '{key}' twice, expected each name once"
    return f"found text that is not YAML ({problem})"


def line_of(text: str, path: tuple[Any, ...]) -> int | None:
    """The line of the deepest key of `path` that the file holds."""
    from ruamel.yaml import YAML

    place: Any = YAML().load(StringIO(text))
    line = None
    for key in path:
        marks = getattr(place, "lc", None)
        if isinstance(place, dict) and key in place and marks:
            line = marks.key(key)[0] + 1
            place = place[key]
        elif isinstance(place, list) and key.isdigit() and int(key) < len(place) and marks:
            line = marks.item(int(key))[0] + 1
            place = place[int(key)]
        else:
            break
    return line
