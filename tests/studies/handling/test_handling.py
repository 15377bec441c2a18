"""`stiffmbs handling` on the example car, against relations of the bicycle model, and its messages."""

import functools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.reading.files.yaml_text import read_yaml
from stiffmbs.studies.handling import study
from stiffmbs.studies.handling.car import Manoeuvre, _renamed, _strip, car_of, with_manoeuvre
from stiffmbs.studies.handling.known import SEEN, Known
from stiffmbs.studies.handling.lane_changes import highest
from stiffmbs.studies.handling.parameters import (
    SPEED,
    SineWithDwell,
    StepSteer,
    StraightBraking,
    names_of,
    with_changes,
)
from stiffmbs.studies.handling.standards import TESTS
from stiffmbs.studies.handling.steady_state_cornering import ramp
from stiffmbs.studies.handling.steering_inputs import dwell_formula, response_of_sweeps

EXAMPLES = Path(stiffmbs.__file__).parents[1] / "examples"
CAR = EXAMPLES / "car.yaml"


@functools.cache
def preliminary():
    """Return what the preliminary runs of the example car give."""
    scene = stiffmbs.load_scene(CAR)
    car = car_of(scene)
    return study._preliminary(scene, car, car.track + study.WIDER, (1 + study.OVERHANGS) * car.wheelbase)


@pytest.fixture(scope="module")
def found():
    tests = ["constant_speed", "constant_radius", "step_steer", "lane_change", "frequency_response"]
    known = preliminary()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "_preliminary", lambda *_: known)
        return stiffmbs.handling(CAR, tests, workers=1)


@pytest.mark.long
def test_the_metrics_of_the_car_agree_with_each_other(found):
    assert not any(one.message for one in found.tests.values())
    ramp, circle, step = (found[name] for name in ("constant_speed", "constant_radius", "step_steer"))
    gradient = ramp["understeer gradient"]
    assert gradient == pytest.approx(circle["understeer gradient"], rel=0.02), "two methods of ISO 4138"
    assert ramp["characteristic speed"] == pytest.approx(np.sqrt(1e3 * found.car.wheelbase / gradient))
    to_rear = 1e-3 * (ramp["sideslip gradient"] - circle["sideslip gradient"]) * SPEED**2
    assert to_rear == pytest.approx(found.car.behind(found.car.centre), rel=0.05), (
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


@pytest.mark.long
def test_the_frequency_response_is_that_of_single_sines(found):
    """Segments of a sweep of 10 s gave 4.5 % more gain at 0.3 Hz, and 2.5 deg more phase at 0.6 Hz."""
    scene = stiffmbs.load_scene(CAR)
    car = car_of(scene)
    known, runs = Known(car, car.wheelbase / found.ratio, 0, 1.8, {}), found.tests["frequency_response"].runs
    responses = {name: response_of_sweeps(known.ratio, runs, f"vehicle.{name}") for name in ("yaw_rate", "ay")}
    amplitude = float(np.max(np.abs(runs[0][SEEN])))
    for f in (0.3, 0.6):
        periods = int(np.ceil(4 * f))
        steer = f"step5(t, 0.5, 0, 1.5, {amplitude!r})*sin(2*pi*{f!r}*t)"
        run = study.solved(with_manoeuvre(scene, car, Manoeuvre(SPEED, 4 + periods / f, steer)))
        time = run["time"]
        basis = np.stack(
            [np.exp(2j * np.pi * f * time).real, np.exp(2j * np.pi * f * time).imag, 1 + 0 * time, time], 1
        )
        late = time > time[-1] - periods / f
        a, b, *_ = np.linalg.lstsq(
            basis[late], np.stack([run[SEEN], run["vehicle.yaw_rate"], run["vehicle.ay"]], 1)[late]
        )[0]
        exact = (a - 1j * b)[1:] / (a - 1j * b)[0] / found.ratio
        for name, value in zip(("yaw_rate", "ay"), exact, strict=True):
            gain, phase = responses[name].at(f)
            assert abs(gain * np.exp(1j * phase) / value - 1) < 3e-3, (name, f)
            assert responses[name].error_at(f) < 0.01
    values = found["frequency_response"]
    assert values["yaw rate, gain at 0.4 Hz"] == pytest.approx(responses["yaw_rate"].at(0.4)[0])
    assert values["yaw rate, frequency of the largest gain, error bar"] < 0.5


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("name", "rear"),
    [("hatchback", "twist_beam"), ("hatchback", "five_link"), ("hatchback", "trailing_arm"), ("formula_student", "")],
)
def test_the_driver_keeps_to_the_double_lane_change(name, rear):
    """Steering that was not ahead by the car's own lag, and a fast correction of its yaw rate, left it by 0.31 m."""
    changes = [("choose.rear", rear)] if rear else []
    scene = stiffmbs.load_scene(EXAMPLES / "vehicles" / f"{name}.yaml", changes)
    found = stiffmbs.handling(scene, ["lane_change"], workers=1)["lane_change"]
    assert found["largest lateral error"] < 0.15
    assert found["passed (1 yes, 0 no)"] == 1


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"position": "[100, 3, height]"}, "about x = 99.9 m, y = 3 m, with a heading of 0 deg"),
        ({"orientation": "{x: [-1, 0, 0], z: [0, 0, 1]}"}, "with a heading of -180 deg from x"),
        ({"orientation": "{x: [0.6, 0.8, 0], z: [0, 0, 1]}"}, "with a heading of 53.1 deg from x"),
    ],
)
def test_a_car_that_does_not_stand_where_courses_begin_is_refused(changes, said):
    scene = stiffmbs.load_scene(CAR, [(f"bodies.chassis.{name}", value) for name, value in changes.items()])
    with pytest.raises(stiffmbs.InputError, match=said):
        stiffmbs.handling(scene, ["lane_change"])


