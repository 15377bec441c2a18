"""`stiffmbs handling` on the example car, against relations of the bicycle model, and its messages."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.studies.handling.standards import SPEED, TESTS

EXAMPLES = Path(stiffmbs.__file__).parents[1] / "examples"
CAR = EXAMPLES / "car.yaml"


@pytest.mark.long
def test_the_metrics_of_the_car_agree_with_each_other():
    found = stiffmbs.handling(CAR, ["constant_speed", "constant_radius", "step_steer", "lane_change"], workers=1)
    assert not any(one.message for one in found.tests.values())
    ramp, circle, step = (found[name] for name in ("constant_speed", "constant_radius", "step_steer"))
    gradient = ramp["understeer gradient"]
    assert gradient == pytest.approx(circle["understeer gradient"], rel=0.06), "two methods of ISO 4138"
    assert ramp["characteristic speed"] == pytest.approx(np.sqrt(1e3 * found.car.wheelbase / gradient))
    to_rear = 1e-3 * (ramp["sideslip gradient"] - circle["sideslip gradient"]) * SPEED**2
    assert to_rear == pytest.approx(found.car.rear, rel=0.05), (
        "by V^2 times the difference: the distance of the rear axle"
    )
    gain = SPEED / (found.car.wheelbase + 1e-3 * gradient * SPEED**2)
    assert step["yaw rate, gain per steer angle of the wheels"] == pytest.approx(gain, rel=0.1), (
        "4 m/s^2 is past the linear range"
    )
    assert step["lateral acceleration, steady"] == pytest.approx(SPEED * step["yaw rate, steady"], rel=0.02)
    assert step["lateral acceleration, steady"] == pytest.approx(4, rel=0.05)
    assert found["lane_change"]["largest lateral error"] < 0.15
    assert found["lane_change"]["passed (1 yes, 0 no)"] == 1


def test_a_misspelt_test_and_a_scene_that_is_no_car_are_refused():
    runner = CliRunner()
    found = runner.invoke(main, ["handling", str(CAR), "--test", "stepsteer", "--json"])
    assert found.exit_code == 2
    assert "did you mean 'step_steer'?" in json.loads(found.stdout)["message"]
    for scene, sentence in (
        (EXAMPLES / "cart_pendulum.yaml", "found a scene in the plane"),
        (EXAMPLES / "heavy_top.yaml", "found no body 'chassis'"),
        (EXAMPLES / "vehicles" / "bushing_axle.yaml", "expected"),
    ):
        found = runner.invoke(main, ["handling", str(scene)])
        assert found.exit_code == 2, scene
        assert sentence in found.stderr
    found = runner.invoke(main, ["handling", str(CAR), "--steering", "steering.gide"])
    assert found.exit_code == 2
    assert "did you mean 'steering.guide'?" in found.stderr


def test_the_guide_lists_all_tests():
    text = (EXAMPLES.parent / "docs" / "handling.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` |" in text for name in TESTS)
