"""Static equilibrium against closed forms, from poses far away, and what is said where there is none."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.commands.main import main
from stiffmbs.errors import SolverError
from tests.stress.random_tree import random_tree

from ..conftest import EXAMPLES


@pytest.mark.long
@pytest.mark.parametrize("height", [-0.2, -0.05, 0.0, 0.1, 0.2])
def test_the_half_car_settles_from_any_height(height):
    scene = stiffmbs.load_scene(EXAMPLES / "half_car.yaml")
    bodies = {
        name: body.model_copy(update={"position": (body.position[0], body.position[1] + height)})
        for name, body in scene.bodies.items()
    }
    found = equilibrium(scene.model_copy(update={"bodies": bodies}))
    weight = 9.81 * sum(body.mass for body in scene.bodies.values())
    loads = found.channels["front_tyre.fy"] + found.channels["rear_tyre.fy"]
    assert abs(loads - weight) < 1e-9 * weight
    assert found.channels["chassis.y"] == pytest.approx(0.6, abs=1e-6)


def test_a_run_from_equilibrium_stays_at_rest():
    scene = stiffmbs.load_scene(EXAMPLES / "half_car.yaml", [("V", "1e-9")])
    lifted = scene.bodies["chassis"].model_copy(update={"position": (0, 0.7)})
    raised = scene.model_copy(update={"bodies": {**scene.bodies, "chassis": lifted}, "start": "equilibrium"})
    found = stiffmbs.run(raised, duration=10.0, rtol=1e-9)
    for name in ("chassis.y", "front.y", "rear.angle"):
        assert np.ptp(found[name]) < 1e-8


@pytest.mark.long
def test_a_ball_falls_onto_the_floor_and_sinks_in():
    found = equilibrium(stiffmbs.load_scene(EXAMPLES / "bouncing_ball.yaml"))
    assert found.channels["floor.fy"] == pytest.approx(0.5 * 9.81, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("name, channel, value", [("bar_pendulum", "bar.y", -0.3), ("heavy_top", "top.z", None)])
def test_pendulums_hang_down(name, channel, value):
    found = equilibrium(stiffmbs.load_scene(EXAMPLES / f"{name}.yaml"))
    hanging = -np.hypot(
        np.hypot(found.channels.get("top.x", 0), found.channels.get("top.y", 0)), found.channels.get("top.z", 0)
    )
    assert found.channels[channel] == pytest.approx(hanging if value is None else value, abs=1e-9)


@pytest.mark.long
def test_a_torsion_spring_in_space_unwinds_by_turns():
    """k (20 rad - a) = m g r cos a after nearly two turns; in the plane the angle is a coordinate."""
    from scipy.optimize import brentq

    text = """
dimensions: 3
gravity: [0, -9.81, 0]
bodies: {bar: {mass: 2, inertia: [0.02, 0.03, 0.04], position: [0.3, 0, 0]}}
joints: {axle: {type: revolute, i: {body: bar, point: [-0.3, 0, 0]}, j: ground}}
forces: {spring: {type: torsion_spring, i: bar, j: ground, stiffness: 0.5, free_angle: 20}}
"""
    found = equilibrium(stiffmbs.read_scene(text))
    angle = brentq(lambda a: 0.5 * (20 - a) - 2 * 9.81 * 0.3 * np.cos(a), 11, 12)
    assert found.channels["spring.tz"] == pytest.approx(0.5 * (20 - angle), abs=1e-9)


STRUT = """
bodies:
  bar: {mass: 1, inertia: 0.1, position: [0, 0.5], angle: 90 deg, markers: {top: {point: [0.5, 0]}}}
joints:
  hinge: {type: revolute, i: {body: bar, point: [-0.5, 0]}, j: ground}
forces:
  spring: {type: torsion_spring, i: bar, j: ground, stiffness: 10, free_angle: 90 deg}
  load: {type: force, i: bar.top, force: [0, -20]}
"""


@pytest.mark.long
def test_a_buckled_strut_finds_a_stable_branch_and_says_that_there_are_two():
    """k a = F L sin a for the angle a from upright; upright itself is unstable for F L > k."""
    from scipy.optimize import brentq

    found = equilibrium(stiffmbs.read_scene(STRUT))
    angle = brentq(lambda a: 10 * a - 20 * np.sin(a), 0.5, 3)
    assert abs(found.channels["bar.angle"] - np.pi / 2) == pytest.approx(angle, abs=1e-9)
    assert any("unstable in bar.omega; of 2 branches" in note for note in found.notes)


def test_free_directions_are_named_and_left_alone():
    text = """
gravity: [0, -9.81]
bodies: {cart: {mass: 2, inertia: 1, position: [3, 0.5]}, bob: {mass: 1, inertia: 0.1, position: [3.4, 0.5]}}
joints:
  rail: {type: prismatic, i: cart, j: {body: ground, point: [0, 0.5]}}
  hinge: {type: revolute, i: {body: bob, point: [-0.4, 0]}, j: cart}
