"""`check` tells motions of a body that nothing holds from those that bushings and springs hold; bodies connected to nothing."""

import pytest

import stiffmbs
from stiffmbs import Body, Distance, Marker, Model, Revolute, spatial
from stiffmbs.elements.planar_kinds import FORCES

from ..spatial_loops import ground, slider_crank


def messages(model):
    return [message for message in stiffmbs.check(model).messages if not message.startswith("presolve")]


def wishbone(stiffness=(1e7, 1e7, 1e7, 0, 0, 0), apart=0.2):
    """A suspension arm along x: a ball joint to a knuckle, two bushings on the chassis (the ground)."""
    model = spatial.Model("wishbone", gravity=(0, 0, -9.81))
    model.add("arm", spatial.Body(mass=2, inertia=(0.01, 0.1, 0.1), position=(0.2, 0, 0)))
    model.add("knuckle", spatial.Body(mass=5, inertia=(0.1, 0.1, 0.1), position=(0.4, 0, 0.1)))
    model.add(
        "ball",
        spatial.Spherical(
            i=spatial.Marker(body="arm", point=(0.2, 0, 0)), j=spatial.Marker(body="knuckle", point=(0, 0, -0.1))
        ),
    )
    model.add("strut", spatial.Prismatic(i="knuckle", j=ground(0.4, 0, 0.1)))
    for name, y in (("front", apart), ("rear", -apart)):
        place = spatial.Marker(body="arm", point=(-0.2, y, 0))
        model.add(name, spatial.Bushing(i=place, j=ground(0, y, 0), stiffness=stiffness))
    return model  # fmt: skip


def test_two_bushings_apart_hold_an_arm():
    assert messages(wishbone()) == []


def test_two_bushings_on_the_line_through_the_ball_do_not_hold_its_turn():
    model = wishbone(apart=0.0)
    assert messages(model) == ["arm can turn by itself between ball, front and rear, which moves no other body"]


@pytest.mark.long
def test_a_torsional_stiffness_there_holds_it():
    assert messages(wishbone((1e7, 1e7, 1e7, 1.0, 0, 0), apart=0.0)) == []


def test_dampers_alone_hold_nothing():
    model = slider_crank(0.7)
    model.add("damper", spatial.Bushing(i="rod", j="ground", damping=(0, 0, 0, 1, 1, 1)))
    assert messages(model) == ["rod can turn by itself between big_end and small_end, which moves no other body"]


@pytest.mark.long
@pytest.mark.parametrize("stiffness", [1.0, 1e8])
def test_a_bushing_that_holds_the_turn_of_a_rod_on_two_balls_is_named(stiffness):
    model = slider_crank(0.7)
    model.add("sleeve", spatial.Bushing(i="rod", j="crank", stiffness=(1e8, 0, 0, stiffness, stiffness, stiffness)))
    (turn,) = [message for message in messages(model) if "by itself" in message]
    assert turn == "the joints let rod turn by itself between big_end and small_end; sleeve prevents it"


def hung(between=True):
    """In the plane: a plate on two rods that leave it one motion of its own, and perhaps a spring that holds it."""
    model = Model("hung", gravity=(0, -9.81))
    bodies = [model.add(name, Body(mass=1, inertia=0.1, position=(x, 0))) for name, x in (("one", 0), ("two", 2))]
    for body, x in zip(bodies, (0, 2), strict=True):
        model.add(f"pin_{body.name}", Revolute(i=body.at(0, 1), j=Marker(body="ground", point=(x, 1))))
    plate = model.add("plate", Body(mass=1, inertia=0.1, position=(1, -1)))
    model.add("rod_one", Distance(i=plate.at(0, 0), j=bodies[0].at(0, 0), length=2**0.5))
    model.add("rod_two", Distance(i=plate.at(0, 0), j=bodies[1].at(0, 0), length=2**0.5))
    if between:
        model.add("spring", stiffmbs.TorsionSpring(i="plate", j="ground", stiffness=5.0))
    return model


def test_in_the_plane_too():
    free = "by itself between rod_one and rod_two"
    assert messages(hung(False)) == [f"plate can turn {free}, which moves no other body"]
    assert messages(hung()) == [f"the joints let plate turn {free}; spring prevents it"]


def forgotten(*bodies, connected=True):
    model = Model("forgotten", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(0.5, 0)))
    if connected:
        model.add("hinge", Revolute(i=bar.at(-0.5, 0), j="ground"))
    for k, name in enumerate(bodies):
        model.add(name, Body(mass=1, inertia=0.1, position=(k, 1)))
        model.request(f"read_{name}", f"{name}.x")
    return model


def told(model):
    return [note for note in stiffmbs.run(model, duration=0.01, points=2).notes if "not connected" in note]


def test_bodies_without_a_joint_beside_others_are_told_in_one_note():
    names = [f"stone{k}" for k in range(9)]
    (note,) = told(forgotten(*names))
    assert all(name in note for name in names) and "bar" not in note
    assert note in messages(forgotten(*names))


def test_bodies_meant_to_be_free_are_not_told():
    assert told(forgotten("ball", connected=False)) == messages(forgotten("ball", connected=False)) == []


@pytest.mark.parametrize("formula", ["-2*stone.x", "dx(stone, bar)", "sin(stone.angle)"])
def test_a_formula_that_reads_a_body_connects_it(formula):
    model = forgotten("stone")
    model.add("pull", FORCES["torque"](i="bar", torque=formula))
    assert told(model) == []
