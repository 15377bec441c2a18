"""Models are changed by handles, replaced and removed parts; they are written as scenes; adding to them is linear."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import (
    AppliedForce,
    Body,
    ConstraintEquation,
    Coupler,
    Drive,
    Fixed,
    InputError,
    Marker,
    Model,
    Prismatic,
    Revolute,
    SpringDamper,
    spatial,
)
from stiffmbs.model.model import PlanarData

from ..conftest import EXAMPLE_SCENES

SECTIONS = ("name", "gravity", "markers", "bodies", "states", "joints", "forces", "requests")


def cart_pendulum():
    """With a handle for each of its bodies."""
    model = Model("Cart", gravity=(0, -9.81))
    cart = model.add("cart", Body(mass=10, inertia=1))
    bar = model.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0), markers={"end": {"point": (0.3, 0)}}))
    model.add("rail", Prismatic(i=cart, j="ground"))
    model.add("hinge", Revolute(i=bar.at(-0.3, 0), j=cart))
    return model, cart, bar


def test_a_handle_stands_wherever_a_body_may():
    model, cart, bar = cart_pendulum()
    assert model.joints["rail"] == Prismatic(i="cart", j="ground")
    assert Marker(body=bar, point=(1, 2)) == Marker(body="bar", point=(1, 2))
    assert SpringDamper(i={"body": bar, "marker": "end"}, j=cart, stiffness=1).i.label == "bar.end"
    model.request("reach", f"dm({bar}.end, {cart})")
    model.request("speed", 0.6 * bar.omega - cart.vx)
    assert "bar.omega" in model.requests["speed"].text
    wheel = spatial.Model().add("wheel", spatial.Body(mass=1, inertia=(1, 1, 1)))
    assert spatial.Spherical(i=wheel, j="ground") == spatial.Spherical(i="wheel", j="ground")
    assert spatial.Marker(body=wheel).body == "wheel"


def test_setting_an_attribute_of_a_handle_changes_the_model():
    model, _, bar = cart_pendulum()
    before = model.run(duration=0.1)["rail.fy"][0]
    bar.mass = "2 kg"
    bar.velocity = np.array([0.5, 0])
    assert bar.mass == model.bodies["bar"].mass == 2
    assert bar.body == Body(
        mass=2, inertia=0.03, position=(0.3, 0), velocity=(0.5, 0), markers={"end": {"point": (0.3, 0)}}
    )
    assert model.run(duration=0.1)["rail.fy"][0] != before
    assert list(model.bodies) == ["cart", "bar"]


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("mas", 2, r"bar: found the unknown field 'mas' \(did you mean 'mass'\?\), expected one of mass, inertia"),
        ("mass", -1, "mass: found -1, expected a mass greater than 0 kg"),
        ("x", 2, "bar: found the unknown field 'x'"),
        ("angle", 2, r"bar\.angle: found 2 for what formulas read .* model\.replace\('bar', Body\(\.\.\., angle="),
        ("omega", 2, r"bar\.omega: found 2 for what formulas read"),
        ("name", "rod", "unknown field 'name'"),
    ],
)
def test_an_attribute_that_changes_nothing_is_refused(field, value, words):
    model, _, bar = cart_pendulum()
    before = dict(model.bodies)
    with pytest.raises(InputError, match=words):
        setattr(bar, field, value)
    assert model.bodies == before and bar.name == "bar"


def test_what_formulas_read_of_a_handle_is_a_symbol():
    _, cart, bar = cart_pendulum()
    assert [str(symbol) for symbol in (cart.x, bar.angle, bar.omega)] == ["cart.x", "bar.angle", "bar.omega"]
    assert not hasattr(bar, "colour")
    with pytest.raises(AttributeError, match=r"found no 'colour' of the body bar, expected one of x, y, angle, .*mass"):
        bar.colour  # noqa: B018
    assert {"x", "omega", "mass", "at", "name"} <= set(dir(bar))


def test_a_part_is_replaced_under_its_name():
    model, cart, bar = cart_pendulum()
    new = model.replace("bar", Body(mass=3, inertia=1, position=(0.3, 0), markers={"end": {}}))
    assert bar.mass == new.mass == 3
    assert model.replace("hinge", Revolute(i=bar.at(0, 0), j=cart)) is None
    assert model.joints["hinge"].i.point == (0, 0)
    for name, part, words in [
        ("hinge", SpringDamper(i="bar", j="cart", stiffness=1), "expected a body for a body"),
        ("hinge", Revolute(i="bar", j="nobody"), "unknown body 'nobody'"),
        ("pin", Revolute(i="bar", j="cart"), "pin: found no part of that name"),
        ("hinge", spatial.Revolute(i="bar", j="cart"), "of the plane"),
    ]:
        with pytest.raises(InputError, match=words):
            model.replace(name, part)
    assert model.joints["hinge"].i.point == (0, 0)


def test_what_others_name_stays():
    model, _cart, bar = cart_pendulum()
    model.add("stop", SpringDamper(i="bar.end", j="ground", stiffness=1))
    model.add("tie", Coupler(joint_1="hinge", joint_2="rail", scale=2))
    model.request("reach", "bar.x")
    before = model.data()
    for change, words in [
        (lambda: model.remove("bar"), r"bar: found it in use \(hinge\.i: found the unknown body 'bar'"),
        (lambda: model.remove("rail"), r"rail: found it in use \(tie\.joint_2: found the unknown joint 'rail'"),
        (lambda: model.replace(bar, Body(mass=1, inertia=1)), r"bar: found it in use \(stop\.i: found 'bar\.end'"),
        (lambda: setattr(bar, "markers", {}), r"bar: found it in use \(stop\.i"),
        (lambda: model.replace("hinge", Fixed(i="bar", j="cart")), r"hinge: found it in use \(tie\.joint_1"),
        (lambda: model.remove("nothing"), "nothing: found no part of that name"),
    ]:
        with pytest.raises(InputError, match=words):
            change()
        assert model.data() == before


def test_parts_are_removed():
    model, _cart, bar = cart_pendulum()
    model.mark("pivot", Marker(body="ground", point=(1, 0)))
    model.add("spring", SpringDamper(i="bar", j="ground.pivot", stiffness=1))
    model.request("reach", "bar.x")
    with pytest.raises(InputError, match=r"reach|bar"):
        model.remove(bar)
    with pytest.raises(InputError, match=r"ground\.pivot: found it in use \(spring\.j"):
        model.remove("ground.pivot")
    for name in ("spring", "ground.pivot", "reach", "hinge"):
        model.remove(name)
    with pytest.raises(InputError, match="expected a body"):
        model.add("bar", 3)
    model.remove(bar)
    assert (list(model.bodies), list(model.joints)) == (["cart"], ["rail"])
    assert not (model.forces or model.requests or model.markers)
    with pytest.raises(InputError, match="bar: found a body that was removed"):
        bar.mass = 2
    assert model.check().degrees_of_freedom == 1


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", EXAMPLE_SCENES.values(), ids=lambda path: path.stem)
def test_a_scene_of_a_model_is_the_model(path):
    scene = stiffmbs.load_scene(path)
    model = (stiffmbs if isinstance(scene, PlanarData) else spatial).Model(scene.name, scene.gravity)
    for section in SECTIONS[2:]:
        getattr(model, section).update(getattr(scene, section))
    if not all(body.rigid for body in scene.bodies.values()):
        with pytest.raises(InputError, match="found a flexible body, expected rigid ones"):
            model.to_scene()
        return
    expected, found = model.data(), stiffmbs.read_scene(model.to_scene())
    for section in SECTIONS:
        assert getattr(found, section) == getattr(expected, section), section


def test_a_model_in_python_is_written_with_all_digits():
    model, cart, bar = cart_pendulum()
    bar.position = (math.pi / 10, 1e-300)
    model.add("track", ConstraintEquation(zero=cart.x - 0.1 * bar.angle**2))
    model.request("reach", "0.1*bar.x + 2 mm")
    text = model.to_scene()
    assert stiffmbs.read_scene(text).bodies["bar"].position == (math.pi / 10, 1e-300)
    found = stiffmbs.run(stiffmbs.read_scene(text), duration=0.1)
    np.testing.assert_array_equal(found["reach"], model.run(duration=0.1)["reach"])


def test_a_parameter_with_two_values_is_refused():
    model, _, _ = cart_pendulum()
    for k in (1, 2):
        scene = stiffmbs.read_scene(
            f"parameters: {{c: {k}}}\nbodies: {{a: {{mass: 1, inertia: 1}}}}\nrequests: {{r: c*a.x}}"
        )
        model.requests[f"r{k}"] = scene.requests["r"]
    model.add("a", Body(mass=1, inertia=1))
    with pytest.raises(InputError, match=r"c: found 1\.0 in one formula and 2\.0 in another"):
        model.to_scene()


@pytest.mark.parametrize("dimensions", [2, 3])
def test_requests_of_requests_and_components_are_written(dimensions):
    inertia = 1 if dimensions == 2 else [1, 1, 1]
    scene = stiffmbs.read_scene(f"""
