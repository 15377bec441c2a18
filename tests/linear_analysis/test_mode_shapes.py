"""Modes as results over one period: shapes of closed forms, closed mechanisms, files as of a run."""

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

from ..conftest import EXAMPLES

PENDULUM = """
gravity: [0, -9.81]
bodies: {bar: {mass: 1.2, inertia: 0.036, position: [0, -0.3], angle: -90 deg}}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: ground}}
"""


def test_a_pendulum_swings_to_and_fro_about_its_hinge():
    found = stiffmbs.modes(stiffmbs.read_scene(PENDULUM))
    shape = found.shape(1, amplitude=0.2, points=41)
    period = 2 * np.pi / np.sqrt(1.2 * 9.81 * 0.3 / (0.036 + 1.2 * 0.09))
    assert shape.time[-1] == pytest.approx(period, rel=1e-9)
    assert np.hypot(shape["bar.x"], shape["bar.y"]) == pytest.approx(0.3, abs=1e-10)
    assert shape["bar.x"][0] == pytest.approx(shape["bar.x"][-1], abs=1e-9)
    assert np.ptp(shape["bar.angle"]) > 0.3
    assert shape["constraint.position"].max() < 1e-10


@pytest.mark.parametrize("name", ["bricard", "governor", "half_car", "heavy_top"])
def test_every_mode_can_be_shown(name):
    found = stiffmbs.modes(EXAMPLES / f"{name}.yaml")
    for number in range(1, len(found.modes) + 1):
        shape = found.shape(number, amplitude=0.02, points=9)
        assert shape["constraint.position"].max() < 1e-9
        moved = max(
            np.ptp(shape[channel]) for channel in shape if channel.endswith((".x", ".y", ".z", ".q1", ".angle"))
        )
        assert moved > 1e-4


def test_the_command_writes_a_file_for_each_mode(tmp_path):
    scene = str(EXAMPLES / "cart_pendulum.yaml")
    done = CliRunner().invoke(main, ["modes", scene, "-o", str(tmp_path / "mode.npz"), "--amplitude", "0.05"])
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mode_1.npz", "mode_2.npz"]
    second = stiffmbs.Solution.load(tmp_path / "mode_2.npz")
    assert np.ptp(second["cart.y"]) < 1e-9 < np.ptp(second["bar.angle"])


def test_a_mode_that_is_not_there_is_refused():
    found = stiffmbs.modes(stiffmbs.read_scene(PENDULUM))
    with pytest.raises(stiffmbs.InputError, match="mode 2: found no such mode, expected one of 1 to 1"):
        found.shape(2)
