"""Friction in joints whose loads depend on this friction: several solutions are reported, with the joints and elements."""

import json
from pathlib import Path

import pytest
import yaml

import stiffmbs
from stiffmbs.analyses.run import prepare
from stiffmbs.compile.machine.native.statuses import NOT_FINITE
from stiffmbs.dynamics.friction_loads import ambiguous_loads

SOLVERS = "bdf", "radau", "projected"
MECHANISM = Path(__file__).parents[1] / "data" / "friction_two_joints.yaml"
"""An arm on a pin with a slider and a rod."""


def drawer(friction, torque):
    """A drawer pushed off its guide: the moment m = torque + 0.3 F of a friction F = friction 2 |m|/0.1 is its own load.

    With k = 6 friction, m = torque + k |m| in the sense of motion: torque/(1 + k) or torque/(1 - k). For k > 1 there are both
    or none.
    """
    return stiffmbs.read_scene(
        f"""
bodies:
  drawer: {{mass: 2, inertia: 0.1, position: [0, 0.3], velocity: [5, 0]}}
joints:
  guide: {{type: prismatic, i: {{body: drawer, point: [0, -0.3]}}, j: ground}}
forces:
  rubbing: {{type: joint_friction, joint: guide, friction: {friction}, length: 0.1}}
  twist: {{type: torque, i: drawer, torque: {torque}}}
"""
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_drawer_with_two_solutions_is_in_doubt(solver):
    solution = stiffmbs.run(drawer(0.3, 1.0), duration=0.1, solver=solver)
    assert "in doubt: several motions are possible from t = 0 s on" in solution.message
    assert any("the loads of guide depend on themselves by the friction of rubbing" in note for note in solution.notes)


def test_a_drawer_without_a_solution_is_refused():
    with pytest.raises(stiffmbs.AssemblyError, match=r"no unique solution .*: rubbing; use less friction"):
        stiffmbs.run(drawer(0.3, -1.0), duration=0.1)


def test_both_solutions_are_found():
    job = prepare(drawer(0.3, 1.0))
    moments, dynamics = [], job.dynamics
    for sign in (1.0, -1.0):
        dynamics.state.q[:], dynamics.state.u[:] = job.start.q, job.start.u
        dynamics.state.lam[:] = sign * job.start.lam
        assert dynamics.accelerate(0.0)[0] == 0
        moments.append(abs(dynamics.state.lam[1]))
    assert sorted(moments) == pytest.approx([1 / 2.8, 1 / 0.8])
    assert ambiguous_loads(dynamics, 0.0, job.start.q, job.start.u) == ["guide"]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("torque", "moment"), [(1.0, 1 / 1.9), (-1.0, 1 / 0.1)])
def test_a_drawer_with_one_solution_has_no_note(solver, torque, moment):
    solution = stiffmbs.run(drawer(0.15, torque), duration=0.1, solver=solver)
    assert solution.message == "completed" and not any("several motions" in note for note in solution.notes)
    assert 2 * (5 - solution["drawer.vx"][-1]) / 0.1 == pytest.approx(0.15 * 2 * moment / 0.1, rel=1e-6)


def turned(friction=1.0, exchanged=False):
    scene = yaml.safe_load(MECHANISM.read_text())
    for name in ("fr", "fq"):
        scene["forces"][name]["friction"] *= friction
    if exchanged:
        q = scene["joints"]["q"]
        q["i"], q["j"] = q["j"], q["i"]
    return stiffmbs.read_scene(json.dumps(scene))


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(("solver", "rtol"), [("bdf", 1e-4), ("radau", 1e-4), ("radau", 1e-6)])
def test_joints_whose_loads_depend_on_each_other_are_named(solver, rtol):
    """Two solutions from 0.54 s to 0.71 s: c.omega at the end was -1.73 to -1.75 without a note, or the energy was said to be broken."""
    solution = stiffmbs.run(turned(), solver=solver, rtol=rtol, errors=False)
    assert (
        "several motions are possible from t = 0.54 s on, where the loads of p and q depend on each other"
        in solution.message
    )


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(("solver", "rtol"), [("bdf", 1e-6), ("radau", 1e-4), ("radau", 1e-8)])
def test_a_stop_where_loads_have_no_further_solution_names_the_friction(solver, rtol):
    """The guide on the other body: two solutions meet at 0.3761 s, after which there is none."""
    solution = stiffmbs.run(turned(exchanged=True), solver=solver, rtol=rtol, errors=False)
    assert not solution.success
    chatters = "'fq' chatters" in solution.message  # steps that a jump of the friction ends, of ever shorter length
    assert chatters or ("fr and fq" in solution.message and "use less friction" in solution.message)


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_third_of_the_friction_has_no_note(solver):
    solution = stiffmbs.run(turned(1 / 3), solver=solver, rtol=1e-6, errors=False)
    assert solution.message == "completed"


def test_an_overflow_is_no_start_of_the_next_iteration():
    """Rejected explicit steps leave huge loads; all later accelerations failed, also those at the start."""
    job = prepare(turned())
    dynamics, start = job.dynamics, job.start
    dynamics.state.q[:], dynamics.state.u[:], dynamics.state.lam[:] = start.q, start.u, 1e307
    assert dynamics.accelerate(0.0)[0] == NOT_FINITE
    status, acceleration = dynamics.accelerate(0.0)
    assert status == 0
    assert acceleration == pytest.approx(start.acceleration, rel=1e-9)
