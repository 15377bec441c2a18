"""A part and its mirror image move as mirror images: each element, in the plane and in space, about each axis."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.solve.trajectory import Outcome

PLANE = """
gravity: [{gravity}]
parts:
  unit:
    markers: {{stop: {{point: [0.3, -0.2], angle: 25 deg}}}}
    bodies:
      one:
        mass: 1
        inertia: 0.1
        position: [0.5, 0.2]
        angle: 20 deg
        velocity: [0.1, 0.2]
        omega: 0.4
        markers: {{a: {{point: [-0.2, 0.05], angle: 10 deg}}, b: {{point: [0.2, 0.03], angle: -15 deg}}}}
      two: {{mass: 0.7, inertia: 0.05, position: [0.9, 0.6], angle: -10 deg}}
    joints: {{{joints}}}
    forces:
      holds: {{type: bushing, i: two, j: mount.stop, stiffness: [200, 300, 4], damping: [1, 1, 0.1]}}
      tension: {{type: spring_damper, i: one.b, j: two, stiffness: 40, damping: 0.3, free_length: 0.2}}
      {forces}
use:
  first: {{part: unit, position: [0.4, 0.3]}}
  other: {{part: unit, position: {position}, mirror: {mirror}}}
run: {{duration: 0.5 s, points: 6, rtol: 1e-11}}
"""
HINGE = "pin: {type: revolute, i: one.a, j: {body: mount, point: [0.3, 0.1], angle: 5 deg}}"
GUIDE = "pin: {type: prismatic, i: one.a, j: {body: mount, point: [0.3, 0.1], angle: 35 deg}}"
WHEEL = "wheel: {type: revolute, i: two, j: {body: mount, point: [0.9, 0.6]}}"
JOINTS_IN_PLANE = {
    "revolute": HINGE,
    "prismatic": GUIDE,
    "point_on_line": HINGE.replace("revolute", "point_on_line"),
    "distance": "rod: {type: distance, i: one.a, j: mount, length: 0.4}",
    "fixed": HINGE.replace("revolute", "fixed"),
    "drive": f'{HINGE}, d: {{type: drive, joint: pin, position: "0.3*t + sin(t)^2"}}',
    "drive by a table": f"{GUIDE}, d: {{type: drive, joint: pin, velocity: {{table: [[0, 0], [1, 2]]}}}}",
    "drive of a coordinate": f'{HINGE}, d: {{type: drive, coordinate: "dx(two, mount, mount)", position: 0.9 + 0.1*t}}',
    "gear": f"{HINGE}, {WHEEL}, teeth: {{type: gear, joint_1: pin, joint_2: wheel, ratio: 0.6}}",
    "gear with an offset": f"{HINGE}, {WHEEL}, teeth: {{type: gear, joint_1: pin, joint_2: wheel, ratio: 0.6, offset: 0.05}}",
    "coupler": f"{GUIDE}, {WHEEL}, c: {{type: coupler, joint_1: pin, joint_2: wheel, scale: 0.3, offset: 0.1}}",
    "rack": f"{GUIDE}, {WHEEL}, c: {{type: rack_and_pinion, rack: pin, pinion: wheel, pitch_radius: 0.3}}",
    "equation": 'e: {type: equation, zero: ["dx(one.a, mount, mount) - 0.4*sin(dy(one.b, two)) - az(one, mount) + dm(one, two)"]}',
    "velocity_equation": 'e: {type: velocity_equation, zero: ["one.vx - 0.3*one.omega + wz(one, two) - 2*vy(one.b)"]}',
}  # fmt: skip
FORCES_IN_PLANE = {
    "torsion_spring": "f: {type: torsion_spring, i: one, j: two, stiffness: 3, damping: 0.1, free_angle: 20 deg, preload: 1}",
    "torsion laws": 'f: {type: torsion_spring, i: one, j: two, spring_law: "9*s + 0.4*s^2", damper_law: {table: [[-5, -1], [0, 0], [2, 1]]}}',
    "bushing": (
        "f: {type: bushing, i: one.b, j: two, stiffness: [[50, 20, 3], [20, 60, 5], [3, 5, 8]], preload: [1, 2, 3], "
        'law_x: 30*s^2, law_y: 30*s^2, law_angle: {table: [[-1, -1], [0, 0], [1, 3]]}}'
    ),
    "bushing of the ground's axes": "f: {type: bushing, i: one.b, j: two, stiffness: [50, 20, 3], law_y: 9*s^2, axes: ground}",
    "line_force": 'f: {type: line_force, i: one, j: two, force: "sin(t) - vr(one, two) + vy(one)^2"}',
    "force": 'f: {type: force, i: one.b, j: two, force: ["2 - one.vx", "3 + t"]}',
    "force of body axes": 'f: {type: force, i: one.b, force: ["2 - vy(one.b, mount, two)", 3], axes: body}',
    "torque": 'f: {type: torque, i: one, j: two, torque: "1 + 0.2*one.omega - az(one, two)"}',
    "joint_friction": "f: {type: joint_friction, joint: pin, friction: 0.3, radius: 0.1}",
    "contact": "f: {type: contact, i: one.b, j: two, radius: 0.3, surface: line, stiffness: 1e3, friction: 0.2}",
    "contact on the mount": "f: {type: contact, i: one.b, j: mount.stop, radius: 0.5, stiffness: 1e3, friction: 0.2}",
}  # fmt: skip


def _planar(mirror, joints=HINGE, forces=""):
    gravity, position = ("0, -9.81", "[-0.4, 0.3]") if mirror == "x" else ("-9.81, 0", "[0.4, -0.3]")
    return PLANE.format(gravity=gravity, position=position, mirror=mirror, joints=joints, forces=forces)


def _differences(text, signs, rotations):
    """Explicit steps, as it is motions that are compared: without the derivatives of all equations they compile sooner."""
    solution = stiffmbs.run(stiffmbs.read_scene(text), solver="projected", scheme="dop853")
    assert solution.outcome is Outcome.DONE
    moved = 0.0
    for body in ("one", "two"):
        for channels, changed in ((("x", "y", "z"), signs), (("vx", "vy", "vz"), signs), (rotations[0], rotations[1])):
            for channel, sign in zip(channels, changed, strict=False):
                first, other = (solution[f"{instance}.{body}.{channel}"] for instance in ("first", "other"))
                assert other == pytest.approx(sign * first, abs=1e-8 * max(1, np.abs(first).max())), (body, channel)
                moved = max(moved, np.ptp(first))
    assert moved > 1e-3


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mirror", ["x", "y"])
@pytest.mark.parametrize("joints", JOINTS_IN_PLANE.values(), ids=JOINTS_IN_PLANE)
def test_joints_in_the_plane(joints, mirror):
    _differences(_planar(mirror, joints), _signs(mirror)[:2], (("angle", "omega"), (-1, -1)))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mirror", ["x", "y"])
@pytest.mark.parametrize("force", FORCES_IN_PLANE.values(), ids=FORCES_IN_PLANE)
def test_forces_in_the_plane(force, mirror):
    _differences(_planar(mirror, forces=force), _signs(mirror)[:2], (("angle", "omega"), (-1, -1)))


SPACE = """
dimensions: 3
parts:
  unit:
    markers: {{stop: {{point: [0.3, -0.2, 0.1], orientation: {{euler: zxz, angles: [0.3, 0.2, 0.1]}}}}}}
    bodies:
      one:
        mass: 1
        inertia: [[0.1, 0.01, 0.02], [0.01, 0.12, -0.01], [0.02, -0.01, 0.09]]
        center_of_mass: [0.02, 0.03, 0.05]
        position: [0.5, 0.2, 0.4]
        orientation: {{euler: zyx, angles: [0.3, -0.2, 0.1]}}
        velocity: [0.1, 0.2, -0.3]
        omega: [0.4, -0.2, 0.5]
        markers:
          a: {{point: [-0.2, 0.05, 0.1], orientation: {{z: [1, 0.3, 0.2]}}}}
          b: {{point: [0.2, 0.03, -0.1], orientation: {{z: [0.2, 1, -0.3]}}}}
      two: {{mass: 0.7, inertia: [0.05, 0.04, 0.06], position: [0.9, 0.6, 0.1], orientation: {{x: [1, 0.2, 0.1]}}}}
    joints: {{{joints}}}
    forces:
      holds: {{type: bushing, i: two, j: mount.stop, stiffness: [90, 80, 70, 4, 5, 6], damping: [1, 1, 1, 0.1, 0.2, 0.1]}}
      tension: {{type: spring_damper, i: one.b, j: two, stiffness: 40, damping: 0.3, free_length: 0.2}}
      {forces}
