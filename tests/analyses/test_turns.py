"""Full turns of angles at the start, in welds, bushings and beams, with drives, in stages and after restarts."""

import json
import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.spatial.orientation import matrix, product, unit_quaternion

TURN = 2 * math.pi


def read(text, **parts):
    for name, value in parts.items():
        text = text.replace(name.upper(), str(value))
    return stiffmbs.read_scene(text)


WELDED = """
gravity: [0, -9.81]
bodies:
  a: {mass: 1, inertia: 0.1, angle: PHI}
  b: {mass: 1, inertia: 0.1, angle: PHI + 2*pi*TURNS, position: [cos(PHI), sin(PHI)]}
joints:
  pin: {type: revolute, i: a, j: ground}
  weld: {type: fixed, i: {body: b, point: [-1, 0]}, j: a}
forces: {spring: {type: torsion_spring, i: {body: b, angle: 0.3}, j: ground, stiffness: 2, free_angle: 2*pi*TURNS}}
run: {duration: 1, points: 11, rtol: 1e-8}
"""


@pytest.mark.parametrize(
    "turns", [pytest.param(1, marks=pytest.mark.long), pytest.param(-1, marks=pytest.mark.long), 3]
)
@pytest.mark.parametrize("phi", [-1.5707963267948966, 3.0])
def test_welded_bodies_move_as_without_turns_between_them(phi, turns):
    wanted = stiffmbs.run(read(WELDED, phi=phi, turns=0))
    found = stiffmbs.run(read(WELDED, phi=phi, turns=turns))
    assert any("merged" in line for line in found.presolve)
    for channel in ("b.x", "b.y", "weld.torque", "spring.torque", "energy.total"):
        np.testing.assert_allclose(found[channel], wanted[channel], atol=1e-6)
    np.testing.assert_allclose(found["b.angle"] - wanted["b.angle"], TURN * turns, atol=1e-6)


BEAM = """
gravity: [0, -9.81]
bodies:
  w:
    {type: beam, START: [1, 0.2], END: [0, 0], elements: 4, section: {type: rectangle, width: 20 mm, height: 10 mm},
     material: {E: 2e9, nu: 0.3, density: 2000}, damping: 2 ms}
  ball: {mass: 0.3, inertia: 0.001, position: [1, 0.2]}
joints:
  pin: {type: fixed, i: w.END, j: {body: ground, angle: ANGLE}}
  k: {type: fixed, i: {body: ball, angle: ANGLE}, j: w.START}
run: {duration: 0.1, points: 11, rtol: 1e-7, solver: radau}
"""


@pytest.mark.long
def test_a_beam_moves_the_same_drawn_from_right_to_left():
    angle = math.atan2(0.2, 1)
    one = stiffmbs.run(read(BEAM, start="end", end="start", angle=angle))
    other = stiffmbs.run(read(BEAM, start="start", end="end", angle=angle + math.pi))
    np.testing.assert_allclose(one["ball.y"], other["ball.y"], atol=1e-6)
    np.testing.assert_allclose(one["pin.torque"], other["pin.torque"], atol=1e-3)


SQUARE = """
bodies:
  frame:
    {type: beam, points: [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], elements: 2, section: {type: rectangle, width: 30 mm, height: 3 mm},
     material: {E: 2e9, nu: 0.3, density: 1200}}
joints: {closed: {type: fixed, i: frame.end, j: {body: frame.start, angle: -90 deg}}}
run: {duration: 0.01, solver: radau}
"""


def test_a_closed_frame_of_beams_starts_without_load():
    assert abs(stiffmbs.run(stiffmbs.read_scene(SQUARE))["energy.total"]).max() < 1e-12


@pytest.mark.long
@pytest.mark.parametrize("turns", [1, -2])
def test_a_bushing_between_described_angles_a_turn_apart_is_not_wound(turns):
    text = """
bodies: {b: {mass: 1, inertia: 0.1, angle: 0.2 + 2*pi*TURNS}}
forces: {m: {type: bushing, i: b, j: ground, stiffness: [1000, 1000, 50]}}
run: {duration: 0.01}
"""
    for found in (read(text, turns=turns), spatial.in_space(read(text, turns=turns))):
        solution = stiffmbs.run(found)
        assert solution["m.torque" if "m.torque" in solution else "m.tz"][0] == pytest.approx(-10)


