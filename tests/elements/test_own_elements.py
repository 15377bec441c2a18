"""A joint and a force from outside of the package: the tests of all kinds, files, schema, docs and messages."""

import importlib.metadata
import json
import subprocess
import sys

import jsonschema
import numpy as np
import pytest
import sympy

import stiffmbs
from stiffmbs import Body, Drive, InputError, Joint, Marker, Model, spatial
from stiffmbs.analyses.warm import usual_elements
from stiffmbs.compile import record
from stiffmbs.elements import own_elements
from stiffmbs.elements.own_elements import REGISTRY
from stiffmbs.redundancy.replacements import transmitted

from ..outside import plane, space
from ..random_parts import forms_of
from .test_element_derivatives import (  # noqa: F401 these run on the elements of this module
    state_with,
    test_a_potential_gives_the_force_at_rest,
    test_applied_forces_and_their_derivatives,
    test_change_of_constraint_forces_with_position,
    test_constraints_and_their_jacobian,
    test_gamma_is_minus_the_rate_of_the_velocity_level_without_accelerations,
    test_iteration_matrix_of_every_formulation,
    test_power_is_what_a_force_brings_into_the_energy,
    test_velocity_level_is_the_rate_of_the_position_level,
)

OWN = [(2, plane.Ring), (2, plane.Bumper), (3, space.Ring), (3, space.Bumper)]
CASES = [(dimensions, element, form) for dimensions, element in OWN for form in forms_of(element, dimensions)]
SCENE = """
dimensions: {dimensions}
gravity: {gravity}
bodies:
  a: {{mass: 1, inertia: {inertia}, position: {place}}}
joints: {{ring: {{type: ring, i: a, j: ground, radius: 500 mm}}}}
forces: {{stop: {{type: bumper, i: a, j: {{body: ground, point: {point}}}, stiffness: 5e3 N/m, gap: 300 mm}}}}
run: {{duration: 2 s, rtol: 1e-9}}
"""
IN_PLANE = SCENE.format(dimensions=2, gravity=[0, -9.81], inertia=1, place=[0.5, 0], point=[0, -0.5])
IN_SPACE = SCENE.format(dimensions=3, gravity=[0, -9.81, 0], inertia=[1, 1, 1], place=[0.5, 0, 0], point=[0, -0.5, 0])


@pytest.fixture(params=CASES, ids=lambda case: f"{case[1].kind}-{case[0]}")
def state(request):
    return state_with(*request.param)


@pytest.fixture
def registered():
    """The elements as scenes know them."""
    for _, element in OWN:
        stiffmbs.register(element)
    yield
    for _, element in OWN:
        REGISTRY.remove(element)


def bob():
    model = Model(gravity=(0, -9.81))
    model.add("a", Body(mass=1, inertia=1, position=(0.5, 0)))
    return model


def test_a_model_takes_them_as_they_are_and_keeps_energy():
    model = bob()
    model.add("ring", plane.Ring(i="a", j="ground", radius="500 mm"))
    model.add("stop", plane.Bumper(i="a", j=Marker(body="ground", point=(0, -0.5)), stiffness=5e3, gap=0.3))
    solution = stiffmbs.run(model, duration=2.0, rtol=1e-9)
    assert solution.solver["events"] > 1  # the breakpoint of Max is located
    np.testing.assert_allclose(np.hypot(solution["a.x"], solution["a.y"]), 0.5, rtol=1e-9)
    np.testing.assert_allclose(solution["energy.total"], solution["energy.total"][0], atol=1e-6)
    assert np.ptp(solution["stop.fx"]) > 100


def test_scenes_know_them_in_the_plane_and_in_space(registered):
    in_plane, in_space = (stiffmbs.run(stiffmbs.read_scene(text)) for text in (IN_PLANE, IN_SPACE))
    for channel in ("a.x", "a.y", "stop.fy", "ring.fx"):
        np.testing.assert_allclose(in_space[channel], in_plane[channel], atol=2e-3 * np.ptp(in_plane[channel]))
    embedded = spatial.in_space(stiffmbs.read_scene(IN_PLANE))
    assert isinstance(embedded.joints["ring"], space.Ring)