DRIVELINE = {
    "use": "driveline", "on": "chassis", "drive": "rear", "position": [0, 0, "-height"],
    "mounts": {f"{end}_{side}": f"{end}.{side}.wheel" for end in ("front", "rear") for side in ("left", "right")},
    "parameters": {"speed": "V", "rolling_radius": "r", "ratio": 3.15},
}  # fmt: skip


def with_driveline(driver, parts=None, **entries):
    """Return the car with a driveline and a driver of its own in every manoeuvre."""
    content = read_yaml(CAR.read_text(), "car.yaml")
    content["parts"] |= {"driveline": DRIVELINE, **(parts or {})}
    chosen = content["options"].pop("manoeuvre")["straight"]
    content["parts"]["driver"] = {**chosen["parts"]["driver"], **driver}
    content["parts"]["driver"]["mounts"] = {**chosen["parts"]["driver"]["mounts"], "input": "driveline.main.input"}
    content |= {"roads": chosen["roads"], "joints": chosen["joints"], **entries}
    for tyre in content["forces"].values():
        tyre["properties"] = str(EXAMPLES / "car.tir")
    return stiffmbs.read_scene(json.dumps(content))


@pytest.mark.long
def test_a_driveline_spins_with_the_wheels_and_is_driven_at_its_input():
    """Its input turns as its ratio times the wheels, and carries the driver's traction by its ratio and that of the axle."""
    scene = with_driveline({"drive": "driveline", "parameters": {"target": "V", "begins": -1, "ratio": 3.15}})
    car = car_of(scene)
    assert car.rolling == (*(wheel.body for wheel in car.wheels.values()), "driveline.main.input")
    tested = with_manoeuvre(scene, car, Manoeuvre(20.0, 1.0))
    rest = stiffmbs.equilibrium(tested).channels
    spins = [rest[f"rear.{side}.wheel.wy"] for side in ("left", "right")]
    assert rest["driveline.main.input.wy"] == pytest.approx(3.15 * sum(spins) / 2, rel=1e-9)
    torque = rest["handling_driver.drive"] * car.radius / 3.15
    assert rest["driveline.main.shaft_torque"] == pytest.approx(3.15 * torque, rel=1e-6)
    assert rest["handling_driver.drive"] > 100, "drag and rolling resistance"


