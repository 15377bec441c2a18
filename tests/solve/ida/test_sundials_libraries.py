"""The libraries of SUNDIALS: found under their names, and what is said where they do not serve."""

import subprocess
import sys

import numpy as np
import pytest

import stiffmbs
from stiffmbs.solve.ida import libraries


@pytest.fixture
def loaded_again():
    libraries.ida_libraries.cache_clear()
    yield
    libraries.ida_libraries.cache_clear()


REMEDY = "expected the libraries of a wheel of scikit-sundae 1.2 or later with SUNDIALS .; use solver projected$"


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_runs_with_other_libraries_stop_with_the_reason_and_a_remedy(
    solver, examples, loaded_again, monkeypatch, tmp_path
):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    monkeypatch.setattr(libraries, "_folder", lambda: tmp_path)
    with pytest.raises(stiffmbs.SolverError, match=f"no library sundials_core found in {tmp_path}; {REMEDY}"):
        stiffmbs.run(scene, solver=solver)
    assert stiffmbs.run(scene, solver="projected").message == "completed"


def test_other_versions_and_precisions_are_refused(loaded_again, monkeypatch):
    monkeypatch.setattr(libraries, "VERSION", 8)
    with pytest.raises(libraries.Unavailable, match=rf"carries SUNDIALS 7\..* version 8; {REMEDY}"):
        libraries.ida_libraries()
    monkeypatch.undo()
    monkeypatch.setattr(libraries.np, "ones", lambda n: np.full(n, 0.5))
    assert libraries.ida_libraries()
    monkeypatch.setattr(libraries.np, "sum", lambda values: 4.0)
    libraries.ida_libraries.cache_clear()
    with pytest.raises(libraries.Unavailable, match=f"do not work in double precision; {REMEDY}"):
        libraries.ida_libraries()


@pytest.mark.parametrize(
    ("name", "library"),
    [
        ("libsundials_ida-16d992eb.so.7.9.0", "ida"), ("libsundials_ida.so.7", "ida"), ("libsundials_ida.so", "ida"),
        ("libsundials_ida.7.9.0.dylib", "ida"), ("libsundials_ida.dylib", "ida"), ("sundials_ida.dll", "ida"),
        ("libsundials_ida-7-0123abcd.dll", "ida"), ("libsundials_idas-16d992eb.so.7.9.0", None),
        ("libsundials_core.so.7", "core"), ("libsundials_ida.a", None),
    ],
)  # fmt: skip
def test_libraries_are_known_by_name_on_every_system(tmp_path, name, library):
    (tmp_path / name).touch()
    found = [known for known in ("ida", "core") if libraries._matching(tmp_path, known)]
    assert found == ([library] if library else [])


@pytest.mark.long
def test_scikit_sundae_is_not_imported():
    code = (
        "import sys; from stiffmbs.solve.ida.libraries import ida_libraries; "
        "assert ida_libraries(); assert 'sksundae' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
