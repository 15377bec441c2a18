"""A bushing that no mechanism is built for is named, though the run goes on."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial

FREE = (1, 1, 1, 0, 2, 2)
"""About the bushing's x the bodies turn as far as they like: what counts is the tilt."""


def thrown(stiffness, speed):
    """A ball on a bushing, turned by an initial speed to the largest angle w sqrt(J/k)."""
    axis = (speed, 0, 0) if stiffness[3] else (0, speed, 0)
    model = spatial.Model(gravity=(0, 0, 0))
    model.add("ball", spatial.Body(mass=1, inertia=(0.1, 0.1, 0.1), omega=axis))
    model.add("mount", spatial.Bushing(i="ball", j="ground", stiffness=stiffness))
    return stiffmbs.run(model, duration=1, rtol=1e-8, points=401)


@pytest.mark.long
@pytest.mark.parametrize("stiffness, limit", [((1, 1, 1, 2, 2, 2), np.pi), (FREE, np.pi / 2)])
def test_bodies_turned_beyond_use_are_told_with_the_first_instant(stiffness, limit):
    rate = np.sqrt(2 / 0.1)
    solution = thrown(stiffness, 1.1 * limit * rate)
    (note,) = (note for note in solution.notes if "'mount' rotates its bodies" in note)
    first = np.arcsin(1 / 1.1) / rate
    assert solution.success and float(note.partition("t = ")[2].split()[0]) == pytest.approx(first, abs=2.6e-3)


@pytest.mark.long
@pytest.mark.parametrize("stiffness, limit", [((1, 1, 1, 2, 2, 2), np.pi), (FREE, np.pi / 2)])
def test_within_use_nothing_is_told(stiffness, limit):
    solution = thrown(stiffness, 0.95 * limit * np.sqrt(2 / 0.1))
    assert not any("'mount'" in note for note in solution.notes)
