"""What was derived and compiled, kept on disk: written once per source and machine, read back without a compiler.

An entry is one file: a digest, then the content.  It is written beside its place and moved there in one step, so
that a crash or a second process can leave no half of it; what does not match its digest is made again.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import cache
from pathlib import Path

FORMAT = "3"
"""Changed whenever the meaning of an entry's content changes."""
DIRECTORY_VARIABLE = "STIFFMBS_CACHE"


def cache_directory() -> Path:
    """Where compiled kernels are kept: the variable STIFFMBS_CACHE, or the user's cache directory."""
    chosen = os.environ.get(DIRECTORY_VARIABLE)
    if chosen:
        return Path(chosen)
    from platformdirs import user_cache_path

    return user_cache_path("stiffmbs", appauthor=False)


@cache
def machine_tag() -> str:
    """What an entry depends on besides its source: processor, LLVM and the versions that make it."""
    from importlib.metadata import version

    import llvmlite.binding as llvm

    parts = (
        llvm.get_process_triple(),
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        version("numba"),
        version("llvmlite"),
    )
    return "\n".join(parts)


def key_of(*parts: str) -> str:
    """The name of the entry for a source."""
    return hashlib.sha256("\0".join((FORMAT, *parts, machine_tag())).encode()).hexdigest()[:40]


def read(key: str) -> bytes | None:
    """The content of an entry, or None where there is none that is whole."""
    try:
        stored = (cache_directory() / key).read_bytes()
    except OSError:
        return None
    digest, content = stored[:32], stored[32:]
    return content if hashlib.sha256(content).digest() == digest else None


def write(key: str, content: bytes) -> None:
    """Keep an entry; a directory that cannot be written to costs a compilation at the next run and nothing else."""
    directory = cache_directory()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=directory, prefix=".part-")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(name, directory / key)
        except BaseException:
            os.unlink(name)
            raise
    except OSError:
        return
