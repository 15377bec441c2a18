"""The bar pendulum: drift without projection, energy with it, and the pin's force at the bottom of the swing."""

import numpy as np
import pytest

import stiffmbs


@pytest.fixture(scope="module")
def scene(examples):
    return stiffmbs.load_scene(examples / "bar_pendulum.yaml")


@pytest.mark.long
@pytest.mark.parametrize(("step", "gap"), [(1e-3, 17.708), (5e-4, 8.850), (2.5e-4, 4.424)])
def test_gap_of_the_pin_without_projection(scene, step, gap):
    solution = stiffmbs.run(
        scene, solver="projected", scheme="euler_cromer", projection=False, step=step, points="steps"
    )
    assert 1e3 * solution["constraint.position"].max() == pytest.approx(gap, abs=5e-4)


@pytest.mark.parametrize(("step", "gain"), [(1e-3, 3.828), (5e-4, 1.873), (2.5e-4, 0.9265)])
def test_energy_gained_with_projection(scene, step, gain):
    """In percent of m g L/2, one step before the end, where the text's digits come out (at the end: 3.827, 1.873, 0.9264)."""
    solution = stiffmbs.run(scene, solver="projected", scheme="euler_cromer", step=step, points="steps")
    total = solution["energy.total"]
    assert 100 * (total[-2] - total[0]) / (1.2 * 9.81 * 0.3) == pytest.approx(gain, abs=6e-4 if gain > 1 else 6e-5)
    assert solution["constraint.position"].max() < 1e-12
    assert solution["constraint.velocity"].max() < 1e-13


def test_pin_carries_five_halves_of_the_weight_at_the_bottom(scene):
    solution = stiffmbs.run(scene, rtol=1e-9, duration=0.6, output=1e-5)
    assert solution["hinge.fy"].max() == pytest.approx(2.5 * 1.2 * 9.81, abs=1e-6)
    assert solution["hinge.fx"][np.argmax(solution["hinge.fy"])] == pytest.approx(0, abs=2e-3)


def test_energy_is_kept(scene):
    solution = stiffmbs.run(scene, rtol=1e-9)
    assert solution.energy_drift() < 1e-6
