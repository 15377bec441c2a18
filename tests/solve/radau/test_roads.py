"""Steps to contacts and kinks of roads: they end, and are not taken for a force that chatters."""

import numpy as np
import pytest

import stiffmbs
from tests.stress.families.roads.cars_over_lines import CARS, PROFILES

LENGTH = 12.5
"""Path of a car along the road, m."""


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
@pytest.mark.parametrize(
    ("vehicle", "profile", "speed"),
    [
        ("car on bushings", "crest", 30.0),  # a kink at a restart, where the error estimate is rounding
        ("car on bushings", "pothole", 10.0),
        ("car on ideal joints", "crest", 20.0),  # three events within four steps
        ("car on ideal joints", "kerb", 20.0),
        ("car, left wheels", "pothole", 5.0),  # a stop just beyond a kink
        ("car, left wheels", "pothole", 30.0),
        ("car, left wheels", "bump", 15.0),
    ],
)
def test_a_car_passes_lines(vehicle, profile, speed, rtol):
    scene, road = CARS[vehicle]
    model, how = scene(road(PROFILES[profile]), speed), {"duration": max(LENGTH / speed, 0.8), "points": 101}
    found = stiffmbs.run(model, solver="radau", rtol=rtol, **how)
    assert found.message == "completed"
    exact = stiffmbs.run(model, solver="projected", scheme="dop853", rtol=1e-8, **how)
    for body in model.bodies:
        for axis in "xyz":
            np.testing.assert_allclose(found[f"{body}.{axis}"], exact[f"{body}.{axis}"], atol=max(1e-6, 30 * rtol))
