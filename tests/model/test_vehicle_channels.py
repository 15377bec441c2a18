"""The section `vehicle`: channels in the axes of ISO 8855, against rotation matrices in NumPy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import stiffmbs

from ..conftest import EXAMPLES

TUMBLING = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  chassis:
    mass: 1200
    inertia: [400, 1500, 1700]
    center_of_mass: [0.1, 0.05, 0.2]
    position: [0, 0, 5]
    orientation: {euler: zyx, angles: [0.3, 0.2, -0.4]}
    velocity: [12, 4, 1]
    omega: [0.4, 0.5, 9]
vehicle: {body: chassis, point: [-0.2, 0.1, 0.3], points: {driver: [0.4, 0.35, 0.6]}}
run: {duration: 2 s, output: 50 ms, rtol: 1e-9}
"""
IN_SAE_AXES = TUMBLING.replace("[-0.2, 0.1, 0.3]", "[-0.2, 0.1, 0.3], orientation: {x: [1, 0, 0], z: [0, 0, -1]}")


def expected(run, name, centre, point, own):
    """Channels of a point in NumPy: horizontal axes that yaw with the vehicle axes, which are `own` in the body."""

    def of(labels):
        return np.stack([run[f"{name}.{label}"] for label in labels.split()], axis=1)

    body = Rotation.from_quat(of("q1 q2 q3 q0"))
    omega, alpha = body.apply(of("wx wy wz")), body.apply(of("wdx wdy wdz"))
    arm = body.apply(np.subtract(point, centre))
    velocity = of("vx vy vz") + np.cross(omega, arm)
    acceleration = of("ax ay az") + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm))
    yaw, pitch, roll = (body * own).as_euler("ZYX").T
    level = Rotation.from_rotvec(np.outer(yaw, [0, 0, 1])).inv()
    (vx, vy, vz), (ax, ay, az) = level.apply(velocity).T, level.apply(acceleration).T
    roll_rate, pitch_rate, yaw_rate = level.apply(omega).T
    return {
        "yaw": np.unwrap(yaw), "pitch": pitch, "roll": roll, "yaw_rate": yaw_rate, "pitch_rate": pitch_rate, "roll_rate": roll_rate,
        "vx": vx, "vy": vy, "vz": vz, "ax": ax, "ay": ay, "az": az, "speed": np.hypot(vx, vy), "sideslip": np.arctan2(vy, vx),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "own"),
    [(TUMBLING, Rotation.identity()), (IN_SAE_AXES, Rotation.from_euler("x", np.pi))],
    ids=["z upwards", "z downwards"],
)
def test_a_tumbling_body_over_several_turns(text, own):
    run = stiffmbs.run(stiffmbs.read_scene(text))
    whole = expected(run, "chassis", (0.1, 0.05, 0.2), (-0.2, 0.1, 0.3), own)
    driver = expected(run, "chassis", (0.1, 0.05, 0.2), (0.4, 0.35, 0.6), own)
    assert np.ptp(run["vehicle.yaw"]) > 2 * np.pi, "it turns more than once"
    for name, values in whole.items():
        assert run[f"vehicle.{name}"] == pytest.approx(values, abs=1e-8), name
        if name in ("vx", "vy", "vz", "ax", "ay", "az", "speed", "sideslip"):
            assert run[f"vehicle.driver.{name}"] == pytest.approx(driver[name], abs=1e-8), name
    assert run.unit("vehicle.vy") == "m/s"
    assert run.unit("vehicle.ay") == "m/s^2"


@pytest.mark.long
def test_the_car_in_a_step_steer():
    steering = "{angle: 'dy(steering.rack, chassis, chassis)/(8 mm)', torque: 'steer.fy*8 mm'}"
    changes = [
        ("choose.manoeuvre", "step_steer"),
        ("choose.compliance", "rigid"),
        ("vehicle", f"{{body: chassis, steering: {steering}}}"),
    ]
    run = stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "car.yaml", changes), duration=2.5, output=0.02)
    for name, values in expected(run, "chassis", np.zeros(3), np.zeros(3), Rotation.identity()).items():
        assert run[f"vehicle.{name}"] == pytest.approx(values, abs=1e-9), name
    assert run["vehicle.ay"][-1] > 1 and run["vehicle.roll"][-1] > 0, "to the left, and leaning to the right"
    assert run["vehicle.steering_angle"][-1] == pytest.approx(5 / 8, rel=1e-6)
    for tyre in ("front.left.tyre", "rear.right.tyre"):
        assert np.array_equal(run[f"vehicle.{tyre}.alpha"], run[f"{tyre}.slip_angle"])
        assert np.array_equal(run[f"vehicle.{tyre}.kappa"], run[f"{tyre}.slip"])


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("{body: chasis}", "vehicle.body: found 'chasis' (did you mean 'chassis'?)"),
        ("{body: chassis, tyres: [front]}", "vehicle.tyres: found 'front', expected one of none"),
        ("{point: [0, 0, 0]}", "vehicle.body"),
        ("{body: chassis, wheels: 4}", "wheels"),
        ("{body: chassis, points: {seat: [0, 1]}}", "vehicle.points.seat"),
        ("{body: chassis, steering: {angle: nobody.x}}", "nobody"),
        ("7", "vehicle: found 7"),
    ],
)
def test_a_fault_is_named(section, message):
    with pytest.raises(stiffmbs.InputError) as error:
        stiffmbs.read_scene(TUMBLING, [("vehicle", section)])
    assert message in str(error.value)


def test_a_planar_scene_has_no_vehicle():
    with pytest.raises(stiffmbs.InputError, match="vehicle"):
        stiffmbs.read_scene("{bodies: {cart: {mass: 1, inertia: 1}}, vehicle: {body: cart}}")
