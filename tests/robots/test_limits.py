"""Stops that hold the joints of robots within their limits."""

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

T = 0.02
ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0.05" rpy="0.3 0 0.5"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0.001" ixz="0" iyz="0"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
    <inertia ixx="0.001" iyy="0.002" izz="0.003" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="{upper}" effort="0" velocity="0"/></joint>
  <joint name="elbow" type="{elbow}"><origin xyz="0.4 0 0"/><parent link="upper"/><child link="fore"/><axis xyz="1 0 0"/>
    <limit lower="-0.05" upper="0.3" effort="0" velocity="0"/></joint>
</robot>"""


def robot(tmp_path, upper=0.1, elbow="fixed"):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(upper=upper, elbow=elbow))
    return path


@pytest.mark.parametrize(("sign", "distance"), [(1.0, 0.1), (-1.0, 0.5)])
def test_a_stop_turns_a_joint_round_as_a_critically_damped_spring(tmp_path, sign, distance):
    """Beyond a limit, x = v t exp(-t/T); the stop lets go at 2 T, where x' = -v/e^2."""
    speed = 3.0
    scene = load_robot(robot(tmp_path), [("gravity", "[0, 0, 0]")], rates={"shoulder": sign * speed}, limits=True)
    found = stiffmbs.run(scene, duration=distance / speed + 3 * T, points=2001, solver="radau", rtol=1e-9)
    past = sign * found["shoulder.angle"] - distance
    assert past.max() == pytest.approx(speed * T / np.e, rel=1e-4)
    assert sign * found["shoulder.angle_rate"][-1] == pytest.approx(-speed / np.e**2, rel=1e-4)


def test_a_slide_is_held_with_the_mass_that_it_carries(tmp_path):
    scene = load_robot(
        robot(tmp_path, elbow="prismatic"), [("gravity", "[0, 0, 0]")], rates={"elbow": -0.5}, limits=True
    )
    found = stiffmbs.run(scene, duration=0.05 / 0.5 + 3 * T, points=2001, solver="radau", rtol=1e-9)
    assert found["elbow.displacement"].min() == pytest.approx(-0.05 - 0.5 * T / np.e, rel=1e-4)


def test_stops_rest_on_their_joint_under_gravity(tmp_path):
    """Gravity along -y turns the arm to its lower limit; at rest the stop carries its weight."""
    scene = load_robot(robot(tmp_path), [("gravity", "[0, -9.81, 0]")], limits=True)
    found = stiffmbs.run(scene, duration=3.0, rtol=1e-8)
    angle = found["shoulder.angle"][-1]
    turned = Rotation.from_euler("xyz", [0.3, 0, 0.5]).as_matrix()
    own = turned @ [[0.01, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.03]] @ turned.T
    inertia = own[2, 2] + 2 * 0.2**2 + 0.003 + 1 * 0.5**2
    weight = 9.81 * (2 * 0.2 + 1 * 0.5) * np.cos(angle)
    assert angle == pytest.approx(-0.5 - weight * T**2 / inertia, rel=1e-5)


def test_limits_are_listed_held_or_not(tmp_path):
    path = robot(tmp_path, upper=-0.1)
    held, free = (
        CliRunner().invoke(main, ["convert", str(path), "--limits"]),
        CliRunner().invoke(main, ["convert", str(path)]),
    )
    said = " ".join(held.output.split())
    assert "shoulder_stop" in held.output and "stops hold joints within their limits: shoulder" in said
    assert "joints start beyond their limits: shoulder at 0 rad" in said
    assert "shoulder_stop" not in free.output and "convert --limits adds stops" in " ".join(free.output.split())
    other = CliRunner().invoke(main, ["convert", "scene.yaml", "--limits"])
    assert other.exit_code == 2 and "found --limits, expected it with a robot alone" in other.output


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_brake_slows_a_joint_to_its_largest_speed(tmp_path, sign):
    """The excess decays with the time constant T; under a constant torque, the torque times T/I is left of it."""
    path, limit, start = robot(tmp_path, upper=20.0), 2.0, 5.0
    path.write_text(path.read_text().replace('velocity="0"', f'velocity="{limit}"', 1).replace("-0.5", "-20"))
    scene = load_robot(path, [("gravity", "[0, 0, 0]")], rates={"shoulder": sign * start}, limits=True)
    found = stiffmbs.run(scene, duration=0.1, points=101, rtol=1e-9)
    expected = limit + (start - limit) * np.exp(-found.time / T)
    np.testing.assert_allclose(sign * found["shoulder.angle_rate"], expected, rtol=1e-6)
    free = load_robot(path, [("gravity", "[0, 0, 0]")], rates={"shoulder": sign * 1.9}, limits=True)
    assert sign * stiffmbs.run(free, duration=0.1)["shoulder.angle_rate"][-1] == pytest.approx(1.9, rel=1e-5)


