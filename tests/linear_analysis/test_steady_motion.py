"""Equilibria at constant speed and on circles, against closed forms, and runs that stay in them."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.optimize import brentq, fsolve

import stiffmbs
from stiffmbs import SteadyMotion
from stiffmbs.commands.main import main

from ..conftest import EXAMPLES

BOB = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {bob: {mass: 2, inertia: [1e-3, 1e-3, 1e-3], position: [0.3, 0, -0.4]}}
joints: {hook: {type: spherical, i: {body: bob, point: [-0.3, 0, 0.4]}, j: ground}}
"""


@pytest.mark.parametrize("rate", [5.0, 9.0, 30.0])
def test_a_conical_pendulum(rate):
    """cos a = g/(W^2 L)."""
    scene = stiffmbs.read_scene(BOB)
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(rotation=rate))
    assert found.channels["bob.z"] == pytest.approx(-9.81 / rate**2, rel=1e-9)
    run = stiffmbs.run(scene, start_from=found.solution, duration=1.0, rtol=1e-10)
    assert np.ptp(run["bob.z"]) < 1e-7
    assert run["bob.x"][-1] == pytest.approx(np.hypot(run["bob.x"][0], run["bob.y"][0]) * np.cos(rate), abs=1e-6)


def test_below_its_critical_speed_the_pendulum_hangs_down():
    found = stiffmbs.equilibrium(stiffmbs.read_scene(BOB), motion=SteadyMotion(rotation=3.0))
    assert found.channels["bob.z"] == pytest.approx(-0.5, abs=1e-9)


def test_a_governor_stays_at_its_height():
    scene = stiffmbs.load_scene(EXAMPLES / "governor.yaml")
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(rotation=2 * np.pi))
    run = stiffmbs.run(scene, start_from=found.solution, duration=2.0, rtol=1e-9)
    assert np.ptp(run["slider.z"]) < 1e-6 and np.ptp(run["left.z"]) < 1e-6


CAR = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  frame: {mass: 100, inertia: [20, 60, 70], position: [0, -30, 0.3]}
  chassis: {mass: 1000, inertia: [300, 300, 300], position: [0, -30, 0.8]}
joints:
  road: {type: planar, i: {body: frame, point: [0, 0, -0.3]}, j: ground}
  tyres: {type: distance, i: frame, j: {body: ground, point: [0, 0, 0.3]}, length: 30}
  roll: {type: revolute, i: {body: chassis, point: [0, 0, -0.5], orientation: {z: [1, 0, 0]}},
         j: {body: frame, orientation: {z: [1, 0, 0]}}}
forces:
  bar: {type: torsion_spring, i: {body: chassis, orientation: {z: [1, 0, 0]}}, j: {body: frame, orientation: {z: [1, 0, 0]}},
        stiffness: 40e3, damping: 2e3}