HALF_A_TURN = """
bodies: {a: {mass: 1, inertia: 0.1, angle: FIRST}, b: {mass: 1, inertia: 0.2, angle: SECOND}}
forces: {m: {type: bushing, i: a, j: b, stiffness: [1000, 1000, 50]}}
run: {duration: 0.001, points: 2}
"""


@pytest.mark.parametrize(
    ("first", "second"), [(0, 180), (180, 0), (10, -170), *(pytest.param(0, b, marks=pytest.mark.long) for b in (-180, 540))]
)  # fmt: skip
def test_a_bushing_at_half_a_turn_has_the_same_torque_in_plane_and_space(first, second):
    plane = read(HALF_A_TURN, first=f"{first} deg", second=f"{second} deg")
    assert stiffmbs.run(plane)["m.torque"][0] == pytest.approx(-50 * math.pi)
    assert stiffmbs.run(spatial.in_space(plane))["m.tz"][0] == pytest.approx(-50 * math.pi)


@pytest.mark.parametrize("turned", ["i", "j"])
@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0.8, -0.6), (-0.6, 0.8, 0), (-1, 0, 0)])
def test_half_a_turn_in_space_is_positive_about_z_or_else_about_y_or_x(axis, turned):
    """In an oblique pose, in which the cosine of half the angle is not 0, but rounding."""
    poses = dict.fromkeys("ij", unit_quaternion((0.5, -0.5, 0.1, 0.7)))
    poses[turned] = product(poses[turned], (0, *axis))
    bodies = {k: {"mass": 1, "inertia": [0.1, 0.1, 0.1], "orientation": list(pose)} for k, pose in poses.items()}
    connection = {"type": "bushing", "i": "i", "j": "j", "stiffness": [1, 1, 1, 50, 50, 50]}
    scene = stiffmbs.read_scene(json.dumps({"dimensions": 3, "bodies": bodies, "forces": {"m": connection}}))
    solution = stiffmbs.run(scene, duration=0.001, points=2)
    sense = math.copysign(1, next(part for part in reversed(axis) if part))
    found = [solution[f"m.t{k}"][0] for k in "xyz"]
    in_axes_of_j = matrix(poses["j"]).T @ found
    assert not solution.notes
    np.testing.assert_allclose(in_axes_of_j, -50 * math.pi * sense * np.array(axis), atol=1e-9)


TURNING = """
bodies:
  a: {mass: 1, inertia: 0.1, omega: 20}
  b: {mass: 1, inertia: 0.2, position: [1, 0]}
joints:
  p: {type: revolute, i: a, j: ground}
  q: {type: revolute, i: b, j: {body: ground, point: [1, 0]}}
"""
STAGE = f"""{TURNING}run: {{points: 6, rtol: 1e-8}}
stages:
  - {{run: {{duration: 1}}}}
  - {{change: {{ADDED}}, run: {{duration: 0.2}}}}
  - {{run: {{duration: 0.2}}}}
"""
BEYOND = 20 - 3 * TURN  # angle of a within half a turn, after 1 s
ADDED = {
    "bushing": "forces: {y: {type: bushing, i: a, j: ground, stiffness: [10, 10, 10], damping: [1, 1, 0.5]}}",
    "spring": "forces: {y: {type: torsion_spring, i: a, j: b, stiffness: 10, damping: 0.5}}",
    "gear": "joints: {y: {type: gear, joint_1: p, joint_2: q, ratio: 1}}",
    "coupler": "joints: {y: {type: coupler, joint_1: p, joint_2: q, scale: -1}}",
}


def starts(scene):
    """Return a planar and a spatial solution, and the row at which the second stage starts."""
    for found in (stiffmbs.run(scene), stiffmbs.run(spatial.in_space(scene))):
        assert not [note for note in found.notes if ".angle by" in note]
        yield found, int(np.flatnonzero(found.time == 1.0)[-1])


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", ADDED)
def test_what_a_stage_adds_is_set_up_in_its_pose_in_plane_and_space(kind):
    (plane, row), (space, _) = starts(read(STAGE, added=ADDED[kind]))
    assert plane["p.angle"][row] == pytest.approx(20, abs=1e-6)
    if kind in ("gear", "coupler"):
        assert plane["a.omega"][row] == pytest.approx(20 / 3, abs=1e-6)
        assert plane["q.angle"][row] == pytest.approx(0, abs=1e-6)
    else:
        assert plane["y.torque"][row] == pytest.approx(-10 * BEYOND - 0.5 * 20, abs=1e-5)
    for channel in ("p.angle", "q.angle"):
        np.testing.assert_allclose(space[channel], plane[channel], atol=1e-5)
    np.testing.assert_allclose(space["y.tz"], plane["y.torque"], atol=1e-4)


