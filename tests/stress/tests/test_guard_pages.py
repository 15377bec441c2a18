"""Arrays between guard pages: compiled code that leaves one is stopped, and code that does not is left alone."""

import signal
import subprocess
import sys

import pytest

from tests.stress.guarded import main

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has no mprotect")

TOO_SHORT = """
import sys
import numpy as np
from stiffmbs.dynamics import saddle_point
from stiffmbs.sparse import elimination_order as factors
from tests.stress import guarded

whole = factors.factors_of
saddle_point.factors_of = lambda n, *pattern: whole(n, *pattern) | {{"{array}": np.zeros(n - 1)}}
guarded.guarded(["lattice of 4 x 4 cells"])
"""
PATTERN = """
import ctypes, os
import numpy as np
from tests.stress.guard_pages import GuardPages

GuardPages().install()
array = np.zeros(3, dtype=np.int32)
ctypes.memset(array.ctypes.data + {offset}, 0, 1)
del array
os._exit(0)
"""


def python(*arguments):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("cells", ["2 x 2 x 2", "4 x 4"])
def test_a_lattice_stays_within_its_arrays(cells):
    done = python("-m", "tests.stress.guarded", f"lattice of {cells} cells")
    assert done.returncode == 0, done.stderr
    assert "1 cases, nothing touched outside" in done.stdout


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("array", ["x", *(pytest.param(name, marks=pytest.mark.long) for name in ("work", "b"))])
def test_an_array_that_is_one_number_too_short_is_found(array):
    done = python("-c", TOO_SHORT.format(array=array))
    assert done.returncode == -signal.SIGSEGV


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(("offset", "status"), [(0, 0), (11, 0), (12, 70), (-1, 70)])
def test_bytes_beside_an_array_are_looked_at(offset, status):
    assert python("-c", PATTERN.format(offset=offset)).returncode == status


def test_an_unknown_case_is_refused(capsys):
    assert main(["no such case"]) == 2
    assert "found the case 'no such case'" in capsys.readouterr().err
