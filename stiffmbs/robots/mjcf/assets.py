"""Files referred to by an MJCF file. MuJoCo opens them itself, and would block on a pipe."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from xml.etree import ElementTree

from ...reading.files.files_read import check_regular
from ...reading.files.quoted import quoted
from ...reading.files.text_file import file_text
from ..robot import RobotFault

FILE, INCLUDE = "file", "include"
FOLDERS = ("assetdir", "meshdir", "texturedir")


def check_assets(path: Path) -> None:
    """Refuse an MJCF file that refers, directly or through included files, to anything but regular files.

    Raises
    ------
    RobotFault
    InputError
        If an included file cannot be read as text.
    """
    waiting, seen = [path], set[Path]()
    while waiting:
        file = waiting.pop()
        if file in seen:
            continue
        seen.add(file)
        for name, included in _named(file, path.parent):
            try:
                check_regular(name)
            except FileNotFoundError:
                continue
            except (OSError, ValueError) as error:
                reason = getattr(error, "strerror", None) or error
                raise RobotFault(f"{quoted(str(name))}: the file cannot be read ({reason})") from None
            if included:
                waiting.append(name)


def _named(file: Path, folder: Path) -> Iterator[tuple[Path, bool]]:
    """Yield the paths where MuJoCo may search for named files, and True for included files."""
    with suppress(ElementTree.ParseError):  # MuJoCo reports the error
        root = ElementTree.fromstring(file_text(file))
        folders = {folder} | {folder / value for part in root.iter() for at in FOLDERS if (value := part.get(at))}
        for part in root.iter():
            if name := part.get(FILE):
                yield from ((each / name, part.tag == INCLUDE) for each in folders)
