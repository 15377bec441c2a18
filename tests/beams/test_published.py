"""Stability, frequencies and deflections of beams against published formulas."""

import math

import numpy as np
import pytest
from numpy.polynomial import Legendre, Polynomial
from scipy.linalg import eigh

import stiffmbs
from stiffmbs import read_scene

from .scenes import at_rest


def column(load, end="", follower=False, n=8):
    """A clamped column of unit length and bending stiffness with an axial load at its end."""
    axes = ", axes: body" if follower else ""
    return read_scene(f"""
bodies:
  c: {{type: beam, start: [0, 0], end: [1, 0], elements: {n}, stiffness: [1e6, 1e6, 1], mass_per_length: 1, inertia_per_length: 1e-7}}
joints: {{a: {{type: fixed, i: c.start, j: ground}}{end}}}
forces: {{P: {{type: force, i: c.end, force: [{-load}, 0]{axes}}}}}
""")


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("end", "critical"),
    [
        ("", math.pi**2 / 4),
        (", b: {type: prismatic, i: c.end, j: ground}", 4 * math.pi**2),
        (", b: {type: point_on_line, i: c.end, j: ground}", 20.1907),
    ],
    ids=["free", "guided", "pinned"],
)
def test_a_column_buckles_at_the_load_of_euler(end, critical):
    for share in (0.97, 1.03):
        found = stiffmbs.equilibrium(column(share * critical, end))
        deflection = max(abs(found.channels[f"c.node{k}.y"]) for k in range(1, 8))
        assert (deflection > 1e-2) == (share > 1)


@pytest.mark.long
@pytest.mark.parametrize(("load", "flutters"), [(0.97 * 20.05, False), (1.03 * 20.05, True)])
def test_a_follower_load_makes_a_column_flutter(load, flutters):
    """Beck, Die Knicklast des einseitig eingespannten, tangential gedrueckten Stabes, ZAMP 3 (1952): 20.05 EI/L^2."""
    scene = column(load, follower=True, n=12)
    modes = stiffmbs.modes(scene, start_from=stiffmbs.equilibrium(scene).solution).modes
    assert (max(value.real for mode in modes for value in mode.eigenvalues) > 1e-3) == flutters


@pytest.mark.long
@pytest.mark.parametrize(("share", "buckles"), [(0.97, False), (1.03, True)])
def test_a_narrow_cantilever_buckles_sideways(share, buckles):
    """Prandtl (1899): 4.0126 sqrt(EI GJ)/L^2."""
    found = at_rest(f"""
dimensions: 3
bodies:
  c: {{type: beam, start: [0, 0, 0], end: [1, 0, 0], elements: 12, stiffness: [1e7, 1e7, 1e7, 0.6, 1e5, 1], mass_per_length: 1,
      inertia_per_length: [2e-4, 1e-4, 1e-4]}}
joints: {{a: {{type: fixed, i: c.start, j: ground}}}}
forces: {{P: {{type: force, i: c.end, force: [0, 0, {-share * 4.0126 * math.sqrt(0.6)!r}]}}}}
""")
    assert (abs(found["c.end.y"]) > 1e-2) == buckles


@pytest.mark.long
def test_a_taut_string_has_its_frequencies():
    scene = read_scene("""
bodies: {c: {type: beam, start: [0, 0], end: [1, 0], elements: 20, stiffness: [1e6, 1e6, 1e-4], mass_per_length: 1, inertia_per_length: 1e-8}}
joints: {a: {type: revolute, i: c.start, j: ground}, b: {type: point_on_line, i: c.end, j: ground}}
forces: {P: {type: force, i: c.end, force: [100, 0]}}
""")
    found = stiffmbs.modes(scene, start_from=stiffmbs.equilibrium(scene).solution)
    assert [mode.frequency for mode in found.modes[:3]] == pytest.approx([5, 10, 15], rel=2e-3)


@pytest.mark.long
@pytest.mark.parametrize(("form", "tolerance"), [("pairs", 7e-3), ("spectral", 2e-5)])
def test_a_pinned_timoshenko_beam_has_its_frequencies(form, tolerance):
    scene = read_scene(f"""
bodies:
  c: {{type: beam, start: [0, 0], end: [1, 0], elements: 16, interpolation: {form}, stiffness: [1e6, 100, 1], mass_per_length: 1,
      inertia_per_length: 0.01}}
joints: {{a: {{type: revolute, i: c.start, j: ground}}, b: {{type: revolute, i: c.end, j: {{body: ground, point: [1, 0]}}}}}}
""")
    expected = []
    for k in (1, 2, 3):
        a, b, c = 0.01 / 100, -(1 + (k * math.pi) ** 2 * (0.01 + 1 / 100)), (k * math.pi) ** 4
        expected.append(math.sqrt((-b - math.sqrt(b * b - 4 * a * c)) / (2 * a)) / math.tau)
    assert [mode.frequency for mode in stiffmbs.modes(scene).modes[:3]] == pytest.approx(expected, rel=tolerance)


def test_a_quarter_circle_bends_as_by_castigliano():
    """Under the load P at its end: pi P R^3/(4 EI) along the load, P R^3/(2 EI) across it."""
    found = at_rest(f"""
bodies:
  c: {{type: beam, start: [0, 0], through: [{1 - math.sqrt(0.5)!r}, {math.sqrt(0.5)!r}], end: [1, 1], elements: 8, stiffness: [1e7, 1e7, 1],
      mass_per_length: 1, inertia_per_length: 1e-4}}
joints: {{a: {{type: fixed, i: c.start.ground_axes, j: ground}}}}
forces: {{P: {{type: force, i: c.end, force: [0, -1e-4]}}}}
""")
    moved = [(found["c.end.x"] - 1) / 1e-4, (found["c.end.y"] - 1) / 1e-4]
    assert moved == pytest.approx([0.5, -math.pi / 4], rel=2e-4)


