"""A car with tyres of ply steer and conicity turns to the right as it turns to the left, if these are mirrored."""

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLE_SCENES


def step_steer(folder, speed, travel, hand):
    data = EXAMPLE_SCENES["car"].with_suffix(".tir").read_text()
    one_sided = "[LATERAL_COEFFICIENTS]\nPVY1 = 0.02\nPHY1 = 0.002\nPEY3 = 0.1"
    (folder / "car.tir").write_text(data.replace("[LATERAL_COEFFICIENTS]", one_sided))
    (folder / "car.yaml").write_text(EXAMPLE_SCENES["car"].read_text().replace("hand: -1", f"hand: {hand}"))
    changes = [
        ("V", f"{speed} m/s"),
        ("choose.manoeuvre", "step_steer"),
        ("choose.compliance", "rigid"),
        ("joints.steer.position", f"step5(t, 0.5, 0, 0.7, {travel} mm)"),
    ]
    scene = stiffmbs.load_scene(folder / "car.yaml", changes)
    return stiffmbs.run(scene, duration=1.5, output=0.05, rtol=1e-9, solver="bdf")


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
def test_a_turn_to_the_right_is_the_mirror_image_of_one_to_the_left(seed, tmp_path):
    rng = np.random.default_rng(seed)
    speed, travel = rng.uniform(12, 25), rng.uniform(3, 8)
    left, right = (step_steer(tmp_path, speed, sign * travel, -1) for sign in (1, -1))
    for channel, sign in {"chassis.x": 1, "chassis.y": -1, "chassis.z": 1, "chassis.wx": -1, "chassis.wz": -1}.items():
        one, other = (run[channel] - run[channel][0] for run in (left, right))  # no force holds the place of the start
        assert other == pytest.approx(sign * one, abs=1e-6), channel
    for axle in ("front", "rear"):
        for channel, sign in {"load": 1, "longitudinal": 1, "lateral": -1, "aligning": -1, "camber": -1}.items():
            one, other = left[f"{axle}.left.tyre.{channel}"], right[f"{axle}.right.tyre.{channel}"]
            assert other == pytest.approx(sign * one, abs=1e-6 * np.abs(one).max()), (axle, channel)
    wrong = step_steer(tmp_path, speed, -travel, 1)
    assert np.abs(wrong["chassis.wz"] + left["chassis.wz"]).max() > 1e-4, (
        "the comparison sees tyres that are not mirrored"
    )
