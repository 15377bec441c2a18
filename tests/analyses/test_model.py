"""Models from Python and scenes from files say the same, and compiled systems do not depend on numbers."""

from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, InputError, Marker, Model, Prismatic, Revolute, SpringDamper
from stiffmbs.compile import record
from stiffmbs.compile.machine import compiler as machine


def cart_pendulum():
    model = Model("Cart-pendulum", gravity=(0, -9.81))
    cart = model.add("cart", Body(mass=10, inertia="1 kg m^2"))
    start = np.radians(20)
    position = (0.3 * np.sin(start), -0.3 * np.cos(start))
    bar = model.add("bar", Body(mass=1, inertia=0.03, position=position, angle=start - np.pi / 2))
    model.add("rail", Prismatic(i="cart", j="ground"))
    model.add("hinge", Revolute(i=cart.at(0, 0), j=bar.at(-0.3, 0)))
    anchor = stiffmbs.Marker(body="ground", point=(-1, 0))
    model.add("spring", SpringDamper(i="cart", j=anchor, stiffness="270 N/m", free_length=1))
    return model


def test_python_and_file_give_the_same_numbers(examples):
    from_file = stiffmbs.run(stiffmbs.load_scene(examples / "cart_pendulum.yaml"), duration=1.0)
    from_python = stiffmbs.run(cart_pendulum(), duration=1.0, output=0.01, rtol=1e-6)
    assert from_file.channels.keys() == from_python.channels.keys()
    for name in from_file:
        np.testing.assert_allclose(from_python[name], from_file[name], rtol=1e-9, atol=1e-9)


def test_numbers_are_no_part_of_what_is_compiled(monkeypatch):
    stiffmbs.run(cart_pendulum(), duration=0.01)
    record._record_of.cache_clear()
    machine.compiled_source.cache_clear()
    monkeypatch.setattr(record, "_derived", lambda kind: pytest.fail("derived again"))
    monkeypatch.setattr(machine, "object_code", lambda *_: pytest.fail("compiled again"))
    model = cart_pendulum()
    model.bodies["cart"] = Body(mass=7, inertia=2)
    model.forces["spring"] = SpringDamper(i="cart", j="bar", stiffness=1.0, damping=3)
    model.joints["rail"] = Prismatic(i=stiffmbs.Marker(body="cart", point=(1, 2), angle=0), j="ground")
    stiffmbs.run(model, duration=0.01)


def test_numbers_in_formulas_are_no_part_of_what_is_compiled():
    def kinds(text):
        model = cart_pendulum()
        model.add("e", stiffmbs.ConstraintEquation(zero=text))
        return [group.kind for group in stiffmbs.compile_model(model.data()).groups]

    assert kinds("bar.x - 0.25*t") == kinds("bar.x - 0.75*t")
    assert kinds("bar.x^2 - 0.25*t") != kinds("bar.x^3 - 0.25*t")


@pytest.mark.parametrize(
    ("name", "part", "words"),
    [
        ("cart", Body(mass=1, inertia=1), "taken"),
        ("ground", Body(mass=1, inertia=1), "reserved"),
        ("two words", Body(mass=1, inertia=1), "letters"),
        ("pin", Revolute(i="cart", j="nobody"), "nobody"),
        ("pin", Revolute(i="cart", j="cart"), "both sides"),
        ("thing", 3, "expected a body, a joint or a force"),
    ],
)
def test_wrong_parts_are_refused_when_added(name, part, words):
    with pytest.raises(InputError, match=words):
        cart_pendulum().add(name, part)


def test_wrong_fields_are_refused_when_made():
    with pytest.raises(InputError, match=r"Body: mass: found -1, expected a mass greater than 0 kg"):
        Body(mass=-1, inertia=1)
    with pytest.raises(InputError, match=r"unknown key 'colour'"):
        Revolute(i="a", j="b", colour="red")
    with pytest.raises(InputError, match=r"settings|rtol|RunSettings"):
        stiffmbs.run(cart_pendulum(), rtol=-1)
    with pytest.raises(InputError, match=r"no body"):
        stiffmbs.run(Model())


@pytest.mark.parametrize("given", [None, 3, {}])
def test_only_models_and_scenes_are_run(given):
    for use in (stiffmbs.run, stiffmbs.check, stiffmbs.verify):
        with pytest.raises(InputError, match="expected a Model, a Scene, or the name of a scene's file"):
            use(given)