use:
  first: {{part: unit, position: [0.4, 0.3, 0.2], orientation: {turned}}}
  other: {{part: unit, position: {position}, orientation: {opposite}, mirror: {mirror}}}
run: {{duration: 0.3 s, points: 4, rtol: 1e-11}}
"""
JOINTS_IN_SPACE = {
    "revolute": "pin: {type: revolute, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "prismatic": "pin: {type: prismatic, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "cylindrical": "pin: {type: cylindrical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "spherical": "pin: {type: spherical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "universal": "pin: {type: universal, i: one.a, j: two}",
    "screw": "pin: {type: screw, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}, pitch: 0.2}",
    "planar": "pin: {type: planar, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "point_on_plane": "pin: {type: point_on_plane, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "perpendicular": "pin: {type: perpendicular, i: one.a, j: two}",
    "constant_velocity": "pin: {type: constant_velocity, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}",
    "drive": 'pin: {type: cylindrical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}, d: {type: drive, joint: pin.angle, velocity: "0.5 + t"}',
    "drive along": 'pin: {type: cylindrical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}, d: {type: drive, joint: pin.displacement, velocity: "0.5*t"}',
    "thread": "pin: {type: cylindrical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}, t: {type: thread, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}, pitch: 0.3, offset: 0.4}",
    "coupler": "pin: {type: cylindrical, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}}, c: {type: coupler, joint_1: pin.angle, joint_2: pin.displacement, scale: 2, offset: 0.3}",
    "equation": 'e: {type: equation, zero: ["0.3*dx(one.b, two, mount) - 2*dm(one, two)"]}',
    "equation of an angle": 'e: {type: equation, zero: ["ax(one.a, two) - 0.3*dx(one.b, two, mount) + 2*dm(one, two)"]}',
    "velocity_equation": 'e: {type: velocity_equation, zero: ["one.wx - 0.3*wy(one, two, mount) - vz(one.b, mount, two)"]}',
}  # fmt: skip
FORCES_IN_SPACE = {
    "bushing": (
        "f: {type: bushing, i: one.b, j: two, stiffness: [[[50, 20, 3], [20, 60, 5], [3, 5, 80]], [[9, 1, 2], [1, 8, 3], [2, 3, 7]]], "
        "preload: [1, 2, 3, 0.4, 0.5, 0.6], law_x: 3*s^2, law_y: 3*s^2, law_z: 3*s^2, law_about_x: s^2, law_about_y: s^2, law_about_z: s^2}"
    ),
    "field": "f: {type: field, i: one.b, j: two, stiffness: [50, 20, 30, 4, 5, 6], free: [0.1, 0.2, 0.1, 0.2, 0.1, 0.05]}",
    "force": 'f: {type: force, i: one.b, force: ["2 - one.wx", "vz(one.b, mount, mount)", "wx(one, mount, two)"], axes: body}',
    "torque": 'f: {type: torque, i: one, j: two, torque: [0.3, "0.2*wy(one, mount, two)", "0.1*dz(one, two, two)"], frame: two}',
    "vertical_tyre": "f: {type: vertical_tyre, i: one.b, j: mount, radius: 0.9, stiffness: 300, damping: 2}",
    "sphere_contact": "f: {type: sphere_contact, i: one.b, j: two, radius: 0.6, surface: plane, stiffness: 1e3}",
    "torsion_spring": "f: {type: torsion_spring, i: one.a, j: {body: two, orientation: {z: [1, 0.3, 0.2]}}, stiffness: 3, free_angle: 1, preload: 0.5, damper_law: v^2}",
    "line_force": 'f: {type: line_force, i: one, j: two, force: "sin(t) + 3*wm(one, two) - vr(one, two)"}',
}  # fmt: skip


def _signs(mirror):
    return [-1 if axis == mirror else 1 for axis in "xyz"]


def _spatial(mirror, joints="", forces=""):
    position = [sign * x for sign, x in zip(_signs(mirror), (0.4, 0.3, 0.2), strict=True)]
    turned = "xyz".replace(mirror, "")[0]
    angles = [0.4, 0, 0]
    opposite = [-0.4, 0, 0]  # a rotation about an axis in the mirror's plane changes its sign
    euler = turned + "xyz".replace(turned, "")[0] + turned
    return SPACE.format(
        position=position, mirror=mirror, joints=joints, forces=forces,
        turned=f"{{euler: {euler}, angles: {angles}}}", opposite=f"{{euler: {euler}, angles: {opposite}}}",
    )  # fmt: skip


LONG = ("equation of an angle",)
"""What takes seconds to compile."""


def _about_each_axis(texts):
    """Each element about each axis; about one, in turn, in the default run."""
    return [
        pytest.param(
            text,
            mirror,
            marks=() if "xyz"[k % 3] == mirror and name not in LONG else pytest.mark.long,
            id=f"{name}-{mirror}",
        )
        for k, (name, text) in enumerate(texts.items())
        for mirror in "xyz"
    ]


def _rotations(mirror):
    return ("wx", "wy", "wz"), [-sign for sign in _signs(mirror)]


@pytest.mark.sampled(21)
@pytest.mark.long
@pytest.mark.parametrize(("joints", "mirror"), _about_each_axis(JOINTS_IN_SPACE))
def test_joints_in_space(joints, mirror):
    _differences(_spatial(mirror, joints), _signs(mirror), _rotations(mirror))


@pytest.mark.sampled(21)
@pytest.mark.long
@pytest.mark.parametrize(("force", "mirror"), _about_each_axis(FORCES_IN_SPACE))
def test_forces_in_space(force, mirror):
    _differences(_spatial(mirror, forces=force), _signs(mirror), _rotations(mirror))
