"""The libraries of SUNDIALS: found under their names, and what is said where they do not serve."""

import subprocess
import sys

import pytest

from stiffmbs.solve.ida import libraries


def test_the_reason_is_told_where_the_libraries_do_not_serve(monkeypatch, tmp_path):
    assert libraries.available() == (True, "")
    monkeypatch.setattr(libraries, "VERSION", 8)
    libraries.ida_libraries.cache_clear()
    served, reason = libraries.available()
    assert not served
    assert "carries SUNDIALS 7." in reason and "version 8" in reason
    monkeypatch.undo()
    monkeypatch.setattr(libraries, "_folder", lambda: tmp_path)
    libraries.ida_libraries.cache_clear()
    assert libraries.available() == (False, f"no library sundials_core found in {tmp_path}")
    monkeypatch.undo()
    libraries.ida_libraries.cache_clear()


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


def test_scikit_sundae_is_not_imported():
    code = (
        "import sys; from stiffmbs.solve.ida.libraries import available; "
        "assert available()[0]; assert 'sksundae' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
