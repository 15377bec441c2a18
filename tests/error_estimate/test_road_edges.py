"""Errors across events whose functions jump: a tyre over the edges of a road, where the rate of its deflection changes at once."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.error_estimate import restarts
from tests.error_estimate.test_against_truth import ratio

QUARTER_CAR = """
dimensions: 3
gravity: [0, 0, -9.81]
roads:
  hole:
    type: table
    profile: {table: [[-100, 0], [1.946, 0], [1.966, -0.02], [2.227, -0.02], [2.247, 0], [1000, 0]], lines: true}
bodies:
  body: {mass: 239.4, inertia: [30, 30, 30], position: [0, 0, 0.51701], velocity: [8.333, 0, 0]}
  wheel: {mass: 57.46, inertia: [1, 1, 1], position: [0, 0, 0.286838], velocity: [8.333, 0, 0]}
joints:
  level: {type: orientation, i: body, j: ground}
  guide: {type: prismatic, i: wheel, j: body}
forces:
  spring: {type: force, i: body, j: wheel, force: [0, 0, "-33632*(dz(body) - dz(wheel) - 0.3) - 1500*(vz(body) - vz(wheel))"]}
  tyre: {type: vertical_tyre, i: wheel, road: hole, radius: 0.3, stiffness: 221288, damping: 2000}
run: {duration: 0.5, output: 0.005}
"""


@pytest.fixture(scope="module")
def truth():
    return stiffmbs.run(stiffmbs.read_scene(QUARTER_CAR), solver="radau", rtol=1e-11, errors=False)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver, rtol", [("bdf", 1e-3), ("bdf", 1e-5), ("radau", 1e-4)])
def test_edges_of_a_road(truth, solver, rtol):
    """The delay of an event that another one causes was that of a smooth function: errors of 190 %, or a lost solution."""
    found = stiffmbs.run(stiffmbs.read_scene(QUARTER_CAR), solver=solver, rtol=rtol, errors=True)
    assert not any("estimated error" in note for note in found.notes) and found.estimate.status == "estimated"
    for channel in ("wheel.z", "wheel.vz", "body.z"):
        assert 0.3 < ratio(found, channel, truth[channel]) < 3.0 or found.errors[channel].over_time < 1e-9 * np.ptp(
            truth[channel]
        )


LANDING = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.5], velocity: [0.3, 0, 0]}}
joints: {level: {type: orientation, i: ball, j: ground}}
forces:
  touch: {type: force, i: ball, j: ground, force: [0, 0, "branch(ball.z, -1e4*ball.z - 60*ball.vz, 0, 0)"]}
run: {duration: 1, points: steps, rtol: 1e-6}
"""


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_row_at_the_jump_of_a_force(solver):
    """The row at an event had the jump of a force as its error, and as a peak between output times."""
    found = stiffmbs.run(stiffmbs.read_scene(LANDING), solver=solver, errors=True)
    assert "estimated error" not in " ".join(found.notes)
    bar, size = found.errors["touch.fz"], np.abs(found["touch.fz"]).max()
    assert bar.over_time < 1e-3 * size
    assert max(bar.sampled_least, bar.sampled_greatest) < 0.05 * size


@pytest.mark.parametrize("late", [0.0, 2e-13, -3e-12])
def test_the_nearest_crossing_of_a_function_that_changes_its_sign_for_an_instant(late):
    """Two wheels met an edge within 9 ns, and the function of one jumped twice: a delay of 7 s was found, and a solution lost."""

    def value(later):
        return 2349.0 if late - 9.5e-9 < later <= late else -41.8 if abs(later) < 1.0 else 300.0

    assert restarts._crossing(value, 1e-7) == pytest.approx(late, abs=1e-13)


def test_a_function_within_rounding_of_zero_may_have_another_sign_when_it_is_evaluated_again():
    """A run of bdf in index1 ended in an error of SciPy."""
    signs = iter([-1.0, 1.0])

    def value(later):
        return next(signs, 1.0)

    assert abs(restarts._crossing(value, 1e-7)) <= 1e-7
