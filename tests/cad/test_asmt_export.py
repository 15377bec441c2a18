"""Scenes written as assemblies for FreeCAD's solver, and read again."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.cad.load import load_cad
from stiffmbs.cad.ondsel.write import written_assembly
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
