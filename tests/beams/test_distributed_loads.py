"""Loads along beams that vary with the place, against closed forms of the Euler-Bernoulli cantilever, with its shear."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.spatial import AppliedForce

LENGTH, EI, GA, LOAD = 2.0, 1e5, 1e9, 3.0


def scene(force, elements=8, more="", stations="", interpolation="pairs", parameters="", dimensions=2):
    zero = ", 0" * (dimensions - 2)
    stiffness = f"[1e7, {GA}, {EI}]" if dimensions == 2 else f"[1e7, {GA}, {GA}, {EI}, {EI}, {EI}]"
    inertia = "0.01" if dimensions == 2 else "[0.02, 0.01, 0.01]"
    return f"""
dimensions: {dimensions}
parameters: {{q0: {LOAD} N/m, L: {LENGTH} m{parameters}}}
tables: {{lift: {{table: [[0 m, 0 N/m], [1 m, 3 N/m], [2 m, 0 N/m]], lines: true}}}}
bodies:
  bar: {{type: beam, start: [0, 0{zero}], end: [2, 0{zero}], elements: {elements}, stiffness: {stiffness}, mass_per_length: 3,
        inertia_per_length: {inertia}, interpolation: {interpolation}, stations: {{{stations}}}}}
joints: {{foot: {{type: fixed, i: bar.start, j: ground}}}}
forces: {{wind: {{type: distributed_load, beam: bar, force: [0, {force}{zero}]{more}}}}}
"""


def at_rest(*args, **fields):
    return stiffmbs.equilibrium(stiffmbs.read_scene(scene(*args, **fields))).channels


def deflection(load, first=0.0, last=LENGTH):
    """Return the deflection of the free end by a function of the place, of bending and shear, and the force and the moment."""
    points, weights = np.polynomial.legendre.leggauss(20)
    found = np.zeros(3)
    for a, b in zip(*[np.linspace(first, last, 201)[k:][:200] for k in (0, 1)], strict=True):
        x, w = (a + b) / 2 + (b - a) / 2 * points, (b - a) / 2 * weights
        q = load(x)
        found += w @ np.array([q * (x**2 * (3 * LENGTH - x) / (6 * EI) + x / GA), q, q * x]).T
    return found


FORMS = [
    ("q0*x/L", lambda x: LOAD * x / LENGTH),
    ("q0*(1 - x/L)", lambda x: LOAD * (1 - x / LENGTH)),
    ("q0*sin(pi*x/L)", lambda x: LOAD * np.sin(np.pi * x / LENGTH)),
    ("lift(x)", lambda x: LOAD * (1 - np.abs(x - 1))),
]


@pytest.mark.parametrize(("formula", "load"), FORMS, ids=[formula for formula, _ in FORMS])
@pytest.mark.parametrize(
    ("interpolation", "elements", "error"), [("pairs", 8, 1.3e-3), ("pairs", 16, 4e-4), ("spectral", 8, 2e-5)]
)
def test_a_load_that_varies_bends_a_cantilever(formula, load, interpolation, elements, error):
    """A station is where the table has its corner. Triangular loads: 11 q L^4/(120 E I) and q L^4/(30 E I)."""
    found = at_rest(f'"{formula}"', elements, stations="middle: 1 m", interpolation=interpolation)
    expected, force, moment = deflection(load)
    if formula == "q0*x/L":
        assert expected == pytest.approx(11 * LOAD * LENGTH**4 / (120 * EI) + LOAD * LENGTH**2 / (3 * GA))
    assert found["bar.end.y"] == pytest.approx(expected, rel=error)
    assert found["foot.fy"] == pytest.approx(-force, rel=error)
    assert found["foot.torque"] == pytest.approx(-moment, rel=error)


@pytest.mark.parametrize("interpolation", ["pairs", "spectral"])
@pytest.mark.parametrize("seed", range(5))
def test_a_load_on_a_part_has_its_resultant_and_moment(interpolation, seed):
    """For uniform loads wherever the part ends; at stations, the deflection is as accurate as that of a whole beam."""
    first, last = np.sort(np.random.default_rng(seed).uniform(0, LENGTH, 2))
    part = f", first: {first} m, last: {last} m"
    expected, force, moment = deflection(lambda x: LOAD + 0 * x, first, last)
    for stations, error in (("", 0.2), (f"a: {first} m, b: {last} m", 4e-3)):
        found = at_rest('"q0"', 9, part, stations, interpolation)
        assert found["foot.fy"] == pytest.approx(-force, rel=1e-9)
        assert found["foot.torque"] == pytest.approx(-moment, rel=1e-5)
        assert found["bar.end.y"] == pytest.approx(expected, rel=error)


@pytest.mark.parametrize("interpolation", ["pairs", "spectral"])
@pytest.mark.parametrize("seed", range(3))
def test_a_load_that_varies_on_a_part_has_its_resultant_and_moment(interpolation, seed):
    """Wherever the part ends within elements, and with a formula that has no value outside of it."""
    first, last = np.sort(np.random.default_rng(seed).uniform(0.1, LENGTH, 2)).tolist()
    part = f", first: {first!r} m, last: {last!r} m"
    for formula, load, error in (
        ("q0*x^2/L^2", lambda x: LOAD * x**2 / LENGTH**2, 1e-5),
        (f"q0*sqrt((x - {first!r} m)/L)", lambda x: LOAD * np.sqrt((x - first) / LENGTH), 0.02),
    ):  # fmt: skip
        expected, force, moment = deflection(load, first, last)
        found = at_rest(f'"{formula}"', 12, part, "", interpolation)
        assert found["foot.fy"] == pytest.approx(-force, rel=error)
        assert found["foot.torque"] == pytest.approx(-moment, rel=error)
        assert found["bar.end.y"] == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    "section",
    ["parameters: {x: 7 m}", "variables: {x: 7 m}", "inputs: {x: 7 m}", "states: {x: {rate: -x/1 s, start: 7 m}}"],
)
@pytest.mark.parametrize("in_part", [False, True])
def test_another_meaning_of_the_place_is_refused(section, in_part):
    """The load took the place for the name without a message."""
    text = """
