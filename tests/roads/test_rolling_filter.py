"""The rolling-radius filter: a disc on a profile, against its geometry."""

import math

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.elements.roads.rolling_filter import heights_of, rolled
from stiffmbs.reading.table import Table
from stiffmbs.roads import CosineBump, FlatRoad, FormulaRoad, Iso8608Road, Road, SineSweep, StepRoad, TableRoad
from stiffmbs.spatial import VerticalTyre

from ..tyres.wheels import reported, wheel

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
    with pytest.raises(InputError, match="expected a road of at most 2000 radii"):
        rolled(Table(table=((0, 0), (1000, 0))), 0.3)


def rolled_height(road, x):
    """What a wheel sees of a road with the filter, and the largest over a fine profile by the definition."""
    at, found = np.array(road.in_equations()["rolled"].table).T
    s = np.linspace(-RADIUS, RADIUS, 60001)
    return np.interp(x, at, found), np.max(road.profile_heights(x + s) + np.sqrt(RADIUS**2 - s**2)) - RADIUS


@pytest.mark.parametrize(
    "road",
    [
        StepRoad(start=5, length=0.05, rise=0.1, filter_radius=RADIUS),
        StepRoad(start=5, length=0.05, rise=-0.1, filter_radius=RADIUS),
        CosineBump(start=5, length=0.2, crest=-0.05, filter_radius=RADIUS),
        SineSweep(start=4.5, length=2, amplitude=0.02, first_wavelength=1, last_wavelength=0.2, filter_radius=RADIUS),
        FormulaRoad(z="0.03*sin(20*x) + step(x, 4.9, 0, 5, 0.02)", first=3, last=8, filter_radius=RADIUS),
    ],
    ids=lambda road: road.kind,
)
def test_roads_by_equations_have_the_filter(road):
    for x in (4.0, 4.85, 4.95, 5.1, 5.3, 6.9):
        found, expected = rolled_height(road, x)
        assert found == pytest.approx(expected, abs=6e-5)


def test_tracks_of_a_random_road_have_the_filter():
    road, plain = (Iso8608Road(roughness="E", length=20, filter_radius=r).in_equations() for r in (RADIUS, None))
    at, found = np.array(road["left"].table).T
    profile = Table.model_construct(table=plain["left"].table, ends="periodic", lines=False, akima=False)
    s = np.linspace(-RADIUS, RADIUS, 20001)
    expected = np.max(heights_of(profile, 7.3 + s) + np.sqrt(RADIUS**2 - s**2)) - RADIUS
    assert np.interp(7.3, at, found) == pytest.approx(expected, abs=2e-5)
    assert "rolled" not in FlatRoad(filter_radius=RADIUS).in_equations()


@pytest.mark.parametrize(
    ("road", "said"),
    [
        (lambda: FormulaRoad(z="0.1*x", filter_radius=0.3), "expected all three or none"),
        (lambda: FormulaRoad(z="0.1*y", first=0, last=1, filter_radius=0.3), "expected a formula of x only"),
        (lambda: FormulaRoad(z="x", first=2, last=1, filter_radius=0.3), "expected it after first = 2 m"),
        (lambda: Dunes(filter_radius=0.3), "without an extent"),
    ],
)
def test_what_the_filter_needs_to_know(road, said):
    with pytest.raises(InputError, match=said):
        road()


class Dunes(Road):
    """A road of the user's own, that goes on for ever."""

    kind = "endless_dunes"


class ShiftedKerb(StepRoad):
    """A kerb that is counted from another place."""

    kind = "shifted_kerb"

    origin: float = 0.0

    @staticmethod
    def place(r, e, x, y):
        return x - r.origin, y


class ScaledTable(TableRoad):
    """A table whose heights are scaled."""

    kind = "scaled_table"

    scale: float = 1.0

    @staticmethod
    def height(r, x, y):
        return r.scale * r.profile(x)


@pytest.mark.long
def test_a_filtered_road_of_the_users_own_keeps_its_other_fields():
    sizes = {"start": 0.1, "length": 0.001, "rise": 0.05, "filter_radius": RADIUS}
    plain, shifted = (
        reported(wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=1e5, road=road), 0.3))["deflection"]
        for road in (StepRoad(**sizes), ShiftedKerb(**sizes, origin=5.0))
    )
    assert plain > 0.01
    assert shifted == pytest.approx(0, abs=1e-9)
    flat = Table(table=[(-3, 0.01), (3, 0.01)])
    road = ScaledTable(profile=flat, scale=2.0, filter_radius=RADIUS)
    found = reported(wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=1e5, road=road), 0.3))["deflection"]
    assert found == pytest.approx(0.02, rel=1e-6)


@pytest.mark.long
def test_a_wheel_climbs_a_filtered_kerb():
    """It stands a hand before the kerb, on the circle about its edge."""
    kerb = StepRoad(start=0.1, length=0.001, rise=0.05, filter_radius=RADIUS)
    rise = 0.05 + math.sqrt(RADIUS**2 - 0.1**2) - RADIUS
    found = reported(wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=1e5, road=kerb), 0.3))
    assert found["deflection"] == pytest.approx(rise, rel=0.15)  # along the slope's normal