def test_without_registration_a_scene_names_what_it_knows():
    with pytest.raises(InputError, match=r"joints.ring: found the type 'ring', expected one of 'equation', "):
        stiffmbs.read_scene(IN_PLANE)


@pytest.mark.long
def test_schema_lists_them(registered):
    schema = json.loads(json.dumps(stiffmbs.scene_schema()))
    validator = jsonschema.Draft202012Validator(schema)
    scene = {
        "bodies": {"a": {"mass": 1, "inertia": 1}},
        "joints": {"ring": {"type": "ring", "i": "a", "j": "ground", "radius": 1}},
    }
    assert validator.is_valid(scene)
    scene["joints"]["ring"]["radius"] = -1
    assert not validator.is_valid(scene)


def test_they_are_compiled_ahead_in_their_forms(registered):
    for dimensions in (2, 3):
        model = usual_elements(dimensions)
        assert {"ring_0", "bumper_0"} <= {*model.joints, *model.forces}
    assert model.forces["bumper_0"].stiffness == 1.0
    assert usual_elements(2).forces["bumper_1"].damping == 1.0


def test_the_docs_have_a_section_and_a_row_for_them(registered, monkeypatch):
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend("docs/sphinx_plugins")
    kinds = importlib.import_module("kinds")
    text = "\n".join(kinds.section("stiffmbs", "ring", plane.Ring))
    assert ".. autoclass:: tests.outside.plane.Ring" in text and "return [d.dot(d) - e.radius**2]" in text
    assert "``radius``" in text and "length (m), above 0" in text
    rows = "\n".join(kinds.overview("stiffmbs", kinds.SECTIONS["forces"][1]))
    assert "``bumper``" in rows and "A stop between two points" in rows


def test_a_kind_is_taken_once(registered):
    class Another(stiffmbs.Joint):
        kind = "ring"
        equations = ("x",)
        i: Marker

        @staticmethod
        def position(e):
            return [e.i.point[0]]

    with pytest.raises(InputError, match=r"Another: found the kind 'ring', which tests.outside.plane.Ring has"):
        stiffmbs.register(Another)
    Another.kind = "revolute"
    with pytest.raises(InputError, match=r"Another: found the kind 'revolute', which stiffmbs has"):
        stiffmbs.register(Another)


def test_installed_packages_offer_elements_by_entry_points(monkeypatch):
    points = [importlib.metadata.EntryPoint("ring", "tests.outside.plane:Ring", own_elements.GROUP)]
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: points if group == own_elements.GROUP else [])
    monkeypatch.setattr(own_elements, "REGISTRY", own_elements.Registry())
    monkeypatch.setattr("stiffmbs.elements.kinds.REGISTRY", own_elements.REGISTRY)
    found = stiffmbs.read_scene(IN_PLANE.replace("forces:", "notes: [no forces]\nrequests: {} #"))
    assert isinstance(found.joints["ring"], plane.Ring)
    points[0] = importlib.metadata.EntryPoint("ring", "tests.outside.nowhere:Ring", own_elements.GROUP)
    monkeypatch.setattr("stiffmbs.elements.kinds.REGISTRY", own_elements.Registry())
    with pytest.raises(InputError, match=r"entry point 'ring = tests.outside.nowhere:Ring' of stiffmbs.elements"):
        stiffmbs.read_scene(IN_PLANE)


class Pin(spatial.Joint):
    """A hinge made by a user, with what presses it."""

    kind = "pin"
    equations = spatial.Revolute.equations
    coordinates = ("angle",)
    i: spatial.Marker
    j: spatial.Marker

    position = staticmethod(spatial.Revolute.position)
    angle = staticmethod(spatial.Revolute.angle)
    loads = staticmethod(spatial.Revolute.loads)