@pytest.mark.long
@pytest.mark.parametrize("kind", [str, Path])
def test_files_are_solved_by_their_names(examples, kind):
    file = kind(examples / "bar_pendulum.yaml")
    scene = stiffmbs.load_scene(file)
    expected = stiffmbs.run(scene, duration=0.1)
    for found in (stiffmbs.run(file, duration=0.1), stiffmbs.verify(file, duration=0.1)):
        np.testing.assert_array_equal(found["bar.x"], expected["bar.x"])
    assert stiffmbs.check(file) == stiffmbs.check(scene)
    assert stiffmbs.equilibrium(file).channels == stiffmbs.equilibrium(scene).channels
    assert [mode.frequency for mode in stiffmbs.modes(file).modes] == [
        mode.frequency for mode in stiffmbs.modes(scene).modes
    ]
    for use in (stiffmbs.run, stiffmbs.check, stiffmbs.verify):
        with pytest.raises(InputError, match=r"nowhere\.yaml: .*no such file"):
            use(kind("nowhere.yaml"))


@pytest.mark.long
def test_a_model_is_solved_by_its_own_methods():
    model, settings = cart_pendulum(), stiffmbs.RunSettings(duration=0.1, rtol=1e-8)
    expected = stiffmbs.run(cart_pendulum(), settings)
    for found in (model.run(settings), model.run(duration=0.1, rtol=1e-8), model.verify(settings)):
        np.testing.assert_array_equal(found["bar.x"], expected["bar.x"])
    assert model.verify(settings).verification
    assert model.check(settings) == stiffmbs.check(model)
    reached = []
    model.run(settings, watch=reached.append)
    assert reached


def test_unknown_channels_are_told_with_their_neighbours():
    solution = stiffmbs.run(cart_pendulum(), duration=0.01)
    with pytest.raises(InputError, match=r"rail.fz.*rail.fx"):
        solution["rail.fz"]


def test_numbers_without_names_are_refused():
    with pytest.raises(
        InputError, match=r"^Body: found 1, 2.5 without a name, expected names of fields: mass=..., inertia="
    ):
        Body(1, 2.5)


def test_points_of_ground_have_names_too():
    """A pendulum on a named point of ground, which a measure names as well, hangs where one without names does."""
    text = """
gravity: [0, -9.81]
{markers}
bodies:
  bar: {{mass: 1, inertia: 0.03, position: [1.3, 2], markers: {{end: {{point: [-0.3, 0]}}}}}}
joints:
  hinge: {{type: revolute, i: bar.end, j: {pivot}}}
requests: {{way: "dm(bar, {measured})"}}
run: {{duration: 1, rtol: 1e-9}}
"""
    named = text.format(markers="markers: {pivot: {point: [1, 2]}}", pivot="ground.pivot", measured="ground.pivot")
    plain = text.format(markers="", pivot="{body: ground, point: [1, 2]}", measured="bar.end")
    found, expected = (stiffmbs.run(stiffmbs.read_scene(scene)) for scene in (named, plain))
    np.testing.assert_allclose(found["bar.y"], expected["bar.y"], atol=1e-12)
    np.testing.assert_allclose(found["way"], 0.3, atol=1e-8)
    with pytest.raises(InputError, match=r"found 'ground.axle', expected one of its markers \(pivot\)"):
        stiffmbs.read_scene(named.replace("j: ground.pivot", "j: ground.axle"))


def test_a_point_of_ground_is_named_in_python():
    model = Model("Pendulum", gravity=(0, -9.81))
    model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 1)))
    model.mark("pivot", Marker(body="ground", point=(0, 1)))
    model.add("hinge", Revolute(i=Marker(body="bar", point=(-0.3, 0)), j="ground.pivot"))
    assert stiffmbs.check(model).degrees_of_freedom == 1
    with pytest.raises(InputError, match="pivot: found a name that is taken"):
        model.mark("pivot", Marker(body="ground", point=(0, 2)))
    with pytest.raises(InputError, match=r"axle: found .* expected a marker with a point on ground"):
        model.mark("axle", Marker(body="bar"))


def test_a_model_is_compiled_as_its_data_are():
    system, of_data = stiffmbs.compile_model(cart_pendulum()), stiffmbs.compile_model(cart_pendulum().data())
    assert system.bodies == of_data.bodies == ("cart", "bar")
    assert system.equations == of_data.equations


@pytest.mark.parametrize("change", ["bodies.bar.mass=2", ("bodies.bar.mass",), (1, "2")])
def test_changes_of_a_scene_that_are_no_pairs_are_refused(change):
    with pytest.raises(stiffmbs.InputError, match="expected pairs such as"):
        stiffmbs.load_scene("examples/cart_pendulum.yaml", [change])