WOUND = STAGE.replace(
    "joints:\n", "forces: {s: {type: torsion_spring, i: a, j: ground, stiffness: 0.05}}\njoints:\n", 1
)


@pytest.mark.long
def test_a_drive_that_a_stage_adds_selects_the_turn_of_its_joint_and_unwinds_no_spring():
    scene = read(WOUND, added='joints: {y: {type: drive, joint: p, position: "0.2 + 3*(t-1)"}}')
    plane, space = stiffmbs.run(scene), stiffmbs.run(spatial.in_space(scene))
    row = int(np.flatnonzero(plane.time == 1.0)[-1])
    assert plane["p.angle"][row] == pytest.approx(0.2) and plane["a.angle"][row] == pytest.approx(3 * TURN + 0.2)
    np.testing.assert_allclose(space["p.angle"], plane["p.angle"], atol=1e-5)
    np.testing.assert_allclose(space["s.tz"], plane["s.torque"], atol=1e-5)


@pytest.mark.parametrize(
    ("omega", "position", "wanted", "moved"),
    [(0, "300 deg", 5 * TURN / 6, -TURN / 6), (20, "20.1 - 2*pi", 20.1 - TURN, 0.1)],
)
def test_a_drive_that_a_stage_adds_in_space_may_prescribe_another_turn(omega, position, wanted, moved):
    text = """
dimensions: 3
bodies: {a: {mass: 1, inertia: [0.1, 0.1, 0.1], omega: [0, 0, OMEGA]}}
joints: {p: {type: revolute, i: a, j: ground}}
requests: {turned: az(a)}
run: {duration: 1, points: 3}
stages:
  - {}
  - {change: {joints: {y: {type: drive, joint: p, position: "LAW"}}}}
"""
    found = stiffmbs.run(read(text, omega=omega, law=position))
    np.testing.assert_allclose(found["p.angle"][-3:], wanted, atol=1e-6)
    np.testing.assert_allclose(found["turned"][-3:], omega + moved, atol=1e-5)


READ_ANGLE = f"""{TURNING}forces: {{f: {{type: torque, i: b, torque: "-p.angle"}}}}
states: {{lag: {{rate: (p.angle - lag)/0.1, start: 0}}}}
requests: {{twice: 2*p.angle}}
run: {{duration: 0.2, points: 5, rtol: 1e-8}}
stages:
  - {{run: {{duration: 1}}}}
  - {{change: {{joints: {{y: {{type: drive, joint: p, position: 100 deg}}}}}}}}
  - {{change: {{forces: {{n: {{type: torque, i: b, torque: "0.1*p.angle"}}}}}}}}
  - {{change: {{joints: {{y: null}}}}}}
  - {{change: {{joints: {{y: {{type: drive, joint: p, position: -500 deg}}}}}}}}
"""


@pytest.mark.long
def test_what_read_an_angle_before_a_drive_keeps_its_turns_in_plane_and_space(tmp_path):
    scene = stiffmbs.read_scene(READ_ANGLE)
    drawn = math.radians(100)
    for whole in (scene, spatial.in_space(scene)):
        found = stiffmbs.run(whole)
        torque, other = ("f.tz", "n.tz") if "f.tz" in found else ("f.torque", "n.torque")
        after = found["p.angle"][5:]
        np.testing.assert_allclose(after, np.repeat([drawn, drawn, drawn, math.radians(-500)], 5), atol=1e-6)
        np.testing.assert_allclose(found["twice"][5:], 2 * after, atol=1e-5)
        np.testing.assert_allclose(found[torque][5:20], -3 * TURN - drawn, atol=1e-5)
        np.testing.assert_allclose(found[torque][20:], -3 * TURN - math.radians(220), atol=1e-5)
        np.testing.assert_allclose(found[other][10:20], 0.1 * drawn, atol=1e-6)
        assert 3 * TURN < found["lag"][19] < 3 * TURN + drawn
        found.save(tmp_path / "all.npz")
        state = stiffmbs.read_state(tmp_path / "all.npz", at=1.3)
        again = stiffmbs.run(whole.stage_scenes[2], start_from=state)
        np.testing.assert_allclose(again[torque], -3 * TURN - drawn, atol=1e-5)
        np.testing.assert_allclose(again["p.angle"], drawn, atol=1e-6)


