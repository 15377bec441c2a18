"""Classics of mechanics in space as scenes, against closed forms: a ball on a turntable, a Stewart platform, a differential,
Bennett's linkage, and Andrews' mechanism with bodies of space."""

import json
import math

import numpy as np
import pytest
from ruamel.yaml import YAML
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.model.read_scene import read_scene

from ..minimal_coordinates import turned

G = 9.81


def forces(solution, element, names="fx fy fz"):
    return np.stack([solution[f"{element}.{name}"] for name in names.split()])


@pytest.mark.long
def test_a_ball_on_a_turntable_goes_round_at_two_sevenths_of_its_rate():
    """Without slipping a solid ball moves in a circle, anywhere on the table: v' = 2/7 Omega x v (Earnshaw, 1844)."""
    radius, rate = 0.1, 2.0
    solution = stiffmbs.run(
        read_scene(f"""
dimensions: 3
gravity: [0, 0, -{G}]
bodies:
  ball: {{mass: 2, inertia: [0.008, 0.008, 0.008], position: [0.5, 0, {radius}], velocity: [0.1, 0.2, 0], omega: [8, 1, 0.7]}}
  table: {{mass: 5, inertia: [1, 1, 1]}}
joints:
  pivot: {{type: revolute, i: table, j: ground}}
  motor: {{type: drive, joint: pivot, position: {rate}*t}}
  touch: {{type: equation, i: ball, zero: ball.z - {radius}}}
  grip:
    type: velocity_equation
    i: ball
    zero: ["vx(ball) - {radius}*wy(ball) + wz(table)*dy(ball)", "vy(ball) + {radius}*wx(ball) - wz(table)*dx(ball)"]
"""),
        duration=8.0,
        points=201,
        rtol=1e-9,
    )
    turning = 2 / 7 * rate * 1j
    path = 0.5 + (0.1 + 0.2j) * (np.exp(turning * solution.time) - 1) / turning
    pull = 2 * turning * (0.1 + 0.2j) * np.exp(turning * solution.time)
    np.testing.assert_allclose(solution["ball.x"] + 1j * solution["ball.y"], path, atol=1e-7)
    np.testing.assert_allclose(solution["grip.fx"] + 1j * solution["grip.fy"], pull, atol=1e-6)
    np.testing.assert_allclose(solution["touch.fz"], 2 * G, atol=1e-9)
    np.testing.assert_allclose(solution["grip.tx"], radius * solution["grip.fy"], atol=1e-9)  # at the ball's foot
    np.testing.assert_allclose(solution["motor.tz"], np.imag(np.conj(path) * pull), atol=1e-6)  # the table feels it too


@pytest.mark.long
@pytest.mark.parametrize("solver", ["kinematic", "bdf"])
def test_a_stewart_platform_heaves_and_twists_as_its_legs_say(solver):
    height, feet, heads = 0.9, (10, 110, 130, 230, 250, 350), (50, 70, 170, 190, 290, 310)
    feet = [turned((0, 0, 1), math.radians(a)) @ [1.0, 0, 0] for a in feet]
    heads = [turned((0, 0, 1), math.radians(a)) @ [0.6, 0, 0] for a in heads]

    def segment(k):
        """Length by the law of cosines for a lift of 0.1 sin 3t and a twist of 0.3 sin 2t."""
        along, across = heads[k] @ feet[k], heads[k][0] * feet[k][1] - heads[k][1] * feet[k][0]
        twist = "0.3*sin(2*t)"
        return f"sqrt(1.36 - 2*({along}*cos({twist}) + {across}*sin({twist})) + ({height} + 0.1*sin(3*t))^2)"

    scene = {
        "dimensions": 3,
        "gravity": [0, 0, -G],
        "markers": {f"b{k}": {"point": feet[k].tolist()} for k in range(6)},
        "bodies": {
            "top": {
                "mass": 3,
                "inertia": [0.2, 0.3, 0.4],
                "position": [0, 0, height],
                "markers": {f"p{k}": {"point": heads[k].tolist()} for k in range(6)},
            }
        },
        "joints": {
            f"leg{k}": {
                "type": "drive",
                "i": f"top.p{k}",
                "j": f"ground.b{k}",
                "coordinate": f"dm(top.p{k}, ground.b{k})",
                "position": segment(k),
            }
            for k in range(6)
        },
    }
    solution = stiffmbs.run(read_scene(json.dumps(scene)), duration=2.0, points=51, solver=solver, rtol=1e-9)
    t = solution.time
    lift, gain, twist, spin = 0.1 * np.sin(3 * t), -0.9 * np.sin(3 * t), 0.3 * np.sin(2 * t), -1.2 * np.sin(2 * t)
    np.testing.assert_allclose(solution["top.z"], height + lift, atol=1e-9)
    np.testing.assert_allclose(solution["top.az"], gain, atol=1e-8)
    np.testing.assert_allclose(solution["top.wz"], 0.6 * np.cos(2 * t), atol=1e-9)
    np.testing.assert_allclose(solution["top.wdz"], spin, atol=1e-8)
    pushes = [forces(solution, f"leg{k}").T for k in range(6)]
    np.testing.assert_allclose(sum(pushes), np.outer(G + gain, [0, 0, 3]), atol=1e-7)
    arms = [np.array([turned((0, 0, 1), a) @ head for a in twist]) for head in heads]
    moments = sum(np.cross(arm, push) for arm, push in zip(arms, pushes, strict=True))
    np.testing.assert_allclose(moments, np.outer(spin, [0, 0, 0.4]), atol=1e-7)
    for arm, push, foot in zip(arms, pushes, feet, strict=True):  # each force is along its leg
        np.testing.assert_allclose(np.cross(arm + np.outer(height + lift, [0, 0, 1]) - foot, push), 0, atol=1e-7)


