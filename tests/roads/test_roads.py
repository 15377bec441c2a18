"""Roads: their heights as a wheel sees them, random roads of ISO 8608, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from stiffmbs import InputError, Table, read_scene
from stiffmbs.compile.table_values import curve
from stiffmbs.roads import CosineBump, FlatRoad, FormulaRoad, Iso8608Road, Road, SineSweep, StepRoad, TableRoad
from stiffmbs.spatial import Body, Marker, Model, Prismatic, VelocityEquation, VerticalTyre

from ..tyres.wheels import reported, wheel

K = 1e5
PROFILE = Table(table=[(0, 0), (1, 0.02), (2, 0.0), (3, 0.01)], lines=True)


def load_at(road, x, y=0.0, deflection=0.03):
    """The load of an upright wheel at a place, pressed by a deflection on z = 0."""
    model = wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=K, road=road), 0.3, deflection, speed=0.0)
    body = model.bodies["wheel"]
    model.bodies["wheel"] = body.model_copy(update={"position": (x, y, body.position[2])})
    return reported(model)["load"]


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("road", "x", "height"),
    [
        (FlatRoad(z=0.01), 3.0, 0.01),
        (StepRoad(start=1, length=0.4, rise=0.02), 0.9, 0.0),
        (StepRoad(start=1, length=0.4, rise=0.02), 1.5, 0.02),
        (CosineBump(start=1, length=0.4, crest=0.02), 1.2, 0.02),
        (CosineBump(start=1, length=0.4, crest=0.02), 1.5, 0.0),
        (SineSweep(start=0, length=10, amplitude=0.01, first_wavelength=1, last_wavelength=1), 3.25, 0.01),
        (SineSweep(start=0, length=10, amplitude=0.01, first_wavelength=4, last_wavelength=0.8), 20.0, 0.0),
        (FormulaRoad(z="0.01*cos(x - 2)*cos(3*y)"), 2.0, 0.01),
    ],
)
def test_an_upright_wheel_stands_on_the_height_where_the_road_is_level(road, x, height):
    assert load_at(road, x) == pytest.approx(K * (0.03 + height), rel=1e-9)


@pytest.mark.long
def test_on_a_slope_the_load_is_along_the_normal():
    """A wheel whose plane is along a slope of angle a: the centre's distance from the plane is h cos(a)."""
    slope = 0.1
    found = reported(wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=K, road=FormulaRoad(z="0.1*x")), 0.3, 0.02))
    distance = 0.28 / math.hypot(1, slope)
    assert found["load"] == pytest.approx(K * (0.3 - distance), rel=1e-12)
    assert (found["fx"], found["fz"]) == pytest.approx(
        (-slope * found["load"] / math.hypot(1, slope), found["load"] / math.hypot(1, slope)), rel=1e-12
    )


def test_a_table_over_x():
    assert load_at(TableRoad(profile=PROFILE), 1.0, deflection=0.03) == pytest.approx(K * 0.05, rel=0.02)


@pytest.mark.long
def test_tables_for_two_tracks():
    raised = Table(table=[(0, 0.01), (3, 0.01)])
    road = TableRoad(left=raised, right=Table(table=[(0, 0), (3, 0)]), track=1.6)
    for y, height in ((0.8, 0.01), (1.2, 0.01), (-0.8, 0.0), (-2.0, 0.0)):
        assert load_at(road, 1.0, y) == pytest.approx(K * (0.03 + height), rel=1e-9)


class Dunes(Road):
    """A road of the user's own."""

    kind = "dunes"

    crest: float = 0.02

    @staticmethod
    def height(r, x, y):
        import sympy

        return r.crest * sympy.cos(x) * sympy.cos(y)


@pytest.mark.long
def test_a_road_of_the_users_own():
    assert load_at(Dunes(), 0.0) == pytest.approx(K * 0.05, rel=1e-9)


def test_density_of_a_random_road():
    """Gd(n) = 4^k 16e-6 m^3 (n/0.1)^-2 on average over seeds, for both tracks, with the coherence of an isotropic surface."""
    from scipy.special import k1

    length, track = 100.0, 1.4
    left, right, cross = 0.0, 0.0, 0.0
    seeds = range(60)
    for seed in seeds:
        parts = Iso8608Road(roughness="C", seed=seed, length=length, shortest=0.5, track=track).in_equations()
        x = np.arange(2000) * length / 2000
        waves = [np.fft.rfft(curve(parts[name])(x))[1:200] / 2000 for name in ("left", "right")]
        left, right = left + np.abs(waves[0]) ** 2, right + np.abs(waves[1]) ** 2
        cross = cross + waves[0] * waves[1].conj()
    n = np.arange(1, 200) / length
    density = 256e-6 * (n / 0.1) ** -2
    bands = np.array_split(np.arange(199), [4, 9, 19, 39, 79, 139])
    for track_density in (left, right):
        found = 2 * length * track_density / len(seeds)
        for band in bands:
            assert np.mean(found[band] / density[band]) == pytest.approx(1, abs=0.15)
    coherence = cross.real * 2 * length / len(seeds) / density
    for band in bands:
        expected = np.mean(2 * math.pi * n[band] * track * k1(2 * math.pi * n[band] * track))
        assert np.mean(coherence[band]) == pytest.approx(expected, abs=0.12)


def test_a_random_road_is_that_of_its_seed():
    one, same, other = (
        Iso8608Road(roughness="B", seed=seed, length=50).in_equations()["left"].table for seed in (1, 1, 2)
    )
    assert one == same
    assert one != other