@pytest.mark.long(50)
def test_a_steering_wheel_steers_the_lane_change():
    """The driver turns the wheel, and the rack has no drive."""
    column = {
        "use": "steering_column",
        "on": "chassis",
        "mounts": {"rack": "steering.rack", "housing": "steering.housing"},
    }
    scene = with_driveline({}, parts={"column": column})  # its own drive of the rack is left out
    found = stiffmbs.handling(scene, ["lane_change"], steering="column.bearing", workers=1)
    assert found.car.angular and not found.tests["lane_change"].message
    assert found["lane_change"]["largest lateral error"] < 0.2


def test_drives_of_the_steering_alone_are_left_out():
    """A second rack, as of a steered rear axle, keeps its drive; where a steering wheel turns one of two racks, that is refused."""
    car = car_of(stiffmbs.load_scene(CAR))
    assert car.steered == ("steering.guide",)
    drives = {name: {"type": "drive", "joint": f"{name}.guide", "position": "0"} for name in ("steering", "rear_rack")}
    content = {"joints": dict(drives)}
    _strip(content, car)
    assert list(content["joints"]) == ["rear_rack"]
    by_wheel = replace(car, steering="column.bearing", steered=("column.bearing",), angular=True)
    with pytest.raises(
        stiffmbs.InputError, match=r"drives of steering.guide, rear_rack.guide in a car that is steered by"
    ):
        _strip({"joints": dict(drives)}, by_wheel)


@pytest.mark.long
def test_variables_read_the_driver_of_the_test():
    """A throttle that follows the scene's own driver follows the one of the test."""
    driver = {"drive": "engine", "parameters": {"target": "V", "begins": -1}}
    text = _renamed("my_driver.x + a.driver.x + driver.y", "driver")
    assert text == "my_driver.x + a.driver.x + handling_driver.y"
    scene = with_driveline(driver, variables={"throttle": "min(driver.throttle_position, 1)"})
    tested = with_manoeuvre(scene, car_of(scene), Manoeuvre(20.0, 1.0))
    assert "handling_driver.throttle_position" in tested.states


def car_with(changes=(), **replaced):
    """Return the example car with texts of its file replaced."""
    text = CAR.read_text().replace("properties: car.tir", f"properties: {EXAMPLES / 'car.tir'}")
    for old, new in replaced.values():
        assert old in text
        text = text.replace(old, new, 1)
    return stiffmbs.read_scene(text, changes)


def speeds(scene, **manoeuvre):
    return study.solved(with_manoeuvre(scene, car_of(scene), Manoeuvre(20.0, 3.0, "0", **manoeuvre)))["vehicle.speed"]


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "entry",
    [
        "brakes: 1 s",
        *(pytest.param(entry, marks=pytest.mark.long) for entry in ("acceleration: 1 m/s^2", "releases: 1 s")),
    ],
)
def test_the_scenes_own_manoeuvre_does_not_act_in_a_test(entry):
    """A driver who brakes after 1 s, as in the guide, braked in every test."""
    scene = car_with(driver=("{target: V, begins: -1 s}", f"{{target: V, begins: -1 s, {entry}}}"))
    assert np.ptp(speeds(scene)) < 0.01


@pytest.mark.long
def test_a_tight_turn_at_low_speed_is_no_spin():
    """The sideslip of its centre is that of the radius: a ramp at 5 m/s ended at 4.5 m/s^2."""
    scene = stiffmbs.load_scene(CAR)
    car = car_of(scene)
    slow = replace(ramp(car, 0.335, 5.0), duration=14.0)
    found = study.solved(with_manoeuvre(scene, car, slow))
    assert found["vehicle.ay"].max() > 5.2
    assert found["vehicle.sideslip"].max() > 0.25


@pytest.mark.long
def test_a_car_that_does_not_keep_the_speed_of_a_test_is_refused():
    """A distance of braking from 20 m/s was that of a test from 28 m/s."""
    with pytest.raises(stiffmbs.InputError, match=r"found a steady speed of 0.381 m/s, expected 20 m/s: the engine"):
        speeds(car_with([("parts.driver.parameters.strongest", "100 N")]))


@pytest.mark.long
def test_a_changed_pedal_counts():
    """It was left out when given by --set."""
    pedal = speeds(car_with(driver=("begins: -1 s}", "begins: -1 s, pedal: 1 kN}")), driver={"brakes": 1})
    changed = speeds(car_with([("parts.driver.parameters.pedal", "1 kN")]), driver={"brakes": 1})
    assert pedal[-1] == pytest.approx(18.4, abs=0.2)
    assert changed == pytest.approx(pedal, rel=1e-9)


