"""Line forces and springs need points that are apart: a place of both gives them no direction."""

import pytest

import stiffmbs
from stiffmbs import spatial
from stiffmbs.model.model_data import ModelData


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
        with pytest.raises(stiffmbs.InputError, match=r"forces\.force: found both of its points in the same place"):
            model.data()


def test_a_spring_of_free_length_needs_points_apart():
    model = spatial.Model()
    model.add("ball", spatial.Body(mass=1, inertia=(1, 1, 1)))
    model.add("spring", spatial.SpringDamper(i="ball", j="ground", stiffness=1, free_length=0.1))
    with pytest.raises(stiffmbs.InputError, match=r"forces\.spring: found both of its points in the same place"):
        model.data()


def test_many_springs_ask_little_more_for_each_than_few(monkeypatch):
    """Whether points are at one place depends on the size of the mechanism, which is the same for all springs."""
    asked = []
    point = ModelData.point
    monkeypatch.setattr(ModelData, "point", lambda model, marker: asked.append(marker) or point(model, marker))
    counts = []
    for many in (10, 40):
        del asked[:]
        model = stiffmbs.Model()
        for k in range(many):
            model.add(f"ball{k}", stiffmbs.Body(mass=1, inertia=1, position=(k, 0)))
            post = stiffmbs.Marker(body="ground", point=(k, 1))
            model.add(f"spring{k}", stiffmbs.SpringDamper(i=f"ball{k}", j=post, stiffness=1, free_length=1))
        model.data()
        counts.append(len(asked))
    assert counts[1] <= 4 * counts[0]


def test_the_size_of_a_mechanism_looks_once_at_a_marker_that_a_formula_names_often(monkeypatch):
    asked = []
    point = ModelData.point
    monkeypatch.setattr(ModelData, "point", lambda model, marker: asked.append(marker) or point(model, marker))
    model = stiffmbs.Model()
    model.add("ball", stiffmbs.Body(mass=1, inertia=1, position=(3, 4)))
    model.add("push", stiffmbs.AppliedForce(i="ball", force=("-dx(ball) - dx(ball)**2 - sin(dx(ball)) - vx(ball)", 0)))
    del asked[:]
    assert model.data().size() == 5
    assert len(asked) == len(set(asked))
