"""Process of lowest priority that compiles the drafts in the cache at their full level, and then the routines of all solvers.

A change of the solver then compiles nothing.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ...cache import entries
from ...cache.contents import FINISHING
from .compiler import compiled_ahead
from .drafts import draft_in
from .linking import sealed
from .object_code import origin
from .routines import Unit, units


@dataclass(frozen=True)
class Finishing:
    """Parameters of the process that compiles drafts.

    - `patience`: time, s, without a new draft after which it compiles the other routines, and then ends. A run makes several drafts;
      to derive the equations of one kind takes about a second between two of them.
    - `pause`: time, s, between two looks for drafts.
    """

    patience: float = 2.0
    pause: float = 0.2


WAITS = Finishing()


def finish() -> None:
    """Compile all drafts in the cache and those that are added meanwhile, then the routines that the cache does not have.

    Do nothing if another process does so.
    """
    if hasattr(os, "nice"):
        os.nice(19)
    with suppress(OSError), alone(entries.cache_directory() / FINISHING):
        seen: set[str] = set()
        last, ahead = time.monotonic(), compiled_ahead(_declared())
        while time.monotonic() - last < WAITS.patience or next(ahead, ""):
            for name in _drafts():
                if name not in seen:
                    seen.add(name)
                    finish_draft(name)
                    last = time.monotonic()
            time.sleep(WAITS.pause)


def _declared() -> Iterator[Unit]:
    """Yield all units of routines; their modules are imported at the first one."""
    yield from units()


def finish_draft(name: str) -> None:
    """Replace a draft by code at its full level; remove it if it is damaged, keep it if it is of another origin or cannot be replaced."""
    draft = draft_in(entries.read(name))
    if draft is not None and draft.origin != origin():
        return
    if draft is None or entries.write(draft.entry, sealed(draft.entry, draft.finished())):
        entries.remove(name)


def _drafts() -> list[str]:
    """Return the names of all drafts, oldest first."""
    found = []
    with suppress(OSError):
        for file in os.scandir(entries.folder()):
            with suppress(OSError):  # removed by another process
                found.append((file.stat().st_mtime_ns, file.name))
    return [name for _, name in sorted(found) if name.startswith("draft-")]


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Lock a file until the end of the context or of this process; raises OSError if another process has locked it."""
    with path.open("ab") as file:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
