"""The car of the examples: at rest, its modes, its manoeuvres, and its loads."""

import numpy as np
import pytest

import stiffmbs

pytestmark = pytest.mark.long
TYRES = [f"{end}.{side}.tyre" for end in ("front", "rear") for side in ("left", "right")]


def weight(scene):
    return 9.81 * sum(body.mass for body in scene.bodies.values())


@pytest.mark.sampled(2)
@pytest.mark.parametrize("word", ["bushing", "rigid"])
def test_at_rest_the_tyres_carry_the_weight_and_go_on_to(examples, word):
    scene = stiffmbs.load_scene(examples / "car.yaml", [("V", "0"), ("choose.compliance", word)])
    found = stiffmbs.equilibrium(scene)
    assert sum(found.channels[f"{tyre}.load"] for tyre in TYRES) == pytest.approx(weight(scene), rel=1e-9)
    still = stiffmbs.run(scene, duration=10, points=101, rtol=1e-8)
    assert still.success
    assert sum(still[f"{tyre}.load"] for tyre in TYRES) == pytest.approx(np.full(101, weight(scene)), rel=1e-9)


def test_the_body_moves_slowly_and_the_wheels_hop(examples):
    modes = stiffmbs.modes(stiffmbs.load_scene(examples / "car.yaml", [("V", "0")]))
    swinging = [mode for mode in modes.modes if mode.eigenvalues[0].imag != 0]
    body, hop = ([each for each in swinging if low < each.frequency < high] for low, high in ((0.7, 2.5), (8, 18)))
    assert len(body) == 3, "heave, pitch and roll"
    assert len(hop) >= 4
    assert min(each.frequency for each in swinging) > 0.7


def test_a_car_with_a_steering_column_starts_in_the_steady_motion_to_which_it_pulls(examples, tmp_path):
    """The steering wheel is 0.35 m to the left; the run that starts turning keeps its yaw rate, loads and speed."""
    text = (examples / "car.yaml").read_text().replace("properties: car.tir", f"properties: {examples / 'car.tir'}")
    column = "column: {use: steering_column, on: chassis, mounts: {rack: steering.rack, housing: steering.housing}}"
    text = text.replace("  air: {use", f"  {column}\n  air: {{use")
    text = text.replace("joint: steering.guide, position: 0 m", "joint: column.bearing, position: 0")
    path = tmp_path / "car.yaml"
    path.write_text(text)
    found = stiffmbs.run(path, duration=3, rtol=1e-7)
    assert abs(found["yaw_rate"][0]) > 1e-5
    for name in ("yaw_rate", "chassis.wx", "chassis.wy"):
        assert np.ptp(found[name]) < 1e-7
    assert np.ptp(found["front.left.tyre.load"]) < 1e-2
    assert any("turns at" in note for note in found.notes)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("manoeuvre", ["bump", "rough", "step_steer", "sine_sweep"])
def test_manoeuvres_run_and_the_driver_keeps_the_speed(examples, manoeuvre):
    scene = stiffmbs.load_scene(examples / "car.yaml", [("choose.manoeuvre", manoeuvre)])
    found = stiffmbs.run(scene, duration=4)
    assert found.success
    assert found["driver.speed"] == pytest.approx(np.full(len(found.time), 20.0), abs=0.5)
    turned = np.max(np.abs(found["yaw_rate"]))
    assert turned > 0.05 if manoeuvre[0] == "s" else turned < 0.02


def test_bushing_loads_add_up_at_rest(examples):
    scene = stiffmbs.load_scene(examples / "car.yaml", [("V", "0")])
    table = stiffmbs.road_loads(scene, {"rest": stiffmbs.run(scene, duration=0.1, points=3)})
    left, right = (table.peaks[f"front.{side}.lower.front_bush"] for side in ("left", "right"))
    assert [abs(a.value) for a in left] == pytest.approx([abs(b.value) for b in right], rel=1e-6, abs=1e-6)


def test_a_leaf_sprung_car_on_bumps_is_the_same_by_both_integrators(examples):
    scene = examples / "vehicles" / "leaf_sprung_car.yaml"
    found = stiffmbs.run(scene, rtol=1e-8, solver="bdf", points=301)
    exact = stiffmbs.run(scene, rtol=1e-10, solver="projected", scheme="dop853", points=301)
    for channel, bound in (("chassis.z", 1e-8), ("front.axle.z", 1e-8), ("front.left.front_bush.fz", 1e-2)):
        assert found[channel] == pytest.approx(exact[channel], abs=bound)


def test_a_driver_who_steers_against_a_held_rack_is_reported(examples):
    held = ("joints", "{steer: {type: drive, joint: steering.guide, position: 0 m}}")
    scene = stiffmbs.load_scene(examples / "car.yaml", [("choose.manoeuvre", "circle"), held])
    report = stiffmbs.check(scene)
    assert any("driver.steer_drive" in message for message in report.messages)


FIALA = """[UNITS]
LENGTH = 'mm'
FORCE = 'newton'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'second'
[MODEL]
PROPERTY_FILE_FORMAT = 'FIALA'
USE_MODE = {mode}
[DIMENSION]
UNLOADED_RADIUS = 316
WIDTH = 205
[PARAMETER]
VERTICAL_STIFFNESS = 220
VERTICAL_DAMPING = 0.3
ROLLING_RESISTANCE = 3
CSLIP = 88000
CALPHA = 1040
UMAX = 1.05
UMIN = 0.85
RELAX_LENGTH_X = 300
RELAX_LENGTH_Y = 500
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("mode", [1, 11])
def test_a_step_steer_on_tyres_of_a_fiala_file(examples, tmp_path, mode):
    """The integrators agree; the steady turn is near that of the Magic Formula tyres, whose cornering stiffness is similar."""
    (tmp_path / "fiala.tir").write_text(FIALA.format(mode=mode))
    path = tmp_path / "car.yaml"
    path.write_text((examples / "car.yaml").read_text().replace("properties: car.tir", "properties: fiala.tir"))
    runs = []
    for solver in ({"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"}):
        scene = stiffmbs.load_scene(path, [("choose.manoeuvre", "step_steer")])
        runs.append(stiffmbs.run(scene, duration=4, points=401, rtol=1e-6, **solver))
        assert runs[-1].success
    for channel, scale in (("yaw_rate", 0.2), ("front.left.tyre.lateral", 1500.0), ("front.right.tyre.load", 4000.0)):
        for other in runs[1:]:
            assert other[channel] == pytest.approx(runs[0][channel], abs=2e-5 * scale)
    scene = stiffmbs.load_scene(examples / "car.yaml", [("choose.manoeuvre", "step_steer")])
    assert runs[0]["yaw_rate"][-1] == pytest.approx(stiffmbs.run(scene, duration=4)["yaw_rate"][-1], rel=0.2)
