"""Scenes as datasets: read again they move alike."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.adams.export.dataset_text import dataset_text
from stiffmbs.adams.export.forces import kept_parallel
from stiffmbs.adams.export.numbering import statement
from stiffmbs.adams.load import read_adams
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError

DATA = Path(__file__).parents[1] / "data" / "adams"

BODIES = """
dimensions: 3
gravity: [0.5, 0, -9.81]
parameters: {k: 300 N/m, loss: -0.2}
tables:
  smooth: {table: [[-2, -3], [-1, -1], [0, 0], [1, 2], [2, 3]], ends: not-a-knot}
  straight: {table: [[-2, 4], [0, 0], [2, 1]], lines: true}
  local: {table: [[-2, -3], [-1, -1], [0, 0], [1, 2], [2, 3]], akima: true}
bodies:
  a:
    mass: 2
    inertia: [[0.3, 0.02, 0.01], [0.02, 0.4, -0.03], [0.01, -0.03, 0.5]]
    center_of_mass: [0.1, 0.05, -0.02]
    orientation: {euler: zxz, angles: [20 deg, 30 deg, -50 deg]}
    omega: [0, 0, 0]
    markers: {end: {point: [0.3, 0, 0.1], orientation: {z: [1, 1, 0]}}, pin: {orientation: {z: [0, 1, 0]}}}
  b:
    mass: 1
    inertia: [0.2, 0.3, 0.35]
    position: [1, 0.2, 0.1]
    markers: {end: {point: [-0.2, 0.1, 0]}, side: {point: [0, 0.3, 0], orientation: {x: [0, 1, 0], z: [1, 0, 0]}}}