"""
    found = equilibrium(stiffmbs.read_scene(text))
    assert found.free == ("cart.vx",)
    assert found.channels["bob.y"] == pytest.approx(0.1, abs=1e-9)
    assert 2.5 < found.channels["cart.x"] < 3.5


def test_what_falls_for_ever_has_no_equilibrium(few_moves):
    with pytest.raises(SolverError, match=r"no equilibrium was found: the largest imbalance is stone.fy"):
        equilibrium(stiffmbs.read_scene("gravity: [0, -9.81]\nbodies: {stone: {mass: 2, inertia: 1}}"))


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=pytest.mark.long if seed in (23, 25) else ()) for seed in range(30)]
)
def test_random_trees_with_springs_settle_or_say_why(seed):
    """At rest with the found pose as described: accelerations are zero."""
    model = random_tree(np.random.default_rng(seed), 4, True, True, 5)
    try:
        found = equilibrium(model)
    except SolverError as error:
        assert "the largest imbalance is" in str(error)
        return
    labels = [name for name in found.channels if name.endswith((".ax", ".ay", ".alpha"))]
    assert max(abs(found.channels[name]) for name in labels) < 1e-7


def test_the_command_prints_poses_and_json():
    scene = str(EXAMPLES / "bar_pendulum.yaml")
    shown = CliRunner().invoke(main, ["equilibrium", scene])
    assert shown.exit_code == 0 and "bar" in shown.output and "hinge" in shown.output
    told = json.loads(CliRunner().invoke(main, ["equilibrium", scene, "--json"]).output)
    assert told["status"] == "done" and told["imbalance"] < 1e-9
    assert told["channels"]["hinge.fy"] == pytest.approx(1.2 * 9.81)
    assert told["moved"]["bar"] == pytest.approx([0.3 * np.sqrt(2), np.pi / 2])


def test_the_command_tells_that_there_is_none(few_moves, tmp_path):
    scene = tmp_path / "stone.yaml"
    scene.write_text("gravity: [0, -9.81]\nbodies: {stone: {mass: 2, inertia: 1}}")
    told = CliRunner().invoke(main, ["equilibrium", str(scene), "--json"])
    assert told.exit_code == 1
    assert json.loads(told.stdout)["status"] == "stopped" and "stone.fy" in json.loads(told.stdout)["message"]


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("pull, expected", [(14.8, 0.3212346895), (14.83, None), (16.0, None), (100.0, None)])
def test_a_plate_beyond_pull_in_has_no_equilibrium_on_the_far_side_of_the_electrode(pull, expected):
    """Electrostatic force F/(1 - x)^2 on a spring of 100 N/m: pull-in at x = 1/3, F = 400/27 (Senturia 2001, ch. 6)."""
    scene = f"""
bodies: {{plate: {{mass: 1, inertia: 1}}}}
joints: {{rail: {{type: prismatic, i: plate, j: ground}}}}
forces:
  spring: {{type: bushing, i: plate, j: ground, stiffness: [100, 0, 0]}}
  pull: {{type: force, i: plate, force: ["{pull}/(1 - plate.x)^2", 0]}}
"""
    if expected is None:
        with pytest.raises(SolverError, match="no equilibrium was found: the largest imbalance"):
            stiffmbs.equilibrium(stiffmbs.read_scene(scene))
    else:
        found = stiffmbs.equilibrium(stiffmbs.read_scene(scene))
        assert found.channels["plate.x"] == pytest.approx(expected, abs=1e-8)


@pytest.mark.long
def test_a_pole_at_which_a_force_changes_its_sign_is_no_equilibrium():
    """A spring of 100 N/m and 26/(1 - x) N have no balance: 25 N is the largest force with one."""
    scene = """
bodies: {block: {mass: 1, inertia: 1}}
joints: {rail: {type: prismatic, i: block, j: ground}}
forces:
  spring: {type: bushing, i: block, j: ground, stiffness: [100, 0, 0]}
  pull: {type: force, i: block, force: ["26/(1 - block.x)", 0]}
