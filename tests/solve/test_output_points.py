"""Output points change no step: the state at the end is the same for any of them."""

import numpy as np
import pytest

from stiffmbs.compile.inputs.features import InputFeatures
from stiffmbs.solve.trajectory import Grid
from tests.stress.case import Outcome
from tests.stress.families.scales.output_points import EXAMPLES, POINTS, SOLVERS, load_scene, run, same_ends

SCENES = "andrews", "bouncing_ball", "cam_follower", "dead_centres"


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("scene", SCENES)
def test_bdf_takes_the_same_steps_for_all_output_points(scene):
    """The first step after a start or event was a part of the time to the next output: ends differed by 10 to 2000 tolerances."""
    described = load_scene(EXAMPLES / f"{scene}.yaml")
    counts = {run(described, points=points, rtol=1e-3, errors=False).solver["steps"] for points in POINTS}
    assert len(counts) == 1


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
def test_ends_do_not_depend_on_output_points(solver):
    verdict = same_ends(EXAMPLES / "bouncing_ball.yaml", SOLVERS[solver], 1e-3)
    assert verdict.outcome is Outcome.RIGHT, verdict


@pytest.mark.parametrize("times", [None, np.array([0.0])])
def test_a_grid_that_starts_just_after_its_end_has_no_negative_length(times):
    """A run up to its first sample, at the breakpoint where it starts, is empty."""
    grid = Grid(2e-16, 0.0, times).before_breakpoints(InputFeatures())
    assert grid.end == grid.start and (times is None or grid.times.tolist() == [grid.start])
