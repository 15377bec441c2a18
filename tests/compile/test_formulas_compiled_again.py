"""A formula that is compiled again gives the same kind and the same data."""

import numpy as np

from stiffmbs import read_scene
from stiffmbs.compile.compile_model import compile_model

SCENE = """
parameters: {k: 3, V: 2}
bodies: {a: {mass: 1, inertia: 1}, b: {mass: 2, inertia: 1, position: [1, 0]}}
joints: {held: {type: equation, zero: b.angle - 2*a.angle}}
forces:
  pull: {type: force, i: a, force: ["k*(b.x - a.x)*sin(V*t)", "-k*b.vy"]}
"""


def test_the_same_scene_compiles_twice_to_the_same_system():
    scene = read_scene(SCENE)
    first, again = compile_model(scene), compile_model(scene)
    assert [group.kind for group in first.groups] == [group.kind for group in again.groups]
    for one, other in zip(first.groups, again.groups, strict=True):
        np.testing.assert_array_equal(one.index, other.index)
        np.testing.assert_array_equal(one.numbers, other.numbers)


def test_a_formula_reads_the_bodies_of_the_element_that_it_stands_in():
    """In an element with other bodies before, its bodies have other slots."""
    scene = read_scene(SCENE)
    formula = scene.forces["pull"].force[0]
    moved = scene.forces["pull"].model_copy(update={"i": scene.forces["pull"].i.model_copy(update={"body": "b"})})
    other = scene.model_copy(update={"forces": {"pull": moved}})
    systems = [compile_model(scene), compile_model(other)]
    groups = [next(group for group in system.groups if "pull" in group.names) for system in systems]
    assert [list(group.bodies[0]) for group in groups] == [[0, 1], [1, 0]]
    assert formula is other.forces["pull"].force[0]
