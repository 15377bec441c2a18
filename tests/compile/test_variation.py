"""What is constant is told by symbols: formulas that are flat in floating point at the start vary, products with zero do not."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome

SLED = """
bodies:
  b: {mass: 1, inertia: 1, velocity: [10, 0]}
  c: {mass: 1, inertia: 1}
joints:
  rail: {type: point_on_line, i: b, j: ground}
  coupling: {type: equation, zero: "FORMULA"}
run: {duration: 1 s, points: 11}
"""


def left_out(text):
    """The equations that are left out of the solution."""
    job = prepare(read_scene(text))
    parts = [subsystem.dynamics for subsystem in job.subsystems] or [job.dynamics]
    return {
        ".".join(part.system.equations[row]) for part in parts for row in np.flatnonzero(part.coordinates.satisfied)
    }


@pytest.mark.parametrize(
    "formula",
    [
        "c.x - tanh(20*(b.x - 5))", "c.x - exp(-((b.x - 50)/0.1)^2)", "c.x - log(cosh(20*(b.x - 5)))/20 + 5",
        "c.x - p(b.x)", "c.x - max(0, b.x - 5)", "c.x - step(b.x, 5, 0, 6, 1)", "c.x - 1e-20*b.x^2",
        "c.x - 0.001*sign(b.x + 1) + 0.001", "c.x + b.x*exp(-(b.angle + 40)^2)", "c.x - 0.1*t", "c.x - (b.x/100)^20",
    ],
)  # fmt: skip
def test_what_varies_stays(formula):
    table = "tables: {p: {table: [[-9, 0], [0, 0], [1, 0], [5, 0], [6, 1], [7, 1], [8, 1]]}}\n"
    assert left_out(SLED.replace("FORMULA", formula) + table) == {"rail.normal"}


@pytest.mark.parametrize(
    "formula",
    [
        "c.x - 0*b.x^2", "c.x - 0*sin(b.x)*exp(b.x) - 3*b.x", "c.x - tanh(2)*b.x", "c.x - tanh(20*(b.y - 5)) - 1",
        "c.x - b.x*cos(b.y)", "c.x - p(b.y)", "c.x + 1e-16*sin(b.x)",
    ],
)  # fmt: skip
def test_what_is_constant_is_left_out(formula):
    table = "tables: {p: {table: [[-9, 0], [0, 0], [1, 0.5], [5, 0], [6, 1], [7, 1], [8, 1]]}}\n"
    assert left_out(SLED.replace("FORMULA", formula) + table) == {"rail.normal", "coupling.zero[0]"}


@pytest.mark.parametrize(("arm", "held"), [(0.0, True), (1e-17, True), (1e-9, False)])
def test_a_pin_in_the_centre_of_mass_holds_it(arm, held):
    scene = f"""
bodies: {{b: {{mass: 1, inertia: 1, omega: 1, position: [{-arm!r}, 0]}}}}
joints: {{pin: {{type: revolute, i: {{body: b, point: [{arm!r}, 0]}}, j: ground}}}}
"""
    assert left_out(scene) == ({"pin.x", "pin.y"} if held else set())


ORIENTED = """
dimensions: 3
bodies:
  b: {mass: 1, inertia: [1, 1, 1], velocity: [10, 0, 0]}
  c: {mass: 1, inertia: [1, 1, 1]}
joints:
  upright: {type: parallel, i: c, j: ground}
  turning: {type: equation, zero: "FORMULA"}
"""


@pytest.mark.long
@pytest.mark.parametrize(("formula", "held"), [("az(c) - tanh(20*(b.x - 5)) - 1", False), ("az(c) - 0*b.x", True)])
def test_an_orientation_is_held_by_what_depends_on_it_alone(formula, held):
    rows = {"upright.x_across_z", "upright.y_across_z", "turning.zero[0]"}
    assert left_out(ORIENTED.replace("FORMULA", formula)) == (rows if held else set())


RAILS = """
bodies: {b: {mass: 1, inertia: 1, velocity: [10, 0]}}
joints:
  rail: {type: point_on_line, i: b, j: ground}
  bumpy: {type: point_on_curve, i: b, j: ground, y: "HEIGHT*exp(-((x - 5.03)/0.1)^2)"}
run: {duration: 1 s, points: 11}
"""
DRIVES = """
bodies: {b: {mass: 1, inertia: 1}}
joints:
  rail: {type: prismatic, i: b, j: ground}
  one: {type: drive, joint: rail, position: 0*t}
  two: {type: drive, joint: rail, position: "exp(-((t - 0.73)/0.5 ms)^2)"}
run: {duration: 1 s, points: 11, rtol: 1e-6}
"""


@pytest.mark.parametrize(("text", "end"), [(RAILS.replace("HEIGHT", "0.3"), 0.4), (DRIVES, 0.7)])
def test_what_is_redundant_near_the_start_alone_ends_the_run(text, end):
    """The second rail rises, and the second drive pulses, between two outputs: from there on there is no motion."""
    scene = read_scene(text)
    solution = stiffmbs.run(scene)
    second = list(scene.joints)[-1]
    assert solution.outcome is Outcome.STOPPED
    assert solution.time[-1] == pytest.approx(end)
    assert f"joint '{second}'" in solution.message
    assert "is violated there" in solution.message
    assert any(
        "the run stops where formulas or tables make these equations independent" in note for note in solution.notes
    )
    assert any("and stops where formulas" in message for message in stiffmbs.check(scene).messages)


def test_what_is_redundant_all_the_way_is_left_out():
    solution = stiffmbs.run(read_scene(RAILS.replace("HEIGHT", "0")))
    assert solution.outcome is Outcome.DONE
    assert solution["b.x"][-1] == pytest.approx(10.0)
    assert not any("stops where" in note for note in solution.notes)
    twice = RAILS.replace("HEIGHT", "0.3").replace(
        "type: point_on_line, i: b, j: ground",
        'type: point_on_curve, i: b, j: ground, y: "0.3*exp(-((x - 5.03)/0.1)^2)"',
    )
    assert stiffmbs.run(read_scene(twice), points=1001).outcome is Outcome.DONE


def test_a_body_in_a_formula_that_is_flat_at_the_start_is_not_called_free():
    """The sled pushes the other one from 5 m on."""
    scene = read_scene(SLED.replace("FORMULA", "c.x - 1 - tanh(20*(b.x - 5))").replace("point_on_line", "prismatic"))
    assert not any("by itself" in message for message in stiffmbs.check(scene).messages)


LOCKING = """
bodies:
  crank: {mass: 1, inertia: 0.1, angle: 45 deg, markers: {end: {point: [0.5, 0]}}}
  slider: {mass: 1, inertia: 0.1, position: [1.2071067811865475, 0]}
joints:
  pin: {type: revolute, i: crank, j: ground}
  guide: {type: prismatic, i: slider, j: ground}
  rod: {type: distance, i: crank.end, j: slider, length: sqrt(0.855553390593)}
  motor: {type: drive, joint: guide, velocity: 1}
run: {duration: 1 s, points: 101}
"""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "auto"])
def test_a_drive_that_a_mechanism_locks_against_ends_the_run(solver):
    """The slider reaches its dead centre, crank and rod in one line, at 0.5 m + L."""
    reach = 0.5 + np.sqrt(0.855553390593) - 1.2071067811865475
    solution = stiffmbs.run(read_scene(LOCKING), solver=solver)
    assert solution.outcome is Outcome.STOPPED
    assert reach - 0.02 < solution.time[-1] <= reach
    assert "joint 'motor'" in solution.message and "locks" in solution.message
