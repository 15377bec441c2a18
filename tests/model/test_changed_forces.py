"""Forces read anew alone make the scene that reading all of it makes."""

import copy

import pytest

from stiffmbs.compile.kind import sorted_out
from stiffmbs.model.files.changed_forces import ChangedForces
from stiffmbs.model.read_scene import made_scene, read_scene
from stiffmbs.reading.files.unchanged import Unchanged
from stiffmbs.studies.case_solver import written_scene

SCENE = """
parameters: {k: 100 N/m, c: 0.1 s*k, L: 1 m, n: 2}
bodies: {a: {mass: 1, inertia: 1, position: [2*L, 0]}, b: {mass: 1, inertia: 1, position: [0, 1]}}
forces:
  one: {type: spring_damper, i: a, j: ground, stiffness: 2*k, damping: c, free_length: 1}
  two: {type: spring_damper, i: b, j: ground, stiffness: 5*(1 N/m)^(n/2), free_length: L/3}
  law: {type: force, i: a, force: [0, "-k*sin(t)*dy(a, b)*(1 m/L)^n - k*a.y"]}
  "more{i}": {for: i in 1..2, type: spring_damper, i: b, j: a, stiffness: 7, free_length: "{i}"}
"""


def whole(written, names, values, unchanged):
    changes = (*written.changes, *zip(names, values, strict=True))
    return made_scene(copy.deepcopy(dict(written.content)), changes, "scene", lambda _: None, None, unchanged)


def both(names, first, values):
    """The scene from its forces, and as a whole."""
    written, unchanged = written_scene(read_scene(SCENE)), Unchanged()
    whole(written, names, first, unchanged)
    return ChangedForces(written, names, unchanged).scene(values), lambda: whole(written, names, values, Unchanged())


@pytest.mark.parametrize(
    ("names", "values"),
    [
        (("k",), (30.0,)),
        (("c", "forces.two.stiffness"), (2.0, 11.0)),
        (("parameters.k", "forces.one.preload"), (1.0, 4.0)),
        (("forces.one.j",), ({"body": "b", "point": [0.5, 0.25]},)),
    ],
)
def test_forces_read_alone_make_the_scene_that_is_read_as_a_whole(names, values):
    found, expected = both(names, values, values)
    assert found is not None
    assert found == expected()
    assert found.parameters == expected().parameters


def test_a_formula_with_other_parameters_has_the_shape_of_one_that_is_read():
    found, expected = both(("k",), (100.0,), (30.0,))
    (kind, data), (same_kind, as_read) = (
        sorted_out("law", scene.forces["law"], scene) for scene in (found, expected())
    )
    assert kind == same_kind
    assert data.numbers == as_read.numbers
    assert -30.0 in data.numbers or 30.0 in data.numbers


@pytest.mark.parametrize(
    ("names", "first", "values"),
    [
        (("L",), (1.0,), (1.5,)),  # a body stands there
        (("n",), (2.0,), (3.0,)),  # which a unit follows from
        (("forces.one.stiffness",), (1.0,), (float("nan"),)),
        (("forces.one.type",), ("spring_damper",), ("bushing",)),
        (("forces.one.j",), ("b",), ({"body": "c"},)),
    ],
)
def test_what_more_follows_from_is_left_to_the_whole(names, first, values):
    found, _ = both(names, first, values)
    assert found is None