@pytest.mark.long
def test_a_differential_of_bevel_gears_shares_a_torque():
    """Both shafts turn by the carrier's rate on the average; two equations of motion in their rates."""
    solution = stiffmbs.run(
        read_scene("""
dimensions: 3
bodies:
  carrier: {mass: 2, inertia: [0.3, 0.3, 0.4]}
  left: {mass: 1, inertia: [0.05, 0.05, 0.08], position: [0, 0, -0.2]}
  right: {mass: 1, inertia: [0.05, 0.05, 0.08], position: [0, 0, 0.2]}
  planet: {mass: 0.5, inertia: [0.02, 0.02, 0.03], position: [0.2, 0, 0], orientation: {z: [1, 0, 0]}}
joints:
  c: {type: revolute, i: carrier, j: ground}
  l: {type: revolute, i: left, j: {body: carrier, point: [0, 0, -0.2]}}
  r: {type: revolute, i: right, j: {body: carrier, point: [0, 0, 0.2]}}
  p: {type: revolute, i: planet, j: {body: carrier, point: [0.2, 0, 0], orientation: {z: [1, 0, 0]}}}
  mesh_left: {type: gear, joint_1: l, joint_2: p, ratio: 0.5}
  mesh_right: {type: gear, joint_1: r, joint_2: p, ratio: -0.5}
forces:
  engine: {type: torque, i: carrier, torque: [0, 0, 3]}
  brake: {type: torque, i: left, torque: [0, 0, "-0.4*wz(left)"]}
"""),
        duration=2.0,
        points=51,
        rtol=1e-9,
    )
    left, right, carrier = (solution[f"{name}.wz"] for name in ("left", "right", "carrier"))
    np.testing.assert_allclose(left + right, 2 * carrier, atol=1e-12)
    np.testing.assert_allclose(solution["planet.wz"], right - left, atol=1e-9)
    turning = 0.4 + 0.02 + 0.5 * 0.2**2
    mass = 0.08 * np.eye(2) + turning / 4 * np.ones((2, 2)) + 0.03 * np.array([[1, -1], [-1, 1]])
    rates = solve_ivp(
        lambda t, w: np.linalg.solve(mass, [1.5 - 0.4 * w[0], 1.5]), (0, 2), [0, 0], "DOP853",
        t_eval=solution.time, rtol=1e-11, atol=1e-12,
    ).y  # fmt: skip
    np.testing.assert_allclose([left, right], rates, atol=1e-7)


BENNETT = (1.0, math.radians(60)), (0.7, math.asin(0.7 * math.sin(math.radians(60))))  # lengths and twists of the bars


def step(angle, length, twist):
    """From one hinge to the next: about z, along the new x and about it (Denavit and Hartenberg)."""
    frame = np.eye(4)
    turn = turned((0, 0, 1), angle)
    frame[:3, :3], frame[:3, 3] = turn @ turned((1, 0, 0), twist), turn @ [length, 0, 0]
    return frame


