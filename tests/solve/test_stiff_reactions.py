"""Reactions next to a very stiff bushing, against those of a fixed joint in its place."""

import re

import numpy as np
import pytest

import stiffmbs

ENDS = "i: {body: first, point: [0.1, 0]}, j: {body: second, point: [-0.1, 0]}"
REACTIONS = ("pin.fx", "pin.fy")
FADED = 20
"""Output times after which the vibration from the start has faded."""


PUSH = "push: {type: force, i: second, force: [%s]}"
KINKS = "'3*abs(t - 0.21) + 4*abs(t - 0.3) + 4*max(t - 0.4, 0)', 0"
JUMPS = "'2*sign(second.y - 0.1)', 0"
STOP = ", ".join(["'-1e4*max(second.y - 0.1, 0)'"] * 2)


def bushing(ends, stiffness, softer=1e4, damping=None):
    damping = damping or 0.1 * np.sqrt(stiffness / 2)
    three = (f"[{size}, {size}, {size}/{softer}]" for size in (stiffness, damping))
    return "{{type: bushing, {}, stiffness: {}, damping: {}}}".format(ends, *three)


def pendulum(run, stiffness=None, push="0, 0"):
    """Return two bars joined by a damped bushing, N/m, or by a fixed joint, and pushed by a force, N."""
    force = f"bushing: {bushing(ENDS, stiffness)}" if stiffness else ""
    return stiffmbs.read_scene(f"""
gravity: [0, -9.81]
bodies:
  first: {{mass: 1, inertia: 0.01, position: [0.1, 0], velocity: [0, 0.5], omega: 5}}
  second: {{mass: 1, inertia: 0.01, position: [0.3, 0], velocity: [0, 1.5], omega: 5}}
joints:
  pin: {{type: revolute, i: {{body: first, point: [-0.1, 0]}}, j: ground}}
  {"" if stiffness else f"weld: {{type: fixed, {ENDS}}}"}
forces:
  {PUSH % push}
  {force}
run: {{duration: 0.5 s, points: 501, {run}}}
""")


@pytest.fixture(scope="module")
def rigid():
    solution = stiffmbs.run(pendulum("solver: bdf, rtol: 1e-10"))
    return {name: solution[name] for name in REACTIONS}


def error(found, rigid):
    """Return the largest error of a reaction, relative to the largest reaction."""
    largest = max(np.abs(rigid[name]).max() for name in REACTIONS)
    count = len(found["pin.fx"])
    return max(np.abs(found[name] - rigid[name][:count])[FADED:].max() for name in REACTIONS) / largest


@pytest.mark.parametrize("stiffness", [1e12, 1e14])
def test_spurious_forces_between_steps_are_removed(rigid, stiffness):
    """Their moments spoiled the matrix of the correction: reactions were wrong by 4000 times the largest at 1e14 N/m."""
    assert error(stiffmbs.run(pendulum("solver: bdf, rtol: 1e-4", stiffness)), rigid) < 0.01


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_simulations_and_followed_runs_correct_states_within_steps(rigid, solver):
    """With uncorrected states, reactions were wrong by 20 times the largest."""
    scene = pendulum(f"solver: {solver}, rtol: 1e-6", 1e14)
    simulation, found = stiffmbs.simulation(scene), {name: [rigid[name][0]] for name in REACTIONS}
    for _ in range(300):
        simulation.step(1e-3)
        for name in REACTIONS:
            found[name].append(simulation[name])
    assert error(found, rigid) < 0.01


def interpolated(run):
    """Return the notes on interpolated states of a run with a bushing of 1e14 N/m."""
    return [note for note in stiffmbs.run(pendulum(run, 1e14)).notes if "interpolated" in note]


