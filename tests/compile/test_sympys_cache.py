"""SymPy's own cache of results: larger for derivations, unless the user has said how large."""

import os
import subprocess
import sys

import pytest

VARIABLE = "SYMPY_CACHE_SIZE"


@pytest.mark.long
@pytest.mark.parametrize(("given", "expected"), [(None, "20000 False"), ("5000", "5000 True")])
def test_derivations_have_a_larger_one_and_leave_the_environment_as_it_is(given, expected):
    script = (
        "import os, stiffmbs.compile.symbolic\nfrom sympy.core import cache\n"
        f"print(cache.{VARIABLE}, {VARIABLE!r} in os.environ)"
    )
    environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
    environment |= {} if given is None else {VARIABLE: given}
    shown = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == expected
