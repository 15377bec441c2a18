"""Compiled code writes its local arrays before it reads them: with arrays that start as NaN, results stay numbers."""

import os
import subprocess
import sys

import numpy as np
import pytest

from stiffmbs.compile.machine.compiler import compiled_source

from .. import unset_memory

READS = """
from stiffmbs.compile.machine.native.access import room


def kernel(value):
    array = room(2)
    array[0] = 1.0
    value[0] = array[0] + 0.0 * array[1]
"""


def test_a_read_before_a_write_shows(tmp_path, monkeypatch):
    """The plugin itself: an entry that is never written makes a sum NaN, even with a factor of zero."""
    monkeypatch.setenv(unset_memory.CACHE, str(tmp_path))
    monkeypatch.setattr(unset_memory.Code, "doubles", unset_memory.filled_doubles)
    value = np.zeros(1)
    compiled_source(READS, "kernel", "void(float64*)").call(value.ctypes.data)
    assert np.isnan(value[0])


@pytest.mark.sampled(2)
@pytest.mark.long(60)
@pytest.mark.parametrize(
    ("tests", "marked"),
    [
        ("tests/flexible_bodies/test_flexible_sensitivities.py", "not long"),
        ("tests/elements/test_directional_derivatives.py", "long"),
    ],
)
def test_results_do_not_depend_on_memory_that_is_not_written(tests, marked, tmp_path):
    command = [sys.executable, "-m", "pytest", "-p", "tests.unset_memory", "-n", "0", "-m", marked, tests]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    environment |= {unset_memory.OWN: "1", unset_memory.CACHE: str(tmp_path)}
    found = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout[-4000:]
