"""A force that moves over a bridge, against Fryba's series and statics of the simply supported beam."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError

LENGTH, EI, MASS, FORCE = 20.0, 2e9, 4000.0, 1e5
"""Length, m, bending stiffness, N m^2, mass per length, kg/m, and load, N, of a bridge."""


def bridge(place, force=f"[0, -{FORCE}]", elements=16, interpolation="pairs", dimensions=2, more="", beam="bridge"):
    zero = ", 0" * (dimensions - 2)
    stiffness = "[1e11, 1e12, 2e9]" if dimensions == 2 else "[1e11, 1e12, 1e12, 2e9, 2e9, 2e9]"
    inertia = "1" if dimensions == 2 else "[2, 1, 1]"
    turned = "" if dimensions == 2 else ", orientation: {z: [1, 0, 0]}"
    pin = "spherical" if dimensions == 3 else "revolute"
    place = "" if place == "" else f"place: {place}, "
    return stiffmbs.read_scene(f"""
dimensions: {dimensions}
gravity: [0, 0{zero}]
parameters: {{v: 30 m/s}}
bodies:
  bridge: {{type: beam, start: [0, 0{zero}], end: [{LENGTH}, 0{zero}], elements: {elements}, stiffness: {stiffness}, mass_per_length: {MASS},
           inertia_per_length: {inertia}, interpolation: {interpolation}, stations: {{middle: {LENGTH / 2}}}}}
joints:
  pin: {{type: {pin}, i: bridge.start, j: ground}}
  roller: {{type: point_on_line, i: bridge.end, j: {{body: ground{turned}}}}}
forces:
  {{axle: {{type: moving_load, beam: {beam}, {place}force: {force}{more}}}}}
run: {{duration: 1 s, points: 201, rtol: 1e-7, solver: radau}}
""")


def series(t, speed, terms=400):
    """Return the deflection in the middle under a force FORCE (Fryba, Vibration of Solids and Structures under Moving Loads, 1999)."""
    found = np.zeros_like(t)
    for j in range(1, terms, 2):
        own, driven = (j * np.pi / LENGTH) ** 2 * np.sqrt(EI / MASS), j * np.pi * speed / LENGTH
        shape = np.sin(j * np.pi / 2) / (own**2 - driven**2)
        found += shape * (np.sin(driven * t) - driven / own * np.sin(own * t))
    return -2 * FORCE / (MASS * LENGTH) * found


@pytest.mark.parametrize("interpolation, elements, error", [("pairs", 16, 6e-3), ("spectral", 8, 1.2e-3)])
def test_a_force_that_crosses_a_bridge_bends_it_as_the_series(interpolation, elements, error):
    solution = stiffmbs.run(bridge("v*t", elements=elements, interpolation=interpolation))
    on = solution.time <= LENGTH / 30
    expected = series(solution.time[on], 30.0)
    np.testing.assert_allclose(solution["bridge.middle.y"][on], expected, atol=error * np.max(np.abs(expected)))
    assert np.ptp(solution["bridge.middle.y"][~on]) > 0.1 * np.max(np.abs(expected))  # it swings on without a load


def test_the_error_falls_with_the_square_of_the_elements():
    errors = []
    for elements in (8, 16):
        solution = stiffmbs.run(bridge("v*t", elements=elements), duration=0.6)
        errors.append(np.max(np.abs(solution["bridge.middle.y"] - series(solution.time, 30.0))))
    assert 3.0 < errors[0] / errors[1] < 5.5


@pytest.mark.parametrize("place", [0.0, 0.7, 5.0, 13.3, 20.0])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_supports_carry_a_standing_load_by_the_lever(place, dimensions):
    zero = ", 0" * (dimensions - 2)
    found = stiffmbs.equilibrium(bridge(place, f"[0, -{FORCE}{zero}]", dimensions=dimensions)).channels
    assert found["pin.fy"] == pytest.approx(FORCE * (1 - place / LENGTH), abs=1e-5 * FORCE)
    assert found["roller.fy"] == pytest.approx(FORCE * place / LENGTH, abs=1e-5 * FORCE)


@pytest.mark.parametrize("place", [-0.1, 20.1])
def test_there_is_no_force_beyond_the_ends(place):
    found = stiffmbs.equilibrium(bridge(place)).channels
    assert found["pin.fy"] == pytest.approx(0.0, abs=1e-6)


def test_a_place_may_be_measured_and_a_load_may_follow_the_section():
    """Numbers and formulas of time and channels; half of the load at twice the place is the same for a lever."""
    scene = bridge('"10 m + 1e-9*bridge.middle.vy*(1 s)"', '[0, "-(1e5 N)*min(1, t/(0.1 s))"]', more=", axes: section")
    solution = stiffmbs.run(scene, duration=0.2)
    assert solution["axle.middle.fy"][-1] == pytest.approx(-FORCE, rel=1e-6)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"place": ""}, "place: found nothing, expected a value"),
        ({"place": "1 m", "beam": "bridg"}, "found the unknown beam 'bridg' (did you mean 'bridge'?)"),
        ({"place": "1 m", "force": "[1]"}, "found 1 components, expected two in the plane or three in space"),
        ({"place": "'2 kg'"}, "expected"),
    ],
)
def test_a_wrong_load_is_refused_in_a_sentence(given, words):
    with pytest.raises(InputError) as refused:
        bridge(**given)
    assert words in str(refused.value)
    assert "axle" in str(refused.value)