def flapping(rate):
    """First three frequencies of a clamped beam in rotation, by Ritz' method with polynomials, in root of EI/(m L^4)."""
    points, weights = np.polynomial.legendre.leggauss(40)
    x, w = (points + 1) / 2, weights / 2
    shapes = [Polynomial([0, 0, 1]) * Legendre.basis(k, domain=[0, 1]).convert(kind=Polynomial) for k in range(12)]
    f, slope, bend = (np.array([shape.deriv(k)(x) for shape in shapes]) for k in range(3))
    tension = rate**2 * (1 - x**2) / 2
    stiffness = (bend * w) @ bend.T + (slope * w * tension) @ slope.T
    return np.sqrt(eigh(stiffness, (f * w) @ f.T, eigvals_only=True)[:3])


def rotating(rate, n, interpolation="pairs", stiffness=""):
    """A bar that rotates about its end, rad/s over root of EI/(m L^4), and its frequencies in the same unit."""
    unit = math.sqrt(210e9 * 4e-3**2 / 12 / 7850)
    section = "section: {type: rectangle, width: 20 mm, height: 4 mm}, material: {E: 210 GPa, density: 7850}"
    scene = read_scene(f"""
dimensions: 3
bodies:
  b: {{type: beam, start: [0, 0, 0], end: [1 m, 0, 0], elements: {n}, interpolation: {interpolation}, omega: [0, 0, {rate * unit!r}],
      {stiffness or section}}}
joints: {{hub: {{type: revolute, i: b.start, j: ground}}}}
start: {{rotation: {rate * unit!r} rad/s}}
""")
    return np.array([math.tau * mode.frequency for mode in stiffmbs.modes(scene).modes]) / unit


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("rate", [2, 4, 10])
def test_a_rotating_cantilever_flaps_faster(rate):
    """Wright, Smith, Thresher, Wang (1982); shear and rotary inertia lower the third frequency by 2e-4."""
    expected = flapping(rate)

    def error(n, interpolation, k):
        return np.abs(rotating(rate, n, interpolation) / expected[k] - 1).min()

    for interpolation in ("pairs", "spectral"):
        for k, within in enumerate((4e-5, 2e-4, 4e-4)):
            assert error(16, interpolation, k) < within
    assert error(4, "pairs", 1) > 100 * error(16, "pairs", 1)


def test_a_stiff_beam_in_rotation_is_steady():
    """The pose a little later is so exact that a beam has no force of its own, with 1e6 times its bending stiffness."""
    stiffness = "stiffness: [1e6, 1e6, 1e6, 1e2, 1, 1e2], mass_per_length: 1, inertia_per_length: [2e-6, 1e-6, 1e-6]"
    assert len(rotating(0.3, 4, stiffness=stiffness))


@pytest.mark.long
@pytest.mark.parametrize("drive", ["", "  motor: {type: drive, joint: axle, position: 5*t}"])
def test_a_beam_on_a_rotating_hub_swings_in_its_plane_of_rotation_at_the_frequencies_of_the_rotating_frame(drive):
    """Ritz' method with the tension of a clamp at 0.5 m from the axis; `modes` names the analysis that has them."""
    points, weights = np.polynomial.legendre.leggauss(40)
    x, w = points + 1, weights
    shapes = [Polynomial([0] * (k + 2) + [0.5 ** (k + 2)]) for k in range(9)]
    f, slope, bend = (np.array([shape.deriv(k)(x) if k else shape(x) for shape in shapes]) for k in range(3))
    stiffness = (100 * bend * w) @ bend.T + (slope * w * 30 * ((4 - x**2) / 2 + 0.5 * (2 - x))) @ slope.T
    mass = 1.2 * (f * w) @ f.T
    expected = np.sqrt(eigh(stiffness - 25 * mass, mass, eigvals_only=True)[:2])
    text = f"""
dimensions: 3
bodies:
  hub: {{mass: 1, inertia: [1e9, 1e9, 1e9], omega: [0, 0, 5]}}
  b: {{type: beam, start: [0.5, 0, 0], end: [2.5, 0, 0], elements: 16, stiffness: [1e7, 1e7, 1e7, 1e4, 100, 100], mass_per_length: 1.2,
      inertia_per_length: [2e-6, 1e-6, 1e-6], velocity: [0, 2.5, 0], omega: [0, 0, 5]}}
joints:
  axle: {{type: revolute, i: hub, j: ground}}
  clamp: {{type: fixed, i: b.start, j: {{body: hub, point: [0.5, 0, 0]}}}}
{drive}
start: {{rotation: 5 rad/s}}
"""
    scene = read_scene(text)
    assert "motion=SteadyMotion(rotation=[0.0, 0.0, 5.0], about=[0.0, 0.0, 0.0])" in stiffmbs.modes(scene).notes[1]
    found = np.abs(
        stiffmbs.equilibrium(scene, motion=stiffmbs.SteadyMotion(rotation=[0, 0, 5], about=[0, 0, 0])).eigenvalues
    )
    for frequency in expected:
        assert np.min(np.abs(found / frequency - 1)) < 1e-4