"""
BETWEEN = {
    "revolute": "joints: {one: {type: revolute, i: a.pin, j: {body: ground, orientation: {z: [-0.219846, 0.844, 0.489]}}}}",
    "spherical": "joints: {one: {type: spherical, i: a, j: ground}, two: {type: spherical, i: b.end, j: {body: ground, point: [0.8, 0.3, 0.1]}}}",
    "rod": "joints: {one: {type: spherical, i: a, j: ground}, rod: {type: distance, i: a.end, j: b.end, length: 0.6}}",
    "slider": "joints: {one: {type: prismatic, i: b, j: {body: ground, point: [1, 0.2, 0.1]}}}\nforces: {push: {type: force, i: b, force: [0, 0, 'step(t, 0, 0, 0.2, 30) - 5*vz(b)']}}",
    "cylinder": "joints: {one: {type: cylindrical, i: b.end, j: {body: ground, point: [0.8, 0.3, 0]}}, motor: {type: drive, joint: one.angle, velocity: '3*sin(5*t)'}}",
    "planar": "joints: {one: {type: planar, i: b, j: {body: ground, point: [1, 0.2, 0.1]}}, turn: {type: drive, coordinate: b.x, position: '1 + t^2'}}",
    "thread": "joints: {one: {type: thread, i: b.end, j: {body: ground, point: [0.8, 0.3, 0.1]}, pitch: 0.05}}",
    "primitives": "joints: {one: {type: point_on_line, i: b.end, j: {body: ground, point: [0.8, 0.3, 0.1]}}, two: {type: point_on_plane, i: a, j: ground}, three: {type: parallel, i: b, j: ground}}",
    "coupler": "joints: {one: {type: prismatic, i: b, j: {body: ground, point: [1, 0.2, 0.1]}}, two: {type: revolute, i: a, j: {body: ground, orientation: {euler: zxz, angles: [20 deg, 30 deg, -50 deg]}}}, tie: {type: coupler, joint_1: one, joint_2: two, scale: 0.3}}",
    "offset": "joints: {one: {type: prismatic, i: b, j: {body: ground, point: [1, 0.2, 0]}}, two: {type: revolute, i: a, j: {body: ground, orientation: {euler: zxz, angles: [20 deg, 30 deg, -50 deg]}}}, tie: {type: coupler, joint_1: one, joint_2: two, scale: 0.3, offset: 0.1}}",
    "equation": "joints: {tie: {type: equation, zero: ['b.x - 1 - 0.3*sin(a.y - 0.05)^2', 'dz(b) - 0.1']}}",
    "springs": "forces: {s: {type: spring_damper, i: a.end, j: b.end, stiffness: k, damping: 3, free_length: 0.5, preload: 2}, u: {type: spring_damper, i: a, j: b, spring_law: '30*s^3 + 40*s', damper_law: '2*v', free_length: 1}, f: {type: line_force, i: a, j: b.side, force: '-3*(dm(a, b.side) - 1)*abs(vr(a, b.side))'}}",
    "bushing": "forces: {s: {type: bushing, i: a.end, j: {body: ground, point: [0.2, 0.1, 0]}, stiffness: [300, 200, 100, 9, 8, 7], damping: [3, 2, 1, 0.9, 0.8, 0.7], preload: [1, 2, 3, 0.1, 0.2, 0.3]}}",
    "field": "forces: {s: {type: field, i: b.end, j: {body: ground, point: [0.8, 0.3, 0.1]}, stiffness: [[90, 5, 0, 0, 0, 1], [5, 80, 0, 0, 0, 0], [0, 0, 70, 0, 2, 0], [0, 0, 0, 9, 0, 0], [0, 0, 2, 0, 8, 0], [1, 0, 0, 0, 0, 7]], free: [0.01, 0, 0.02, 0, 0.1, 0]}}",
    "beam": "forces: {s: {type: beam, i: {body: b, point: [-0.2, 0.1, 0]}, j: {body: ground, point: [0.3, 0.3, 0.1]}, length: 0.5, young: 1e7, shear_modulus: 4e6, area: 1e-4, torsion: 2e-8, iyy: 1e-8, izz: 1e-8, damping_ratio: 1e-3}}",
    "torques": "joints: {one: {type: spherical, i: a, j: ground}}\nforces: {turn: {type: torque, i: a, j: b, frame: b.side, torque: ['0.3*az(a, b)', '-0.2*wx(a, b, a)', 'max(0.1, min(t, 0.2), loss)']}, g: {type: force, i: b, j: a, axes: body, force: ['branch(b.vx, 1, 2, 3)', 'sign(t - 0.1)*asinh(2*t)', 'exp(-t) + atan2(t, 2) - 2^-t - (1 - (t - 2))/(3/(1 + t))']}}",
    "reactions": "joints: {one: {type: prismatic, i: b, j: {body: ground, point: [1, 0.2, 0.1]}}, two: {type: point_on_line, i: a, j: ground}}\nforces: {f: {type: force, i: b, force: [0, 0, '-0.2*sqrt(fx(one)^2 + fy(one)^2 + 0.01)*step(vz(b), -0.1, -1, 0.1, 1) + 0.01*tx(one) - 0.02*fy(two)']}}",
    "tables": "forces: {f: {type: force, i: b, force: ['smooth(t)', 'straight(b.x - 1.1)', '-2*local(b.vz)']}}",
    "states": "states: {lag: {rate: '(b.vz - lag)/0.05', start: 0.3}, root: {zero: 'root^3 + root - b.x', start: 0.6}, smooth: {numerator: [2], denominator: [0.1, 1], input: b.vy}}\nforces: {f: {type: force, i: b, force: [root, '-smooth', '-3*lag']}}",
}  # fmt: skip


def _scene(kind):
    text = BODIES
    if kind != "tables":
        text = "\n".join(
            line for line in BODIES.splitlines() if not line.startswith(("tables", "  smooth", "  straight", "  local"))
        )
    return stiffmbs.read_scene(f"{text}\n{BETWEEN[kind]}\n")  # fmt: skip


def _same_motion(scene, again, **how):
    settings = {"duration": 0.4, "output": 0.1, "rtol": 1e-9} | how
    one, other = stiffmbs.run(scene, **settings), stiffmbs.run(again, **settings)
    for name, read in zip(scene.bodies, again.bodies, strict=True):
        for axis in "xyz":
            np.testing.assert_allclose(other[f"{read}.{axis}"], one[f"{name}.{axis}"], atol=2e-8, err_msg=name)


QUICK = ("slider", "coupler", "bushing", "states")


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=[] if kind in QUICK else pytest.mark.long) for kind in BETWEEN if kind != "planar"],
)
def test_a_scene_moves_as_its_dataset(kind):
    scene = _scene(kind)
    text = dataset_text(scene)
    assert max(map(len, text.splitlines())) <= 80
    _same_motion(scene, read_adams(text))


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("name", sorted(path.parent.name for path in DATA.glob("*/dataset.adm")))
def test_a_dataset_written_anew_is_the_same(name):
    scene = stiffmbs.load_scene(DATA / name / "dataset.adm")
    text = dataset_text(scene)
    again = read_adams(text)
    _same_motion(scene, again, rtol=1e-7)
    written = dataset_text(again)
    assert dataset_text(read_adams(written)).count("\n") == written.count("\n"), "a third time nothing is added"


@pytest.mark.long
def test_tables_continue_with_the_slope_of_their_ends_in_adams_too():
    """Adams would follow a parabola; the body leaves both tables at once."""
    text = BETWEEN["tables"].replace("smooth(t)", "5*smooth(b.x - 3.1) + sign(0*t)").replace("- 1.1", "- 4")
    scene = stiffmbs.read_scene(f"{BODIES}\n{text.replace('local(b.vz)', 'local(b.vz - 5)')}")
    written = dataset_text(scene)
    _same_motion(scene, read_adams(written), rtol=1e-7)
    assert dataset_text(read_adams(written)).count("MIN(") == written.count("MIN(")


def test_a_periodic_table_of_lines_is_refused():
    teeth = BODIES.replace("lines: true", "lines: true, ends: periodic").replace("[-2, 4]", "[-2, 1]")
    with pytest.raises(InputError, match=r"forces\.f: found the table straight \(periodic\)"):
        dataset_text(stiffmbs.read_scene(f"{teeth}\n{BETWEEN['tables']}"))


def test_requests_are_read_again():
    scene = stiffmbs.read_scene(f"{BODIES}\nrequests: {{r: 'accx(b.end, a, a) + 2*phi(a) - b.vx', lost: energy.total}}")
    text = dataset_text(scene)
    assert "! the request lost is left out" in text
    one, other = (stiffmbs.run(each, duration=0.1, output=0.05, rtol=1e-9) for each in (scene, read_adams(text)))
    np.testing.assert_allclose(other["REQUEST_1.f2"], one["r"], atol=1e-7)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (BETWEEN["planar"], "joints.turn: found a drive of a formula, expected one of a joint"),
        ("forces: {f: {type: force, i: a, force: [b.q1, 0, 0]}}", "forces.f: found 'b.q1'"),
        ("joints: {p: {type: revolute_spherical, i: a, j: b.end, length: 1}}", "joints.p: found a joint of the type revolute_spherical"),
        ("forces: {s: {type: bushing, i: a, j: b, axes: ground, stiffness: [1, 1, 1, 0, 0, 0]}}", "forces.s: .*'axes: ground'"),
        ("forces: {s: {type: torsion_spring, i: a, j: b, spring_law: 2*s^3}}", "forces.s: found curves of a torsion spring between axes"),
    ],
)  # fmt: skip
def test_what_adams_has_no_statement_for_is_named(more, message):
    with pytest.raises(InputError, match=f"a dataset has no statement for {message}"):
        dataset_text(stiffmbs.read_scene(f"{BODIES}\n{more}"))


def test_the_command_writes_a_dataset_and_its_command_file(tmp_path):
    scene, dataset = tmp_path / "swing.yaml", tmp_path / "swing.adm"
    scene.write_text(f"{BODIES}{BETWEEN['revolute']}\nrun: {{duration: 0.2, output: 0.1, rtol: 1e-9}}\n")
    done = CliRunner().invoke(main, ["convert", str(scene), "-o", str(dataset)])
    assert done.exit_code == 0, done.output
    again = stiffmbs.load_scene(dataset)
    assert again.run.duration == 0.2 and len(stiffmbs.run(again).t) == 3
    refused = CliRunner().invoke(main, ["convert", str(dataset), "-o", str(tmp_path / "swing.ADM")])
    assert refused.exit_code in (0, 2)


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        (
            "one: {type: screw, i: b, j: {body: ground, point: [1, 0.2, 0.1]}, pitch: 0.05}",
            "found a joint of the type screw, expected a thread",
        ),
        (
            "one: {type: point_on_line, i: b, j: {body: ground, point: [1, 0.2, 0.1]}}, two: {type: drive, joint: one, position: t}",
            "found the joint one, expected one that is a JOINT",
        ),
    ],
)
def test_joints_that_are_no_joint_of_adams_are_refused_by_name(joints, said):
    text = "\n".join(
        line for line in BODIES.splitlines() if not line.startswith(("tables", "  smooth", "  straight", "  local"))
    )
    with pytest.raises(InputError, match=said):
        dataset_text(stiffmbs.read_scene(f"{text}\njoints: {{{joints}}}\n"))


@pytest.mark.parametrize("operator", ["**", "1.5E+16*"])
def test_a_line_ends_within_no_operator_and_no_number(operator):
    for width in range(60, 90):
        written = statement("SFORCE", 1, f"FUNCTION = {'x' * width}{operator}3")
        assert operator in written


@pytest.mark.parametrize(
    "joints",
    [
        "{one: {type: revolute, i: a, j: b}}",
        "{one: {type: planar, i: a, j: ground}, other: {type: parallel, i: {body: b, point: [1, 0, 0]}, j: ground}}",
        "{one: {type: fixed, i: {body: a, orientation: {z: [1, 0, 0]}}, j: {body: c, orientation: {z: [1, 0, 0]}}}, other: {type: cylindrical, i: c, j: b}}",
    ],
)  # fmt: skip
def test_curves_of_torsion_springs_are_written_where_joints_keep_the_axes_parallel(joints):
    scene = stiffmbs.read_scene(f"""
        dimensions: 3
        bodies: {{a: {{mass: 1, inertia: [1, 1, 1]}}, b: {{mass: 1, inertia: [1, 1, 1]}}, c: {{mass: 1, inertia: [1, 1, 1]}}}}
        joints: {joints}
        forces: {{s: {{type: torsion_spring, i: a, j: b, spring_law: 2*s^3}}}}
    """)
    assert "FUNCTION = -(2*" in dataset_text(scene)


@pytest.mark.parametrize(
    "joints",
    [
        "{one: {type: spherical, i: a, j: b}}",
        "{one: {type: revolute, i: {body: a, orientation: {z: [1, 0, 0]}}, j: {body: b, orientation: {z: [1, 0, 0]}}}}",
        "{one: {type: revolute, i: a, j: ground}}",
    ],
)
def test_curves_of_torsion_springs_are_refused_elsewhere(joints):
    scene = stiffmbs.read_scene(f"""
        dimensions: 3
        bodies: {{a: {{mass: 1, inertia: [1, 1, 1]}}, b: {{mass: 1, inertia: [1, 1, 1]}}}}
        joints: {joints}
        forces: {{s: {{type: torsion_spring, i: a, j: b, spring_law: 2*s^3}}}}
    """)
    with pytest.raises(InputError, match="no joints keep parallel"):
        dataset_text(scene)


@pytest.mark.parametrize(("sine", "kept"), [(0.7e-9, True), (1.5e-9, False)])
def test_axes_are_parallel_up_to_rounding(sine, kept):
    scene = stiffmbs.read_scene(f"""
        dimensions: 3
        bodies: {{a: {{mass: 1, inertia: [1, 1, 1]}}, b: {{mass: 1, inertia: [1, 1, 1]}}}}
        joints: {{one: {{type: revolute, i: a, j: b}}}}
        forces: {{s: {{type: torsion_spring, i: {{body: a, orientation: [1, {sine / 2!r}, 0, 0]}}, j: b, spring_law: 2*s^3}}}}
    """)
    assert kept_parallel(scene, scene.forces["s"].i, scene.forces["s"].j) is kept


@pytest.mark.parametrize("motion", ["velocity: [0.3, 0, 0]", "omega: [0, 0, 2]"])
def test_a_free_body_keeps_a_motion_of_one_kind(motion):
    """Velocities of assembly are left to joints where nothing is given: one kind of motion is enough to give all."""
    scene = stiffmbs.read_scene(f"dimensions: 3\nbodies: {{b: {{mass: 1, inertia: [1, 1, 1], {motion}}}}}\n")
    again = read_adams(dataset_text(scene))
    one, other = (stiffmbs.run(each, duration=0.5, points=3) for each in (scene, again))
    (name,) = again.bodies
    for channel in ("x", "vx", "wz"):
        np.testing.assert_allclose(other[f"{name}.{channel}"], one[f"b.{channel}"], atol=1e-9)
