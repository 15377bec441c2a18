"""Disk cache of derived and compiled code, written once per source and machine.

Entries of one package version on one kind of machine share a folder.
"""

from __future__ import annotations

from functools import cache

from ...cache.entries import Folder, digest, tag_of

FORMAT = "6"
"""Version of the format of entries."""
RECORD, KERNEL, ROUTINE = "record", "kernel", "routine"
"""Kinds of entries: derivation record of a kind of element, its machine code, and that of solvers."""
FOLDER = "entries"


@cache
def own_folder() -> Folder:
    """Return the folder for this package, processor and LLVM version."""
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
    """Return the entry name of a source."""
    return f"{kind}-{digest(*parts)}"