@pytest.mark.long
def test_changes_of_what_a_test_keeps_count():
    """Drive and tolerances by --set were left out, and so were parameters whose names begin as a section's."""
    changes = [
        ("parts.driver.drive", "front"),
        ("run.rtol", "1e-6"),
        ("run.duration", "1 h"),
        ("start_height", "0.5 m"),
    ]
    scene = car_with(changes, height=("height: 0.55 m", "start_height: 0.55 m\n  height: start_height"))
    tested = with_manoeuvre(scene, car_of(scene), Manoeuvre(20.0, 3.0))
    assert (tested.run.rtol, tested.run.duration) == (1e-6, 3.0)
    assert "handling_driver.drive_front_left" in tested.forces
    scene = stiffmbs.load_scene(CAR, [("parameters.soft", "2e6 N/m"), ("parts.front.left.parameters.k_b", "soft")])
    assert with_manoeuvre(scene, car_of(scene), Manoeuvre(20.0, 3.0)).parameters["soft"] is not None
    assert tested.bodies["chassis"].position[2] == 0.5


CAB = """  cab: {mass: 1 kg, inertia: [0.1, 0.1, 0.1], position: [0, 0, height], orientation: AXES, velocity: [V, 0, 0]}
parts:
  steering"""
ON_CAB = """joints: {on_cab: {type: fixed, i: cab, j: {body: chassis, orientation: AXES}}}
vehicle: {body: cab, orientation: BACK}
forces:
"""


@pytest.mark.long
@pytest.mark.sampled(7)
@pytest.mark.parametrize(
    ("axes", "back"),
    [
        ("{x: [1, 0, 0], z: [0, 0, -1]}", "{x: [1, 0, 0], z: [0, 0, -1]}"),
        ("{x: [0, 1, 0], z: [0, 0, 1]}", "{x: [0, -1, 0], z: [0, 0, 1]}"),
    ],
)
def test_a_body_with_axes_of_its_own_is_driven_as_any_other(axes, back):
    """Axes of the section `vehicle` did not apply to the driver, and its channels were not those of another --body."""
    turn = Manoeuvre(15.0, 6.0, path={"circle": 100, "entry": 10.0, "transition": 30.0})
    scene = car_with(
        bodies=("parts:\n  steering", CAB.replace("AXES", axes)),
        joints=("forces:\n", ON_CAB.replace("AXES", axes).replace("BACK", back)),
    )
    by_cab, by_chassis = (study.solved(with_manoeuvre(scene, car_of(scene, body), turn)) for body in (None, "chassis"))
    assert by_cab["vehicle.yaw_rate"][-1] == pytest.approx(0.149, abs=0.002)
    assert abs(by_cab["handling_driver.lateral_error"][-1]) < 0.05
    for name in ("vehicle.ay", "vehicle.sideslip", "vehicle.roll", "vehicle.yaw_rate"):
        assert by_chassis[name][-1] == pytest.approx(by_cab[name][-1], rel=0.01), name


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


def test_the_guide_lists_all_tests_and_their_parameters():
    text = (EXAMPLES.parent / "docs" / "handling.md").read_text(encoding="utf-8")
    for name, test in TESTS.items():
        line = next(each for each in text.splitlines() if each.startswith(f"| `{name}` | `"))
        assert all(f"`{each}`" in line for each in names_of(test.parameters))


@pytest.mark.long
def test_changed_parameters_on_the_command_line(monkeypatch):
    known = preliminary()
    monkeypatch.setattr(study, "_preliminary", lambda *_: known)
    options = ["--test", "straight_braking", "--workers", "1", "--json"]
    for change in ("straight_braking.speed=60 km/h", "pedal=9 kN"):
        options += ["--set-test", change]
    found = CliRunner().invoke(main, ["handling", str(CAR), *options])
    assert found.exit_code == 0, found.output
    braking = json.loads(found.stdout)["tests"]["straight_braking"]
    assert braking["parameters"] == {"speed": pytest.approx(60 / 3.6), "pedal": 9000}
    values = {name: one["value"] for name, one in braking["metrics"].items()}
    mass = sum(body.mass for body in stiffmbs.load_scene(CAR).bodies.values())
    deceleration = values["mean fully developed deceleration"]
    assert deceleration == pytest.approx(9000 / mass, rel=0.03), "the inertia of the wheels and drag nearly cancel"
    assert values["distance"] == pytest.approx((60 / 3.6) ** 2 / (2 * deceleration) + 0.15 * 60 / 3.6, rel=0.05)


