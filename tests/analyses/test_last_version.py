"""Scenes, models, results, states and stores of the last version give the same results.

The folder `tests/data/last_version` was written by version 0.1.0 before estimates of errors and provenance: results by
``stiffmbs run X.yaml -o X.npz``, the state by ``stiffmbs equilibrium plane.yaml -o state.npz``, and the store by a study that was
interrupted.
"""

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

FOLDER = Path(__file__).parents[1] / "data" / "last_version"


@pytest.mark.parametrize("name", ["plane", "space"])
def test_a_scene_has_the_results_of_the_last_version(name):
    before = stiffmbs.Solution.load(FOLDER / f"{name}.npz")
    found = stiffmbs.run(FOLDER / f"{name}.yaml")
    assert found.time == pytest.approx(before.time)
    for channel, values in before.channels.items():
        if channel.startswith("constraint.") or channel not in found.channels:
            continue
        scale = 1.0 + np.abs(values).max()
        assert np.abs(found[channel] - values).max() < 1e-3 * scale, channel
    missing = before.channels.keys() - found.channels.keys()
    assert not missing, missing


def test_a_run_starts_from_a_state_of_the_last_version():
    state = stiffmbs.Solution.load(FOLDER / "state.npz")
    found = stiffmbs.run(FOLDER / "plane.yaml", start_from=FOLDER / "state.npz", duration=0.2)
    assert found["slider.x"] == pytest.approx(float(state["slider.x"][-1]), abs=1e-6)


def test_a_study_goes_on_from_the_store_of_the_last_version(tmp_path):
    pytest.importorskip("xarray")
    for name in ("plane.yaml", "study.nc.study"):
        shutil.copy(FOLDER / name, tmp_path / name)
    command = [
        "study",
        str(tmp_path / "plane.yaml"),
        "--vary",
        "k=300:500:20",
        "--of",
        "final(slider.x)",
        "--workers",
        "1",
    ]
    found = CliRunner().invoke(main, [*command, "-o", str(tmp_path / "study.nc")])
    assert found.exit_code in (0, 2), found.output  # solved, or a message that names the other study
    assert "Traceback" not in found.output


def test_a_model_has_the_motion_of_the_last_version():
    spec = importlib.util.spec_from_file_location("model_of_last_version", FOLDER / "model.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = module.model().run(duration=1.0, rtol=1e-8)
    before = {
        "cart.x": 0.2319277505849796,
        "bar.angle": -2.5391158908185836,
        "rail.fy": 114.07492070008587,
        "hinge.fx": 10.469229863801536,
    }
    assert {name: found[name][-1] for name in before} == pytest.approx(before, abs=1e-5)
