"""Air springs, hydraulic mounts and bushings that stiffen with frequency, against their formulas."""

import json

import numpy as np
import pytest

import stiffmbs

pytestmark = pytest.mark.long
AREA, VOLUME, EXPONENT, AMBIENT, LOAD = 0.04, 0.012, 1.38, 101325.0, 20e3


def on_a_guide(name, part, mass, gravity=0.0, position=(0, 0, 0), axis=(0, 0, 1), **entry):
    guide = {"type": "prismatic", "i": {"body": "b", "orientation": {"z": axis}}, "j": {"body": "ground", "point": position, "orientation": {"z": axis}}}  # fmt: skip
    found = {
        "dimensions": 3, "gravity": [0, 0, -gravity], "joints": {"guide": guide},
        "bodies": {"b": {"mass": mass, "inertia": [1, 1, 1], "position": position}},
        "parts": {"part": {"use": part, "mounts": {name: "b"}, **entry}},
    }  # fmt: skip
    return stiffmbs.read_scene(json.dumps(found))


def air_spring(mass):
    return on_a_guide("above", "air_spring", mass, 10, (0, 0.5, 0.6))


def test_an_air_spring_carries_by_the_law_of_gases():
    assert stiffmbs.equilibrium(air_spring(2000)).channels["b.z"] == pytest.approx(0.6)
    s = stiffmbs.equilibrium(air_spring(2500)).channels["b.z"] - 0.6
    pressure = (LOAD / AREA + AMBIENT) * (VOLUME / (VOLUME + AREA * s)) ** EXPONENT
    assert AREA * (pressure - AMBIENT) == pytest.approx(25e3, rel=1e-9)
    (mode,) = stiffmbs.modes(air_spring(2000)).modes
    stiffness = EXPONENT * (LOAD + AMBIENT * AREA) * AREA / VOLUME
    assert abs(mode.eigenvalues[0]) == pytest.approx(np.sqrt(stiffness / 2000), rel=1e-9)


def dynamic_stiffness(scene, axis, w, mass):
    """Force per displacement without the inertia of the body."""
    found = stiffmbs.transfer(scene, [f"b.f{axis}"], [f"b.{axis}"])
    response = found.c @ np.linalg.solve(1j * w * np.eye(len(found.a)) - found.a, found.b) + found.d
    return 1 / response[0, 0] + w**2 * mass


@pytest.mark.sampled(2)
@pytest.mark.parametrize("w", [10.0, 61.0, 300.0])
def test_the_dynamic_stiffness_of_a_hydraulic_mount(w):
    fluid = -(w**2) * 40 + 1j * w * 1200
    expected = 200e3 + 1j * w * 100 + 150e3 * fluid / (150e3 + fluid)
    found = dynamic_stiffness(on_a_guide("load", "hydromount", 100), "z", w, 100)
    assert found == pytest.approx(expected, rel=1e-7)


def test_a_hydraulic_mount_carries_on_its_rubber_alone():
    rest = stiffmbs.equilibrium(on_a_guide("load", "hydromount", 100, 10))
    assert rest.channels["b.z"] == pytest.approx(-100 * 10 / 200e3, rel=1e-9)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("axis", ["x", "z"])
@pytest.mark.parametrize("w", [1.0, 100.0, 1e4])
def test_a_bushing_stiffens_with_frequency(axis, w):
    static, more = {"x": (2e6, 1e6), "z": (5e5, 2.5e5)}[axis]
    direction = {"x": (1, 0, 0), "z": (0, 0, 1)}[axis]
    found = dynamic_stiffness(on_a_guide("other", "viscoelastic_bushing", 5, axis=direction), axis, w, 5)
    assert found == pytest.approx(static + more * 1j * w * 0.01 / (1 + 1j * w * 0.01), rel=1e-5)