@pytest.mark.long
def test_joints_and_a_coupler_of_one_stage_have_the_same_turns():
    text = STAGE.replace("  p: {type: revolute, i: a, j: ground}\n", "")
    pin = "r: {type: revolute, i: a, j: {body: ground, angle: 1}}"
    scene = read(text, added=f"joints: {{{pin}, y: {{type: coupler, joint_1: q, joint_2: r, scale: 0.3}}}}")
    (plane, row), (space, _) = starts(scene)
    np.testing.assert_allclose(space["r.angle"][-6:], plane["r.angle"][-6:], atol=1e-5)
    assert plane["r.angle"][row] == pytest.approx(BEYOND - 1, abs=1e-6)


def test_a_lock_closes_in_the_nearest_turn():
    found = stiffmbs.run(read(WOUND, added="joints: {y: {type: fixed, i: a, j: ground}}"))
    assert found["a.angle"][-1] == pytest.approx(3 * TURN, abs=1e-9)
    assert found["s.torque"][-1] == pytest.approx(-0.05 * 3 * TURN, abs=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(
    "kind", ["bushing", *(pytest.param(kind, marks=pytest.mark.long) for kind in ("spring", "coupler"))]
)
def test_a_restart_from_a_file_keeps_the_turns_of_what_a_stage_has_added(kind, tmp_path):
    scene = read(STAGE, added=ADDED[kind])
    for whole in (scene, spatial.in_space(scene)):
        wanted = stiffmbs.run(whole)
        wanted.save(tmp_path / "all.npz")
        rows = np.flatnonzero(np.isclose(wanted.time, 1.2))
        state = stiffmbs.read_state(tmp_path / "all.npz", at=float(wanted.time[rows[-1]]))
        found = stiffmbs.run(whole.stage_scenes[2], start_from=state, duration=0.2, points=6)
        for channel in ("p.angle", "q.angle", "y.torque" if "y.torque" in wanted else "y.tz"):
            np.testing.assert_allclose(found[channel], wanted[channel][-6:], atol=1e-5)


SPINNING = """
dimensions: 3
bodies:
  a: {mass: 1, inertia: [0.1, 0.1, 0.1], omega: [0, 0, 20]}
  b: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0], omega: [0, 0, -9]}
joints: {p: {type: revolute, i: a, j: ground}, q: {type: revolute, i: b, j: {body: ground, point: [1, 0, 0]}}}
REST
"""
WEAK = 'y: {type: torque, i: b, torque: [0, 0, "-1e-9*az(a) + 1e-6*az(b)"]}'


@pytest.mark.parametrize(
    "before",
    ["requests: {w: az(a), v: az(b)}", "forces: {z: {type: torque, i: a, torque: [0, 0, '1e-9*az(a)*az(b)']}}"],
)
@pytest.mark.parametrize(
    "old", ["", "y: {type: torque, i: b, torque: [0, 0, 0]}", "y: {type: torque, i: b, torque: [0, 0, 1e-9*az(b)]}"]
)
def test_a_new_formula_in_space_keeps_the_turns_that_are_counted(before, old, tmp_path):
    """A request read 20 rad, and a force that a stage added, with the same text, 1.15 rad."""
    if old and before.startswith("forces"):
        before = before.replace("forces: {", f"forces: {{{old}, ")
    elif old:
        before += f"\nforces: {{{old}}}"
    rest = f"run: {{duration: 1, points: 3, rtol: 1e-9}}\nstages: [{{}}, {{change: {{forces: {{{WEAK}}}}}}}]"
    scene = read(SPINNING, rest=f"{before}\n{rest}")
    found = stiffmbs.run(scene)
    found.save(tmp_path / "all.npz")
    state = stiffmbs.read_state(tmp_path / "all.npz", at=1.5)
    again = stiffmbs.run(scene.stage_scenes[1], start_from=state)
    for each, t in ((found["y.tz"][-3:], found.time[-3:]), (again["y.tz"], again.time)):
        np.testing.assert_allclose(each, -1e-9 * 20 * t - 1e-6 * 9 * t, rtol=1e-4)


@pytest.mark.parametrize(("force", "torque"), [
    ("{type: torsion_spring, i: a, j: ground, stiffness: 10}", -10 * BEYOND),
    ('{type: torque, i: a, torque: [0, 0, "-3*az(a)"]}', -3 * BEYOND),
])  # fmt: skip
def test_a_restart_from_a_file_accepts_what_is_new_in_space(force, torque, tmp_path):
    """It was refused as another mechanism; files without turns of what acted before are still refused."""
    run = "run: {duration: 1, points: 3, rtol: 1e-9}"
    stiffmbs.run(read(SPINNING, rest=run)).save(tmp_path / "before.npz")
    scene = read(SPINNING, rest=f"forces: {{y: {force}}}\n{run}")
    found = stiffmbs.run(scene, start_from=tmp_path / "before.npz")
    assert found["y.tz"][0] == pytest.approx(torque, abs=1e-5)
    found.save(tmp_path / "after.csv")
    with pytest.raises(stiffmbs.InputError, match="found no count of the turns of 'y'"):
        stiffmbs.run(scene, start_from=tmp_path / "after.csv")


@pytest.mark.long
def test_a_joint_that_a_stage_adds_is_checked_where_it_closes():
    text = """
dimensions: 3
bodies: {a: {mass: 1, inertia: [1, 1, 1], orientation: {euler: zxz, angles: [90 deg, 0, 0]}, omega: [0, 0, RATE]}}
joints: {p: {type: revolute, i: a, j: ground}}
stages:
  - {run: {duration: 1, rtol: 1e-8}}
  - {change: {joints: {x: {type: fixed, i: a, j: ground}}}, run: {duration: 0.1}}
"""
    assert stiffmbs.run(read(text, rate=1.5 * math.pi))["p.angle"][-1] == pytest.approx(TURN)
    with pytest.raises(stiffmbs.InputError, match=r"stage 2 of 2: joints\.x: found the axes .* in the pose at t = 1 s"):
        stiffmbs.run(read(text, rate=math.pi))


DRIVEN = """
bodies:
  a: {mass: 1, inertia: 0.1, angle: A}
  b: {mass: 1, inertia: 0.2, position: [1, 0], angle: -350 deg}
joints:
  p: {type: revolute, i: a, j: ground}
  q: {type: revolute, i: b, j: {body: ground, point: [1, 0]}}
  g: {type: gear, joint_1: p, joint_2: q, ratio: 0.7}
MOTOR
forces: {s: {type: torsion_spring, i: b, j: a, stiffness: 5, damping: 0.1}}
requests: {angles: q.angle + 2*p.angle}
run: {duration: 0.5, points: 11, rtol: 1e-8}
"""
MOTOR = "  m: {type: drive, joint: p, position: 20 deg + 3*t^2}"
HELD = "at_start: {m: {type: drive, joint: p, position: 20 deg}}"


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("motor", [MOTOR, HELD], ids=["drive", "at_start"])
@pytest.mark.parametrize(
    "angle",
    ["20 deg", "-1060 deg", *(pytest.param(angle, marks=pytest.mark.long) for angle in ("380 deg", "30 deg + 2*pi"))],
)
def test_a_drive_selects_the_turn_and_moves_no_geared_wheel(motor, angle):
    near = stiffmbs.run(read(DRIVEN, a="30 deg" if "30 deg" in angle else "20 deg", motor=motor))
    scene = read(DRIVEN, a=angle, motor=motor)
    found, there = stiffmbs.run(scene), stiffmbs.run(spatial.in_space(scene))
    for channel in ("a.angle", "b.angle", "p.angle", "g.torque", "s.torque"):
        np.testing.assert_allclose(found[channel], near[channel], atol=2e-5)
        other = channel.replace("torque", "tz")
        if other in there:
            np.testing.assert_allclose(there[other], near[channel], atol=2e-5)
    np.testing.assert_allclose(there["angles"], found["angles"], atol=2e-5)


def test_a_drive_between_free_bodies_a_turn_away_moves_neither():
    text = """
bodies: {a: {mass: 1, inertia: 0.1, angle: 20 deg}, b: {mass: 1, inertia: 0.2, position: [1, 0]}}
joints:
  p: {type: revolute, i: {body: b, point: [-0.5, 0]}, j: {body: a, point: [0.5*cos(20 deg), -0.5*sin(20 deg)]}}
  m: {type: drive, joint: p, position: 340 deg + 3*t^2}
run: {duration: 0.1}
"""
    found = stiffmbs.run(stiffmbs.read_scene(text))
    assert found["b.angle"][0] == pytest.approx(TURN) and found["a.angle"][0] == pytest.approx(math.radians(20))
    assert any("bodies start with full turns added: b +1" in note for note in found.notes)


def test_in_space_a_gear_has_the_turn_of_the_drive_of_its_joint():
    text = """
dimensions: 3
bodies:
  a: {mass: 1, inertia: [1, 1, 1], orientation: {euler: zxz, angles: [200 deg, 0, 0]}}
  b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}
joints:
  p: {type: revolute, i: a, j: ground}
  q: {type: revolute, i: b, j: {body: ground, point: [1, 0, 0]}}
  g: {type: gear, joint_1: p, joint_2: q, ratio: 0.7}
  m: {type: drive, joint: p, position: 200 deg}
run: {duration: 0.1}
"""
    found = stiffmbs.run(stiffmbs.read_scene(text))
    assert found["q.angle"][0] == pytest.approx(0, abs=1e-9) and found["p.angle"][0] == pytest.approx(math.radians(200))


@pytest.mark.parametrize("angle", [190, -900, *(pytest.param(angle, marks=pytest.mark.long) for angle in (170, 540))])
def test_the_angle_of_a_joint_has_its_turns_in_space(angle):
    text = f"""
bodies: {{a: {{mass: 1, inertia: 0.1, angle: {angle} deg, omega: 3}}}}
joints: {{p: {{type: revolute, i: a, j: ground}}}}
forces: {{f: {{type: torque, i: a, torque: "-0.1*p.angle"}}}}
requests: {{angle: 2*p.angle}}
run: {{duration: 1, points: 11, rtol: 1e-8}}
"""
    plane = stiffmbs.run(stiffmbs.read_scene(text))
    space = stiffmbs.run(spatial.in_space(stiffmbs.read_scene(text)))
    for channel in ("p.angle", "angle", "p.angle_rate"):
        np.testing.assert_allclose(space[channel], plane[channel], atol=1e-6)


def test_conversion_keeps_what_holds_at_the_start():
    text = """
bodies: {a: {mass: 1, inertia: 0.1, angle: 10 deg}}
joints: {p: {type: revolute, i: a, j: ground}}
at_start: {m: {type: drive, joint: p, position: 1.0}, w: {type: drive, joint: p, velocity: 4}}
run: {duration: 0.1, rtol: 1e-8}
"""
    found = stiffmbs.run(spatial.in_space(stiffmbs.read_scene(text)))
    assert found["p.angle"][0] == pytest.approx(1) and found["p.angle_rate"][0] == pytest.approx(4)


@pytest.mark.long
def test_the_polar_angle_of_a_cam_jumps_without_a_note():
    text = """
bodies: {a: {mass: 1, inertia: 0.1, angle: 50 deg, omega: 9}, f: {mass: 0.4, inertia: 0.01, position: [0, 0.0496]}}
joints:
  p: {type: revolute, i: a, j: ground}
  u: {type: prismatic, i: {body: f, angle: 90 deg}, j: {body: ground, angle: 90 deg}}
  c: {type: point_on_curve, i: f, j: a, radius: "0.04 + 0.01*cos(angle) + 0.002*sin(2*angle)"}
  d: {type: drive, joint: p, velocity: 9}
run: {duration: 1, points: 11, rtol: 1e-8}
"""
    assert not [note for note in stiffmbs.run(stiffmbs.read_scene(text)).notes if "period" in note]
