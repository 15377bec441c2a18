"""What was derived and compiled, kept on disk: written once per source and machine, read back without a compiler.

An entry is one file: a digest, then the content.  It is written beside its place and moved there in one step, so
that a crash or a second process can leave no half of it; what does not match its digest is made again.  Entries of
one version of the package on one kind of machine share a directory of their own.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

FORMAT = "5"
"""Changed whenever the meaning of an entry's content changes."""
DIRECTORY_VARIABLE = "STIFFMBS_CACHE"
RECORD, KERNEL, ROUTINE = "record", "kernel", "routine"
"""Kinds of entries: what was derived of a kind of element, its machine code, and that of solvers."""
PART = ".part-"
"""How the name of a file begins that is still being written."""


def cache_directory() -> Path:
    """Where compiled kernels are kept: the variable STIFFMBS_CACHE, or the user's cache directory."""
    chosen = os.environ.get(DIRECTORY_VARIABLE)
    if chosen:
        return Path(chosen)
    from platformdirs import user_cache_path

    return user_cache_path("stiffmbs", appauthor=False)


def own_directory() -> Path:
    """The entries of this version of the package on this machine."""
    return cache_directory() / f"entries-{_own_tag()}"


@cache
def _own_tag() -> str:
    """A name for what all entries depend on besides their sources: the package, processor and LLVM."""
    from importlib.metadata import version

    import llvmlite.binding as llvm

    parts = (
        FORMAT,
        version("stiffmbs"),
        llvm.get_process_triple(),
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        version("llvmlite"),
    )
    return _digest(*parts)[:12]


def name_of(kind: str, *parts: str) -> str:
    """The name of the entry for a source."""
    return f"{kind}-{_digest(*parts)}"


def _digest(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:40]


def read(name: str) -> bytes | None:
    """The content of an entry, or None where there is none that is whole."""
    try:
        stored = (own_directory() / name).read_bytes()
    except OSError:
        return None
    digest, content = stored[:32], stored[32:]
    return content if hashlib.sha256(content).digest() == digest else None


def write(name: str, content: bytes) -> None:
    """Keep an entry; a directory that cannot be written to costs a compilation at the next run and nothing else."""
    directory = own_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(dir=directory, prefix=PART)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(part, directory / name)
        except BaseException:
            os.unlink(part)
            raise
    except OSError:
        return