def bennett(angle):
    """Frames of the four hinges: opposite angles are equal and opposite, neighbours' half tangents have a fixed product."""
    (_, one), (_, other) = BENNETT
    following = 2 * math.atan(math.sin((other + one) / 2) / math.sin((other - one) / 2) / math.tan(angle / 2))
    frames = [np.eye(4)]
    for turn, bar in zip((angle, following, -angle), (BENNETT * 2)[:3], strict=True):
        frames.append(frames[-1] @ step(turn, *bar))
    np.testing.assert_allclose(frames[-1] @ step(-following, *BENNETT[1]), np.eye(4), atol=1e-12)
    return frames


def bennett_scene(angle, motor):
    frames, bodies, joints = bennett(angle), {}, {}

    def marker(body, frame, origin):
        axes = {"x": frame[:3, 0].tolist(), "z": frame[:3, 2].tolist()}
        return {"body": body, "point": (frame[:3, 3] - origin).tolist(), "orientation": axes}

    def on(bar, frame):
        middle = (frames[bar][:3, 3] + frames[bar + 1][:3, 3]) / 2 if bar < 3 else np.zeros(3)
        return marker(f"bar{bar}" if bar < 3 else "ground", frame, middle)

    for bar in range(3):
        middle = (frames[bar][:3, 3] + frames[bar + 1][:3, 3]) / 2
        bodies[f"bar{bar}"] = {"mass": 1 + bar, "inertia": [0.1, 0.12, 0.15], "position": middle.tolist()}
    for hinge, pair in enumerate(((0, 3), (1, 0), (2, 1), (2, 3))):
        i, j = (on(bar, frames[hinge]) for bar in pair)
        joints[f"hinge{hinge}"] = {"type": "revolute", "i": i, "j": j}
    if motor:
        joints["motor"] = {"type": "drive", "joint": "hinge0", "position": motor}
    return {"dimensions": 3, "gravity": [0, 0, -G], "bodies": bodies, "joints": joints}


@pytest.mark.parametrize("solver", ["kinematic", "bdf"])
def test_bennetts_linkage_moves_though_it_counts_as_rigid(solver):
    """Four hinges and three bars: two freedoms too few by the count, one in truth."""
    scene = read_scene(json.dumps(bennett_scene(1.0, "1.5*t")))
    solution = stiffmbs.run(scene, duration=1.0, points=26, solver=solver, rtol=1e-9)
    for k, t in enumerate(solution.time):
        frames = bennett(1.0 + 1.5 * t)
        for bar in range(3):
            middle = (frames[bar][:3, 3] + frames[bar + 1][:3, 3]) / 2
            np.testing.assert_allclose([solution[f"bar{bar}.{c}"][k] for c in "xyz"], middle, atol=1e-8)


def test_bennetts_linkage_keeps_its_energy():
    solution = stiffmbs.run(read_scene(json.dumps(bennett_scene(1.0, None))), duration=2.0, points=51, rtol=1e-9)
    assert np.ptp(solution["energy.total"]) < 1e-5 and np.ptp(solution["energy.kinetic"]) > 1
    assert solution["constraint.position"].max() < 1e-9


@pytest.mark.long
def test_andrews_mechanism_with_bodies_of_space(examples):
    """IFToMM A03: as in the plane, with nine equations too many, and forces across the hinges that stay the same."""
    plane = YAML(typ="safe").load(examples / "andrews.yaml")

    def raised(item):
        """The same with a third coordinate."""
        if not isinstance(item, dict):
            return item
        return {key: [*value, 0] if key in ("point", "position") else raised(value) for key, value in item.items()}

    scene = {key: raised(plane[key]) for key in ("parameters", "bodies", "joints", "forces", "run")} | {"dimensions": 3}
    for body in scene["bodies"].values():
        body["inertia"] = [body["inertia"]] * 3
        body["orientation"] = {"euler": "zyx", "angles": [body.pop("angle"), 0, 0]}
    scene["forces"]["motor"]["torque"] = [0, 0, scene["forces"]["motor"]["torque"]]
    flat = stiffmbs.run(stiffmbs.load_scene(examples / "andrews.yaml"), rtol=1e-8)
    solution = stiffmbs.run(read_scene(json.dumps(scene)), rtol=1e-8)
    pairs = [("K1.omega", "K1.wz"), *((f"K{k}.{c}", f"K{k}.{c}") for k in range(1, 8) for c in ("x", "vy"))]
    pairs += [(f"{joint}.{c}", f"{joint}.{c}") for joint in plane["joints"] for c in ("fx", "fy")]
    for in_plane, in_space in pairs:
        peak = np.abs(flat[in_plane]).max()
        np.testing.assert_allclose(solution[in_space], flat[in_plane], atol=3e-5 * peak, err_msg=in_plane)
