"""Notes on forces that the rounding of coordinates changes."""

from types import SimpleNamespace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.run_checks import lost_digits

SCENE = """
gravity: [0, -9.81]
bodies:
  first: {mass: 1, inertia: 0.01, position: [0.1, 0]}
  second: {mass: 1, inertia: 0.01, position: [0.3, 0]}
joints: {pin: {type: revolute, i: {body: first, point: [-0.1, 0]}, j: ground}}
forces:
  bushing: {type: bushing, i: {body: first, point: [0.1, 0]}, j: {body: second, point: [-0.1, 0]}, stiffness: [STIFFNESS, STIFFNESS, 1e6]}
run: {duration: 0.1 s, points: 51, solver: radau, rtol: 1e-8}
"""


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("stiffness", ["1e9", "1e12", "1e15"])
def test_a_force_beyond_the_digits_of_coordinates_is_noted(stiffness):
    found = stiffmbs.run(stiffmbs.read_scene(SCENE.replace("STIFFNESS", stiffness)))
    notes = [note for note in found.notes if note.startswith("the force of 'bushing' is known to about")]
    assert len(notes) == (stiffness == "1e15")
    if notes:
        known = float(notes[0].split()[8])
        smooth = np.diff(found["pin.fy"][5:], 4)
        assert np.abs(smooth).max() / 70**0.5 < 10 * known  # fourth differences of rounding


@pytest.mark.parametrize(("lost", "noted"), [(0.9e-4, False), (1.1e-4, True)])
def test_a_change_of_a_ten_thousandth_of_the_largest_force_is_noted(lost, noted, monkeypatch):
    monkeypatch.setattr(lost_digits, "lost_digits", lambda state, t: ("strut", lost, 1.0))
    state = SimpleNamespace(q=np.zeros(1), u=np.zeros(1))
    rows = SimpleNamespace(t=np.zeros(1), **dict.fromkeys(("q", "u", "acceleration"), np.zeros((1, 1))))
    system = SimpleNamespace(mass=np.ones(1), per_velocity=lambda linear, angular: np.full(1, linear))
    found = list(lost_digits.lost_digits_notes(SimpleNamespace(state=state, system=system), rows))
    assert bool(found) == noted


def test_forces_that_fade_are_compared_with_the_largest_of_the_run():
    """A damped mass comes to rest where its spring has no force: rounding of 4e-10 N was noted."""
    mass = "gravity: [0, 0]\nbodies: {mass: {mass: 1, inertia: 1, position: [1.001, 0]}}\n"
    bushing = "forces: {bushing: {type: bushing, i: {body: mass, point: [-1, 0]}, j: ground, stiffness: [1e6, 1e6, 1e6], damping: [1e3, 1e3, 1e3]}}\n"
    found = stiffmbs.run(stiffmbs.read_scene(f"{mass}{bushing}run: {{duration: 0.1}}"), solver="bdf")
    assert abs(found["mass.x"][-1] - 1) < 1e-12
    assert not [note for note in found.notes if "is known to about" in note]


def test_forces_in_equilibrium_are_compared_with_each_other():
    """Their sum is zero: a mass at rest on its spring had a note on 4e-11 N."""
    mass = "gravity: [0, -9.81]\nbodies: {mass: {mass: 57, inertia: 1, position: [0, -0.00279585]}}\n"
    spring = "forces: {spring: {type: force, i: mass, force: [0, '-2e5*mass.y']}}\n"
    found = stiffmbs.run(stiffmbs.read_scene(f"{mass}{spring}run: {{duration: 0.1}}"), solver="bdf")
    assert not [note for note in found.notes if "is known to about" in note]
