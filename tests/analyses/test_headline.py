"""The sentence on the end of a run follows its notes."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses import rerun
from stiffmbs.solve.trajectory import IN_DOUBT, Outcome

FOUR_BAR = """
gravity: [0, -9.81]
bodies:
  a: {mass: 1, inertia: 0.1, position: [0, 0.5], angle: 90 deg}
  c: {mass: 1, inertia: 0.1, position: [0.75, 1]}
  b: {mass: 1, inertia: 0.1, position: [1.5, 0.5], angle: 90 deg}
joints:
  a0: {type: revolute, i: {body: a, point: [-0.5, 0]}, j: ground}
  ac: {type: revolute, i: {body: a, point: [0.5, 0]}, j: {body: c, point: [-0.75, 0]}}
  cb: {type: revolute, i: {body: c, point: [0.75, 0]}, j: {body: b, point: [0.5, 0]}}
  b0: {type: revolute, i: {body: b, point: [-0.5, 0]}, j: {body: ground, point: [1.5, 0]}}
forces: {p: {type: torque, i: a, torque: 1e7}, u: {type: torque, i: b, torque: -1e7}}
"""
GROWS = "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1, position: [1, 0]}}\nforces: {f: {type: force, i: b, force: ['9*b.x', 0]}}"


def test_constraint_drift_that_stays_is_in_the_headline(monkeypatch):
    """The run with exact constraints is cut, as where a mechanism locks."""
    exactly = rerun.exactly

    def cut(job):
        grid = replace(job.grid, end=0.1, times=job.grid.times[job.grid.times <= 0.1])
        return replace(exactly(job), grid=grid)

    monkeypatch.setattr(rerun, "exactly", cut)
    monkeypatch.setattr(rerun, "DRIFTED", 1e-9)
    scene = stiffmbs.read_scene(FOUR_BAR.replace("1e7", "1e2"))
    solution = stiffmbs.run(scene, solver="bdf", duration=3, points=61)
    assert any("constraint drift" in note and "may be wrong" in note for note in solution.notes)
    assert solution.message.startswith(f"{IN_DOUBT}: the reactions in '")


def test_drift_that_exact_constraints_have_removed_is_not():
    solution = stiffmbs.run(stiffmbs.read_scene(FOUR_BAR), solver="bdf", duration=3, points=61)
    assert solution.message == Outcome.DONE.value


@pytest.mark.parametrize("solver", ["bdf", "auto", "projected"])
def test_growth_beyond_sense_is_in_the_headline(solver):
    solution = stiffmbs.run(stiffmbs.read_scene(GROWS), solver=solver, duration=8, points=81)
    assert np.all(np.isfinite(solution["b.x"]))
    assert any("the motion diverges" in note for note in solution.notes)
    assert solution.message.startswith(f"{IN_DOUBT}: the motion diverges")
