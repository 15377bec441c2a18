"""Cache folder of file contents that were read before."""

from __future__ import annotations

from functools import cache

from ...cache.entries import Folder, tag_of

FORMAT = "1"
"""Version of the entries; increase it when the reading of YAML changes."""
MOST_FILES, MOST_BYTES = 1000, 50_000_000
"""Limits on the number of entries and on their total size in bytes."""


@cache
def folder_of_files() -> Folder:
    """Return the folder for this version of the package and of the YAML reader."""
    from importlib.metadata import version

    from ... import __version__

    return Folder("files", tag_of(FORMAT, __version__, version("ruamel.yaml")))


def keep(name: str, content: bytes) -> None:
    """Write an entry, and remove the oldest entries beyond the limits."""
    folder_of_files().write(name, content)
    folder_of_files().keep_newest(MOST_FILES, MOST_BYTES)
