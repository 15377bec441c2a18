"""Loads of Magic Formula tyres by curves, contact of the rim, and ranges that are left, of property files."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.spatial import MagicFormulaTyre
from stiffmbs.tyres import TyreProperties

from .test_property_files import FILE
from .wheels import reported, wheel

CURVE = "[DEFLECTION_LOAD_CURVE]\n{pen fz}\n0 0.0\n10 3.0\n20 5.0\n30 8.0\n"
RIM = "[DIMENSION]\nBOTTOMING_RADIUS = 280\n[BOTTOMING_CURVE]\n{pen fz}\n0 0\n10 20\n"


@pytest.fixture
def tyre(tmp_path):
    def read(added):
        (tmp_path / "front.tir").write_text(FILE + added)
        return TyreProperties.from_file(tmp_path / "front.tir")

    return read


def loaded(properties, deflection, camber=0.0, **more):
    return reported(wheel(MagicFormulaTyre(i="wheel", properties=properties), 0.32, deflection, camber=camber, **more))


@pytest.mark.long
@pytest.mark.parametrize(("deflection", "load"), [(0.01, 3000), (0.02, 5000), (0.03, 8000), (-0.001, 0)])
def test_the_load_is_that_of_the_curve(tyre, deflection, load):
    """In mm and kN, the units of the file; VERTICAL_STIFFNESS plays no part, and its damping stays."""
    assert loaded(tyre(CURVE), deflection)["load"] == pytest.approx(load, abs=1e-9)


@pytest.mark.long
def test_a_curve_counts_as_the_stiffness_that_it_has_everywhere(tyre):
    straight = "[DEFLECTION_LOAD_CURVE]\n0 0\n10 2\n40 8\n"
    for camber in (0.0, 0.05):
        one, other = (loaded(tyre(added), 0.017, camber, slip_angle=0.05) for added in (straight, ""))
        assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ("[DEFLECTION_LOAD_CURVE]\n0 0\n10 2 3\n", "found a row without exactly two numbers"),
        ("[DEFLECTION_LOAD_CURVE]\n10 0\n0 2\n", "expected increasing arguments"),
        ("[DEFLECTION_LOAD_CURVE]\n0 0\n", "[DEFLECTION_LOAD_CURVE]"),
    ],
)
def test_curves_that_make_no_sense_are_refused_with_their_line(tyre, added, said):
    with pytest.raises(InputError) as error:
        tyre(added)
    assert said in str(error.value)
    assert "front.tir, line" in str(error.value)


def by_strips(depth, camber, width, count=200_000):
    """Force of 2 MN/m on the mean penetration of strips across the rim, and its moment about the middle."""
    y = (np.arange(count) + 0.5) / count * width - width / 2
    pressed = np.maximum(depth - y * np.tan(camber), 0)
    mean = pressed.mean()
    return 2e6 * mean, 2e6 * (y * pressed).mean()


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("camber", [0.0, 0.03, -0.03, 0.1, -0.2])
@pytest.mark.parametrize("deflection", [0.02, 0.038, 0.0401, 0.045, 0.06])
def test_the_rim_presses_on_the_road_by_its_curve(tyre, deflection, camber):
    with_rim, without = (
        loaded(tyre(f"{added}[MORE]\nWIDTH = 200\nQSX1 = 0\n"), deflection, camber) for added in (RIM, "")
    )
    force, moment = by_strips(deflection - 0.04, camber, 0.2)
    assert with_rim["load"] - without["load"] == pytest.approx(force, rel=1e-6, abs=1e-3)
    assert with_rim["overturning"] - without["overturning"] == pytest.approx(moment, rel=1e-5, abs=1e-3)
    for name in ("longitudinal", "lateral", "rolling", "aligning"):
        assert with_rim[name] == pytest.approx(without[name], rel=1e-12, abs=1e-9)


RANGES = "[VERTICAL_FORCE_RANGE]\nFZMIN = 0.1\nFZMAX = {load}\n[LONG_SLIP_RANGE]\nKPUMIN = -{slip}\nKPUMAX = {slip}\n[SLIP_ANGLE_RANGE]\nALPMIN = -{angle}\nALPMAX = {angle}\n[INCLINATION_ANGLE_RANGE]\nCAMMIN = -{camber}\nCAMMAX = {camber}\n"
WITHIN = {"load": 10, "slip": 1.5, "angle": 12, "camber": 10}
"""kN and degrees, as the file has them."""


@pytest.mark.parametrize("duration", [0.002, 0.01])
@pytest.mark.parametrize(
    ("narrow", "said"),
    [
        ({}, ""),
        ({"load": 1}, "load reaches 2000"),
        ({"slip": 1e-4}, "slip reaches"),
        ({"angle": 2}, "slip_angle reaches"),
        ({"camber": 1}, "camber reaches 0.05"),
        ({"load": 1, "angle": 2}, "slip_angle reaches"),
    ],
)
def test_ranges_that_are_left_are_noted_with_the_extremes(tyre, narrow, said, duration):
    properties = tyre(RANGES.format(**{**WITHIN, **narrow}))
    model = wheel(MagicFormulaTyre(i="wheel", properties=properties), 0.32, 0.01, 0.05, 0.05, spin=30)
    notes = [note for note in model.run(duration=duration, points=5).notes if "leaves the valid ranges" in note]
    assert bool(notes) == bool(said)
    assert not said or (said in notes[0] and notes[0].startswith("'tyre' leaves") and "valid from" in notes[0])


def test_a_tyre_in_the_air_leaves_no_range(tyre):
    properties = tyre("[LONG_SLIP_RANGE]\nKPUMAX = 0.001\n[INCLINATION_ANGLE_RANGE]\nCAMMAX = 1\n")
    model = wheel(MagicFormulaTyre(i="wheel", properties=properties), 0.32, -0.2, camber=0.1)
    assert not any("leaves the valid ranges" in note for note in stiffmbs.run(model, duration=0.01).notes)


@pytest.mark.long
def test_the_deflection_at_a_load_is_that_of_the_curve():
    """At its points, and beyond them with the slope of its end."""
    numbers = {
        "FNOMIN": 4e3,
        "UNLOADED_RADIUS": 0.32,
        "VERTICAL_STIFFNESS": 2e5,
        "PCX1": 1.6,
        "PDX1": 1.0,
        "PKX1": 20.0,
    }
    numbers |= {"PCY1": 1.3, "PDY1": 1.0, "PKY1": -14.0, "PKY2": 1.8}
    curve = {"table": [[0, 0], [0.01, 1900], [0.03, 6500]]}
    tyre = TyreProperties(coefficients=numbers, deflection_load=curve)
    assert tyre.steady_state([0, 1900, 6500])["rho"] == pytest.approx([0, 0.01, 0.03], abs=1e-12)
    ends = tyre.steady_state([6501, 6502, 7500])["rho"]
    assert (ends[2] - 0.03) == pytest.approx(1000 * (ends[1] - ends[0]), rel=1e-8)
    assert tyre.steady_state([6500])["Rl"] == pytest.approx([0.29])
