"""Scenes written as assemblies for FreeCAD's solver, and read again."""

import re

import numpy as np
import pytest

import stiffmbs
from stiffmbs.cad.load import load_cad
from stiffmbs.cad.ondsel.write import written_assembly
from stiffmbs.errors import InputError
from stiffmbs.model.read_scene import read_scene

SCENE = """
dimensions: 3
gravity: [0, -9.81, 0.5]
parameters: {w: 3}
bodies:
  crank: {mass: 1, inertia: [0.01, 0.02, 0.03], position: [0.1, 0.02, 0], center_of_mass: [0.01, 0, 0.02]}
  beam: {mass: 2, inertia: [[0.03, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.04]], position: [0.5, 0.1, 0.1], orientation: [0.8, 0, 0, 0.6]}
  nut: {mass: 0.5, inertia: [0.01, 0.01, 0.01], position: [0, 0, 1], velocity: [0, 0, 0.2], omega: [0, 0, 4]}
  float: {mass: 0.5, inertia: [0.01, 0.02, 0.01], position: [2, 0, 1], center_of_mass: [0, 0.1, 0], velocity: [0.3, 0, 0], omega: [1, 2, 0]}
joints:
  hinge: {type: revolute, i: {body: crank, point: [-0.1, 0, 0]}, j: {body: ground, point: [0, 0.02, 0]}}
  motor: {type: drive, joint: hinge, position: "0.5*sin(w*t) + 2*t"}
  ball: {type: spherical, i: {body: crank, point: [0.1, 0, 0]}, j: {body: beam, point: [-0.148, 0.2656, -0.1]}}
  rod: {type: distance, i: {body: beam, point: [0.1, 0, 0]}, j: {body: ground, point: [0.9, 0.5, 0]}, length: 0.489}
  wire: {type: point_on_plane, i: {body: beam, point: [0, 0, 0.1]}, j: {body: ground, point: [0.5, 0.1, 0.2], orientation: {z: [0, 0.6, 0.8]}}}
  spindle: {type: screw, i: nut, j: ground, pitch: 0.3141592653589793}
  tie: {type: equation, zero: "float.z - 1"}
forces:
  spring: {type: spring_damper, i: beam, j: ground, stiffness: 10}
run: {duration: 0.2, output: 0.1}
"""


@pytest.mark.long
def test_a_scene_is_the_same_after_a_file(tmp_path):
    """Without the spring and the equation, which an .asmt file cannot contain, and the notes name."""
    written = written_assembly(read_scene(SCENE))
    assert [note.partition(": ")[2] for note in written.notes] == ["force spring", "joint tie (kind equation)"]
    path = tmp_path / "rig.asmt"
    path.write_text(written.text)
    lines = [line for line in SCENE.splitlines() if not any(word in line for word in ("tie:", "spring:", "forces:"))]
    one, other = stiffmbs.run(read_scene("\n".join(lines)), rtol=1e-9), stiffmbs.run(load_cad(path), rtol=1e-9)
    np.testing.assert_allclose(other.t, one.t)
    for body in ("crank", "beam", "nut", "float"):
        for what in ("x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz"):
            np.testing.assert_allclose(
                other[f"{body}.{what}"], one[f"{body}.{what}"], atol=1e-7, err_msg=f"{body}.{what}"
            )
    np.testing.assert_allclose(other["hinge.fx"], one["hinge.fx"], atol=1e-5)


PENDULUM = """
dimensions: 3
gravity: [0, -9.81, 0]
bodies: {b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
joints: {j: {type: revolute, i: {body: b, point: [-1, 0, 0]}, j: ground}}
"""


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ("start: equilibrium", "start (describe the bodies in the pose of the start, and use start: described)"),
        ("start: settled", "start (describe"),
        ("at_start: {held: {type: drive, joint: j, position: 0.2}}", "at_start (describe bodies in the pose"),
        ("stages: [{run: {duration: 1}}, {run: {duration: 2}}]", "stages (write each stage as a scene of its own)"),
    ],
)
def test_a_start_and_stages_are_refused_with_a_remedy(added, said):
    with pytest.raises(InputError, match=re.escape(f"rig.yaml: an .asmt file cannot contain {said}")):
        written_assembly(read_scene(PENDULUM + added), "rig.yaml")


def test_an_offset_of_a_thread_is_refused():
    with pytest.raises(InputError, match=r"cannot contain joint\.offset of spindle"):
        written_assembly(read_scene(SCENE.replace("pitch: 0.3141592653589793", "pitch: 0.3, offset: 0.1")))


def test_fields_without_an_effect_on_the_motion_are_left_out_with_a_note():
    added = "name: swing\nnotes: [of a clock]\nrun: {duration: 1, points: steps, rtol: 1e-8}"
    text = PENDULUM.replace("inertia:", "open: [omega], geometry: [{type: sphere, radius: 0.1}], inertia:") + added
    notes = " ".join(written_assembly(read_scene(text)).notes)
    for name in ("name", "notes", "body open of b", "body geometry of b", "run points", "run rtol"):
        assert name in notes


@pytest.mark.long
def test_a_run_that_starts_later_is_written_with_its_time(tmp_path):
    driven = PENDULUM.replace("ground}}", "ground}, m: {type: drive, joint: j, position: 0.5*t*t}}")
    scene = read_scene(driven + "run: {start: 1, duration: 0.5, output: 0.1, rtol: 1e-9}")
    path = tmp_path / "rig.asmt"
    path.write_text(written_assembly(scene).text)
    one, other = stiffmbs.run(scene), stiffmbs.run(load_cad(path), rtol=1e-9)
    np.testing.assert_allclose(other.t, one.t - 1)
    np.testing.assert_allclose(other["b.wz"], one["b.wz"], atol=1e-7)


def test_a_law_that_the_solver_cannot_read_is_not_written():
    scene = read_scene(SCENE.replace("0.5*sin(w*t) + 2*t", "exp(t) - 1"))
    assert any("joint motor (its coordinate or its law)" in note for note in written_assembly(scene).notes)


@pytest.mark.parametrize(
    "kind", ["universal", "cylindrical", "prismatic", "planar", "parallel", "perpendicular", "fixed", "orientation"]
)
def test_joints_are_written_and_read_as_they_are(tmp_path, kind):
    turned = ", orientation: {z: [1, 0, 0]}" if kind in ("universal", "perpendicular") else ""
    text = (
        "{dimensions: 3, bodies: {a: {mass: 1, inertia: [1, 1, 1]}}, joints: {j: {type: "
        f"{kind}, i: {{body: a, point: [0.1, 0, 0]}}, j: {{body: ground, point: [0.1, 0, 0]{turned}}}}}}}}}"
    )
    path = tmp_path / "rig.asmt"
    path.write_text(written_assembly(read_scene(text)).text)
    scene = load_cad(path)
    assert scene.joints["j"].kind == kind
    assert stiffmbs.check(scene).degrees_of_freedom == stiffmbs.check(read_scene(text)).degrees_of_freedom