@pytest.mark.long
def test_a_joint_that_states_its_loads_rubs_and_is_driven():
    def braked(hinge):
        model = spatial.Model(gravity=(0, -9.81, 0))
        bar = model.add("bar", spatial.Body(mass=1, inertia=(0.01, 0.1, 0.1), position=(0.5, 0, 0), omega=(0, 0, 3)))
        model.add("hinge", hinge(i=bar.at(-0.5, 0, 0), j="ground"))
        model.add("rubs", spatial.JointFriction(joint="hinge", friction=0.3, radius=0.05))
        return stiffmbs.run(model, duration=1.0)

    own, shipped = braked(Pin), braked(spatial.Revolute)
    np.testing.assert_allclose(own["bar.wz"], shipped["bar.wz"], atol=1e-9)
    assert shipped["energy.total"][-1] < shipped["energy.total"][0] - 0.1


def test_advice_knows_what_own_joints_transmit(registered):
    assert transmitted()["ring"] == ("fx",)


SCRIPT = """
import stiffmbs
class Level(stiffmbs.Joint):
    kind = "level"
    equations = ("height",)
    i: stiffmbs.Marker
    @staticmethod
    def position(e):
        return [e.i.point[{axis}]]
model = stiffmbs.Model(gravity=(1, 2))
model.add("a", stiffmbs.Body(mass=1, inertia=1))
model.add("level", Level(i="a"))
solution = stiffmbs.run(model, duration=1)
print(round(solution["a.x"][-1], 6), round(solution["a.y"][-1], 6))
"""


@pytest.mark.long
def test_another_text_of_a_class_is_never_taken_for_the_kept_one(tmp_path):
    script = tmp_path / "script.py"
    for axis, expected in ((1, "0.5 0.0"), (0, "0.0 1.0"), (1, "0.5 0.0")):
        script.write_text(SCRIPT.format(axis=axis))
        found = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
        assert found.stdout.replace("-0.0", "0.0").strip() == expected


def test_what_a_class_takes_from_elsewhere_is_part_of_what_is_kept():
    """A variable of the script, which is in no text that could be compared."""

    def kind(factor):
        class Pull(stiffmbs.Force):
            kind = "pull"
            i: Marker

            @staticmethod
            def efforts(e):
                return [(factor * e.t, e.i.point[0])]

        model = bob()
        model.add("pull", Pull(i="a"))
        (found,) = (k for k in stiffmbs.compile.compile_model.kinds_of(model.data()) if k.element is Pull)
        return record._entry(found)

    assert kind(1) == kind(1) != kind(2)


def made(base, **members):
    return type("Mine", (base,), {"__module__": __name__, "__annotations__": {"i": Marker}, **members})


JOINT = {"kind": "mine", "equations": ("x",)}


