"""The process that compiles drafts at their full level, as the process that starts it sees it."""

from __future__ import annotations

import math
import subprocess
import sys
import time
from pathlib import Path


class Finishing(subprocess.Popen[bytes]):
    """Process that finishes drafts and outlives this one, without a warning of that."""

    begin = math.inf

    def __del__(self) -> None:
        """Do nothing."""

    def has_ended(self) -> bool:
        """Return True if it ended for want of drafts, or another process worked then and may have ended since."""
        from .finish import WAITS

        return self.poll() is not None and time.monotonic() - self.begin > WAITS.patience


def started() -> Finishing | None:
    """Start the process, with the packages of this process and no others; None if the system refuses it."""
    import llvmlite
    import platformdirs

    packages = sorted({str(Path(file).parents[1]) for file in (llvmlite.__file__, platformdirs.__file__)})
    path = [str(Path(__file__).parents[3]), *packages]
    command = f"import sys; sys.path.extend({path!r}); from {__package__}.finish import finish; finish()"
    quiet = subprocess.DEVNULL
    low = getattr(subprocess, "IDLE_PRIORITY_CLASS", 0)
    arguments = [sys.executable, "-I", "-S", "-c", command]
    try:
        process = Finishing(
            arguments, stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True, creationflags=low
        )
    except OSError:
        return None
    process.begin = time.monotonic()
    return process
