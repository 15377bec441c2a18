"""Estimated errors of reactions next to very stiff bushings in a loop, against runs of radau with a much smaller tolerance."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.analyses.load_scene import load_scene
from tests.conftest import EXAMPLES
from tests.error_estimate.test_against_truth import ratio, solved
from tests.solve.test_stiff_reactions import REACTIONS, four_bar
from tests.stress.families.stiffness.stiffness import bar_on_bushing

WELL_DAMPED = (1e12, 7e9)
LIGHTLY_DAMPED = (1e13, None)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["radau", "bdf"])
@pytest.mark.parametrize("bushing", [WELL_DAMPED, LIGHTLY_DAMPED], ids=["1e12", "1e13"])
def test_errors_of_poses_do_not_stretch_stiff_bushings(solver, bushing):
    """Bars of forces were 1000 to 3e8 times the errors, as poses without their errors were off by 1e-10 m; or all was lost."""
    found = stiffmbs.run(four_bar(f"solver: {solver}, rtol: 1e-4, errors: true", *bushing))
    truth = stiffmbs.run(four_bar("solver: radau, rtol: 1e-9, errors: false", *bushing))
    assert found.estimate.status == "estimated"
    assert 0.8 < ratio(found, "a.angle", truth["a.angle"]) < 1.2
    for name in REACTIONS:
        assert 1 / 2 < ratio(found, name, truth[name]) < 2


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("stiffness", [1e10, 1e12])
def test_motions_beside_a_stiff_bushing_have_the_errors_of_rigid_ones(stiffness):
    """Linearised by differences, a stretched bushing turned: poses had bars 20 to 300 times their errors."""
    found = stiffmbs.run(four_bar("solver: radau, rtol: 1e-6, errors: true", stiffness))
    truth = stiffmbs.run(four_bar("solver: radau, rtol: 1e-10, errors: false", stiffness))
    assert 0.7 < ratio(found, "a.angle", truth["a.angle"]) < 1.4
    assert max(found.errors[name].over_time / np.abs(truth[name]).max() for name in REACTIONS) < 1e-3


@pytest.mark.sampled(3)
@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
@pytest.mark.parametrize("scene", [bar_on_bushing, partial(four_bar, "")], ids=["bar", "loop"])
def test_defects_of_radau_beside_stiff_bushings(scene, rtol):
    """At the points of the method itself the curve of a step has small defects: bars were 0.04 to 0.6 of the errors."""
    found = stiffmbs.run(scene(1e8), solver="radau", rtol=rtol, errors=True)
    truth = stiffmbs.run(scene(1e8), solver="radau", rtol=1e-11, errors=False)
    names = (name for name in found if name.endswith((".angle", ".omega")) or name in (*REACTIONS, "bearing.fx"))
    for name in names:
        assert 0.4 < ratio(found, name, truth[name]) < 2.5, name


@pytest.mark.parametrize(("size", "rtol"), [(1e5, 1e-4), (1e5, 1e-8), (1.0, 1e-4)])
def test_a_fast_state_has_the_errors_of_outputs_within_steps(size, rtol):
    """A pressure follows its flow within 10 us: between the steps of bdf its bar was 1/70 of the error."""
    scene = f"""
        gravity: [0, 0]
        bodies: {{b: {{mass: 1, inertia: 1}}}}
        joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
        states: {{p: {{rate: "1e5*({size}*(sin(3*t) - 0.2*b.vx) - p - p^3/{size**2})", start: 0}}}}
        forces: {{push: {{type: force, i: b, force: ["p/{size} - 4*b.x", 0]}}}}
    """
    found = solved(scene, solver="bdf", rtol=rtol, duration=5.0, points=317)
    truth = solve_ivp(
        lambda t, y: [y[1], y[2] - 4 * y[0], 1e5 * (np.sin(3 * t) - 0.2 * y[1] - y[2] - y[2] ** 3)],
        (0, 5), [0, 0, 0], "Radau", found.time, rtol=1e-11, atol=1e-13,
    ).y  # fmt: skip
    for name, values in (("p", size * truth[2]), ("push.fx", truth[2] - 4 * truth[0]), ("b.x", truth[0])):
        assert 0.7 < ratio(found, name, values) < 4, name  # a polynomial over a step that doubles has an error, too


def test_every_block_of_a_run_may_be_taken_step_by_step():
    """Vibrations of all time scales of the steps: no row had a slope of its error, and closing none of them failed."""
    scene = stiffmbs.read_scene("""
        dimensions: 3
        bodies: {a: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
        forces: {s: {type: force, i: a, force: [-1e2*a.x, -1e5*a.y, -1e8*a.z]}}
        run: {duration: 2, solver: bdf, rtol: 1e-2, errors: true}
    """)
    found = stiffmbs.run(scene)
    assert 0.5 < ratio(found, "a.x", np.cos(10 * found.time)) < 2


SEESAW = """
gravity: [0, -9.81]
bodies:
  plank: {mass: 25, inertia: 18, angle: 10 deg, markers: {seat: {point: [1.4, 0.1]}, hook: {point: [-1.4, 0]}}}
  child: {mass: 30, inertia: 0.8, position: [1.361, 0.342]}
  sack: {mass: 20, inertia: 0.3, position: [-1.379, -0.743]}
joints: {pivot: {type: revolute, i: plank, j: ground}}
forces:
  cushion: {type: bushing, i: child, j: plank.seat, stiffness: [2e6, 2e6, 2e3], damping: [2e3, 2e3, 20]}
  strap: {type: spring_damper, i: sack, j: plank.hook, stiffness: 5e4, damping: 200, free_length: 0.5}
run: {duration: 2, points: 201}
"""


@pytest.mark.parametrize("rtol", [1e-4, 1e-5])
def test_stiff_directions_that_turn_within_a_step(rtol):
    """Taken step by step with matrices of its middle between distant nodes, errors did not grow: bars were 0.14 to 0.3 of them."""
    scene = stiffmbs.read_scene(SEESAW)
    found = stiffmbs.run(scene, solver="bdf", rtol=rtol, errors=True)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-10, errors=False)
    for name in ("child.x", "child.y", "plank.angle", "sack.y", "pivot.fy", "strap.fy"):
        assert 0.7 < ratio(found, name, truth[name]) < 1.4, name


def test_a_step_with_a_large_error_of_its_own_stretches_no_stiff_spring():
    """One linear correction of the largest local error left springs of 800 kN/m stretched: their bars were 28 times the errors."""
    scene = load_scene(EXAMPLES / "governor.yaml")
    found = stiffmbs.run(scene, solver="bdf", rtol=1e-5, errors=True)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-9, errors=False)
    for name in ("right_spring.fx", "left_spring.fz", "right_hinge.fy", "slider.az", "right.wdy"):
        assert 0.8 < ratio(found, name, truth[name]) < 1.25, name


KINKED = """
gravity: [0, -9.81]
bodies:
  a: {mass: 1, inertia: 0.01, position: [0.1, 0]}
  b: {mass: 1, inertia: 0.01, position: [0.3, 0]}
  c: {mass: 0.5, inertia: 0.004, position: [0.5, 0]}
joints:
  pin: {type: revolute, i: {body: a, point: [-0.1, 0]}, j: ground}
  elbow: {type: revolute, i: {body: c, point: [-0.1, 0]}, j: {body: b, point: [0.1, 0]}}
forces:
  hold: {type: torque, i: a, torque: -60*a.angle - 2*a.omega}
  strut: {type: spring_damper, i: c, j: {body: ground, point: [0.5, -0.5]}, stiffness: 300, damping: 5, free_length: 0.5}
  bushing:
    type: bushing
    i: {body: a, point: [0.1, 0]}
    j: {body: b, point: [-0.1, 0]}
    stiffness: [4.398e8, 4.398e8, 1.743e6]
    damping: [2.513e4, 2.513e4, 99.54]
  push: {type: force, i: c, force: ["3*abs(t - 0.262) + 4*max(t - 0.338, 0)", 2*sin(9*t)]}
run: {duration: 1, points: 101, rtol: 1e-5}
"""


def test_vibrations_after_a_kink_have_errors_at_each_step():
    """Pairs of equal steps had one error: that of a bushing in the middle of one was 0.2 times the true one."""
    scene = stiffmbs.read_scene(KINKED)
    found = stiffmbs.run(scene, solver="bdf", errors=True)
    truth = stiffmbs.run(scene, solver="radau", rtol=1e-10, errors=False)
    for name in ("bushing.fx", "bushing.fy", "pin.fx", "a.angle"):
        assert 0.4 < ratio(found, name, truth[name]) < 2.0, name


AT_REST = """
dimensions: 3
bodies:
  b:
    mass: 1
    inertia: [0.1, 0.1, 0.1]
    position: [0.3, 0.7, 0.1]
    orientation: {euler: zyx, angles: [0.3, 0.4, 0.5]}
    omega: [OMEGA, 0, 0]
forces:
  m:
    type: bushing
    i: b
    j: {body: ground, point: [0.3, 0.7, 0.1], orientation: {euler: zyx, angles: [0.3, 0.4, 0.5]}}
    stiffness: [1e6, 1e6, 1e6, 500, 500, 500]
    damping: [1, 1, 1, 1, 1, 1]
run: {duration: 0.5}
"""


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_rounding_is_no_force_with_a_large_error(solver, tmp_path):
    """A body at rest has torques of 1e-14 N m from the rounding of its quaternion: they had an error of 140 %, with a note."""
    found = stiffmbs.run(stiffmbs.read_scene(AT_REST.replace("OMEGA", "0")), solver=solver)
    assert not [note for note in found.notes if note.kind == "large-error"]
    assert "velocities" in found.estimate.sentence
    assert "forces" not in found.estimate.sentence
    assert 1e-13 < found.estimate.resolved_torque < 1e-10
    found.save(tmp_path / "rest.npz")
    assert stiffmbs.Solution.load(tmp_path / "rest.npz").estimate == found.estimate


def test_a_force_a_little_above_rounding_keeps_its_note():
    """The motion is below the tolerance, so that its torques, thousands of times their rounding, are wrong."""
    found = stiffmbs.run(stiffmbs.read_scene(AT_REST.replace("OMEGA", "1e-10")), rtol=1e-4)
    (note,) = (note for note in found.notes if note.kind == "large-error")
    assert note.element.startswith("m.t")