@pytest.mark.parametrize(
    ("base", "members", "words"),
    [
        (stiffmbs.Joint, {}, r"Mine: found no kind, expected a name for scenes, such as kind = 'my_joint'"),
        (stiffmbs.Force, {"kind": "a b"}, r"Mine: found the kind 'a b', expected a name"),
        (stiffmbs.Joint, {"kind": "mine"}, r"Mine: found no equations, expected a static method position"),
        (stiffmbs.Joint, {"kind": "mine", "position": lambda e: [e.i.point[0]]}, r"Mine: found no names of equations"),
        (stiffmbs.Joint, {**JOINT, "position": lambda e: [0], "coordinates": ("s",)}, r"Mine: found the coordinate 's' without"),
        (stiffmbs.Joint, {**JOINT, "coordinates": ("angle",), "channels": ("x",)}, r"Mine: found channels x of a joint with coordinates, expected none"),
        (stiffmbs.Force, {"kind": "mine"}, r"Mine: found no law, expected a static method efforts"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda self, e: []}, r"Mine: found efforts\(self, e\), expected a static method efforts\(e\)"),
        (stiffmbs.Joint, {**JOINT, "position": lambda e: [e.i.point[0], 1]}, r"x: Mine: found 2 expressions .* expected 1, .*\(x\)"),
        (stiffmbs.Joint, {**JOINT, "position": lambda e: [e.leng]}, r"x: Mine.position: AttributeError: found e.leng, expected one of e.i, "),
        (stiffmbs.Joint, {**JOINT, "position": lambda e: [e.t]}, r"x: Mine: found equation 1 of 1, which depends on no coordinate"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [e.t]}, r"x: Mine.efforts: expected a list of pairs"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(1 / 0, e.i.point[0])]}, r"x: Mine.efforts: ZeroDivisionError"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(stiffmbs_gamma(e), e.i.point[0])]}, r"x: Mine.efforts: found the function gamma, expected one of Abs, "),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(_stranger(), e.i.point[0])]}, r"x: Mine: found the symbol k in its equations"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(_half(e.i.point[1]), e.i.point[1])]}, r"x: Mine.efforts: found Piecewise.* expected a last part"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(_undone(e.i.point[1]), e.i.point[1])]}, r"x: Mine.efforts: found Integral.* which SymPy has not worked out"),
        (stiffmbs.Force, {"kind": "mine", "stiffness": 5}, r"Mine: A non-annotated attribute was detected"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [(1j, e.i.point[1])]}, r"x: Mine.efforts: found 1.0\*I, which is no real number"),
        (stiffmbs.Force, {"kind": "mine", "efforts": lambda e: [("what is this", e.i.point[0])]}, r"x: Mine.efforts: "),
    ],
)  # fmt: skip
def test_a_class_that_cannot_be_used_is_named_in_one_sentence(base, members, words):
    model = bob()
    with pytest.raises(InputError, match=words) as raised:
        model.add("x", made(base, **members)(i="a"))
        stiffmbs.run(model, duration=0.1)
    assert "\n" not in str(raised.value)


def stiffmbs_gamma(e):
    import sympy

    return sympy.gamma(e.i.point[0])


def _half(x):
    import sympy

    return sympy.Piecewise((x, x > 0))


def _undone(x):
    import sympy

    s = sympy.Symbol("s")
    return sympy.Integral(sympy.exp(-(s**2)), (s, 0, x))


def _stranger():
    import sympy

    return sympy.Symbol("k")


class Wave(stiffmbs.Force):
    """A force with constants of SymPy."""

    kind = "wave"
    i: Marker

    @staticmethod
    def efforts(e):
        x = e.i.point[0]
        return [(-sympy.E * sympy.GoldenRatio * sympy.sin(sympy.pi * x), x)]


def test_constants_of_sympy_are_numbers_in_kernels():
    model = Model(gravity=(0, 0))
    model.add("a", Body(mass=1, inertia=1, position=(0.3, 0)))
    model.add("wave", Wave(i="a"))
    solution = model.run(duration=1.0)
    expected = -np.e * (1 + 5**0.5) / 2 * np.sin(np.pi * solution["a.x"])
    np.testing.assert_allclose(solution["wave.fx"], expected, rtol=1e-12)


def test_only_joints_and_forces_are_registered():
    for wrong in (Body, 3):
        with pytest.raises(InputError, match=r"found no subclass of Joint or Force, expected one"):
            stiffmbs.register(wrong)


class Track(Joint):
    """A point on a line, whose displacement has a name of its own."""

    kind = "track_of_tests"
    equations = ("y",)
    coordinates = ("along",)

    i: Marker
    j: Marker

    @staticmethod
    def position(e):
        return [(e.i.point - e.j.point)[1]]

    @staticmethod
    def along(e):
        return (e.i.point - e.j.point)[0]


def test_a_drive_refuses_a_coordinate_that_is_neither_an_angle_nor_a_displacement():
    model = Model()
    model.add("b", Body(mass=1, inertia=1))
    model.add("track", Track(i="b", j="ground"))
    with pytest.raises(
        InputError, match="found 'track' of the type track_of_tests, expected a joint with a coordinate"
    ):
        model.add("motor", Drive(joint="track", position="t"))


def test_an_element_of_an_earlier_version_may_say_where_it_is_symmetric():
    class Symmetric(space.Bumper):
        kind = "symmetric_bumper"
        symmetric_with = {"i": "point", "j": "point"}

    assert Symmetric(i="a", j="ground", stiffness=1, gap=0.3).gap == 0.3
