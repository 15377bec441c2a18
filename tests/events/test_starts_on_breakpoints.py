"""Laws that start exactly on a breakpoint, or touch one so that the value rounds to zero."""

import numpy as np
import pytest

import stiffmbs
from tests.stress.case import Outcome
from tests.stress.families.events import starts_on_breakpoints
from tests.stress.families.events.within_one_step import SOLVERS


@pytest.mark.sampled(20)
@pytest.mark.long
@pytest.mark.parametrize("case", starts_on_breakpoints.CASES, ids=lambda case: case.name)
def test_a_law_that_starts_on_a_breakpoint_is_felt(case):
    verdict = case.judge()
    assert verdict.outcome is Outcome.RIGHT, verdict


@pytest.mark.parametrize("solver", ["dop853", "dopri5"])
@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-9])
def test_no_stage_of_a_step_to_an_event_within_it_sees_the_law_beyond(solver, rtol):
    """Windows of 4.5 ms with a jump at both ends: a stage beyond the first one counts an eighth of the step."""
    scene = stiffmbs.read_scene(starts_on_breakpoints.STARTS["shallow windows 0.9999"].scene)
    solution = stiffmbs.run(scene, duration=10.0, points=2, rtol=rtol, **SOLVERS[solver])
    assert solution["b.vx"][-1] == pytest.approx(10.0, rel=1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_stays_on_a_breakpoint_is_left_alone(solver):
    """A body at rest that touches a stop: no event, and no motion."""
    scene = stiffmbs.read_scene("""
gravity: [0, 0]
bodies: {b: {mass: 1, inertia: 1, velocity: [0, 1]}}
forces: {f: {type: force, i: b, force: ["-1e6*max(0, b.x)", 0]}}
""")
    solution = stiffmbs.run(scene, duration=1.0, points=2, **SOLVERS[solver])
    assert solution.solver.get("events", 0) == 0
    np.testing.assert_allclose(solution["b.x"], 0.0, atol=1e-15)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6])
def test_a_table_that_rises_from_the_start_is_felt_from_there(solver, rtol):
    """The forces at the start and beyond the roof are zero: the first steps must see what lies between."""
    width, rate = 2e-6, 0.014
    scene = {
        "gravity": [0, 0], "bodies": {"b": {"mass": 1, "inertia": 1}}, "states": {"p": {"rate": str(rate), "start": 0.1}},
        "tables": {"roof": {"table": [[-1e6, 0], [0, 0], [0.25, 1], [1, 0], [1e6, 0]], "lines": True}},
        "forces": {"f": {"type": "force", "i": "b", "force": [f"{2 * rate / width!r}*roof((p - 0.1)/{width!r})", 0]}},
    }  # fmt: skip
    solution = stiffmbs.run(stiffmbs.read_scene(str(scene)), duration=0.4, points=2, rtol=rtol, **SOLVERS[solver])
    assert solution["b.vx"][-1] == pytest.approx(1.0, abs=10 * rtol)
