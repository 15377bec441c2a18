"""The folder of the cache for files that were read before."""

from __future__ import annotations

from functools import cache

from ...cache.entries import Folder, tag_of

FORMAT = "1"
"""Changed whenever YAML is read in another way."""
MOST_FILES, MOST_BYTES = 1000, 50_000_000
"""That are kept."""


@cache
def folder_of_files() -> Folder:
    """The entries that this version of the package and of the reader of YAML make."""
    from importlib.metadata import version

    from ... import __version__

    return Folder("files", tag_of(FORMAT, __version__, version("ruamel.yaml")))


def keep(name: str, content: bytes) -> None:
    """Keep an entry; where there are many, those that were written first go."""
    folder_of_files().write(name, content)
    folder_of_files().keep_newest(MOST_FILES, MOST_BYTES)