"""


@pytest.mark.long
def test_a_car_on_a_circle_rolls_outwards():
    """k a = m h (W^2 (R + h sin a) cos a + g sin a) for a chassis of equal moments of inertia about a roll axis."""
    rate, radius, height = 0.4, 30.0, 0.5
    found = stiffmbs.equilibrium(stiffmbs.read_scene(CAR), motion=SteadyMotion(rotation=rate))
    angle = brentq(
        lambda a: 40e3 * a - 1000 * height * (rate**2 * (radius + height * np.sin(a)) * np.cos(a) + 9.81 * np.sin(a)),
        0,
        1,
    )
    assert found.channels["chassis.z"] == pytest.approx(0.3 + height * np.cos(angle), abs=1e-9)
    outwards = np.hypot(found.channels["chassis.x"], found.channels["chassis.y"])
    assert outwards == pytest.approx(radius + height * np.sin(angle), abs=1e-8)
    speed = np.hypot(found.channels["chassis.vx"], found.channels["chassis.vy"])
    assert speed == pytest.approx(rate * outwards, rel=1e-12)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("rate", [0.5, pytest.param(1.0, marks=pytest.mark.long)])
def test_a_disc_rolls_on_a_circle(rate):
    """Its lean and spin follow from rolling; it falls over by statics and stays up by its spin, as a run from there does."""
    text = (EXAMPLES / "rolling_disc.yaml").read_text().replace("position: [0, 0, R", "position: [0, -2, R")
    still = [("falling", "0"), ("turning", "0"), ("rolling", "0")]
    scene = stiffmbs.read_scene(text, still)
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(rotation=rate, rolling=("disc",)))
    assert abs(found.channels["disc.wz"]) > 3 and found.moves <= 4
    run = stiffmbs.run(scene, start_from=found.solution, duration=1.5, rtol=1e-10)
    assert np.ptp(run["disc.z"]) < 1e-8
    assert np.ptp(np.hypot(run["disc.x"], run["disc.y"])) < 1e-5


TURNTABLE = """
bodies: {puck: {mass: 2, inertia: 0.1, position: [1, 0]}}
forces: {spring: {type: spring_damper, i: puck, j: ground, stiffness: 50, free_length: 0.8, damping: 3}}
"""


def test_a_puck_on_a_turntable_in_a_scene_that_starts_so():
    """r = k l/(k - m W^2)."""
    scene = stiffmbs.read_scene(TURNTABLE + "start: {rotation: 3 rad/s}\nrun: {duration: 2 s, rtol: 1e-10}\n")
    radius = 50 * 0.8 / (50 - 2 * 9)
    assert np.hypot(*(stiffmbs.equilibrium(scene).channels[f"puck.{axis}"] for axis in "xy")) == pytest.approx(radius)
    run = stiffmbs.run(scene)
    assert np.hypot(run["puck.x"], run["puck.y"]) == pytest.approx(radius, abs=1e-6)
    assert run["puck.omega"] == pytest.approx(3.0)


SLED = """
gravity: [0, -9.81]
bodies: {sled: {mass: 5, inertia: 1, position: [0, 0.1]}}
joints: {rail: {type: prismatic, i: sled, j: {body: ground, point: [0, 0.1]}}}
forces: {air: {type: force, i: sled, force: ["40 N - 2 N s/m*vx(sled)", 0]}}
"""


@pytest.mark.long
def test_a_sled_at_the_speed_at_which_thrust_and_drag_balance(few_moves):
    scene = stiffmbs.read_scene(SLED)
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(velocity=(20, 0)))
    assert found.channels["sled.vx"] == 20 and found.channels["rail.fy"] == pytest.approx(49.05)
    with pytest.raises(stiffmbs.SolverError, match=r"the largest imbalance is sled\.fx"):
        stiffmbs.equilibrium(scene, motion=SteadyMotion(velocity=(19, 0)))


@pytest.mark.parametrize("first", [3, 20, 200])
def test_a_speed_that_forces_tell(first):
    """Thrust and drag balance at 20 m/s, from whatever speed that is sought."""
    found = stiffmbs.equilibrium(stiffmbs.read_scene(SLED), motion=SteadyMotion(velocity=(first, 0), speed="found"))
    assert found.channels["sled.vx"] == pytest.approx(20, rel=1e-9)
    assert found.channels["sled.x"] == pytest.approx(0, abs=1e-9)


@pytest.mark.long
def test_a_speed_that_forces_tell_to_a_rolling_wheel():
    """A disc of 2 kg rolls with v = r w, 3 N against 1.5 N s/m of air."""
    scene = """
gravity: [0, -9.81]
bodies: {disc: {mass: 2, inertia: 0.1, position: [0, 0.3]}}
joints:
  floor: {type: point_on_line, i: disc, j: {body: ground, point: [0, 0.3]}}
  rolling: {type: velocity_equation, i: disc, zero: "vx(disc) + 0.3*wz(disc)"}
forces: {air: {type: force, i: disc, force: ["3 N - 1.5 N s/m*vx(disc)", 0]}}
"""
    motion = SteadyMotion(velocity=(1, 0), rolling=("disc",), speed="found")
    found = stiffmbs.equilibrium(stiffmbs.read_scene(scene), motion=motion)
    assert found.channels["disc.vx"] == pytest.approx(2) and found.channels["disc.omega"] == pytest.approx(-2 / 0.3)


WHEEL = """
dimensions: 3
gravity: [0, 0, -10]
bodies:
  car: {mass: 380, inertia: [50, 50, 50], position: [0, 0, 0.33], velocity: [10, 0, 0]}
  wheel: {mass: 20, inertia: [0.6, 1, 0.6], position: [0, 0, 0.33], velocity: [10, 0, 0], omega: [0, 25, 0]}
