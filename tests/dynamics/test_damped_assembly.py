"""Mechanisms drawn far from closed are assembled where they can be, and refused where they cannot."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import AssemblyError

PLANE = """
parameters: {N: 6, span: 0.7*N}
gravity: [0, -9.81]
bodies:
  rod{k}: {for: k in 1..N, mass: 1, inertia: 1/12, position: [(k - 0.5)*span/N, 0]}
joints:
  first: {type: revolute, i: {body: rod1, point: [-0.5, 0]}, j: ground}
  pin{k}: {for: k in 2..N, type: revolute, i: {body: "rod{k}", point: [-0.5, 0]}, j: {body: "rod{k-1}", point: [0.5, 0]}}
  last: {type: revolute, i: {body: "rod{N}", point: [0.5, 0]}, j: {body: ground, point: [span, 0]}}
run: {duration: 10 ms, points: 2}
"""
SPACE = """
dimensions: 3
parameters: {N: 4, span: 0.8*N}
gravity: [0, 0, -9.81]
bodies:
  rod{k}: {for: k in 1..N, mass: 1, inertia: [0.1, 0.1, 0.1], position: [(k - 0.5)*span/N, 0, 0]}
joints:
  first: {type: universal, i: {body: rod1, point: [-0.5, 0, 0], orientation: {z: [0, 1, 0]}}, j: ground}
  pin{k}: {for: k in 2..N, type: spherical, i: {body: "rod{k}", point: [-0.5, 0, 0]}, j: {body: "rod{k-1}", point: [0.5, 0, 0]}}
  last: {type: spherical, i: {body: "rod{N}", point: [0.5, 0, 0]}, j: {body: ground, point: [span, 0, 0]}}
run: {duration: 10 ms, points: 2}
"""


@pytest.mark.parametrize("scene", [PLANE, SPACE])
def test_a_slack_chain_drawn_straight_is_assembled_and_reported(scene):
    solution = stiffmbs.run(stiffmbs.read_scene(scene))
    assert solution.success
    assert solution["constraint.position"].max() < 1e-11
    assert any("assembly changed rod" in note for note in solution.notes)


def test_its_equilibrium_is_the_catenary_of_rods():
    """The tension in rod k has the vertical component first.fy - (k - 1/2) m g, and its direction is that of the rod."""
    found = stiffmbs.equilibrium(stiffmbs.read_scene(PLANE)).channels
    assert found["first.fy"] == pytest.approx(3 * 9.81)
    slopes = (found["first.fy"] - (np.arange(6) + 0.5) * 9.81) / found["first.fx"]
    angles = np.array([found[f"rod{k}.angle"] for k in range(1, 7)])
    np.testing.assert_allclose(np.tan(angles), slopes, rtol=1e-6)


@pytest.mark.parametrize("scene", [PLANE, SPACE])
def test_a_chain_that_is_too_short_is_refused(scene):
    with pytest.raises(AssemblyError, match=r"cannot be assembled: the largest gap is in joint '(first|pin\d|last)'"):
        stiffmbs.run(stiffmbs.read_scene(scene, [("span", "1.01*N")]))


@pytest.mark.parametrize("presolve", [True, False])
def test_bodies_without_a_gap_stay_where_they_are_drawn(presolve):
    others = "  ball: {mass: 1, inertia: 1, position: [1, 2], angle: 0.5}\n  bob: {mass: 1, inertia: 1, position: [3, 1], angle: 0.5}\n"
    hinge = "joints:\n  hinge: {type: revolute, i: bob, j: {body: ground, point: [3, 1]}}\n"
    scene = stiffmbs.read_scene(PLANE.replace("joints:\n", others + hinge))
    solution = stiffmbs.run(scene, presolve=presolve)
    drawn = {"ball.x": 1.0, "ball.y": 2.0, "ball.angle": 0.5, "bob.x": 3.0, "bob.y": 1.0, "bob.angle": 0.5}
    assert {name: solution[name][0] for name in drawn} == drawn