dimensions: {dimensions}
parameters: {{k: 3 N/m}}
variables: {{pull: k*dx(a)}}
bodies: {{a: {{mass: 1, inertia: {inertia}, position: {[0.5, 0, 0][:dimensions]}}}}}
forces: {{push: {{type: force, i: a, force: {["-k*a.x", 0, 0][:dimensions]}}}}}
requests: {{total: own.x + push.fx + pull, own: {{x: 2*accx(a)*unit.kg, y: a.y}}}}
run: {{duration: 1}}
""")
    model = Model() if dimensions == 2 else spatial.Model()
    for section in SECTIONS[2:]:
        getattr(model, section).update(getattr(scene, section))
    found = stiffmbs.run(stiffmbs.read_scene(model.to_scene()), duration=1)
    expected = stiffmbs.run(scene)
    assert found.requested == expected.requested == {"total": "N", "own.x": "N", "own.y": "m"}
    np.testing.assert_array_equal(found["total"], expected["total"])
    assert expected["total"][0] == -3


def test_a_force_is_not_replaced_by_one_without_what_a_request_reads():
    model, cart, bar = cart_pendulum()
    model.add("spring", SpringDamper(i=bar, j=cart, stiffness=1))
    model.request("back", "fx(spring.j)")
    model.replace("spring", SpringDamper(i=bar, j=cart, stiffness=2))
    with pytest.raises(InputError, match=r"spring: found it in use \(requests.back: found 'spring.j'"):
        model.replace("spring", AppliedForce(i=bar, force=(1, 0)))


def test_a_request_names_those_before_it_in_any_number():
    model, _, _ = cart_pendulum()
    model.request("far", {"x": "bar.x + 2 m", "y": "far.x + bar.y"})
    model.request("twice", "2*far.y")
    with pytest.raises(InputError, match=r"requests\.wrong: .*far.*expected one of far\.x, far\.y"):
        model.request("wrong", "far + 1")
    with pytest.raises(InputError, match=r"requests\.wrong: "):
        model.request("wrong", "twice + 2 s")
    with pytest.raises(InputError, match="depends on itself"):
        model.request("wrong", {"a": "wrong.b", "b": "wrong.a"})
    assert set(model.requests) == {"far", "twice"}


def test_units_of_parameters_and_tables_are_written():
    """Formulas are checked by them; a scene's variables are written in their places."""
    scene = stiffmbs.read_scene("""
dimensions: 3
parameters: {R: 20 cm}
tables: {law: {table: [[0 s, 0 N], [1 s, 2 N]]}}
variables: {reach: 2*R + dx(a)}
bodies: {a: {mass: 1, inertia: [1, 1, 1]}}
forces: {push: {type: force, i: a, force: [law(t), 3 N, 0]}}
requests: {way: reach + a.x, off: a.y + R}
run: {duration: 1}
""")
    model = spatial.Model()
    for section in SECTIONS[2:]:
        getattr(model, section).update(getattr(scene, section))
    found = stiffmbs.read_scene(model.to_scene())
    assert found.forces == scene.forces and found.requests["off"] == scene.requests["off"]
    expected, again = stiffmbs.run(scene), stiffmbs.run(found, duration=1)
    assert expected["way"][0] == 0.4
    np.testing.assert_array_equal(again["way"], expected["way"])
    curve = stiffmbs.Table(table=[[0, 0], [1, "2 rad"]])
    pendulum, _, _ = cart_pendulum()
    pendulum.add("motor", Drive(joint="hinge", position=curve))
    assert stiffmbs.read_scene(pendulum.to_scene()).joints["motor"].prescribed_position == curve


