"""What was derived and compiled, kept on disk: written once per source and machine, read back without a compiler.

Entries of one version of the package on one kind of machine share a folder of their own.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from ...cache.entries import Folder, digest, tag_of

FORMAT = "6"
"""Changed whenever the meaning of an entry's content changes."""
RECORD, KERNEL, ROUTINE = "record", "kernel", "routine"
"""Kinds of entries: what was derived of a kind of element, its machine code, and that of solvers."""
FOLDER = "entries"


def own_directory() -> Path:
    """The entries of this version of the package on this machine."""
    return _own().path


@cache
def _own() -> Folder:
    """The folder of all that depends on the package, processor and LLVM besides its source."""
    import llvmlite
    import llvmlite.binding as llvm

    from ... import __version__

    parts = (
        FORMAT,
        __version__,
        llvm.get_process_triple(),
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        llvmlite.__version__,
    )
    return Folder(FOLDER, tag_of(*parts))


def name_of(kind: str, *parts: str) -> str:
    """The name of the entry for a source."""
    return f"{kind}-{digest(*parts)}"


def read(name: str) -> bytes | None:
    """The content of an entry; see `Folder.read`."""
    return _own().read(name)


def write(name: str, content: bytes) -> None:
    """Keep an entry; see `Folder.write`."""
    _own().write(name, content)
