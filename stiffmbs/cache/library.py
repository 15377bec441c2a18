"""Library: entries that come with a wheel of the package, in an archive next to its modules.

The command ``.ci/library`` of the repository makes it. Installations from source have none. Names of entries are digests of
all sources that their content follows from, so that a changed source never meets an old entry.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zipfile import ZipFile

FILE = Path(__file__).parents[1] / "library.zip"


def read(name: str) -> bytes | None:
    """Return the content of an entry; None if the library does not have it, or cannot be read."""
    archive = _opened(FILE)
    try:
        return archive.read(name) if archive else None
    except (KeyError, OSError, ValueError, RuntimeError, NotImplementedError):
        return None
    except Exception as error:
        if type(error).__module__ in ("zipfile", "zlib"):  # damaged
            return None
        raise


@cache
def _opened(file: Path) -> ZipFile | None:
    if not file.is_file():
        return None
    from zipfile import BadZipFile, ZipFile

    try:
        return ZipFile(file)
    except (BadZipFile, OSError):
        return None
