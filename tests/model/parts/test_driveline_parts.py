"""Steering column, differentials, driveline and powertrain against hand calculations."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.reading.files.yaml_text import read_yaml

LEFT, RIGHT = 30.0, 10.0  # resisting torque per speed of each output, N m s
TORQUE, RATIO = 100.0, 3.5


def outputs(inertia=1.0, names=("left", "right"), **sections):
    """Return a scene of flywheels that stand in for wheels, with further sections."""
    bodies, joints = {}, {}
    for k, name in enumerate(names):
        turned = {"orientation": {"z": [0, 1, 0]}}
        bodies[name] = {"mass": 1, "inertia": [inertia] * 3, "position": [0, 1 - k, 0]}
        joints[f"{name}_axle"] = {"type": "revolute", "i": {"body": name, **turned}, "j": {"body": "ground", "point": [0, 1 - k, 0], **turned}}  # fmt: skip
    return {"dimensions": 3, "bodies": bodies, "joints": joints, **sections}


def torque(body, text):
    return {"type": "wheel_torque", "i": body, "j": "ground", "torque": text}


def driven(locking, drive=TORQUE, parameters=None):
    """Return the end of a run with a differential that drives two outputs against unequal viscous torques."""
    part = {
        "use": "differential",
        "mounts": {"left": "left", "right": "right"},
        "locking": locking,
        "parameters": parameters or {},
    }
    forces = {
        "engine": torque("diff.input", f"{drive} N m"),
        "load": torque("left", f"-{LEFT}*wy(left)"),
        "other": torque("right", f"-{RIGHT}*wy(right)"),
    }
    scene = stiffmbs.read_scene(json.dumps(outputs(parts={"diff": part}, forces=forces)))
    found = stiffmbs.run(scene, duration=5, points=101, rtol=1e-8)
    assert found.success
    left, right = found["left.wy"][-1], found["right.wy"][-1]
    assert found["diff.input.wy"][-1] == pytest.approx(RATIO * (left + right) / 2, rel=1e-6), "the mean of the outputs"
    assert found["diff.torque_left"][-1] + found["diff.torque_right"][-1] == pytest.approx(RATIO * drive, rel=1e-6)
    return found, left, right


@pytest.mark.long
def test_an_open_differential_has_equal_torques():
    found, left, right = driven("open")
    assert found["diff.torque_left"] == pytest.approx(found["diff.torque_right"], abs=1e-9)
    assert left == pytest.approx(RATIO * TORQUE / 2 / LEFT, rel=1e-6)
    assert right == pytest.approx(RATIO * TORQUE / 2 / RIGHT, rel=1e-6)


@pytest.mark.long
def test_a_limited_slip_differential_slips_at_preload_plus_locking_ratio_and_holds_below():
    given = {"preload": "20 N m", "drive_locking": 0.1, "coast_locking": 0.05}
    for drive, share in ((TORQUE, 0.1), (-TORQUE, 0.05)):
        found, left, right = driven("limited_slip", drive, given)
        difference = found["diff.torque_left"][-1] - found["diff.torque_right"][-1]
        assert difference == pytest.approx(np.sign(drive) * 2 * (20 + share * RATIO * TORQUE), rel=1e-3)
        assert abs(right) > abs(left), "the slower output has the greater torque"
    _, left, right = driven("limited_slip", TORQUE, {**given, "drive_locking": 0.3})
    assert left == pytest.approx(right, rel=1e-6)
    assert left == pytest.approx(RATIO * TORQUE / (LEFT + RIGHT), rel=1e-6)


@pytest.mark.long
def test_a_viscous_differential_has_a_torque_difference_by_the_speeds():
    found, left, right = driven("viscous", parameters={"viscosity": "7 N m s/rad"})
    assert found["diff.torque_left"][-1] - found["diff.torque_right"][-1] == pytest.approx(
        14 * (right - left), rel=1e-6
    )
    half = RATIO * TORQUE / 2
    assert [left, right] == pytest.approx(np.linalg.solve([[LEFT + 7, -7], [-7, RIGHT + 7]], [half, half]), rel=1e-6)


@pytest.mark.long
def test_a_locked_differential_turns_both_outputs_alike():
    found, left, right = driven("locked")
    assert left == pytest.approx(right, rel=1e-6)
    assert found["diff.torque_left"][-1] == pytest.approx(LEFT * left, rel=1e-6)


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("locking", ["open", "limited_slip", "viscous", "locked"])
def test_differentials_at_random(locking, seed):
    """Torques add up, the input turns by the weighted mean, and the locking torque obeys its law, forwards and backwards."""
    rng = np.random.default_rng([len(locking), seed])
    split, ratio, drive = rng.uniform(0.2, 0.8), rng.uniform(1, 5), (-1) ** seed * rng.uniform(50, 200)
    left, right = rng.uniform(5, 40, 2)
    law = {"open": {}, "locked": {}, "viscous": {"viscosity": rng.uniform(1, 80)}, "limited_slip": dict(zip(("preload", "drive_locking", "coast_locking"), rng.uniform(0, (60, 0.3, 0.3)).tolist(), strict=True))}[locking]  # fmt: skip
    part = {"use": "differential", "mounts": {"left": "left", "right": "right"}, "locking": locking, "parameters": {"ratio": ratio, "split": split, **law}}  # fmt: skip
    forces = {"engine": torque("diff.input", f"{drive} N m"), "load": torque("left", f"-{left}*wy(left)"), "other": torque("right", f"-{right}*wy(right)")}  # fmt: skip
    found = stiffmbs.run(
        stiffmbs.read_scene(json.dumps(outputs(parts={"diff": part}, forces=forces))), duration=6, points=201, rtol=1e-9
    )
    shafts, a, b = found["diff.shaft_torque"], found["left.wy"], found["right.wy"]
    assert found["diff.torque_left"] + found["diff.torque_right"] == pytest.approx(shafts, abs=1e-9 * abs(drive))
    assert shafts[-1] == pytest.approx(ratio * drive, rel=1e-6)
    assert found["diff.input.wy"][-1] == pytest.approx(ratio * (split * a[-1] + (1 - split) * b[-1]), rel=1e-6)
    locked, slip = split * shafts - found["diff.torque_left"], a - b
    if locking == "open":
        assert np.max(np.abs(locked)) < 1e-9
    elif locking == "viscous":
        assert locked == pytest.approx(law["viscosity"] * slip, abs=1e-6)
    elif locking == "limited_slip":
        capacity = law["preload"] + np.where(shafts > 0, law["drive_locking"], -law["coast_locking"]) * shafts
        assert np.max(np.abs(locked) - capacity) < 1e-6 * abs(drive)
        if abs(slip[-1]) > 1e-3 * abs(a[-1]):
            assert locked[-1] == pytest.approx(np.sign(slip[-1]) * capacity[-1], rel=1e-5)
    else:
        assert slip[-1] == pytest.approx(0, abs=1e-6 * abs(a[-1]))


@pytest.mark.long
@pytest.mark.parametrize(
    ("drive", "shares"), [("front", (0.5, 0)), ("rear", (0, 0.5)), ("all", (0.2, 0.3))], ids=["front", "rear", "all"]
)
def test_a_driveline_gives_each_axle_its_part_of_the_torque(drive, shares):
    """Flywheels of equal inertia J with viscous torques c: each of them has its part of the torque, M/c at last."""
    wheels = ("front_left", "front_right", "rear_left", "rear_right")
    part = {"use": "driveline", "drive": drive, "mounts": {name: name for name in wheels}}
    if drive == "all":
        part["parameters"] = {"split": 0.4}
    forces = {
        "engine": torque("line.main.input", "100 N m"),
        **{f"load_{name}": torque(name, f"-10*wy({name})") for name in wheels},
    }
    found = stiffmbs.run(
        stiffmbs.read_scene(json.dumps(outputs(names=wheels, parts={"line": part}, forces=forces))),
        duration=5,
        rtol=1e-8,
    )
    speeds = [found[f"{name}.wy"][-1] for name in wheels]
    assert speeds == pytest.approx([shares[k // 2] * RATIO * 100 / 10 for k in range(4)], rel=1e-5, abs=1e-9)
    turned = RATIO * (0.4 * np.mean(speeds[:2]) + 0.6 * np.mean(speeds[2:])) if drive == "all" else RATIO * max(speeds)
    assert found["line.main.input.wy"][-1] == pytest.approx(turned, rel=1e-6)


def test_one_word_chooses_the_locking_of_all_differentials():
    wheels = ("front_left", "front_right", "rear_left", "rear_right")
    part = {"use": "driveline", "drive": "all", "locking": "locked", "mounts": {name: name for name in wheels}}
    states = stiffmbs.read_scene(json.dumps(outputs(names=wheels, parts={"line": part}))).states
    assert {f"line.{place}.output_twist" for place in ("main", "front", "rear")} <= states.keys()


def powered(clutch, variables=None, tables=None, parameters=None, **words):
    parts = {
        "diff": {"use": "differential", "mounts": {"left": "left", "right": "right"}},
        "engine": {
            "use": "powertrain",
            "mounts": {"output": "diff.input"},
            "clutch": clutch,
            "parameters": {"idle": "0 rpm", "start_speed": "0 rpm", **(parameters or {})},
            **words,
        },
    }
    more = {key: value for key, value in (("variables", variables), ("tables", tables)) if value}
    return stiffmbs.read_scene(json.dumps(outputs(inertia=60.0, parts=parts, **more)))


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("gear", "ratio"), [(1, 3.6), (3, 1.4)])
def test_a_powertrain_accelerates_by_torque_times_ratio_over_inertia(gear, ratio):
    """Inertias at the outputs: 2 J, the input's times r^2, and the engine's times (r i)^2; losses by the efficiency."""
    tables = {
        "torque_open": {"table": [[0, "120 N m"], ["700 rad/s", "120 N m"]]},
        "torque_closed": {"table": [[0, "-20 N m"], ["700 rad/s", "-20 N m"]]},
    }
    given = {"gear": gear, "throttle": 0.5, "efficiency": 0.9}
    found = stiffmbs.run(
        powered("closed", tables=tables, parameters=given, map="tables"), duration=4, output=0.01, rtol=1e-8
    )
    total = ratio * RATIO
    engine = 0.5 * (120 - 20)  # halfway between open and closed
    acceleration = 0.9 * engine * total / (2 * 60 + 0.01 * RATIO**2 + 0.9 * 0.15 * total**2)
    measured = np.polyfit(found.time[200:], found["left.wy"][200:], 1)[0]
    assert measured == pytest.approx(acceleration, rel=1e-3)
    assert found["engine.engine_speed"][-1] == pytest.approx(total * found["left.wy"][-1], rel=1e-3)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(6))
def test_engine_maps_gears_and_losses_at_random(seed):
    """Torque by the parabolas of the speed, and acceleration by it, by the ratio of the gear and by the losses, also when it drags."""
    rng = np.random.default_rng(seed)
    names, gear = ("first", "second", "third", "fourth", "fifth", "sixth"), seed + 1
    ratios = dict(zip(names, np.sort(rng.uniform(0.6, 4, 6))[::-1].tolist(), strict=True))
    peak, top, falling, drag, rise = rng.uniform((80, 250, 0.1, 5, 0), (300, 450, 0.5, 30, 0.1)).tolist()
    throttle, efficiency, inertia, spin = (seed % 2) * rng.uniform(0, 1), rng.uniform(0.85, 1), rng.uniform(0.05, 0.3), rng.uniform(20, 40)  # fmt: skip
    total = RATIO * ratios[names[gear - 1]]
    given = {**ratios, "gear": gear, "throttle": throttle, "efficiency": efficiency, "engine_inertia": inertia, "peak_torque": peak,
             "peak_speed": top, "falling": falling, "drag_torque": drag, "drag_rise": rise, "idle": 0, "start_speed": total * spin, "limit": 2000}  # fmt: skip
    parts = {
        "diff": {
            "use": "differential",
            "mounts": {"left": "left", "right": "right"},
            "parameters": {"speed": 0.3 * spin},
        },
        "engine": {"use": "powertrain", "mounts": {"output": "diff.input"}, "parameters": given},
    }
    scene = outputs(inertia=60.0, parts=parts)
    for name in ("left", "right"):
        scene["bodies"][name]["omega"] = [0, spin, 0]
    found = stiffmbs.run(stiffmbs.read_scene(json.dumps(scene)), duration=3, output=0.005, rtol=1e-9)
    n, later = found["engine.engine_speed"], slice(200, None)
    closed = -drag * np.tanh(n / 10) - rise * n
    torques = closed + (peak * (1 - falling * (n / top - 1) ** 2) - closed) * throttle
    assert found["engine.engine_torque"] == pytest.approx(torques, rel=1e-9)
    clutch = (torques - inertia * np.gradient(n, found.time))[later]
    driving = total * (clutch - (1 - efficiency) * np.abs(clutch))
    assert (120 + 0.01 * RATIO**2) * np.gradient(found["left.wy"], found.time)[later] == pytest.approx(driving, abs=5e-3 * np.max(np.abs(driving)))  # fmt: skip
    assert n[later] == pytest.approx(total * found["left.wy"][later], rel=1e-2)


@pytest.mark.long
def test_a_clutch_slips_at_its_capacity_and_the_gear_follows_a_formula():
    """While the engine spins up against the pressed clutch its torque is the capacity; then both turn alike, in the second gear."""
    variables = {"gear": "step(t, 3, 1, 3.2, 2)", "throttle": "step(t, 3, 0.6, 3.1, 0)", "pressing": "step(t, 0, 0, 0.1, 0.3)"}  # fmt: skip
    scene = powered("formula", variables, parameters={"start_speed": "3500 rpm"}, gear="formula", throttle="formula")
    found = stiffmbs.run(scene, duration=6, output=0.01, rtol=1e-7)
    assert found["engine.clutch_torque"][20:60] == pytest.approx(np.full(40, 0.3 * 350), rel=1e-3)
    assert found["engine.gear_ratio"][[0, -1]] == pytest.approx([3.6, 2.1])
    assert found["engine.engine_speed"][-1] == pytest.approx(2.1 * found["diff.input.wy"][-1], rel=1e-2)


@pytest.mark.long
def test_an_automatic_gearbox_shifts_by_the_speed_in_the_chosen_gear():
    """Sample by sample; output every 50 ms is the state just before a sample. A shift takes 0.3 s."""
    given = {"drag_torque": "150 N m", "upshift": "3500 rpm", "downshift": "1500 rpm", "gears": 3}
    scene = powered(
        "closed", {"throttle": "step(t, 8, 1, 8.2, 0)"}, parameters=given, gear="automatic", throttle="formula"
    )
    found = stiffmbs.run(scene, duration=22, output=0.05, rtol=1e-7)
    chosen, speed = found["engine.chosen_gear"], found["engine.chosen_speed"] * 60 / (2 * np.pi)
    ratios = np.array([3.6, 2.1, 1.4])[chosen.astype(int) - 1]
    assert speed == pytest.approx(ratios * found["diff.input.wy"] * 60 / (2 * np.pi), abs=1e-6)
    change = ((speed > 3500) & (chosen < 3)).astype(int) - ((speed < 1500) & (chosen > 1))
    assert chosen[1:] == pytest.approx((chosen + change)[:-1])
    assert chosen.max() == 3 and chosen[-1] == 1 and np.abs(np.diff(chosen)).max() == 1
    up = int(np.argmax(chosen == 2))
    assert found["engine.gear_now"][up + 3] == pytest.approx(1 + 4 * 0.05 / 0.3, abs=1e-3)
    assert found["engine.gear_now"][up + 7] == pytest.approx(2, abs=1e-2)


def steered(assist, tables=None, hand="5 N m", parameters=None):
    """Return the rest of a column and rack against a spring of 100 N/mm, with a torque at the steering wheel."""
    parts = {
        "steering": {"use": "steering_rack", "compliance": "rigid", "on": "car"},
        "column": {"use": "steering_column", "on": "car", "mounts": {"rack": "steering.rack", "housing": "car"}, "assist": assist, "parameters": parameters or {}},
    }  # fmt: skip
    scene = {
        "dimensions": 3,
        "bodies": {"car": {"mass": 1000, "inertia": [500, 1500, 1700]}},
        "joints": {"held": {"type": "fixed", "i": "car", "j": "ground"}},
        "parts": parts,
        "forces": {
            "hand": {"type": "torque", "i": "column.hand_wheel", "j": "car", "axes": "body", "torque": [0, 0, hand]},
            "load": {"type": "force", "i": "steering.rack", "j": "car", "force": [0, "-1e5*dy(steering.rack, car)", 0]},
        },
        "requests": {"rack": "dy(steering.rack, car)"},
        **({"tables": tables} if tables else {}),
    }
    return stiffmbs.equilibrium(stiffmbs.read_scene(json.dumps(scene))).channels


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("hand", [5.0, -2.0])
def test_a_steering_column_has_its_ratio_compliance_and_assist(hand):
    """The rack's force is (M + A)/p with p = travel per angle; the wheel turns by the rack's travel over p and the twist M/k."""
    p, k = 0.05 / (2 * np.pi), 120.0
    tables = {"assist_of": {"table": [[-10, -30], [0, 0], [10, 30]], "lines": True}}
    for assist, helped in (("none", 0.0), ("table", 3 * hand), ("formula", 40 * np.tanh((hand + 0.1 * hand**3) / 40))):
        found = steered(assist, tables if assist == "table" else None, f"{hand} N m")
        assert found["column.assist_torque"] == pytest.approx(helped, abs=1e-6)
        assert found["rack"] == pytest.approx((hand + helped) / p / 1e5, rel=1e-6)
        assert found["column.wheel_angle"] == pytest.approx(found["rack"] / p + hand / k, rel=1e-6)


@pytest.mark.long
def test_a_shaft_that_is_missing_from_the_spinning_bodies_is_named(examples):
    """Its twist would grow without end; the search stops soon, and no rod that spins freely on its bushings is named."""
    entries = read_yaml((examples / "car.yaml").read_text(), "car.yaml")
    wheels = {
        name.replace(".", "_"): f"{name}.wheel" for name in ("front.left", "front.right", "rear.left", "rear.right")
    }
    entries["parts"]["driveline"] = {
        "use": "driveline", "on": "chassis", "drive": "rear", "position": [0, 0, "-height"], "mounts": wheels,
        "parameters": {"speed": "V", "rolling_radius": "r"},
    }  # fmt: skip
    for tyre in entries["forces"].values():
        tyre["properties"] = str(examples / "car.tir")
    with pytest.raises(stiffmbs.SolverError) as error:
        stiffmbs.equilibrium(stiffmbs.read_scene(json.dumps(entries)))
    assert (
        "'driveline.main.input' spins freely and acts on the spin of rear.left.wheel, expected it in rolling too"
        in str(error.value)
    )
