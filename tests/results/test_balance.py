"""Between the steps of a stiff scene forces are as right as at their ends, and motion is what it was."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.ida import starts
from stiffmbs.tuning import parameters_of
from tests.stress.families.stiffness.stiffness import bar_on_bushing
from tests.stress.mechanisms.pendulum import bar_rate, swing

from ..solve.ida.test_native_ida import KINDS, Problem, hanging_chain

GRAVITY = 9.81


def swinging(stiffness, rtol=1e-6):
    return stiffmbs.run(bar_on_bushing(stiffness), duration=2.0, points=201, rtol=rtol)


def force_error(solution):
    """In weights, against a hinge's force, once the ringing of the start is over."""
    phi = swing(solution.t, np.pi / 2, bar_rate(1.0))
    fy = 2.5 * np.cos(phi) ** 2 + 0.25 * np.sin(phi) ** 2
    return np.max(np.abs(solution["bearing.fy"] / GRAVITY - fy)[len(phi) // 4 :])


@pytest.fixture
def as_interpolated(monkeypatch):
    def switch_off():
        monkeypatch.setattr(starts, "POLISHING", replace(parameters_of(starts.POLISHING), amplified=np.inf))

    return switch_off


@pytest.mark.parametrize("stiffness", [1e10, 1e12, 1e13])
def test_force_of_a_stiff_bearing_between_steps(stiffness, as_interpolated):
    balanced = swinging(stiffness)
    as_interpolated()
    plain = swinging(stiffness)
    assert force_error(balanced) < 1e-3
    assert force_error(plain) > 0.5  # what the interpolant makes of it
    assert balanced.solver["steps"] <= plain.solver["steps"]  # the correction also solves steps
    exact = swing(balanced.t, np.pi / 2, bar_rate(1.0)) - np.pi / 2
    for found in (balanced, plain):
        np.testing.assert_allclose(found["bar.angle"], exact, atol=5e-6)


def test_forces_balance_where_joints_are_closed(examples):
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e10 N/m")])
    expected, seen = (
        np.array([run["front_bushing.fx"], run["rear_bushing.fx"], run["front_bushing.fy"], run["rear_bushing.fy"]])
        for run in (stiffmbs.run(scene, solver="bdf", rtol=rtol) for rtol in (1e-9, 1e-3))
    )
    assert np.max(np.abs(seen - expected)) < 0.01 * np.max(np.abs(expected))  # 0.028 with ten times an opening's force


@pytest.mark.long
def test_states_whose_forces_balance_are_left_alone(examples, monkeypatch):
    scene, rtol = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e7 N/m")]), 1e-4
    seen = stiffmbs.run(scene, solver="bdf", rtol=rtol)
    bounds = starts.polishing_bounds
    monkeypatch.setattr(starts, "polishing_bounds", lambda rtol: bounds(rtol) | {"balanced": 0.0})
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e7 N/m"), ("name", "another")])
    corrected = stiffmbs.run(scene, solver="bdf", rtol=rtol)
    assert seen.solver["steps"] == corrected.solver["steps"]
    force, expected = seen["front_bushing.fx"], corrected["front_bushing.fx"]
    assert np.any(seen["chassis.y"] != corrected["chassis.y"])
    np.testing.assert_allclose(force, expected, rtol=0, atol=rtol * np.max(np.abs(corrected["front_spring.fy"])))


def test_correction_ends_where_forces_balance(monkeypatch):
    bounds = starts.newton_bounds
    monkeypatch.setattr(starts, "newton_bounds", lambda rtol, fixed: bounds(rtol, fixed) | {"soft": 0.0})
    assert force_error(swinging(1.1e10, rtol=1e-4)) < 0.01  # no correction is small enough by its size


def test_a_scene_that_is_not_stiff_is_left_alone(examples, as_interpolated):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    balanced = stiffmbs.run(scene, duration=2.0)
    as_interpolated()
    np.testing.assert_array_equal(stiffmbs.run(scene, duration=2.0)["bar.angle"], balanced["bar.angle"])


CARRIED = """
name: A load on a driven slider
gravity: [0, -9.81]
bodies:
  slider: {mass: 4 kg, inertia: 1}
  load: {mass: 20 kg, inertia: 1}
joints:
  rail: {type: prismatic, i: slider, j: ground}
  drive: {type: drive, joint: rail, position: "step5(t, 0.5, 0, 1.5, 5 mm)*sin(1.5*(t - 0.5)^2)"}
forces:
  mount:
    type: bushing
    i: load
    j: slider
    stiffness: [1e9, 1e9, 1e9 N m/rad]
    damping: [2e3, 2e3, 2e3 N m s/rad]
    preload: [0, 196.2, 0]
run: {duration: 2 s, output: 10 ms, solver: bdf}
"""


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6])
def test_closing_a_joint_of_an_output_makes_no_force_in_a_stiff_bushing(rtol):
    scene = read_scene(CARRIED)
    expected, seen = (stiffmbs.run(scene, rtol=asked)["mount.fx"] for asked in (1e-9, rtol))
    assert np.max(np.abs(expected)) < 1.3
    assert np.max(np.abs(seen - expected)) < 100 * rtol * 20 * GRAVITY  # without it 46 kN, 2.5 kN and 6 N


