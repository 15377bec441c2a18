"""Line forces and springs need points that are apart: a place of both gives them no direction."""

import pytest

import stiffmbs
from stiffmbs import spatial


def test_points_at_one_place_but_for_rounding_give_a_line_force_no_direction():
    """0.1 + 0.2 is not 0.3 in binary; a micrometre is apart."""
    for gap, together in ((0.0, True), (1e-6, False)):
        model = spatial.Model()
        model.add("ball", spatial.Body(mass=1, inertia=(1, 1, 1), position=(0.3 + gap, 0, 0)))
        post = spatial.Marker(body="ground", point=(0.1 + 0.2, 0, 0))
        model.add("force", spatial.LineForce(i="ball", j=post, force=10.0))
        if not together:
            model.data()
            continue
        with pytest.raises(stiffmbs.InputError, match=r"forces\.force: found both of its points at one place"):
            model.data()


def test_a_spring_of_free_length_needs_points_apart():
    model = spatial.Model()
    model.add("ball", spatial.Body(mass=1, inertia=(1, 1, 1)))
    model.add("spring", spatial.SpringDamper(i="ball", j="ground", stiffness=1, free_length=0.1))
    with pytest.raises(stiffmbs.InputError, match=r"forces\.spring: found both of its points at one place"):
        model.data()
