"""Local arrays of compiled code that start as NaN, so that a value that is read before it is written shows.

As a plugin, for any tests: ``python -m pytest -p tests.unset_memory ...``. The changed code has a cache of its own.
"""

import os
import tempfile

from stiffmbs.compile.machine.translate.code import Code

CACHE, OWN = "STIFFMBS_CACHE", "STIFFMBS_UNSET_MEMORY"
FILL = "llvm.memset.p0.i64"

_doubles = Code.doubles


def pytest_configure() -> None:
    """Fill the local arrays of all functions that this process and its workers compile from now on."""
    if OWN not in os.environ:
        os.environ[OWN] = os.environ[CACHE] = tempfile.mkdtemp(prefix="unset")
    Code.doubles = filled_doubles


def filled_doubles(code, count):
    """Allocate doubles for the duration of the function, as `Code.doubles`; all bytes are 0xFF, which is NaN."""
    array = _doubles(code, count)
    code.unit.declare(f"declare void @{FILL}(ptr, i8, i64, i1)")
    code._entry.append(f"call void @{FILL}(ptr {array.text}, i8 -1, i64 {8 * count}, i1 false)")
    return array