@pytest.mark.parametrize("kind", KINDS)
def test_every_matrix_serves(kind):
    chain, times = Problem(hanging_chain()), np.linspace(0.1, 0.4, 31)

    def rows(matrix, long_step):
        dynamics = Dynamics(chain.system)
        ida = chain.native(matrix=matrix, state=dynamics.state)
        cells = ida.output_correction.cells
        cells["long"], cells["enough"], cells["balanced"] = long_step, 1e-6, 0.0
        ida.correct_outputs(dynamics, True)
        return chain.through(ida, times)[0]

    expected = rows(None, 0.0)
    matrix = KINDS[kind](chain.equations)
    np.testing.assert_allclose(rows(matrix, 0.0), expected, atol=1e-6)
    assert np.max(np.abs(rows(matrix, np.inf) - expected)) > 1e-4


STICKS = """
bodies: {a: {mass: 2, inertia: 0.1, position: [0, 0], velocity: [0.5, 0]}}
joints: {rail: {type: prismatic, i: a, j: ground}}
forces:
  f: {type: force, i: a, j: ground, force: ["-8*tanh(a.vx/0.001)", 0]}
  s: {type: force, i: a, j: ground, force: ["-50*a.x + 3*sin(20*t)", 0]}
run: {duration: 1 s, points: 201, solver: bdf}
"""


def test_friction_that_becomes_stiff_after_the_start():
    """Outputs within long steps were interpolated, as nothing is stiff at the start: 6 % of the force, without a note."""
    expected, seen = (stiffmbs.run(read_scene(STICKS), rtol=rtol)["f.fx"] for rtol in (1e-9, 1e-4))
    assert np.max(np.abs(seen - expected)) < 0.005 * np.max(np.abs(expected))


def test_forces_at_the_ends_of_steps():
    """Newton's remainder at the end of a step was a force in stiff bushings; outputs within it were in balance."""
    chain = read_scene(BRACED)
    expected = stiffmbs.run(chain, solver="radau", rtol=1e-9, points="steps")
    seen = stiffmbs.run(chain, rtol=1e-3, points="steps")
    first = seen.t < 1e-3
    off = seen["pin2.fx"] - np.interp(seen.t, expected.t, expected["pin2.fx"])
    assert np.max(np.abs(off[first])) < 0.1


BRACED = """
gravity: [0, -9.81]
parameters: {k: 1e12, c: 0.5*2*sqrt(k*0.5)}
bodies:
  link{n}: {for: n in 1..4, mass: 0.5, inertia: 0.5*0.09/12, position: [(n - 0.5)*0.3, 0], markers: {left: {point: [-0.15, 0]}, right: {point: [0.15, 0]}}}
forces:
  pin1: {type: bushing, i: link1.left, j: ground, stiffness: [k, k, 0], damping: [c, c, 0]}
  pin{n}: {for: n in 2..4, type: bushing, i: "link{n}.left", j: "link{n-1}.right", stiffness: [k, k, 0], damping: [c, c, 0]}
run: {duration: 0.5 s, solver: bdf}
"""


SWINGS = """
gravity: [0, -9.81]
bodies:
  cart: {{mass: 1, inertia: 0.01}}
  load: {{mass: {mass}, inertia: {inertia}, position: [0.2, -{length}]}}
joints:
  rail: {{type: prismatic, i: cart, j: ground}}
  motor: {{type: drive, joint: rail, position: {{table: {table}}}}}
forces:
  rope: {{type: bushing, i: {{body: load, point: [0, {length}]}}, j: {{body: cart, point: [0.2, 0]}}, stiffness: [{k}, {k}, 0], damping: [{c}, {c}, 0]}}
run: {{duration: 1 s, solver: bdf, errors: false}}
"""
FIRST = {
    "mass": 1, "inertia": 0.01, "length": 0.5, "k": 1e8, "c": 1e4,
    "table": [[0, 0], [0.1, 0.03], [0.2, 0.1], [0.31, 0.12], [0.44, 0.09], [0.6, 0.09], [0.7, 0.2], [1, 0.4]],
}  # fmt: skip
SECOND = {
    "mass": 0.612, "inertia": 0.00372, "length": 0.672646, "k": 2.306e9, "c": 3.672e4,
    "table": [[0, 0], [0.166, -0.124], [0.312, -0.167], [0.559, -0.187], [0.669, -0.197], [0.74, -0.202], [1, -0.13]],
}  # fmt: skip


@pytest.mark.parametrize(("numbers", "rtol", "points"), [(FIRST, 1e-2, 101), (FIRST, 3e-2, 331), (SECOND, 1e-2, 201)])
def test_a_correction_ends_near_the_interpolated_state(numbers, rtol, points):
    """Newton's iteration found another solution: in single rows, the load turned at 243, 7e5 and 2e7 rad/s."""
    scene = read_scene(SWINGS.format(**numbers))
    expected, seen = (stiffmbs.run(scene, rtol=asked, points=points) for asked in (1e-6, rtol))
    for name in ("load.angle", "load.omega"):
        assert np.max(np.abs(seen[name] - expected[name])) < 0.5 * np.ptp(expected[name])
    assert not any("interpolated" in note for note in seen.notes)