def test_parameters_are_changed_for_one_test_or_for_all_that_have_them():
    defaults = {"step_steer": StepSteer(), "straight_braking": StraightBraking(), "sine_with_dwell": SineWithDwell()}
    found = with_changes({"step_steer.speed": "100 km/h", "speed": 30, "sine_with_dwell.factors": "[2, 4]"}, defaults)
    assert found["step_steer"] == StepSteer(speed=100 / 3.6), "the more particular one counts, in any order"
    assert found["straight_braking"] == StraightBraking(speed=30)
    assert found["sine_with_dwell"] == SineWithDwell(speed=30, factors=(2, 4))
    assert defaults["step_steer"].speed == SPEED


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("step_steer.sped=3", "did you mean 'speed'?"),
        ("ride.speed=3", "expected one that runs: step_steer, frequency_response"),
        ("speed=3 kg", "which is in kg, expected a velocity in m/s"),
        ("rise=0", "expected a value above zero"),
        ("first=4 Hz", "expected first below last"),
        ("speed", "expected PATH=VALUE"),
    ],
)
def test_a_wrong_parameter_is_refused(change, sentence):
    options = ["--test", "step_steer", "--test", "frequency_response", "--set-test", change]
    found = CliRunner().invoke(main, ["handling", str(CAR), *options])
    assert found.exit_code == 2
    assert sentence in found.stderr


def test_the_highest_speed_is_found_to_its_resolution():
    for limit in (10.1, 13.37, 21.9):
        tried = []

        def passes(speed, limit=limit, tried=tried):
            tried.append(speed)
            return speed <= limit

        assert limit - 0.25 < highest(passes, 8, 22, 0.25, 15) <= limit
        assert len(tried) == 2 + np.ceil(np.log2(14 / 0.25))
    assert np.isnan(highest(lambda speed: False, 8, 22, 0.25, 15))
    assert highest(lambda speed: True, 8, 22, 0.25, 15) == np.inf


def test_a_sine_with_dwell_has_the_frequency_and_dwell_of_its_parameters():
    formula = dwell_formula(2.0, SineWithDwell(frequency=0.5, dwell=1.0))
    for t, exact in ((0.5, 0), (1.5, 2), (2, 0), (2.5, -2), (3.4, -2), (3.5, -2), (4, 0), (5, 0)):
        value = eval(formula, {"t": t, "min": min, "max": max, "sin": np.sin, "pi": np.pi})
        assert value == pytest.approx(exact, abs=1e-9), t


@pytest.mark.parametrize(
    "given",
    [
        {"width": -1.0}, {"width": float("nan")}, {"width": "2 s"}, {"width": True}, {"length": 0}, {"workers": 0}, {"workers": "2"},
        {"workers": True}, {"workers": 1.5}, {"tests": "ride"},
    ],
)  # fmt: skip
def test_a_width_and_a_number_of_processes_are_checked(examples, given):
    with pytest.raises(stiffmbs.InputError, match=f"{next(iter(given))}: found"):
        stiffmbs.handling(examples / "car.yaml", **{"tests": [], **given})


def test_a_width_may_have_a_unit(examples, monkeypatch):
    widths = []
    monkeypatch.setattr(
        study,
        "_preliminary",
        lambda scene, car, width, length: widths.append((width, length)) or Known(car, 1, 0, width, {}),
    )
    monkeypatch.setattr(study, "_solved", lambda *arguments: {})
    for width, length in (("1900 mm", "4.5 m"), (1.9, None)):
        stiffmbs.handling(examples / "car.yaml", [], width=width, length=length, workers=1)
    assert widths == [pytest.approx((1.9, 4.5)), pytest.approx((1.9, 1.6 * 2.7))]
