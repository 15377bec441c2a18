"""How the command is loaded."""

import gc
import os
import subprocess
import sys

import pytest

from stiffmbs.commands.run import READ_BY_RICH

from ..conftest import EXAMPLES


@pytest.mark.long
@pytest.mark.parametrize("scene", [pytest.param("car", marks=pytest.mark.long), "half_car"])
def test_a_run_of_compiled_kernels_loads_neither_scipy_nor_sympy(scene):
    """Loading them takes longer than the search for the steady motion in which the car starts."""
    run = f"stiffmbs.run({str(EXAMPLES / f'{scene}.yaml')!r}, duration=0.1)"
    program = f"import sys, stiffmbs; {run}; print(sys.modules.keys() & {{'scipy', 'sympy'}})"
    for _ in range(2):  # the first may have to compile
        found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "set()"


@pytest.mark.long
def test_a_warm_run_does_not_load_the_metadata_of_packages(tmp_path):
    """Their imports take longer than reading the cached scene."""
    arguments = ["run", str(EXAMPLES / "cart_pendulum.yaml"), "-o", str(tmp_path / "out.npz")]
    program = f"import sys; sys.argv[1:] = {arguments}; from stiffmbs.commands.main import main; " + (
        "import atexit; atexit.register(lambda: print(sys.modules.keys() & {'importlib.metadata'})); main()"
    )
    for _ in range(2):  # the first may have to compile
        found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "set()"


@pytest.mark.long
def test_a_check_loads_no_solver(tmp_path):
    program = "import sys; from stiffmbs.commands.main import main; import atexit;" + (
        f"sys.argv[1:] = ['check', {str(EXAMPLES / 'cart_pendulum.yaml')!r}];"
        "atexit.register(lambda: print([name for name in sys.modules if name in ('stiffmbs.solve.auto', 'stiffmbs.solve.bdf')])); main()"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "[]"


def test_an_import_loads_no_dataclasses():
    program = "import sys, stiffmbs; print(sys.modules.keys() & {'dataclasses', 'inspect', 'numpy'})"
    found = subprocess.run(
        [sys.executable, "-S", "-c", program], capture_output=True, text=True, check=True, cwd=EXAMPLES.parent
    )
    assert found.stdout.strip() == "set()"


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("environment", [{}, {"COLUMNS": "90"}, {"PYTHONIOENCODING": "ascii"}])
def test_a_summary_in_a_file_loads_rich_only_where_it_changes_the_text(environment, tmp_path):
    arguments = ["run", str(EXAMPLES / "cart_pendulum.yaml"), "-o", str(tmp_path / "out.npz"), "--duration", "0.1"]
    program = f"import sys; sys.argv[1:] = {arguments}; from stiffmbs.commands.main import main; " + (
        "import atexit; atexit.register(lambda: print('rich.console' in sys.modules)); main()"
    )
    given = {name: value for name, value in os.environ.items() if name not in READ_BY_RICH}
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, check=True,
        env={**given, "PYTHONIOENCODING": "utf-8", **environment},
    )  # fmt: skip
    assert found.stdout.split()[-1] == str(bool(environment)).encode()


def test_the_garbage_collector_waits_for_the_command_to_be_loaded_and_for_nothing_else():
    program = (
        "import gc, sys, runpy; sys.argv = ['stiffmbs', '--version']; import stiffmbs; print(gc.isenabled());"
        "import stiffmbs.commands.main as m; m.main = lambda: print(gc.isenabled(), gc.get_freeze_count() > 0);"
        "runpy.run_module('stiffmbs', run_name='__main__')"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["False", "True", "True"]
    assert gc.isenabled()  # of a program that imports the package


def test_what_was_registered_for_the_end_of_the_process_before_the_command_is_called(tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import atexit; atexit.register(print, 'called')")
    path = os.pathsep.join((str(tmp_path), *filter(None, sys.path)))
    found = subprocess.run(
        [sys.executable, "-m", "stiffmbs", "--version"], capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
    assert found.stdout.split()[-1] == "called"


@pytest.mark.long
@pytest.mark.parametrize("scene", ["half_car", "car"])
def test_a_check_of_a_scene_that_was_read_before_builds_no_validators(scene):
    """Each takes milliseconds; a cached scene is not validated, and what follows from it is constructed without."""
    program = (
        "import sys, stiffmbs; from stiffmbs.reading.fields import Described;"
        f"stiffmbs.check({str(EXAMPLES / f'{scene}.yaml')!r});"
        "found = [Described];"
        "[found.extend(kind.__subclasses__()) for kind in found];"
        "print(*[kind.__name__ for kind in found if kind.__pydantic_complete__], 'of', len(found))"
    )
    for _ in range(2):  # the first may have to read it
        found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split()[0] == "of"
