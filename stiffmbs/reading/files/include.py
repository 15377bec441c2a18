"""Inclusion of other files: ``include: suspension.yaml``, at the top of a scene or of one of its parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os.path import relpath
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ...errors import InputError
from .quoted import quoted, written
from .read_before import read_yaml_file
from .text_file import STANDARD_INPUT, file_text
from .yaml_text import Content, line_and_depth, line_of

INCLUDE, PARTS = "include", "parts"
MOST_FILES = 100
"""Largest number of included files; repeated inclusions count."""
LARGEST = 20_000_000
"""Largest size of an included file, bytes."""
PLACES = (
    ("bodies", "*", "mesh"),
    ("bodies", "*", "matrices"),
    *(("bodies", "*", "matrices", key) for key in ("stiffness", "mass", "nodes", "rows")),
    ("bodies", "*", "geometry", "file"),
    ("bodies", "*", "geometry", "*", "file"),
    ("forces", "*", "properties"),
    ("forces", "*", "road", "file"),
    ("roads", "*", "file"),
)
"""Paths of the names of files in a scene; a star is any name, or any place in a list."""
SECTIONS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"parts": ("*",), "options": ("*", "*"), "stages": ("*", "change")}
)
"""Paths of further sections, in the sections that have them."""


@dataclass
class Sources:
    """Texts of a scene."""

    # name in messages, text, and path of keys in the scene at which its content is inserted
    texts: list[tuple[str, str, tuple[str, ...]]] = field(default_factory=list)

    def line(self, path: tuple[object, ...]) -> str | None:
        """Return the line of the deepest known key of a path, with the file if it is an included one."""
        deepest, line = 0, None
        for k, (source, text, above) in enumerate(self.texts):
            if path[: len(above)] != above:
                continue
            found, depth = line_and_depth(text, path[len(above) :])
            if found and depth + len(above) > deepest:
                deepest, line = depth + len(above), str(found) if k == 0 else f"{found} of {source}"
        return line


def read_including(text: str, source: str, file: Path | None) -> tuple[Any, Callable[[tuple[object, ...]], str | None]]:
    """Read a YAML text and the files that it includes; return the content, and `Sources.line` as a function of a path.

    `source`: name of the text in messages. `file`: file of the text; included files are relative to its folder, or to
    the working folder if it is None. Raises InputError for a file that cannot be read, that includes itself, or that
    has a name twice.
    """
    sources = Sources([(source, text, ())])
    found = read_yaml_file(text, source, file)
    if isinstance(found, dict):
        own = (file.resolve(),) if file else ()
        found = _Including(sources, file.parent if file else Path()).whole(found, source, Path(), own, ())
    return found, sources.line


@dataclass(frozen=True)
class _Place:
    """Key of a file; as text its file, line and path, for the beginning of a message, as to find the line takes long."""

    sources: Sources
    source: str
    path: tuple[str, ...]

    def __str__(self) -> str:
        known = ((text, above) for name, text, above in reversed(self.sources.texts) if name == self.source)
        text, above = next(known, ("", ()))
        line = line_of(text, self.path[len(above) :])
        return f"{self.source}, {f'line {line}, ' if line else ''}{'.'.join(self.path)}"


@dataclass
class _Including:
    sources: Sources
    folder: Path  # of the scene; all other folders are seen from it

    def whole(
        self, found: dict[str, object], source: str, folder: Path, within: tuple[Path, ...], path: tuple[str, ...]
    ) -> dict[str, object]:
        """Return a mapping with its includes and those of its parts resolved."""
        found = self._opened(found, source, folder, within, path)
        parts = found.get(PARTS)
        if isinstance(parts, dict):
            opened = {
                name: self._opened(part, source, folder, within, (*path, PARTS, str(name))) if isinstance(part, dict) else part
                for name, part in parts.items()
            }  # fmt: skip
            found = {**found, PARTS: opened}
        return found

    def _opened(
        self, found: dict[str, object], source: str, folder: Path, within: tuple[Path, ...], path: tuple[str, ...]
    ) -> dict[str, object]:
        if INCLUDE not in found:
            return found
        where = _Place(self.sources, source, (*path, INCLUDE))
        merged: dict[str, object] = {}
        owners: dict[tuple[object, ...], str] = {}
        for name in _listed(found[INCLUDE], where):
            file = self.folder / folder / name
            _add(merged, self._content(folder / name, where, within, path), str(file), owners, where)
        _add(merged, {key: value for key, value in found.items() if key != INCLUDE}, source, owners, where)
        return merged

    def _content(self, name: Path, where: _Place, within: tuple[Path, ...], path: tuple[str, ...]) -> dict[str, object]:
        file = self.folder / name
        if file.resolve() in within:
            raise InputError(f"{where}: found '{quoted(str(file))}', which includes itself, expected no circle")
        if len(self.sources.texts) > MOST_FILES:
            raise InputError(f"{where}: found more than {MOST_FILES} files, expected fewer")
        _check_file(file, where)
        text = file_text(file)
        self.sources.texts.append((str(file), text, path))
        found = read_yaml_file(text, str(file), file)
        if not isinstance(found, dict):
            raise InputError(
                f"{file}: found {'nothing' if found is None else 'other content'}, expected a mapping of sections"
            )  # no quote
        if name.parent != Path():
            found = _with_names_of_files(found, lambda own: self._from_scene(own, name))
        return self.whole(found, str(file), name.parent, (*within, file.resolve()), path)

    def _from_scene(self, name: str, within: Path) -> str:
        """Return the name of a file in an included file, seen from the folder of the scene.

        Raises InputError for one that starts from the folder of the scene, as in earlier versions.
        """
        own = within.parent / name
        if not (self.folder / own).exists() and (self.folder / name).exists():
            raise InputError(
                f"{self.folder / within}: found the file '{quoted(name)}', expected '{quoted(relpath(name, within.parent))}': "
                "names of files start from the folder of the file that has them"
            )
        return own.as_posix()


def _check_file(file: Path, where: _Place) -> None:
    """Refuse anything except a regular file of moderate size; reading a device may not end."""
    try:
        if not file.is_file():
            raise InputError(f"{where}: found no such file '{quoted(str(file))}', expected a YAML file")
        size = file.stat().st_size
    except (OSError, ValueError) as error:
        raise InputError(f"{where}: the file '{quoted(str(file))}' cannot be read ({error})") from None
    if size > LARGEST:
        raise InputError(f"{where}: found {size} bytes in '{quoted(str(file))}', expected at most {LARGEST}")


def _listed(found: Any, where: _Place) -> list[str]:
    names = found if isinstance(found, list) else [found]
    for name in names:
        if not isinstance(name, str) or not name or "\0" in name or name == STANDARD_INPUT:
            raise InputError(f"{where}: found {written(name)}, expected the name of a YAML file, or a list of them")
    return names


def _add(
    merged: Content, found: dict[str, object], source: str, owners: dict[tuple[object, ...], str], where: _Place
) -> None:
    """Merge the sections of a file; a name may occur in one file only."""
    for section, value in found.items():
        if not (isinstance(value, dict) and isinstance(merged.get(section, {}), dict)):
            _own((section,), merged, section, value, source, owners, where)
            continue
        merged[section] = dict(merged.get(section, {}))
        for name, entry in value.items():
            _own((section, name), merged[section], name, entry, source, owners, where)


def _own(
    path: tuple[str, ...], place: dict[str, object], name: Any, value: object, source: str,
    owners: dict[tuple[object, ...], str], where: _Place,
) -> None:  # fmt: skip
    if name in place and not (len(path) == 1 and place[name] == value):  # equal values may be repeated
        first = owners.get(path, "another file")
        raise InputError(f"{where}: found '{'.'.join(map(str, path))}' in {first} and in {source}, expected it in one")
    place[name] = value
    owners[path] = source


def _with_names_of_files(found: Any, change: Callable[[str], str]) -> Any:
    """Return the sections of a file with their names of files changed; Python objects and mappings stay as they are.

    The sections are not modified, because YAML aliases may share them.
    """
    if not isinstance(found, dict):
        return found
    for path in PLACES:
        found = _replaced(found, path, lambda name: change(name) if isinstance(name, str) else name)
    for section, path in SECTIONS.items():
        found = _replaced(found, (section, *path), lambda inner: _with_names_of_files(inner, change))
    return found


def _replaced(found: Any, path: tuple[str, ...], change: Callable[[Any], object]) -> Any:
    """Return content with the values at a path changed."""
    if not path:
        return change(found)
    first, *rest = path
    inner = tuple(rest)
    if isinstance(found, list) and first == "*":
        return [_replaced(part, inner, change) for part in found]
    if isinstance(found, dict):
        return {key: _replaced(part, inner, change) if first in (key, "*") else part for key, part in found.items()}
    return found
