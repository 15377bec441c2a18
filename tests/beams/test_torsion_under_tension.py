"""Tension stiffens the torsion of every section by N (I2 + I3)/A (Wagner 1929), and a beam of given stiffnesses by nothing."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.model.beams.section import Rectangle

E, NU, L, WIDTH, HEIGHT = 70e9, 0.3, 1.0, 0.06, 0.002
RECTANGLE = (
    f"section: {{type: rectangle, width: {WIDTH}, height: {HEIGHT}}}, material: {{E: {E}, nu: {NU}, density: 2700}}"
)


def scene(beam, interpolation, tension, damping=0.0):
    text = f"""
dimensions: 3
bodies:
  strip: {{type: beam, start: [0, 0, 0], end: [{L}, 0, 0], elements: 4, interpolation: {interpolation}, damping: {damping}, {beam}}}
joints:
  clamp: {{type: fixed, i: strip.start, j: ground}}
  guide: {{type: cylindrical, i: {{body: strip.end, orientation: {{z: [1, 0, 0]}}}}, j: {{body: ground, point: [{L}, 0, 0], orientation: {{z: [1, 0, 0]}}}}}}
forces:
  pull: {{type: force, i: strip.end, force: [{tension}, 0, 0]}}
  turn: {{type: torque, i: strip.end, torque: [1e-2, 0, 0]}}
run: {{duration: 0.01}}
"""
    return stiffmbs.read_scene(text)


def twist(*arguments):
    return 2 * np.arcsin(stiffmbs.equilibrium(scene(*arguments)).channels["strip.end.q1"])


@pytest.mark.parametrize("interpolation", ["pairs", "spectral"])
@pytest.mark.parametrize("tension", [5e3, 2e4])
def test_tension_stiffens_torsion(interpolation, tension):
    of = Rectangle(width=WIDTH, height=HEIGHT).properties(NU)
    expected = 1 + tension * (of.I2 + of.I3) / of.A / (E / (2 + 2 * NU) * of.J)
    ratio = twist(RECTANGLE, interpolation, 0.0) / twist(RECTANGLE, interpolation, tension)
    assert ratio == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("interpolation", ["pairs", "spectral"])
def test_a_beam_of_given_stiffnesses_is_that_of_reissner_and_simo(interpolation):
    given = "stiffness: [1e7, 4e6, 4e6, 10, 100, 1e4], mass_per_length: 1, inertia_per_length: [1e-3, 5e-4, 5e-4]"
    assert twist(given, interpolation, 5e3) == pytest.approx(twist(given, interpolation, 0.0), rel=1e-4)


@pytest.mark.long
@pytest.mark.parametrize("interpolation", ["pairs", pytest.param("spectral", marks=pytest.mark.long)])
def test_energy_is_kept_by_a_twisting_strip(interpolation):
    """Forces are derivatives of the energy with the stretch; a damped strip has the same static twist."""
    found = stiffmbs.run(scene(RECTANGLE, interpolation, 5e3), solver="radau", rtol=1e-8, points=11)
    balance = found["energy.total"] - found["energy.total"][0]
    work = 5e3 * (found["strip.end.x"] - L) + 1e-2 * 2 * np.arcsin(found["strip.end.q1"])
    assert np.max(np.abs(work)) > 1e-8
    assert np.max(np.abs(balance)) < 1e-5 * np.max(np.abs(work))  # the loads have potentials
    assert twist(RECTANGLE, interpolation, 5e3, 1e-4) == pytest.approx(twist(RECTANGLE, interpolation, 5e3), rel=1e-9)