"""
    with pytest.raises(SolverError, match="the derivatives of forces grow without bound"):
        stiffmbs.equilibrium(stiffmbs.read_scene(scene))


@pytest.mark.long
def test_a_line_force_of_zero_length_balances_nothing():
    """It pulls the points together, and has no direction there that could balance the load across it."""
    scene = """
    gravity: [0, 0]
    bodies: {b: {mass: 1, inertia: 1, position: [0.4, 0.3]}}
    forces:
      cable: {type: line_force, i: b, j: ground, force: -8}
      load: {type: force, i: b, force: [2.5, 0]}
    """
    with pytest.raises(SolverError, match="distances that become zero"):
        stiffmbs.equilibrium(stiffmbs.read_scene(scene))


def test_constraints_of_velocities_hold_many_poses():
    scene = """
    gravity: [0, 0]
    bodies: {b: {mass: 1, inertia: 1, position: [0.4, 0.3]}}
    joints: {edge: {type: velocity_equation, zero: "b.vx - 0.3*b.y*b.vy"}}
    forces: {f: {type: force, i: b, force: ["-b.x", "-b.y"]}, g: {type: torque, i: b, torque: "-b.angle"}}
    """
    found = stiffmbs.equilibrium(stiffmbs.read_scene(scene))
    assert found.channels["edge.fx"] == pytest.approx(found.channels["b.x"])
    assert [note[:52] for note in found.notes] == ["edge constrains velocities alone and can hold many p"]


ELBOW = """
gravity: [0, -9.81]
bodies:
  upper: {mass: 1, inertia: 0.1, position: [0.5, 0], markers: {end: {point: [0.5, 0]}}}
  lower: {mass: 1, inertia: 0.1, position: [1.3, 0.4], angle: "atan2(4, 3)", markers: {end: {point: [-0.5, 0]}}}
joints:
  shoulder: {type: revolute, i: {body: upper, point: [-0.5, 0]}, j: ground}
  elbow: {type: revolute, i: lower.end, j: upper.end}
  motor: {type: drive, joint: elbow, velocity: 2*t}
start: equilibrium
run: {duration: 1 ms}
"""
RESTS = "equilibria are at rest: the velocities of motor have no effect, and move nothing from one time to another"
ARM = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  upper: {mass: 1, inertia: [0.1, 0.2, 0.15], position: [0.5, 0, 0], markers: {end: {point: [0.5, 0, 0]}}}
  lower: {mass: 1, inertia: [0.1, 0.2, 0.15], position: [1.3, 0.4, 0.3], markers: {end: {point: [0.5, 0, 0]}}}
joints:
  shoulder: {type: spherical, i: {body: upper, point: [-0.5, 0, 0]}, j: ground}
  motor: {type: drive, coordinate: "dm(upper.end, lower.end)", velocity: 0.3}
forces:
  cord: {type: spring_damper, i: lower.end, j: ground, stiffness: 20, damping: 1, free_length: 0.4}
  joint: {type: bushing, i: lower, j: upper, stiffness: [90, 90, 90, 9, 9, 9]}
start: equilibrium
run: {duration: 1 ms}
"""


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("scene", "driven", "described"),
    [
        (ELBOW, lambda at: at["lower.angle"] - at["upper.angle"], np.arctan2(4, 3)),
        (ARM, lambda at: at["motor_length"], np.hypot(0.8, 0.5)),
    ],
)
def test_a_drive_of_a_velocity_keeps_its_coordinate_in_the_search(scene, driven, described):
    """Moves of the search are large here: its joints were closed after each without regard to the drive."""
    scene = stiffmbs.read_scene(scene + "requests: {motor_length: 'dm(upper.end, lower.end)'}\n")
    found = stiffmbs.equilibrium(scene)
    assert driven(found.channels) == pytest.approx(described, abs=1e-10)
    assert not any("velocities alone" in note for note in found.notes)
    run = stiffmbs.run(scene)
    assert driven(run.channels)[0] == pytest.approx(described, abs=1e-10)


@pytest.mark.long
def test_a_drive_of_a_velocity_keeps_its_coordinate_on_a_branch():
    """From standing upright, the elbow straight: the search leaves the unstable pose by a small move."""
    upright = ELBOW.replace("[0.5, 0], m", "[0, 0.5], angle: pi/2, m")
    upright = upright.replace('[1.3, 0.4], angle: "atan2(4, 3)"', "[0, 1.5], angle: pi/2")
    found = stiffmbs.equilibrium(stiffmbs.read_scene(upright))
    assert any("is unstable" in note for note in found.notes)
    assert found.channels["upper.y"] == pytest.approx(-0.5)
    assert found.channels["lower.angle"] - found.channels["upper.angle"] == pytest.approx(0, abs=1e-10)


@pytest.mark.long
def test_drives_of_velocities_rest_in_equilibria_over_time():
    """A growing force lifts the arm; the elbow keeps its angle, and a prescribed velocity is noted."""
    base = ELBOW + "forces: {lift: {type: force, i: upper, force: [20*t, 0]}}\n"
    found = stiffmbs.quasi_static(stiffmbs.read_scene(base.replace("2*t", "0")), duration=1.0, points=3)
    assert np.ptp(found["lower.angle"] - found["upper.angle"]) < 1e-10
    assert np.ptp(found["upper.angle"]) > 0.1
    assert not found.notes
    found = stiffmbs.quasi_static(stiffmbs.read_scene(base), duration=1.0, points=3)
    assert found.notes == (RESTS,)
    assert RESTS in stiffmbs.equilibrium(stiffmbs.read_scene(base), start=1.0).notes
    assert RESTS not in stiffmbs.run(stiffmbs.read_scene(base)).notes
