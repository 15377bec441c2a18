"""Scenes: the file form of a model with the way to run it."""

from __future__ import annotations

from collections.abc import Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from pydantic import Field
from pydantic import ValidationError as PydanticError

from ..errors import InputError
from .expand import read_parameters, repeat_entries, set_value
from .fields import sentence
from .figure import Figure
from .model import FORCES, JOINTS, ModelData
from .settings import RunSettings

SECTIONS = ("bodies", "joints", "forces")


class Scene(ModelData):
    """A model and its run settings, as read from a file."""

    parameters: dict[str, float | str] = Field(default_factory=dict, description="names for use in formulas")
    run: RunSettings = Field(default_factory=RunSettings, description="how to run the scene")
    figure: Figure | None = Field(None, description="the plot that shows what the scene is about")


def load_scene(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path : str or Path
        A YAML file.
    changes : sequence of (path, text)
        Values put in place of the file's, such as ``("bodies.cart.mass", "12 kg")``.

    Raises
    ------
    InputError
        When the file cannot be read or is no valid scene; names the file, the line and the path in it.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: found no such file, expected a scene") from None
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise InputError(f"{path}: the file cannot be read ({reason})") from None
    return read_scene(text, changes, str(path))


def read_scene(text: str, changes: Sequence[tuple[str, str]] = (), source: str = "scene") -> Scene:
    """Read a scene from text; as `load_scene`."""
    found = _yaml(text, source)
    if found is None:
        raise InputError(f"{source}: found an empty scene, expected at least 'bodies'")
    if not isinstance(found, dict):
        raise InputError(f"{source}: found {type(found).__name__}, expected a mapping with 'bodies'")
    for path, value in changes:
        set_value(found, path, _yaml(value, f"--set {path}"))
    try:
        return _validated(found)
    except _Located as error:
        line = _line(text, error.path)
        where = f"{source}, line {line}, " if line else f"{source}, "
        raise InputError(where + str(error)) from None


class _Located(Exception):
    """An error with the path of keys at which it occurred."""

    def __init__(self, message: str, path: tuple[Any, ...]) -> None:
        super().__init__(message)
        self.path = path


def _validated(found: dict[str, Any]) -> Scene:
    try:
        parameters = read_parameters(found.get("parameters"))
        raw = {
            key: repeat_entries(key, value, parameters) if key in SECTIONS else value for key, value in found.items()
        }
    except InputError as error:
        raise _Located(str(error), tuple(str(error).split(":")[0].split("."))) from None
    raw["parameters"] = {name: parameter.value for name, parameter in parameters.items()}
    try:
        return Scene.model_validate(raw, context={"parameters": parameters})
    except PydanticError as error:
        message = sentence(error)
        path = message.split(":")[0].split(".")
        raise _Located(message, tuple(path)) from None


def _yaml(text: str, source: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return YAML(typ="safe", pure=True).load(StringIO(text))
    except MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(f"{source}{line}: {_yaml_reason(error)}") from None
    except (YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{source}: found text that is not YAML ({str(error).splitlines()[0]})") from None


def _yaml_reason(error: Any) -> str:
    problem = str(error.problem or "").splitlines()[0]
    if "duplicate key" in problem:
        key = problem.split('"')[1]
        return f"found the name '{key}' twice, expected each name once"
    return f"found text that is not YAML ({problem})"


def _line(text: str, path: tuple[Any, ...]) -> int | None:
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


def scene_schema() -> dict[str, Any]:
    """The JSON schema of scene files."""
    schema = Scene.model_json_schema()
    loop = {"type": "string", "description": "repeat this entry: 'k in 1..N'; k and {k} are replaced in it"}
    for part in ("Body", *(element.__name__ for element in (*JOINTS.values(), *FORCES.values()))):
        schema["$defs"][part]["properties"]["for"] = loop
    return schema