joints:
  guide: {type: planar, i: {body: car, orientation: {z: [0, 1, 0]}}, j: {body: ground, orientation: {z: [0, 1, 0]}}}
  level: {type: perpendicular, i: {body: car, orientation: {z: [1, 0, 0]}}, j: ground}
  hub: {type: revolute, i: {body: wheel, orientation: {z: [0, 1, 0]}}, j: {body: car, orientation: {z: [0, 1, 0]}}}
forces:
  tyre: {type: fiala_tyre, i: wheel, radius: 0.35, stiffness: 2e5, damping: 800, slip_stiffness: 8e4, cornering_stiffness: 6e4,
         mu_static: 1, mu_sliding: 0.8, rolling_resistance: 0.007 m%s}
  air: {type: force, i: car, force: ["thrust - 0.5 N s^2/m^2*vx(car)^2", 0, 0]}
parameters: {thrust: %s N}
start: {velocity: [10, 0, 0], rolling: [wheel], speed: found}
run: {duration: 2 s, rtol: 1e-8}
"""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(
    "relaxation",
    [pytest.param("", marks=pytest.mark.long, id="steady"), pytest.param(", relaxation: [0.3, 0.5]", id="lagging")],
)
def test_a_wheel_spins_as_its_tyre_asks(relaxation):
    """A load of 4 kN deflects by 20 mm; 28 N m of rolling resistance take Fx = -28/0.33 N, and so the slip Fx/80 kN; the rest is drag."""
    resistance = 28 / 0.33
    scene = stiffmbs.read_scene(WHEEL % (relaxation, 0.5 * 30**2 + resistance))
    found = stiffmbs.equilibrium(scene)
    assert found.channels["car.vx"] == pytest.approx(30, rel=1e-9)
    spin = 30 * (1 - resistance / 8e4) / (0.35 - 0.02 / 3)
    assert found.channels["wheel.wy"] == pytest.approx(spin, rel=1e-9)
    run = stiffmbs.run(scene)
    assert run["car.vx"] == pytest.approx(np.full(len(run.time), 30.0), abs=1e-6)
    assert run["tyre.load"] == pytest.approx(np.full(len(run.time), 4000.0), abs=1e-3)


@pytest.mark.long
def test_a_speed_that_no_force_tells_is_refused(few_moves):
    scene = stiffmbs.read_scene(SLED.replace("40 N - 2 N s/m*vx(sled)", "40 N"))
    with pytest.raises(stiffmbs.SolverError, match=r"the largest imbalance is sled\.fx"):
        stiffmbs.equilibrium(scene, motion=SteadyMotion(velocity=(20, 0), speed="found"))


@pytest.mark.parametrize("rate", [1e-3, 0.1])
def test_a_slow_rotation_of_a_stiff_blade_is_steady(rate):
    """Rounding of its stiffness exceeds the centrifugal forces, as 1e-7 N of 1e-8 to 1e-3 N."""
    scene = stiffmbs.read_scene("""
bodies:
  hub: {mass: 1, inertia: 1}
  rod: {type: beam, start: [0, 0], end: [1, 0], elements: 6, section: {type: rectangle, width: 40 mm, height: 15 mm}, material: {E: 70 GPa, density: 2700}}
joints:
  pin: {type: revolute, i: hub, j: ground}
  clamp: {type: fixed, i: rod.start, j: hub}