@pytest.mark.parametrize(("kind", "file"), [("prismatic", "urdf"), ("continuous", "urdf"), ("revolute", "sdf")])
def test_speeds_are_read_and_listed(tmp_path, kind, file):
    """A driven joint has its largest speed and the excess force times T over its inertia."""
    path, mass = tmp_path / f"a.{file}", 2.0
    if file == "urdf":
        path.write_text(
            f'<robot name="r"><link name="w"/><link name="l"><inertial><mass value="{mass}"/><inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0"'
            f' iyz="0"/></inertial></link><joint name="j" type="{kind}"><parent link="w"/><child link="l"/><axis xyz="0 0 1"/>'
            '<limit lower="-9" upper="9" effort="40" velocity="0.5"/></joint></robot>'
        )
    else:
        path.write_text(
            f'<sdf version="1.9"><model name="m"><link name="l"><inertial><mass>{mass}</mass><inertia><ixx>2</ixx><iyy>2</iyy><izz>2</izz></inertia>'
            f'</inertial></link><joint name="j" type="{kind}"><parent>world</parent><child>l</child><axis><xyz>0 0 1</xyz>'
            "<limit><effort>40</effort><velocity>0.5</velocity></limit></axis></joint></model></sdf>"
        )
    unit = "m" if kind == "prismatic" else "rad"
    assert any("does not hold" in note and f"0.5 {unit}/s" in note for note in load_robot(path).notes)
    scene = load_robot(path, [("gravity", "[0, 0, 0]"), ("inputs.j_input", "10")], limits=True)
    found = stiffmbs.run(scene, duration=1.0, rtol=1e-8)
    rate = found["j.displacement_rate" if kind == "prismatic" else "j.angle_rate"]
    assert rate[-1] == pytest.approx(0.5 + 10 * T / 2, rel=1e-5)


PRESS = """<sdf version="1.9"><model name="press">
  <link name="nut"><pose>0 0 0.1 0 0 0</pose><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.04</izz></inertia></inertial></link>
  <joint name="thread" type="screw"><parent>world</parent><child>nut</child><screw_thread_pitch>{pitch}</screw_thread_pitch>
    <axis><xyz>0 0 1</xyz><limit>{lower}<upper>0.5</upper></limit></axis></joint>
</model></sdf>"""


@pytest.mark.parametrize("lower", ["<lower>-1</lower>", ""])
def test_a_screw_is_held_with_the_mass_that_it_lifts(tmp_path, lower):
    """The inertia of a screw with the pitch p is I + m (p/2 pi)^2. A side without a limit has no stop."""
    path, speed = tmp_path / "press.sdf", 2.0
    path.write_text(PRESS.format(pitch=0.5, lower=lower))
    scene = load_robot(path, [("gravity", "[0, 0, 0]")], rates={"thread": speed}, limits=True)
    found = stiffmbs.run(scene, duration=0.5 / speed + 3 * T, points=2001, solver="radau", rtol=1e-9)
    angle = next(name for name in found.channels if name.startswith("thread") and name.endswith("angle"))
    assert (found[angle] - 0.5).max() == pytest.approx(speed * T / np.e, rel=1e-4)


def test_limits_in_the_wrong_order_are_refused(tmp_path):
    """Both stops would have acted at once between them."""
    with pytest.raises(InputError, match=r"found the limits -0\.5 and -0\.8, expected the lower one first"):
        load_robot(robot(tmp_path, upper=-0.8), limits=True)
