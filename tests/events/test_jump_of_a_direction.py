"""The polar angle of a cam's follower jumps by a full turn; the periodic table of its radius continues."""

import numpy as np
from scipy.interpolate import CubicSpline

import stiffmbs

ANGLES, RADII = np.deg2rad([0, 120, 200, 360]), [0.040, 0.046, 0.044, 0.040]
CAM = """
gravity: [0, -9.81]
bodies: {{cam: {{mass: 1, inertia: 0.1, omega: {w}}}, follower: {{mass: 0.4, inertia: 0.01, position: [0, 0.0449]}}}}
joints:
  bearing: {{type: revolute, i: cam, j: ground}}
  guide: {{type: prismatic, i: {{body: follower, angle: 90 deg}}, j: {{body: ground, angle: 90 deg}}}}
  contact: {{type: point_on_curve, i: follower, j: cam, radius: {{table: [[0, 40 mm], [120 deg, 46 mm], [200 deg, 44 mm], [360 deg, 40 mm]], ends: periodic}}}}
  motor: {{type: drive, joint: bearing, velocity: {w}}}
run: {{duration: 0.5, points: 21}}
"""


def test_the_jump_is_no_event():
    """Each step about the jump ended there, until the run stopped with a message on a force that chatters."""
    w = 49.14679964638872  # a step that ends there was repeated
    found = stiffmbs.run(stiffmbs.read_scene(CAM.format(w=w)), solver="bdf", rtol=1e-3, errors=False)
    assert found.success, found.message
    assert not any("period" in note for note in found.notes)
    curve = CubicSpline(ANGLES, RADII, bc_type="periodic")
    expected = curve(np.mod(np.pi / 2 - w * found.t, 2 * np.pi))
    np.testing.assert_allclose(found["follower.y"], expected, rtol=0, atol=1e-3)
