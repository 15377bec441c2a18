"""Compiling on two processors what a run is about to need and the cache does not hold.

numba compiles one function at a time in a process, so a second process takes the routines, which are the same for all
scenes, while this one takes the scene's own kernels; both write to the cache, from which everything is then loaded.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence

from . import cache as store
from .machine import compiled_routine, compiled_source, routine_key, source_key
from .routines import Routine
from .system import System
from .terms import KERNEL_SIGNATURE

WORTH_A_PROCESS = 3
"""Missing routines from which a second process is started: it takes half a second to come up."""


def compile_ahead(system: System, term_sets: Sequence[str], routines: Sequence[Routine]) -> None:
    """Compile the kernels of a system's term sets and the routines of a run, whatever of them is not in the cache.

    A second process that cannot be started, or fails, costs nothing but time: what is still missing is compiled when
    it is asked for.
    """
    missing = [routine for routine in routines if not store.holds(routine_key(*_words(routine)))]
    if len(missing) < WORTH_A_PROCESS or (os.cpu_count() or 1) < 2 or not store.is_writable():
        return
    sources = {
        group.record.sources[name] for group in system.groups for name in term_sets if name in group.record.sources
    }
    helper = _started([_words(routine) for routine in missing])
    for source in sources:
        if not store.holds(source_key(source, KERNEL_SIGNATURE)):
            compiled_source(source, "kernel", KERNEL_SIGNATURE)
    if helper is None:
        return
    for routine in reversed(missing[1:]):  # from the other end of the list, until both meet
        if not store.holds(routine_key(*_words(routine))) and helper.poll() is None:
            compiled_routine(*_words(routine))
    helper.wait()


def _words(routine: Routine) -> tuple[str, str, str]:
    return routine.module, routine.name, routine.signature


def _started(routines: list[tuple[str, str, str]]) -> subprocess.Popen[bytes] | None:
    command = [sys.executable, "-c", "from stiffmbs.compile.ahead import main; main()"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    quiet = subprocess.DEVNULL
    try:
        helper = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet, env=environment)
        assert helper.stdin is not None
        helper.stdin.write(json.dumps(routines).encode())
        helper.stdin.close()
    except OSError:
        return None
    return helper


def main() -> None:
    """Compile the routines that standard input lists."""
    for routine in json.load(sys.stdin):
        if not store.holds(routine_key(*routine)):
            compiled_routine(*routine)