@pytest.mark.long
def test_interpolated_states_that_cannot_be_corrected_are_told():
    """One correction, in place of eight, does not suffice."""
    (note,) = interpolated("solver: bdf, rtol: 1e-3, tuning: {polishing: {most_corrections: 1}}")
    assert "stiff forces do not balance" in note and "solver: radau" in note
    assert not interpolated("solver: bdf, rtol: 1e-4")


@pytest.mark.long
def test_states_between_output_times_are_not_told():
    """Radau left up to 51 states of the search for events open, which the note counted among 3 output times."""
    run = "solver: radau, rtol: 1e-4, tuning: {polishing: {most_corrections: 1}}"
    notes = stiffmbs.run(pendulum(run, 1e14, STOP), points=3).notes
    assert [re.search("at (.*?) from", note).group(1) for note in notes if "interpolated" in note] == ["1 output time"]


@pytest.mark.parametrize(("stiffness", "most"), [(1e12, 0.01), (1e14, 0.1)])
def test_long_steps_at_a_loose_tolerance_have_right_forces(rigid, stiffness, most):
    """Newton's iteration failed in a quarter of the steps. Reactions were wrong by 0.8 and 390 times the largest."""
    found = stiffmbs.run(pendulum("solver: bdf, rtol: 1e-3", stiffness))
    assert error(found, rigid) < most
    assert found.solver["steps"] < 200
    assert not any("missed" in note for note in found.notes)


@pytest.mark.parametrize("push", [KINKS, JUMPS, STOP], ids=["kinks", "jumps", "stop"])
def test_reactions_after_breakpoints_and_events(push):
    """They were wrong in 71, 28 and 18 of 501 rows, by up to 0.7 times the largest."""
    found, exact = (
        stiffmbs.run(pendulum("solver: bdf, rtol: 1e-4", 1e14, push)),
        stiffmbs.run(pendulum("solver: radau, rtol: 1e-10", None, push)),
    )
    largest = max(np.abs(exact[name]).max() for name in REACTIONS)
    errors = np.max([np.abs(found[name] - exact[name])[FADED:] for name in REACTIONS], axis=0) / largest
    assert errors.max() < 0.2
    assert np.count_nonzero(errors > 0.02) <= 2  # next to a jump of a force, which excites a vibration
    assert found.solver["steps"] < 400


LOOP_ENDS = ((0.0, 0.0), (0.2, 0.0), (0.35, 0.5), (0.8, 0.0))
"""Hinges of a four-bar, m."""


def four_bar(run, stiffness=None, damping=None):
    """Return a four-bar at rest whose coupler has two halves, joined by a bushing, N/m and N s/m, or by a fixed joint."""
    points = np.array(LOOP_ENDS)
    bodies, ends = [], []
    for name, begin, end in zip("abc", points[:-1], points[1:], strict=True):
        length, angle = np.hypot(*(end - begin)), np.arctan2(*(end - begin)[::-1])
        parts = ("b1", "b2") if name == "b" else (name,)
        for k, part in enumerate(parts):
            x, y = begin + (end - begin) * (k + 0.5) / len(parts)
            bodies.append(f"{part}: {{mass: 1, inertia: 0.01, position: [{x}, {y}], angle: {angle}}}")
        half = length / len(parts) / 2
        ends.append([f"{{body: {part}, point: [{side * half}, 0]}}" for part, side in ((parts[0], -1), (parts[-1], 1))])
    middle = f"i: {{body: b1, point: [{half_of(points)}, 0]}}, j: {{body: b2, point: [-{half_of(points)}, 0]}}"
    indent = "\n  "
    return stiffmbs.read_scene(f"""
gravity: [0, -9.81]
bodies:
  {indent.join(bodies)}
joints:
  pin: {{type: revolute, i: {ends[0][0]}, j: ground}}
  p1: {{type: revolute, i: {ends[0][1]}, j: {ends[1][0]}}}
  p2: {{type: revolute, i: {ends[1][1]}, j: {ends[2][0]}}}
  p3: {{type: revolute, i: {ends[2][1]}, j: {{body: ground, point: {list(LOOP_ENDS[-1])}}}}}
  {"" if stiffness else f"weld: {{type: fixed, {middle}}}"}
forces:
  push: {{type: force, i: b1, force: ['2*sign(t - 0.35)', 0]}}
  {f"bushing: {bushing(middle, stiffness, 100, damping)}" if stiffness else ""}
run: {{duration: 0.5 s, points: 501, {run}}}
""")


