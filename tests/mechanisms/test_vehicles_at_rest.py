"""Vehicles that start from their rest: loads add up to the weight, and stay where they are on a level road."""

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLE_SCENES

LEVEL = {"quarter_car": "roads.rough", "half_car_at_rest": None, "bushing_axle": "roads.ramp"}
MASSES = {"quarter_car": 320 + 38, "half_car_at_rest": 1200 + 2 * 40}
"""Of the axle it is that of all its bodies."""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("name", LEVEL)
def test_a_vehicle_stays_at_rest_on_a_level_road(name):
    changes = [("V", "0"), *([(LEVEL[name], "{type: flat}")] if LEVEL[name] else [])]
    scene = stiffmbs.load_scene(EXAMPLE_SCENES[name], changes)
    mass = MASSES.get(name) or sum(body.mass for each, body in scene.bodies.items() if each != "tractor")
    run = stiffmbs.run(scene, duration=1.0, output=0.1)
    vertical = "y" if scene.dimensions == 2 else "z"
    loads = sum(run[f"{each}.f{vertical}"] for each in scene.forces if each.endswith("tyre"))
    assert loads == pytest.approx(mass * 9.81, rel=1e-9)
    assert np.ptp(run[f"{'body' if name == 'quarter_car' else 'chassis'}.{vertical}"]) < 1e-8


@pytest.mark.long
def test_the_half_car_from_its_rest_is_the_one_with_loads_by_hand():
    """The same car but for where its springs are in their laws: heights over the bump within a millimetre."""
    by_hand, sought = (stiffmbs.run(EXAMPLE_SCENES[name], duration=1.5) for name in ("half_car", "half_car_at_rest"))
    height = [run["chassis.y"] - run["chassis.y"][0] for run in (by_hand, sought)]
    assert np.ptp(height[0]) > 0.04
    assert np.max(np.abs(height[0] - height[1])) < 1e-3


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["leaf_sprung_car", "bushing_axle", "truck", "hatchback", "formula_student", "motorcycle", "car"])  # fmt: skip
def test_a_vehicle_starts_in_steady_motion(name):
    """No wheel is accelerated or braked at the start, and no body falls."""
    scene = stiffmbs.load_scene(EXAMPLE_SCENES[name])
    run = stiffmbs.run(scene, duration=2e-4, output=1e-4, rtol=1e-9)
    rates = {
        f"{body}.{c}": np.diff(run[f"{body}.{c}"])[0] / 1e-4
        for body in scene.bodies
        for c in ("vx", "vy", "vz", "wx", "wy", "wz")
    }
    worst = max(rates, key=lambda each: abs(rates[each]))
    assert abs(rates[worst]) < 0.05, (worst, rates[worst])
