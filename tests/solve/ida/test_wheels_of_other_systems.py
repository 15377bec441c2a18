"""The wheels of scikit-sundae for each system: libraries found, and every function that is called exported by them."""

import subprocess
import sys
import zipfile

import pytest

from stiffmbs.solve.ida import libraries
from stiffmbs.solve.ida.libraries import DECLARATIONS, declared

WHEELS = ("win_amd64", "macosx_11_0_arm64", "manylinux_2_28_x86_64")
EXTENSIONS = {"win_amd64": ".dll", "macosx_11_0_arm64": ".dylib", "manylinux_2_28_x86_64": ".so."}
pytestmark = pytest.mark.long


@pytest.fixture(scope="module", params=WHEELS)
def unpacked(request, tmp_path_factory):
    """A wheel as it is installed, and its system; skipped where no index of packages is at hand."""
    folder = tmp_path_factory.mktemp(request.param)
    asked = ["--no-deps", "--only-binary", ":all:", "--platform", request.param, "--python-version", "3.12"]
    done = subprocess.run(
        [sys.executable, "-m", "pip", "download", "-q", *asked, "-d", str(folder), "scikit-sundae"],
        capture_output=True,
        text=True,
        check=False,
    )
    wheels = list(folder.glob("*.whl"))
    if not wheels:
        pytest.skip(f"no wheel for {request.param}: {done.stderr.strip().splitlines()[-1:]}")
    with zipfile.ZipFile(wheels[0]) as wheel:
        wheel.extractall(folder)
    return folder, request.param


def _exported(path):
    """The names of the functions that a library offers to others."""
    lief = pytest.importorskip("lief")
    binary = lief.parse(str(path))
    if isinstance(binary, lief.PE.Binary):
        return {entry.name for entry in binary.get_export().entries}
    return {
        function.name.removeprefix("_" if isinstance(binary, lief.MachO.Binary) else "")
        for function in binary.exported_functions
    }


@pytest.mark.sampled(3)
def test_libraries_are_found_in_the_wheel_of_each_system(unpacked, monkeypatch):
    folder, system = unpacked
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setattr(libraries.importlib.util, "find_spec", lambda name: _Spec(folder / name))
    found = libraries._folder()
    assert found.is_relative_to(folder)
    for name in libraries.IDA_LIBRARIES:
        assert EXTENSIONS[system] in libraries._file(found, name).name
        assert len(libraries._matching(found, name)) == 1


class _Spec:
    """Where a package is, as importlib says it."""

    def __init__(self, path):
        self.submodule_search_locations = [str(path)]


def test_every_function_is_exported_by_a_library_that_is_loaded(unpacked, monkeypatch):
    """Windows looks for a function in the one library that is asked, not in those which it needs."""
    folder, _ = unpacked
    monkeypatch.setattr(libraries.importlib.util, "find_spec", lambda name: _Spec(folder / name))
    place = libraries._folder()
    offered = set().union(*(_exported(libraries._file(place, name)) for name in libraries.IDA_LIBRARIES))
    wanted = set(declared())
    assert len(wanted) == DECLARATIONS.strip().count("(")
    assert wanted <= offered, f"missing: {sorted(wanted - offered)}"
