"""Reactions next to a very stiff bushing, against those of a fixed joint in its place."""

import numpy as np
import pytest

import stiffmbs

ENDS = "i: {body: first, point: [0.1, 0]}, j: {body: second, point: [-0.1, 0]}"
REACTIONS = ("pin.fx", "pin.fy")
FADED = 20
"""Output times after which the vibration from the start has faded."""


def pendulum(run, stiffness=None):
    """Return two bars joined by a damped bushing, N/m, or by a fixed joint."""
    damping = 0.1 * np.sqrt(stiffness / 2) if stiffness else 0.0
    force = f"bushing: {{type: bushing, {ENDS}, stiffness: [{stiffness}, {stiffness}, {stiffness}/1e4], damping: [{damping}, {damping}, {damping}/1e4]}}"
    return stiffmbs.read_scene(f"""
gravity: [0, -9.81]
bodies:
  first: {{mass: 1, inertia: 0.01, position: [0.1, 0], velocity: [0, 0.5], omega: 5}}
  second: {{mass: 1, inertia: 0.01, position: [0.3, 0], velocity: [0, 1.5], omega: 5}}
joints:
  pin: {{type: revolute, i: {{body: first, point: [-0.1, 0]}}, j: ground}}
  {"" if stiffness else f"weld: {{type: fixed, {ENDS}}}"}
{"forces: {" + force + "}" if stiffness else ""}
run: {{duration: 0.5 s, points: 501, {run}}}
""")


@pytest.fixture(scope="module")
def rigid():
    solution = stiffmbs.run(pendulum("solver: bdf, rtol: 1e-10"))
    return {name: solution[name] for name in REACTIONS}


def error(found, rigid):
    """Return the largest error of a reaction, relative to the largest reaction."""
    largest = max(np.abs(values).max() for values in rigid.values())
    count = len(found["pin.fx"])
    return max(np.abs(found[name] - rigid[name][:count])[FADED:].max() for name in REACTIONS) / largest


@pytest.mark.parametrize("stiffness", [1e12, 1e14])
def test_spurious_forces_between_steps_are_removed(rigid, stiffness):
    """Their moments spoiled the matrix of the correction: reactions were wrong by 4000 times the largest at 1e14 N/m."""
    assert error(stiffmbs.run(pendulum("solver: bdf, rtol: 1e-4", stiffness)), rigid) < 0.01


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


def test_interpolated_states_that_cannot_be_corrected_are_told():
    """One correction, in place of eight, does not suffice."""
    (note,) = interpolated("solver: bdf, rtol: 1e-3, tuning: {polishing: {most_corrections: 1}}")
    assert "stiff forces do not balance" in note and "solver: radau" in note
    assert not interpolated("solver: bdf, rtol: 1e-4")
