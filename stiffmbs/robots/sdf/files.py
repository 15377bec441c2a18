"""SDFormat files, their versions, and the files that they include."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from os.path import isdir, isfile
from pathlib import Path
from typing import Final

from ...reading.files.quoted import quoted
from ...reading.files.text_file import file_text
from ...reading.files.xml_nodes import FileFault, Node, parsed
from ..robot import RobotFault
from .parameters import SDF
from .poses import text_of

Version = tuple[int, ...]
OLDEST: Final[Version] = (1, 3)
NEWEST: Final[Version] = (1, 12)
OUTER = ("world", "model")
"""Elements that contain whole models; the kinds of elements in notes omit them."""
CONFIGURATION, MODEL = "model.config", "model.sdf"
"""Files in the folder of a model."""
SCHEMES = ("model://", "package://", "file://")


@dataclass(frozen=True)
class Source:
    """SDFormat file with its version. `path`: empty for the text of no file. `chain`: files that include it."""

    root: Node
    version: Version
    path: Path
    chain: tuple[Path, ...] = ()


@dataclass
class Files:
    """Reader of the included files of an SDFormat file; `read` holds all files read."""

    folder: Path
    read: list[Source] = field(default_factory=list)

    def source(self, path: Path, chain: tuple[Path, ...] = ()) -> Source:
        """Read a file; raises RobotFault if it is not SDFormat, and InputError if it cannot be read."""
        try:
            root = parsed(file_text(path), "an SDF file", {}, OUTER)
        except FileFault as fault:
            raise RobotFault(f"{_of_included(path, chain)}{fault}") from None
        if root.tag != "sdf":
            raise RobotFault(f"{_of_included(path, chain)}found <{root.tag}>, expected <sdf version=...>")
        if any("${" in value for node in root.walk() for value in (*node.attributes.values(), node.text)):
            raise RobotFault(f"{_of_included(path, chain)}found a macro, expected plain SDF: run xacro first")
        found = Source(root, _version(root, _of_included(path, chain)), path, chain)
        self.read.append(found)
        return found

    def included(self, where: str, uri: str, by: Source) -> Source | None:
        """Read the file of an ``<include>``; None if it does not exist.

        Raises RobotFault if files include each other, or are too many.
        """
        path = next((path for path in self._places(where, uri, by) if isfile(path)), None)
        if path is None:
            return None
        chain = (*by.chain, by.path.resolve())
        if path.resolve() in chain:
            raise RobotFault(
                f"{where}: found the file {quoted(str(path))}, which includes itself, expected another one"
            )
        if len(self.read) > SDF.files:
            raise RobotFault(f"{where}: found more than {SDF.files} included files, expected fewer")
        return self.source(path, chain)

    def _places(self, where: str, uri: str, by: Source) -> Iterator[Path]:
        """Yield the paths where the file of a uri may be; a folder stands for the model in it."""
        scheme = next((scheme for scheme in SCHEMES if uri.startswith(scheme)), "")
        if not scheme and re.match(r"[A-Za-z][\w+.-]*://", uri):
            raise RobotFault(
                f"{where}: found the uri {quoted(uri)} of a network, expected a file: download the model, and name its folder"
            )
        name = uri.removeprefix(scheme)
        nearest = dict.fromkeys(
            base for start in (by.path.parent, self.folder) for base in (start, start / "..", start / ".." / "..")
        )
        for base in nearest:
            for folder in (base, base / "models"):
                place = folder / name
                yield from (_models(place) if isdir(place) else (place,))


def _models(folder: Path) -> Iterator[Path]:
    """Yield the newest readable file of a model's folder by its configuration, then the usual one."""
    configuration = folder / CONFIGURATION
    if isfile(configuration):
        try:
            root = parsed(file_text(configuration), "the configuration of a model", {})
        except FileFault as fault:
            raise RobotFault(f"{quoted(str(configuration))}: {fault}") from None
        named = [(_numbered(sdf.get("version") or ""), sdf.text) for sdf in root.findall("sdf")]
        for version, name in sorted(named, reverse=True):
            if OLDEST <= version <= NEWEST or not version:
                yield folder / name
    yield folder / MODEL


def _of_included(path: Path, chain: tuple[Path, ...]) -> str:
    return f"{quoted(str(path))}: " if chain else ""


def _numbered(version: str) -> Version:
    """Return a version such as 1.12 as numbers; empty if it is none."""
    return tuple(map(int, version.split("."))) if re.fullmatch(r"[0-9]{1,3}(\.[0-9]{1,3})*", version) else ()


def _version(root: Node, where: str) -> Version:
    text = (root.get("version") or "").strip()
    version = _numbered(text)[:2]
    if not OLDEST <= version <= NEWEST:
        first, last = (".".join(map(str, bound)) for bound in (OLDEST, NEWEST))
        raise RobotFault(
            f"{where}found version='{quoted(text)}' of <sdf>, expected {first} to {last}: convert the file by 'gz sdf -p'"
        )
    return version


def named(where: str, node: Node) -> str:
    """Return the name of an element."""
    name = (node.get("name") or "").strip()
    if not name:
        raise RobotFault(f"{where}found a {node.tag} without a name, expected <{node.tag} name=...>")
    return name


def uri_of(where: str, include: Node) -> str:
    """Return the uri of an ``<include>``."""
    uri = text_of(include.find("uri")).strip().rstrip("/")
    if not uri:
        raise RobotFault(f"{where}: found an <include> without <uri>, expected the file of a model in it")
    return uri