def driven_over(road, speed, duration):
    """A mass on a tyre, driven at a constant speed over a road."""
    model = Model("quarter car", gravity=(0, 0, -9.81))
    body = Body(mass=300, inertia=(10, 10, 10), position=(0, 0, 0.3 - 300 * 9.81 / K), velocity=(speed, 0, 0))
    wheel_on = model.add("wheel", body)
    across = {"z": (0, 0, 1)}
    slide = model.add("slide", Body(mass=1, inertia=(1, 1, 1), position=(0, 0, 0), velocity=(speed, 0, 0)))
    model.add("up", Prismatic(i=wheel_on.at(0, 0, 0, across), j=slide.at(0, 0, 0, across)))
    along = {"z": (1, 0, 0)}
    model.add("along", Prismatic(i=slide.at(0, 0, 0, along), j=Marker(body="ground", orientation=along)))
    model.add("speed", VelocityEquation(i="slide", j="ground", zero=f"slide.vx - {speed}"))
    model.add("tyre", VerticalTyre(i="wheel", radius=0.3, stiffness=K, damping=1000, road=road))
    return model.run(duration=duration, output=1e-3)


@pytest.mark.long
def test_a_short_bump_at_speed_is_not_jumped_over():
    """The bump lasts 10 ms after 3 s of perfectly steady running; the impulse is that of a free mass on a moved spring."""
    solution = driven_over(CosineBump(start=90, length=0.3, crest=0.05), 30.0, 3.2)
    assert solution.success
    assert solution["tyre.load"].max() > 300 * 9.81 + 0.8 * K * 0.05
    before = solution.time < 2.99
    assert np.ptp(solution["wheel.z"][before]) < 1e-9


@pytest.mark.long
def test_a_wheel_lifts_off_behind_a_kerb_and_comes_down():
    solution = driven_over(StepRoad(start=5, length=0.3, rise=-0.2), 20.0, 5.0)
    assert solution.success
    assert solution["tyre.load"].min() == 0.0
    assert solution["tyre.load"][-1] == pytest.approx(300 * 9.81, rel=0.02)


SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {h: 20 mm}
tables: {curve: {table: [[0, 0], [1, 1 cm], [2, 0]]}}
roads:
  bumpy: {type: ROAD}
bodies:
  wheel: {mass: 20, inertia: [1, 1, 1], position: [0, 0, 0.29]}
forces:
  tyre: {type: vertical_tyre, i: wheel, radius: 300 mm, stiffness: 200 N/mm, damping: 500, road: NAME}
"""


def scene(road="cosine_bump, start: 1, length: 50 cm, crest: h", name="bumpy"):
    return read_scene(SCENE.replace("ROAD", road).replace("NAME", name))


def test_roads_of_a_scene_by_name():
    found = scene()
    assert found.forces["tyre"].road == CosineBump(start=1, length=0.5, crest=0.02)
    assert scene("table, profile: curve").forces["tyre"].road.profile.table[1] == (1.0, 0.01)
    again = read_scene(found_text(found))
    assert again.forces["tyre"].road == found.forces["tyre"].road


def found_text(found):
    from stiffmbs.model.model_text import model_text

    return model_text(found)


@pytest.mark.parametrize(
    ("road", "name", "said"),
    [
        ("hump", "bumpy", "found the type 'hump', expected one of 'flat'"),
        (
            "step, start: 1, length: 0, rise: 1",
            "bumpy",
            "roads.bumpy.length: found 0, expected a length greater than 0 m",
        ),
        ("flat", "smooth", "forces.tyre.road: found the unknown road 'smooth', expected one of bumpy"),
        ("formula, z: 2*x*x + t", "bumpy", "roads.bumpy.z: found t in '2*x*x + t'"),
        ("iso8608, roughness: K", "bumpy", "roads.bumpy.roughness: found 'K'"),
        ("table, profile: no", "bumpy", "found the unknown table 'no', expected one of curve"),
        ("iso8608, roughness: A, shortest: 1 m, longest: 50 cm", "bumpy", "found waves down to 1 m"),
    ],
)
def test_what_is_refused(road, name, said):
    with pytest.raises(InputError) as error:
        scene(road, name)
    assert said in str(error.value)
    assert "line" in str(error.value)


@pytest.mark.long
def test_a_quarter_car_answers_a_random_road_as_its_transfer_function_says():
    """The load's variance from the road's density and the linear model's response, over a long stretch (no lift-off)."""
    import stiffmbs

    path = Path(__file__).parents[2] / "examples" / "vehicles" / "quarter_car.yaml"
    changes = [
        ("roads.rough.start", "null"),
        ("roads.rough.roughness", "A"),
        ("run.output", "5 ms"),
        ("run.duration", "27 s"),
    ]
    solution = stiffmbs.run(stiffmbs.load_scene(path, changes))
    load = solution["tyre.load"][solution.time >= 27 - 250 / 20]
    n = np.arange(3, 834) / 250
    s = 2j * math.pi * n * 20
    k, kt, c, ct, m, mw = 20e3, 190e3, 1500, 100, 320, 38
    suspension, tyre = k + c * s, kt + ct * s
    wheel = tyre * (m * s**2 + suspension) / ((m * s**2 + suspension) * (mw * s**2 + suspension + tyre) - suspension**2)
    force = tyre * (1 - wheel)
    variance = np.sum(np.abs(force) ** 2 * 16e-6 * (n / 0.1) ** -2 / 250)
    assert np.std(load) == pytest.approx(math.sqrt(variance), rel=0.02)
    assert load.min() > 0
