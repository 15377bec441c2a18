"""Drafts: code that was compiled with little optimisation, and is to be compiled at its full level later.

A first run uses drafts, because compiling them takes a fifth of the time. An entry ``draft`` of the cache holds the
object code of a draft and the assembly that it was made from. One process of lowest priority compiles all drafts at
their full level (`stiffmbs.compile.machine.finish`), stores the results under the names that later lookups ask for, and
removes the drafts. Both give bit-equal results.
"""

from __future__ import annotations

import json
import os
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ...cache import entries, library
from .object_code import object_code, origin

if TYPE_CHECKING:
    from .finishing import Finishing

VARIABLE = "STIFFMBS_DRAFTS"
"""Environment variable; with ``0`` everything is compiled at its full level at once."""
_BATCH = ("SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "SGE_TASK_ID", "OAR_JOB_ID", "FLUX_JOB_ID", "COBALT_JOBID")
"""Variables that batch systems set: processes beyond the end of a job are not wanted there."""


class Tier(IntEnum):
    """Code that may be used: of the full level for this processor, of the library too, drafts too."""

    NATIVE = 0
    LIBRARY = 1
    DRAFT = 2


_TIER: ContextVar[Tier] = ContextVar("tier", default=Tier.LIBRARY)
_used: dict[str, bool] = {}
"""Names of the drafts that this process has linked, with `Draft.is_quick`."""
OPEN = "@entry@"
"""Part of the names of functions in assembly, which is replaced before it is compiled."""


_finishing: list[Finishing] = []
"""Processes that finish drafts, started by this one."""


class Draft(NamedTuple):
    """Compiled functions with the assembly that their code was made from.

    - `entry`: name of the entry that stands for them at the full level.
    - `origin`: of the entry, as `stiffmbs.compile.machine.object_code.origin` gives it.
    - `level`, `unrolled`: settings of the full level.
    - `is_quick`: whether the code was compiled at the level `DRAFT`, not for the library.
    - `symbols`: part of the names of functions in the code, for `stiffmbs.compile.machine.linking.symbol`; that of the
      assembly is `OPEN`.
    - `assembly`: compressed; empty for code of the library that is used for good.
    """

    entry: str
    origin: str
    level: int
    unrolled: bool
    is_quick: bool
    symbols: str
    code: bytes
    assembly: bytes

    def packed(self) -> bytes:
        """Return the content of the entry."""
        head = json.dumps([*self[:-2], len(self.code), len(self.assembly)])
        return head.encode() + b"\n" + self.code + self.assembly

    @classmethod
    def unpacked(cls, content: bytes) -> Draft:
        """Return the draft in an entry; raises ValueError if it is of another form."""
        head, _, rest = content.partition(b"\n")
        entry, of_origin, level, unrolled, is_quick, symbols, size, behind = json.loads(head)
        if len(rest) != size + behind:
            raise ValueError(f"found {len(rest)} bytes, expected {size + behind}")
        return cls(entry, of_origin, level, unrolled, is_quick, symbols, rest[:size], rest[size:])

    def text(self, names: str) -> str:
        """Return the assembly with a part of the names of its functions."""
        return zlib.decompress(self.assembly).decode().replace(OPEN, names)

    def finished(self) -> bytes:
        """Return the object code at the full level."""
        return object_code(self.text(self.entry), self.level, self.unrolled)


def draft_in(content: bytes | None) -> Draft | None:
    """Return the draft in the content of an entry; None if there is none, or it has another form."""
    try:
        return Draft.unpacked(content or b"")
    except (ValueError, TypeError):
        return None


def stored(entry: str) -> Draft | None:
    """Return the draft of an entry in the cache, if there is one."""
    found = draft_in(entries.read(name_of(entry)))
    return found if found is not None and found.entry == entry else None


def draft_of(entry: str, shipped: str) -> Draft | None:
    """Return the draft of an entry in the cache, or code of the library, whose name is `shipped`; None without such of the tier."""
    found = stored(entry)
    if found is not None and found.is_quick and tier() < Tier.DRAFT:
        found = None
    if found is None and shipped and (found := draft_in(library.read(shipped))):
        found = found._replace(entry=entry, origin=origin())
        if found.assembly and not entries.write(name_of(entry), found.packed()):
            found = found._replace(assembly=b"")
    return found


def name_of(entry: str) -> str:
    """Return the name of the draft of an entry."""
    return entries.name_of("draft", entry)


def tier() -> Tier:
    """Return which code may be used in this context."""
    return Tier.NATIVE if os.environ.get(VARIABLE) == "0" else _TIER.get()


def can_be_finished() -> bool:
    """Return True if drafts can be stored, and a process that finishes them may be started.

    In a program that embeds Python, `sys.executable` may be that program, which is not to be started.
    """
    is_python = "python" in os.path.basename(sys.executable or "") and not hasattr(sys, "frozen")
    return is_python and _can_be_finished(entries.cache_directory())


@cache
def _can_be_finished(directory: Path) -> bool:
    return not any(name in os.environ for name in _BATCH) and entries.is_writable(directory)


@contextmanager
def down_to(lowest: Tier) -> Iterator[None]:
    """Use code of a tier and of higher ones within a context."""
    token = _TIER.set(lowest)
    try:
        yield
    finally:
        _TIER.reset(token)


def use(name: str, is_quick: bool) -> None:
    """Record that this process uses a draft, and start the process that finishes drafts unless it is at work."""
    if (not _used or (_finishing and all(process.has_ended() for process in _finishing))) and can_be_finished():
        _start_finishing()
    _used[name] = is_quick


def some_are_finished() -> bool:
    """Return True if drafts that this process uses were finished since; such drafts are in use no longer."""
    folder = entries.folder() if _used else Path()
    finished = [name for name in tuple(_used) if not (folder / name).exists()] if can_be_finished() else []
    for process in _finishing:
        process.poll()  # collects its exit status if it has ended
    for name in finished:
        _used.pop(name, None)  # another thread may have seen it
    return bool(finished)


def quick_ones_are_used() -> bool:
    """Return True if this process uses code of the level `DRAFT`."""
    return any(tuple(_used.values()))


def number_used() -> int:
    """Return how many drafts, and functions of the library, this process uses."""
    return len(_used)


def are_used() -> bool:
    """Return True if this process uses drafts or code of the library."""
    return bool(_used)


def _start_finishing() -> None:
    """Start the process that compiles drafts, and do not wait for it."""
    from .finishing import started

    if (process := started()) is not None:
        _finishing[:] = [*(other for other in _finishing if other.poll() is None), process]
