"""Names of fields: the symbolic element's own are refused, all others mean the field, in the plane and in space."""

import re

import numpy as np
import pytest
import sympy

import stiffmbs
from stiffmbs import InputError, si, spatial
from stiffmbs.analyses.warm import usual_elements
from stiffmbs.compile.kind import sorted_out
from stiffmbs.compile.symbolic.derive import derive
from stiffmbs.compile.symbolic.generate import kernel_source
from stiffmbs.compile.symbolic.referred import ReferredJoint
from stiffmbs.compile.symbolic.symbols import INTERNAL
from stiffmbs.elements.element import IN_EQUATIONS

FAMILIES = {"plane": stiffmbs, "space": spatial}
ALLOWED = [
    "x",
    "y",
    "q0",
    "vx",
    "wz",
    "ax",
    "a00",
    "e0",
    "n",
    "size",
    "phi0",
    "turn0",
    "s",
    "e",
    "self",
    "name",
    "time",
    "number",
    "mass",
]
OF_BASES = ("kind", "markers", "parts", "forms", "spins_with", "point", "reflected")


def fields(family, name):
    return {"__annotations__": {name: si.Number, "i": family.Marker}, "__module__": __name__, "__qualname__": "Own"}


def force(family, name):
    """A force between springs, whose number is its first field."""

    def efforts(e):
        x, y = e.i.point[0], e.i.point[1]
        root, stiffness = sympy.sqrt(1 + y**2), getattr(e, name)
        return [(-stiffness * y / root, y), (-stiffness * x * root, x)]

    return type("Own", (family.Force,), fields(family, name) | {"kind": "own", "efforts": staticmethod(efforts)})


def joint(family, name):
    """A marker whose y grows at a rate, the first field."""

    def position(e):
        return [e.i.point[1] - getattr(e, name) * e.t]

    of_joint = {"kind": "own", "equations": ("y",), "position": staticmethod(position)}
    return type("Own", (family.Joint,), fields(family, name) | of_joint)


def end(family, make, name):
    """Coordinates at the end of a run with an element whose field of 2 has a name."""
    planar, point = family is stiffmbs, [0.3, 1, 0] if make is force else [0.3, 0, 0]
    model = family.Model(gravity=(0,) * (2 if planar else 3))
    turning = {"inertia": 1} if planar else {"inertia": (1, 2, 3), "omega": (0.1, 0.2, 3)}
    start = {
        "position": point[: 2 if planar else 3],
        "velocity": (0, 0 if make is force else 2, 0)[: 2 if planar else 3],
    }
    model.add("b", family.Body(mass=1, **start, **turning))
    model.add("own", make(family, name)(i={"body": "b", "point": (0.1, 0.2, 0)[: 2 if planar else 3]}, **{name: 2.0}))
    solution = stiffmbs.run(model, duration=1.0, points=2, rtol=1e-8)
    return np.array([solution["b.x"][-1], solution["b.y"][-1]])


def derived(name):
    scene = usual_elements(3).data()
    element = (scene.joints | scene.forces)[name]
    return derive(sorted_out(name, element.at_initial_pose(scene), scene)[0])


def test_the_reserved_names_are_the_attributes_of_the_symbolic_element_and_of_joints_that_it_refers_to():
    rubbing = derived("joint_friction_0").symbols.element
    (referred,) = (value for value in vars(rubbing).values() if isinstance(value, ReferredJoint))
    attributes = {*dir(rubbing), *dir(referred)} - {*rubbing.__dict__, *referred.__dict__}
    attributes |= {name for element in (rubbing, referred) for name in vars(element) if name in IN_EQUATIONS}
    assert {name for name in attributes if not name.startswith("__")} | {"type"} == IN_EQUATIONS


@pytest.mark.sampled(3)
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
@pytest.mark.parametrize("make", (force, joint))
@pytest.mark.parametrize("name", sorted((IN_EQUATIONS | {*OF_BASES}) - {"type"}))
@pytest.mark.filterwarnings("ignore:Field name")
def test_a_field_with_a_name_of_the_symbolic_element_or_of_the_base_is_refused_with_a_list(family, make, name):
    hidden = {*dir(family.Force if make is force else family.Joint)} | IN_EQUATIONS
    if name not in hidden:
        pytest.skip("an attribute of the other base")
    with pytest.raises(
        InputError, match=rf"^Own: found the field '{name}', expected names other than a, acceleration, angle, .* u, "
    ):
        make(family, name)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
@pytest.mark.parametrize("make", (force, joint))
def test_other_names_mean_the_field(family, make):
    expected = end(family, make, "stiffness")
    for name in ALLOWED:
        np.testing.assert_allclose(end(family, make, name), expected, atol=1e-12, err_msg=name)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("name", ("revolute_0", "joint_friction_0", "bushing_0", "cylindrical_0", "vertical_tyre_0"))
def test_symbols_of_numbers_differ_from_all_others(name):
    found = derived(name)
    source = "".join(kernel_source(terms, found, "kernel") for terms in ("acceleration", "tangent"))
    of_numbers = {symbol.name for symbol in found.symbols.numbers}
    words = {*re.findall(r"\b([a-zA-Z]\w*_\d+)\b", source)} - of_numbers
    assert words and all(INTERNAL.fullmatch(word.rpartition("_")[0]) for word in words), words
