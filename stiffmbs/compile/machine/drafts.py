"""Drafts: code that was compiled with little optimisation, and is to be compiled at its full level later.

A first run uses drafts, because compiling them takes a fifth of the time. An entry ``draft`` of the cache holds the
object code of a draft and the assembly that it was made from. One process of lowest priority compiles all drafts at
their full level (`stiffmbs.compile.machine.finish`), stores the results under the names that later lookups ask for, and
removes the drafts. Both give bit-equal results.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ...cache import entries
from .object_code import object_code

VARIABLE = "STIFFMBS_DRAFTS"
"""Environment variable; with ``0`` everything is compiled at its full level at once."""
_BATCH = ("SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "SGE_TASK_ID", "OAR_JOB_ID", "FLUX_JOB_ID", "COBALT_JOBID")
"""Variables that batch systems set: processes beyond the end of a job are not wanted there."""
_FULLY: ContextVar[bool] = ContextVar("fully", default=False)
_used: set[str] = set()
"""Names of the drafts that this process has linked."""


class Draft(NamedTuple):
    """Entry of the cache: the `entry` that it stands for, of a machine, with the settings of its full level."""

    entry: str
    machine: str
    level: int
    unrolled: bool
    code: bytes
    assembly: str

    def packed(self) -> bytes:
        """Return the content of the entry."""
        head = json.dumps([self.entry, self.machine, self.level, self.unrolled, len(self.code)])
        return head.encode() + b"\n" + self.code + zlib.compress(self.assembly.encode(), 1)

    @classmethod
    def unpacked(cls, content: bytes) -> Draft:
        """Return the draft in an entry; raises ValueError if it is of another form."""
        head, _, rest = content.partition(b"\n")
        entry, of_machine, level, unrolled, size = json.loads(head)
        try:
            return cls(entry, of_machine, level, unrolled, rest[:size], zlib.decompress(rest[size:]).decode())
        except zlib.error as error:
            raise ValueError(str(error)) from None

    def finished(self) -> bytes:
        """Return the object code at the full level."""
        return object_code(self.assembly, self.level, self.unrolled)


def draft_in(name: str) -> Draft | None:
    """Return the draft in an entry of the cache; None if there is none, or it has another form."""
    try:
        return Draft.unpacked(entries.read(name) or b"")
    except (ValueError, TypeError):
        return None


def name_of(entry: str) -> str:
    """Return the name of the draft of an entry."""
    return entries.name_of("draft", entry)


def are_allowed() -> bool:
    """Return True if drafts may be used: they can be stored, and a process that finishes them may be started."""
    return not _FULLY.get() and _can_be_finished(entries.cache_directory())


@cache
def _can_be_finished(directory: Path) -> bool:
    if os.environ.get(VARIABLE) == "0" or any(name in os.environ for name in _BATCH):
        return False
    return entries.is_writable(directory)


@contextmanager
def none() -> Iterator[None]:
    """Use no drafts within a context."""
    token = _FULLY.set(True)
    try:
        yield
    finally:
        _FULLY.reset(token)


def use(name: str) -> None:
    """Record that this process uses a draft, and start the process that finishes drafts at the first one."""
    if not _used:
        _start_finishing()
    _used.add(name)


def some_are_finished() -> bool:
    """Return True if drafts that this process uses were finished since; such drafts are in use no longer."""
    folder = entries.folder() if _used else Path()
    finished = {name for name in _used if not (folder / name).exists()}
    _used.difference_update(finished)
    return bool(finished)


def are_used() -> bool:
    """Return True if this process uses drafts, unless none are allowed in this context."""
    return bool(_used) and not _FULLY.get()


def _start_finishing() -> None:
    """Start the process that compiles drafts, with the packages of this process and no others, and do not wait for it."""
    import llvmlite
    import platformdirs

    packages = sorted({str(Path(file).parents[1]) for file in (llvmlite.__file__, platformdirs.__file__)})
    path = [str(Path(__file__).parents[3]), *packages]
    command = f"import sys; sys.path[:0] = {path!r}; from {__package__}.finish import finish; finish()"
    quiet = subprocess.DEVNULL
    low = getattr(subprocess, "IDLE_PRIORITY_CLASS", 0)
    with suppress(OSError):
        subprocess.Popen(
            [sys.executable, "-I", "-c", command], stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True, creationflags=low
        )  # fmt: skip