def half_of(points):
    return np.hypot(*(points[2] - points[1])) / 4


@pytest.fixture(scope="module")
def rigid_four_bar():
    return stiffmbs.run(four_bar("solver: radau, rtol: 1e-10"))


@pytest.mark.parametrize(("solver", "rtol"), [("bdf", 1e-4), ("radau", 1e-3)])
def test_restarts_in_a_loop_keep_stiff_forces(rigid_four_bar, solver, rtol):
    """The smallest move at the restart changed the force of the bushing by 24 and 2 times the largest reaction."""
    found = stiffmbs.run(four_bar(f"solver: {solver}, rtol: {rtol}", 1e14))
    assert error(found, rigid_four_bar) < 0.1


def simulated(scene):
    """Return reactions of a simulation past the duration of its scene, with a push that jumps twice, N."""
    push = "forces.push.force.0"
    simulation = stiffmbs.simulation(scene, inputs={push: -2.0})
    found = {name: [simulation[name]] for name in REACTIONS}
    for t in np.arange(505) * 1e-3:
        simulation.step(1e-3, {push: -2.0 if t < 0.2 else 3.0 if t < 0.35 else 0.5})
        for name in REACTIONS:
            found[name].append(simulation[name])
    return {name: np.array(values) for name, values in found.items()}


@pytest.mark.long
def test_simulations_restart_without_a_change_of_stiff_forces():
    """At jumps, and after the duration of the scene, the smallest move made reactions wrong by 1.4 times the largest.

    A force between bodies is as wrong as their accelerations, after a jump by a tolerance of velocities per step: 0.2 at 1e-4.
    """
    exact = simulated(four_bar("solver: radau, rtol: 1e-10"))
    for rtol in (7e-5, 3e-5):
        assert error(simulated(four_bar(f"solver: bdf, rtol: {rtol}", 1e14)), exact) < 0.05


@pytest.mark.parametrize("solver", ["bdf", "radau"])
@pytest.mark.parametrize("damping", [1e9, 1e11])
def test_corrections_of_velocities_keep_the_forces_of_strong_dampers(rigid_four_bar, solver, damping):
    """The smallest corrections of velocities made reactions wrong by 1.7 and 253 times the largest."""
    found = stiffmbs.run(four_bar(f"solver: {solver}, rtol: 1e-4", 1e8, damping))
    assert error(found, rigid_four_bar) < 0.01


@pytest.mark.parametrize(
    ("stiffness", "damping"), [(1e10, 7e8), (1e12, 7e9)], ids=["old matrix", "stiffness and damping equal"]
)
def test_radau_closes_every_state_within_a_step(rigid_four_bar, stiffness, damping):
    """One reaction was wrong by 19 times the largest: the matrix was too old at its place in the step.

    Other reactions were wrong by 0.05: the projection onto the constraints had changed forces, and ended too early.
    """
    found = stiffmbs.run(four_bar("solver: radau, rtol: 1e-4", stiffness, damping))
    assert error(found, rigid_four_bar) < 0.01
    assert not found.notes


@pytest.mark.long
def test_states_of_radau_that_stay_open_are_told():
    """One correction, in place of eight, does not suffice."""
    run = "solver: radau, rtol: 1e-4, errors: false, tuning: {polishing: {most_corrections: 1}}"
    note, _ = stiffmbs.run(four_bar(run, 1e10, 7e8)).notes
    assert "stiff forces do not balance" in note and "radau" not in note