def test_objects_say_what_they_are(examples):
    model, cart, _ = cart_pendulum()
    assert repr(model) == "<Model 'Cart': 2 bodies, 2 joints>"
    assert repr(cart) == "<BodyHandle 'cart': Body(mass=10.0, inertia=1.0)>"
    assert str(cart) == "cart"
    assert repr(model.joints["hinge"]) == "Revolute(i=Marker(body='bar', point=(-0.3, 0.0)), j=Marker(body='cart'))"
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    assert repr(scene) == str(scene) == "<PlanarScene 'Cart-pendulum': 2 bodies, 2 joints, 1 force>"
    assert repr(model.check()).startswith("<Report Cart: 2 degrees of freedom, 4 equations of rank 4")


class Watched(dict):
    """A section of a model that counts how often it is looked through."""

    looks = 0

    def __iter__(self):
        self.looks += 1
        return super().__iter__()

    def keys(self):
        self.looks += 1
        return super().keys()

    def items(self):
        self.looks += 1
        return super().items()


def test_adding_and_changing_look_at_no_other_part():
    """So that the time is in proportion to the number of parts."""
    model = Model()
    sections = [Watched() for _ in range(4)]
    model.bodies, model.joints, model.forces, model.requests = sections
    for k in range(5):
        bar = model.add(f"b{k}", Body(mass=1, inertia=1, position=(k, 0)))
        model.add(f"s{k}", SpringDamper(i=bar, j="ground" if k == 0 else f"b{k - 1}", stiffness=1))
        model.add(f"c{k}", ConstraintEquation(zero=f"b{k}.y"))
        model.request(f"r{k}", f"b{k}.x")
        bar.mass = 2
    assert [section.looks for section in sections] == [0, 0, 0, 0]
    with pytest.raises(InputError):
        model.remove("b1")
    assert sections[1].looks, "a part that is removed is looked for in all others"