""")
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(rotation=rate))
    slowest = np.sort(np.abs(np.imag(found.eigenvalues)))[2]
    still = np.sort(np.abs(np.imag(stiffmbs.equilibrium(scene, motion=SteadyMotion(rotation=1e-9)).eigenvalues)))[2]
    assert slowest == pytest.approx(still, rel=1e-5)


WRONG = [
    ({"rotation": (1, 0, 0)}, "the motion is not steady"),
    ({"velocity": (1, 0, 0)}, "joint 'hook' (equation x) does not allow this motion"),
    ({"velocity": (1, 0)}, "velocity: found 2 numbers, expected 3"),
    ({"rolling": ("ball",)}, "rolling: found no body 'ball', expected one of bob"),
]


@pytest.mark.parametrize("motion, told", WRONG, ids=[told[:25] for _, told in WRONG])
def test_motions_that_are_none_are_refused(motion, told):
    with pytest.raises(stiffmbs.StiffmbsError) as error:
        stiffmbs.equilibrium(stiffmbs.read_scene(BOB), motion=SteadyMotion(**motion))
    assert told in str(error.value)


def test_a_drive_that_accelerates_at_the_start_has_an_equilibrium():
    scene = SLED.replace('forces: {air: {type: force, i: sled, force: ["40 N - 2 N s/m*vx(sled)", 0]}}', "")
    drive = "joints: {rail: {type: prismatic, i: sled, j: {body: ground, point: [0, 0.1]}}, motor: {type: drive, joint: rail, position: 3*t^2}}"
    lines = [drive if line.startswith("joints") else line for line in scene.splitlines()]
    assert stiffmbs.equilibrium(stiffmbs.read_scene("\n".join(lines))).channels["sled.x"] == pytest.approx(0, abs=1e-12)


def test_the_command(tmp_path):
    scene = tmp_path / "bob.yaml"
    scene.write_text(BOB)
    told = CliRunner().invoke(main, ["equilibrium", str(scene), "--rotation", "9 rad/s", "--json"])
    assert told.exit_code == 0, told.output
    assert json.loads(told.stdout)["channels"]["bob.z"] == pytest.approx(-9.81 / 81)
    assert "in steady motion" in json.loads(told.stdout)["message"]
    wrong = CliRunner().invoke(main, ["equilibrium", str(scene), "--velocity", "1,2"])
    assert wrong.exit_code == 2 and "velocity: found 2 numbers, expected 3" in wrong.output


@pytest.mark.long
def test_an_unstable_state_is_found_by_shortened_newton_steps(few_moves):
    """Full Newton steps on atan(20 p) from p = 1 go to -30, 1400, ...; p = 0 is unstable."""
    scene = stiffmbs.read_scene(SLED + 'states: {p: {rate: "atan(20*p)", start: 1}}\n')
    found = stiffmbs.equilibrium(scene, motion=SteadyMotion(velocity=(20, 0)))
    assert found.channels["p"] == pytest.approx(0.0, abs=1e-9)
    assert "unstable" in found.notes[0]


PULLING_CAR = """
parameters: {C1: 6e4, C2: 7e4, V: 20}
bodies: {car: {mass: 1200, inertia: 1500, position: [3, 2], markers: {front: {point: [1.2, 0]}, rear: {point: [-1.4, 0]}, side: {point: [0.3, 0]}}}}
forces:
  front: {type: force, i: car.front, axes: body, force: [0, "-C1*vy(car.front, ground, car)/V"]}
  rear: {type: force, i: car.rear, axes: body, force: [0, "-C2*vy(car.rear, ground, car)/V"]}
  wind: {type: force, i: car.side, axes: body, force: [0, 400]}
  drive: {type: force, i: car, axes: body, force: ["500 - 30*vx(car, ground, car)", 0]}
"""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("asked", ["", "rotation: found, "])
def test_a_car_that_pulls_to_one_side_turns_at_the_rate_of_the_bicycle_model(asked):
    start = f"start: {{{asked}velocity: [18, 0], speed: found}}\nrun: {{duration: 20 s, rtol: 1e-9}}\n"
    scene = stiffmbs.read_scene(PULLING_CAR + start)

    def left(unknown):
        vx, vy, r = unknown
        front, rear = -6e4 * (vy + 1.2 * r) / 20, -7e4 * (vy - 1.4 * r) / 20
        return (500 - 30 * vx + 1200 * r * vy, front + rear + 400 - 1200 * r * vx, 1.2 * front - 1.4 * rear + 0.3 * 400)

    vx, vy, r = fsolve(left, [18.0, 0.0, 0.0], xtol=1e-13)
    assert abs(r) > 5e-3
    found = stiffmbs.equilibrium(scene)
    assert found.channels["car.omega"] == pytest.approx(r, rel=1e-8)
    assert np.hypot(found.channels["car.vx"], found.channels["car.vy"]) == pytest.approx(np.hypot(vx, vy), rel=1e-9)
    run = stiffmbs.run(scene)
    assert run["car.omega"] == pytest.approx(np.full(len(run.time), r), rel=1e-6)
    assert any("turns at" in note for note in run.notes)


def test_forces_determine_a_rotation_only_of_bodies_that_move():
    with pytest.raises(stiffmbs.InputError, match="rotation: found no velocity"):
        stiffmbs.equilibrium(stiffmbs.read_scene(PULLING_CAR), motion=SteadyMotion(rotation="found"))
