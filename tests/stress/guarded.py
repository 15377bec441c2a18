"""Cases of stress with every array between guard pages: ``python -m tests.stress.guarded [CASE]...``.

Compiled code that reads or writes outside of an array then ends the process at that instruction, where it would else
change other memory or go unnoticed.  The cases run in a process of their own; what ends it is told with the case, and
where in Python it was.  Works where mmap and mprotect do.

Exit status: 0 nothing was found, 1 the process was ended, 2 there is no such case.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys

from stiffmbs.errors import StiffmbsError

from .catalogue import chosen, outcomes
from .guard_pages import BROKEN, GuardPages

CHILD = "--guarded"
ENDED, WRONG_INPUT = 1, 2


def main(arguments: list[str]) -> int:
    """Run the quick cases, or those that are named, in a guarded process; the exit status."""
    try:
        cases = chosen(arguments, quick=not arguments)
    except StiffmbsError as error:
        sys.stderr.write(f"stiffmbs: {error}\n")
        return WRONG_INPUT
    command = [sys.executable, "-X", "faulthandler", "-m", "tests.stress.guarded", CHILD, *arguments]
    status = subprocess.run(command).returncode
    if status == 0:
        print(f"{len(cases)} cases, nothing touched outside of its memory")
        return 0
    why = "a write outside of an array" if status == BROKEN else _ended_by(status)
    sys.stderr.write(f"stiffmbs: the case named last ended by {why}\n")
    return ENDED


def _ended_by(status: int) -> str:
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def guarded(arguments: list[str]) -> None:
    """Run the cases in this process, each announced by its name."""
    pages = GuardPages()
    pages.install()
    for family, case in chosen(arguments, quick=not arguments):
        print(f"{family}: {case.name}", end="", flush=True)
        (row,) = outcomes([(family, case)])
        print(f": {row.verdict.outcome.value}, {row.seconds:.1f} s, {pages.count} arrays", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == [CHILD]:
        guarded(sys.argv[2:])
        os._exit(0)  # without an interpreter's end, at which the allocators go before the arrays
    else:
        sys.exit(main(sys.argv[1:]))
