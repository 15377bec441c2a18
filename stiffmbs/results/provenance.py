"""Origin of results: the scene that was solved, how it differs from its file, and by which command, version and when."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..model.files.written_scene import WrittenScene
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..model.settings import RunSettings
from ..reading.files.yaml_text import Content, scene_text
from .command_line import command_line, date

if TYPE_CHECKING:
    from .saved_state import SavedState

PROVENANCE = "run/provenance"
"""Name of the origin in .npz files, as JSON."""


@dataclass(frozen=True)
class Provenance:
    """Origin of results, written into every file, page and figure.

    Attributes
    ----------
    changes : tuple of str
        Differences of the run from the scene's file: ``run.rtol = 1e-8``.
    command : str
        Command line.
    version : str
        Version of stiffmbs.
    date : str
        When it was solved, UTC, or the time in the environment variable SOURCE_DATE_EPOCH, for files that are the same
        each time.
    content : callable
        Function that returns the scene that was solved, with all changes except those within instances of parts, and
        these by their paths.
    """

    changes: tuple[str, ...]
    command: str
    version: str
    date: str
    content: Callable[[], tuple[Content, dict[str, object]]] = field(compare=False, repr=False)

    @cached_property
    def _effective(self) -> tuple[Content, dict[str, object]]:
        return self.content()

    @property
    def scene(self) -> Content:
        """Scene that was solved, with all changes, as in a scene file."""
        return self._effective[0]

    @property
    def changes_in_parts(self) -> dict[str, object]:
        """Changes within instances of parts, by their paths, which `scene` does not contain."""
        return self._effective[1]

    @property
    def scene_text(self) -> str:
        """Text of a scene file of the scene that was solved; comments name changes within instances of parts."""
        options = [
            f"# run it with --set {shlex.quote(f'{path}={value}')}\n" for path, value in self._effective[1].items()
        ]
        return "".join(options) + scene_text(json.loads(self.as_texts()["scene"]))

    def as_texts(self) -> dict[str, str]:
        """Return all of it as texts by name; the scene in JSON, which is a scene file too."""
        scene, in_parts = self._effective
        return {
            "scene": _json(scene),
            **({"changes_in_parts": _json(in_parts)} if in_parts else {}),
            "changes": "\n".join(self.changes),
            "command": self.command,
            "version": self.version,
            "date": self.date,
        }

    def as_json(self) -> str:
        """Return `as_texts` as one JSON object."""
        return _json(self.as_texts())


def from_json(text: str) -> Provenance:
    """Return what `Provenance.as_json` wrote."""
    found = json.loads(text)
    changes = tuple(found["changes"].splitlines())
    content = partial(_pair, json.loads(found["scene"]), json.loads(found.get("changes_in_parts", "{}")))
    return Provenance(changes, found["command"], found["version"], found["date"], content)


def _pair(scene: Content, in_parts: dict[str, object]) -> tuple[Content, dict[str, object]]:
    return scene, in_parts


def provenance_of(
    data: ModelData | WrittenScene, settings: RunSettings | None = None, others: tuple[str, ...] = (),
    state: SavedState | None = None,
) -> Provenance:  # fmt: skip
    """Return the origin of results of a model or scene.

    `settings`: those of the run; by default those of the scene. `others`: further changes. `state`: start of the run.
    """
    own = data.run if isinstance(data, Scene) else RunSettings()
    chosen = {name: value for name, value in settings or () if value != getattr(own, name)}
    if state is not None:
        others = (*others, f"start from the state at t = {state.t:g} s of {state.source}")
    return with_settings(data, chosen, others)


def with_settings(
    data: ModelData | WrittenScene, chosen: Mapping[str, object], others: tuple[str, ...] = ()
) -> Provenance:
    """Return the origin of results with settings that differ from those of the scene."""
    from .. import __version__

    read = data if isinstance(data, WrittenScene) else _source(data)
    listed = (*(read.changes if read else ()), *((f"run.{name}", value) for name, value in chosen.items()))
    changes = (*[f"{path} = {value}" for path, value in listed], *others)
    return Provenance(changes, command_line(), __version__, date(), partial(_content, data, dict(chosen)))


def _source(data: ModelData) -> WrittenScene | None:
    return data._written if isinstance(data, Scene) else None


def _content(data: ModelData | WrittenScene, chosen: Mapping[str, object]) -> tuple[Content, dict[str, object]]:
    """Return a scene or model as in a scene file, with other settings."""
    content, in_parts = _of_data(data)
    if not chosen:
        return content, in_parts
    from ..model.model_text import written

    run = {name: written(value) for name, value in chosen.items() if value is not None}
    known = {name: value for name, value in (content.get("run") or {}).items() if name not in chosen}
    return content | {"run": known | run}, in_parts


def _of_data(data: ModelData | WrittenScene) -> tuple[Content, dict[str, object]]:
    from ..model.files.effective import effective

    if isinstance(data, WrittenScene):
        return effective(data)
    read = _source(data)
    if read is not None and isinstance(data, Scene) and data.is_as_read:
        return effective(read)
    from ..model.model_text import model_content

    try:
        return model_content(data) | _of_scene(data), {}
    except InputError:  # a flexible body, or a Python function, which no scene file can hold
        return effective(read) if read is not None else ({"name": data.name}, {})


def _of_scene(data: ModelData) -> Content:
    """Return the sections of a changed scene that a model does not have, if they differ from their defaults."""
    if not isinstance(data, Scene):
        return {}
    from ..model.model_text import written

    values = {name: getattr(data, name) for name in ("start", "at_start", "stages", "figure", "units", "notes", "run")}
    defaults = {name: Scene.model_fields[name].get_default(call_default_factory=True) for name in values}
    return {name: written(value) for name, value in values.items() if value != defaults[name]}


def metadata_file(path: Path) -> Path:
    """Return the file that accompanies a table without place for it (W3C, Metadata Vocabulary for Tabular Data, 2015)."""
    return path.with_name(f"{path.name}-metadata.json")


def _json(found: object) -> str:
    return json.dumps(found, ensure_ascii=False, default=_plain)


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else str(value)
