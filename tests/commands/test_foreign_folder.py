"""No command imports a module of the current folder, which may come from anywhere."""

import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from ..conftest import EXAMPLES

MODULES = (
    "json",
    "numpy",
    "pickle",
    "threading",
    "signal",
    "sympy",
    "multiprocessing",
    "concurrent",
    "starlette",
    "typing",
)
START = (
    "import sys; sys.path.pop(0); import os; os.environ.pop('PYTHONSAFEPATH', None); sys.argv[0] = 'stiffmbs'; "
    "from stiffmbs.__main__ import start; start()"
)
"""Start of the command as by its script: the current folder is not on the search path of this process."""
RAN = "this_ran"


@pytest.fixture
def folder(tmp_path):
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / RAN)!r}, 'a').write({name!r})\n")
    (tmp_path / "scene.yaml").write_text((EXAMPLES / "bar_pendulum.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    return tmp_path


@contextmanager
def started(folder, *arguments) -> Iterator[subprocess.Popen[str]]:
    """The command in that folder, which is killed at the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", START, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.long
@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "scene.yaml"),
        ("study", "scene.yaml", "--vary", "L=0.5:0.7:3", "--of", "final(bar.x)", "--processes", "--workers", "2"),
        pytest.param(("check", "scene.yaml"), marks=pytest.mark.long),
        pytest.param(("modes", "scene.yaml"), marks=pytest.mark.long),
        pytest.param(("report", "scene.yaml"), marks=pytest.mark.long),
        pytest.param(("draw", "scene.yaml", "-o", "a.svg"), marks=pytest.mark.long),
        pytest.param(("animate", "scene.yaml", "-o", "a.gif"), marks=pytest.mark.long),
        pytest.param(("convert", "scene.yaml", "-o", "a.adm"), marks=pytest.mark.long),
        pytest.param(("compare", "scene.yaml", "--rtol", "1e-3:1e-5"), marks=pytest.mark.long),
        pytest.param(("equilibrium", "scene.yaml"), marks=pytest.mark.long),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_command_imports_nothing_from_the_current_folder(folder, arguments):
    with started(folder, *arguments) as process:
        output, _ = process.communicate(timeout=300)
    assert process.returncode == 0, output
    assert not (folder / RAN).exists(), (folder / RAN).read_text()


@pytest.mark.long
def test_workers_of_a_page_import_nothing_from_the_current_folder(folder):
    pytest.importorskip("starlette")
    pytest.importorskip("uvicorn")
    with started(folder, "open", "scene.yaml", "--no-browser") as process:
        assert process.stdout is not None
        assert any(re.search(r"http://\S+", line) for line in process.stdout)
        time.sleep(1.0)  # a worker has begun to import
        assert process.poll() is None
    assert not (folder / RAN).exists(), (folder / RAN).read_text()


def test_processes_of_a_pool_import_nothing_from_the_current_folder(folder):
    program = "import sys; sys.path.pop(0); from stiffmbs.processes import process_pool; import operator\n"
    program += "with process_pool(2) as pool: print(list(pool.map(operator.neg, [1, 2])))"
    found = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, timeout=120)
    assert found.stdout == "[-1, -2]\n", found.stderr
    assert not (folder / RAN).exists(), (folder / RAN).read_text()