bodies: {bar: {type: beam, start: [0, 0], end: [2, 0], elements: 2, stiffness: [1e7, 1e9, 1e5], mass_per_length: 3, inertia_per_length: 0.01}}
forces: {lift: {type: distributed_load, beam: bar, force: [0, 1 N/m^2*x]}}
"""
    if in_part:
        text = f"parts:\n  wing:{text.replace(chr(10), chr(10) + '    ')}\nuse: {{left: {{part: wing}}}}\n"
    with pytest.raises(
        InputError, match="found a name 'x' of the scene, which is the distance from the start of the beam here"
    ):
        stiffmbs.read_scene(text + section)


def test_the_parts_of_a_load_are_the_whole_load():
    whole, first, last = (
        stiffmbs.read_scene(scene("2 N/m", 5, more, "a: 0.7 m")) for more in ("", ", last: 0.7 m", ", first: 0.7 m")
    )
    for name, force in whole.forces.items():
        if name.startswith("wind."):
            parts = [
                float(one.forces[name].force[1].text.split(" ")[0][1:]) if name in one.forces else 0.0
                for one in (first, last)
            ]
            assert sum(parts) == pytest.approx(float(force.force[1].text.split(" ")[0][1:]))


def test_a_load_along_an_arc_is_over_its_length():
    """In space, on a quarter circle of radius 1 m, along z: the sum of q(x) dx and the moments about the start."""
    text = """
dimensions: 3
parameters: {k: 2 N/m^2}
bodies:
  bow: {type: beam, start: [1, 0, 0], through: [0.7071067811865476, 0.7071067811865476, 0], end: [0, 1, 0], elements: 32,
        stiffness: [1e9, 1e9, 1e9, 1e9, 1e9, 1e9], mass_per_length: 1, inertia_per_length: [0.02, 0.01, 0.01]}
joints: {foot: {type: fixed, i: bow.start.ground_axes, j: ground}}
forces: {load: {type: distributed_load, beam: bow, force: [0, 0, k*x]}}
"""
    found = stiffmbs.equilibrium(stiffmbs.read_scene(text)).channels
    assert found["foot.fz"] == pytest.approx(-2 * (np.pi / 2) ** 2 / 2, rel=1e-6)
    about_x = 2 * 1.0  # k * integral of x sin x
    assert found["foot.tx"] == pytest.approx(-about_x, rel=1e-4)


def test_a_load_of_place_and_time():
    found = stiffmbs.run(stiffmbs.read_scene(scene('"q0*x/L*sin(3 rad/s*t)"', 2)), duration=0.3, points=4)
    for t, force in zip(found.time, found["wind.end.fy"], strict=True):
        assert force == pytest.approx(LOAD * LENGTH / 6 * np.sin(3 * t), abs=1e-9)


def test_a_load_in_a_part_and_in_space():
    """The place is that along the beam of the part, in a mirrored one too."""
    part = """
dimensions: 3
parts:
  wing:
    bodies:
      spar: {type: beam, start: [0, 0, 0], end: [0, 2, 0], elements: 4, stiffness: [1e7, 1e9, 1e9, 1e5, 1e5, 1e5], mass_per_length: 3,
             inertia_per_length: [0.02, 0.01, 0.01]}
    joints: {foot: {type: fixed, i: spar.start.ground_axes, j: mount}}
    forces: {lift: {type: distributed_load, beam: spar, force: [0, 0, 3 N/m^2*x], first: 0.5 m}}
use: {left: {part: wing}, right: {part: wing, mirror: y}}
"""
    found = stiffmbs.equilibrium(stiffmbs.read_scene(part)).channels
    for side in ("left", "right"):
        assert found[f"{side}.foot.fz"] == pytest.approx(-3 * (4 - 0.25) / 2, rel=0.02)
    assert found["right.foot.tx"] == pytest.approx(-found["left.foot.tx"], rel=1e-9)
    assert all(
        isinstance(force, AppliedForce) for name, force in stiffmbs.read_scene(part).forces.items() if "lift" in name
    )


@pytest.mark.parametrize(("fields", "reason"), [
    ({"more": ", first: 1 m, last: 3 m"}, "forces.wind: found a load from 1 to 3 m, expected a part of the beam, 0 to 2 m"),
    ({"more": ", first: 1 m, last: 1 m"}, "found a load from 1 to 1 m"),
    ({"force": '"q0*x"'}, "found N and N/m"),
    ({"parameters": ", x: 2", "force": '"q0*x/L"'}, "forces.wind.force: found a name 'x' of the scene"),
    ({"force": "true"}, "forces.wind.force.1: found True"),
    ({"force": ".nan"}, "forces.wind.force.1: found "),
    ({"more": ", last: 2 kg"}, "forces.wind.last: found '2 kg'"),
])  # fmt: skip
def test_wrong_loads_are_refused(fields, reason):
    with pytest.raises(InputError, match=reason.replace("(", r"\(")):
        stiffmbs.read_scene(scene(**{"force": "2 N/m", **fields}))
