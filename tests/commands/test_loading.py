"""How the command is loaded."""

import gc
import subprocess
import sys


def test_the_garbage_collector_waits_for_the_command_to_be_loaded_and_for_nothing_else():
    program = (
        "import gc, sys, runpy; sys.argv = ['stiffmbs', '--version']; import stiffmbs; print(gc.isenabled());"
        "import stiffmbs.commands.main as m; m.main = lambda: print(gc.isenabled(), gc.get_freeze_count() > 0);"
        "runpy.run_module('stiffmbs', run_name='__main__')"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["False", "True", "True"]
    assert gc.isenabled()  # of a program that imports the package
