"""Recorded steps and further output times do not change results."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.results.error_bars import bars_by_difference
from tests.solve.test_stiff_reactions import four_bar
from tests.stress.families.stiffness.stiffness import bar_on_bushing


def same(first, second, every=1):
    """Return True if all channels of two runs are equal, those of the second at each `every`th time."""
    return all(np.array_equal(first[name], second[name][::every], equal_nan=True) for name in first)


@pytest.mark.parametrize("solver", ["radau", "bdf"])
@pytest.mark.parametrize(
    "scene", [lambda: bar_on_bushing(1e7), lambda: four_bar("rtol: 1e-4", 1e10, 7e8)], ids=["bar", "loop"]
)
def test_recording_changes_no_output(scene, solver):
    """Places within the steps of radau changed its outputs by 6e-9."""
    runs = [stiffmbs.run(scene(), solver=solver, duration=0.5, points=11, errors=errors) for errors in (False, True)]
    assert same(*runs) and runs[0].solver["steps"] == runs[1].solver["steps"]


@pytest.mark.long
def test_outputs_of_radau_do_not_depend_on_others():
    """A few outputs of a step were corrected one by one; the matrices for that stayed for the next steps."""
    few, many = (stiffmbs.run(four_bar("solver: radau, rtol: 1e-4", 1e10, 7e8), points=points) for points in (6, 501))
    for name in ("pin.fx", "bushing.fy", "a.angle"):
        assert np.allclose(few[name], many[name][::100], rtol=1e-8, atol=1e-8 * np.abs(many[name]).max())


RAMP = """
gravity: [0, -9.81]
bodies:
  cart: {mass: 3, inertia: 1, velocity: [0.75, 0]}
  bob: {mass: 1, inertia: 0.01, position: [0, -0.4], velocity: [0.75, 0]}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  pin: {type: revolute, i: {body: bob, point: [0, 0.4]}, j: cart}
  motor: {type: drive, joint: rail, position: "min(0.75*t, 1.5)"}
run: {duration: 4, points: 401}
"""


@pytest.mark.parametrize(
    "solver", [{"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"}]
)
def test_a_jump_at_a_breakpoint_is_no_peak_between_output_times(solver):
    """Velocities jump where the drive stops; bars of their peaks were 25 to 160 % of them."""
    solution = stiffmbs.run(stiffmbs.read_scene(RAMP), **solver)
    for channel in ("cart.vx", "bob.omega", "bob.vx", "pin.fy", "energy.total"):
        bar, size = solution.errors[channel], np.abs(solution[channel]).max()
        assert max(bar.sampled_least, bar.sampled_greatest) < 1e-3 * size, channel


def test_a_jump_at_an_event_between_own_steps_is_no_error():
    """A second run meets the event a little later: its value just after the own event is that before the jump."""
    times, at = np.array([0.0, 0.5, 1.0, 1.0 + 1e-6, 1.5, 2.0]), np.arange(6)
    own, other = np.array([1.0, 2.0, 3.0, 8.0, 9.0, 10.0]), np.array([1.0, 2.0, 3.0, 3.01, 9.1, 10.0])
    found = [
        bars_by_difference(times, at, {"f": own}, {"f": other}, 0.0, np.empty(0), 1000, close)["f"].over_time
        for close in (0.0, 1e-5)
    ]
    np.testing.assert_allclose(found, [4.99, 0.1])
