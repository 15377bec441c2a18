"""Notes on forces that the rounding of coordinates changes."""

import numpy as np
import pytest

import stiffmbs

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


@pytest.mark.parametrize("stiffness", ["1e9", "1e12", "1e15"])
def test_a_force_beyond_the_digits_of_coordinates_is_noted(stiffness):
    found = stiffmbs.run(stiffmbs.read_scene(SCENE.replace("STIFFNESS", stiffness)))
    notes = [note for note in found.notes if note.startswith("the force of 'bushing' is known to about")]
    assert len(notes) == (stiffness == "1e15")
    if notes:
        known = float(notes[0].split()[8])
        smooth = np.diff(found["pin.fy"][5:], 4)
        assert np.abs(smooth).max() / 70**0.5 < 10 * known  # fourth differences of rounding
