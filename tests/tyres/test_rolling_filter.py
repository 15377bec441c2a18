"""The rolling-radius filter: a disc on a profile, against its geometry."""

import math

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.describe.roads.rolling_filter import rolled
from stiffmbs.describe.table import Table
from stiffmbs.roads import TableRoad

RADIUS = 0.3


def heights(table, x):
    at, found = np.array(rolled(table, RADIUS).table).T
    return np.interp(x, at, found)


def test_a_disc_climbs_a_kerb_on_a_circle():
    kerb = Table(table=((0, 0), (5, 0), (5.0001, 0.1), (10, 0.1)), lines=True)
    x = np.array([2.0, 4.7, 4.8, 4.9, 4.99, 5.5, 8.0])
    expected = [0.0, *(max(0.0, 0.1 + math.sqrt(RADIUS**2 - (5 - s) ** 2) - RADIUS) for s in x[1:5]), 0.1, 0.1]
    assert heights(kerb, x) == pytest.approx(expected, abs=1e-3)


def test_a_disc_bridges_a_gap_and_keeps_a_slope():
    gap = Table(table=((0, 0), (4.95, 0), (4.951, -1), (5.049, -1), (5.05, 0), (10, 0)), lines=True)
    deepest = math.sqrt(RADIUS**2 - 0.05**2) - RADIUS
    assert heights(gap, np.array([5.0])) == pytest.approx([deepest], abs=1e-3)
    slope = Table(table=((0, 0), (10, 1)), lines=True)
    above = RADIUS * (math.hypot(1, 0.1) - 1)
    assert heights(slope, np.array([0.0, 3.0, 10.0])) == pytest.approx(np.array([0, 0.3, 1.0]) + above, abs=1e-5)


def test_waves_that_are_longer_than_the_disc_stay():
    x = np.linspace(0, 20, 401)
    z = 0.01 * np.sin(2 * np.pi * np.append(x[:-1], 0.0) / 10)
    waves = Table(table=tuple(zip(x, z, strict=True)), ends="periodic")
    found = np.array(rolled(waves, RADIUS).table)
    assert found[:, 1] == pytest.approx(0.01 * np.sin(2 * np.pi * found[:, 0] / 10), abs=2e-5)
    assert rolled(waves, RADIUS).ends == "periodic"


def test_a_road_has_the_filter():
    bump = {"table": [[0, 0], [4.99, 0], [5, 0.05], [5.01, 0], [10, 0]], "lines": True}
    road = TableRoad(profile=bump, filter_radius="300 mm")
    at, found = np.array(road.in_equations()["profile"].table).T
    assert np.interp(5.1, at, found) == pytest.approx(0.05 + math.sqrt(0.09 - 0.01) - 0.3, abs=1e-3)
    assert TableRoad(profile=bump).in_equations()["profile"].table == road.profile.table


def test_a_road_of_too_many_radii_is_refused():
    with pytest.raises(InputError, match="expected a road of at most 800 radii"):
        rolled(Table(table=((0, 0), (1000, 0))), 0.3)
