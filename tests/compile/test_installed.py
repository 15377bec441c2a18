"""Versions of installed packages in the keys of cached results."""

from __future__ import annotations

import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from stiffmbs.cache.installed import installed_version


@pytest.fixture(autouse=True)
def _looked_up_again():
    installed_version.cache_clear()
    yield
    installed_version.cache_clear()


@pytest.mark.parametrize("package", ["numpy", "scipy", "sympy", "ruamel.yaml", "scikit_sundae", "typing-extensions"])
def test_versions_are_those_of_the_metadata(package: str) -> None:
    assert installed_version(package) == version(package)


def test_the_first_folder_of_the_path_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "SymPy-9.9.dist-info").mkdir()
    monkeypatch.setattr(sys, "path", [str(tmp_path / "missing"), str(tmp_path), *sys.path])
    assert installed_version("sympy") == "9.9"


def test_a_missing_package_is_reported() -> None:
    with pytest.raises(PackageNotFoundError):
        installed_version("no-such-package")
