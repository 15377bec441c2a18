"""Starts in equilibrium that are kept: the same numbers, and never those of other scenes, settings or versions."""

import shutil

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import job, stored_start

from .test_settled_start import SCENE


@pytest.fixture
def scene(tmp_path, monkeypatch):
    monkeypatch.setattr(stored_start, "machine", lambda: str(tmp_path))
    stored_start._solver.cache_clear()
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    yield path
    stored_start._solver.cache_clear()


@pytest.fixture
def searches(monkeypatch):
    """The starts that are searched."""
    found = []
    search = job._start
    monkeypatch.setattr(job, "_start", lambda *given: found.append(given) or search(*given))
    return found


def test_a_start_is_searched_once_and_comes_back_with_the_same_motion(scene, searches):
    first, again = (stiffmbs.run(scene) for _ in range(2))
    assert len(searches) == 1
    assert first.notes == again.notes
    assert first.solver.keys() == again.solver.keys()
    assert all(np.array_equal(first[name], again[name], equal_nan=True) for name in first.channels)


@pytest.mark.parametrize("changed", ["value", "setting", "file", "numpy", "library", "threads"])
def test_anything_that_a_start_depends_on_makes_it_searched_anew(scene, searches, monkeypatch, changed):
    stiffmbs.run(scene)
    settings = {}
    match changed:
        case "value":
            scene.write_text(scene.read_text().replace("mass: 2", "mass: 2.5"))
        case "setting":
            settings["rtol"] = 1e-7
        case "numpy":
            monkeypatch.setattr(np, "__version__", "0")
        case "library":
            monkeypatch.setattr(stored_start, "installed_version", lambda name: "0")
        case "threads":
            monkeypatch.setenv("OPENBLAS_NUM_THREADS", "7")
        case "file":
            package = shutil.copytree(stored_start.PACKAGE / "equilibria", scene.parent / "equilibria")
            (package / "parameters.py").write_text("changed")
            monkeypatch.setattr(stored_start, "PACKAGE", package)
    stored_start._solver.cache_clear()
    stiffmbs.run(scene, **settings)
    stiffmbs.run(scene, **settings)
    monkeypatch.undo()
    stored_start._solver.cache_clear()
    assert len(searches) == 2
