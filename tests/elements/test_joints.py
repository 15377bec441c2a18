"""Each joint's motion and reaction against formulas worked by hand."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import (
    AppliedForce,
    AppliedTorque,
    Body,
    Coupler,
    Distance,
    Drive,
    Fixed,
    Gear,
    InputError,
    Marker,
    Model,
    PointOnCurve,
    PointOnLine,
    Prismatic,
    RackAndPinion,
    Revolute,
    TorsionSpring,
)
from stiffmbs.compile.state import State

G = 9.81
RATE = 3.0


def reaction(solution, name):
    return np.stack([solution[f"{name}.fx"], solution[f"{name}.fy"]])


def test_rod_of_a_pendulum_carries_its_weight_and_its_swing():
    """Released at rest at an angle a: w^2 = 2 g/L (cos th - cos a), tension m (g cos th + L w^2)."""
    mass, length, start = 2.0, 0.7, 1.2
    model = Model(gravity=(0, -G))
    bob = Body(mass=mass, inertia=0.1, position=(1 + length * np.sin(start), 2 - length * np.cos(start)), omega=0.4)
    model.add("bob", bob)
    model.add("rod", Distance(i="bob", j=Marker(body="ground", point=(1, 2)), length=length))
    solution = stiffmbs.run(model, duration=2, rtol=1e-9)
    up = (2 - solution["bob.y"]) / length
    tension = mass * G * (up + 2 * (up - np.cos(start)))
    towards_pivot = np.stack([1 - solution["bob.x"], 2 - solution["bob.y"]]) / length
    np.testing.assert_allclose(reaction(solution, "rod"), tension * towards_pivot, atol=2e-6)
    np.testing.assert_allclose(solution["rod.torque"], 0, atol=1e-12)
    np.testing.assert_allclose(solution["bob.angle"], 0.4 * solution.time, atol=1e-8)


def turning_arm(**arm):
    """An arm pinned to ground at its centre and driven at RATE."""
    model = Model()
    model.add("arm", Body(mass=1, inertia=1, **arm))
    model.add("pivot", Revolute(i="arm", j="ground"))
    model.add("motor", Drive(joint="pivot", position=f"{arm.get('angle', 0)} + {RATE}*t"))
    return model


def test_bead_in_a_turning_slot_is_thrown_out():
    """x'' = w^2 x along the slot: x = x0 cosh w t, and the slot presses with 2 m w x'."""
    mass, x0, start = 0.3, 0.2, 0.6
    model = turning_arm(angle=start)
    along, across = np.array([np.cos(start), np.sin(start)]), np.array([-np.sin(start), np.cos(start)])
    model.add("bead", Body(mass=mass, inertia=0.01, position=tuple(x0 * along), velocity=tuple(RATE * x0 * across)))
    model.add("slot", PointOnLine(i="bead", j="arm"))
    solution = stiffmbs.run(model, duration=1, rtol=1e-9)
    angle, out = start + RATE * solution.time, x0 * np.cosh(RATE * solution.time)
    np.testing.assert_allclose(solution["bead.x"], out * np.cos(angle), atol=1e-6)
    np.testing.assert_allclose(solution["bead.y"], out * np.sin(angle), atol=1e-6)
    pressure = 2 * mass * RATE**2 * x0 * np.sinh(RATE * solution.time)
    np.testing.assert_allclose(reaction(solution, "slot"), pressure * [-np.sin(angle), np.cos(angle)], atol=1e-5)
    np.testing.assert_allclose(solution["motor.torque"], pressure * out, atol=1e-5)


@pytest.mark.parametrize("ratio", [0.4, -0.25], ids=["sun", "ring"])
def test_planet_on_a_turning_carrier(ratio):
    """Wheel 1 at rest: the planet turns 1 + 1/ratio times as fast as its carrier, from wherever it is drawn."""
    mass, arm, inertia, planet, torque = 0.5, 0.3, 0.02, 0.004, 0.7
    model = Model()
    model.add("wheel", Body(mass=1, inertia=1, angle=0.9))
    carrier = model.add("carrier", Body(mass=1, inertia=inertia, angle=0.3))
    model.add("planet", Body(mass=mass, inertia=planet, position=(arm * np.cos(0.3), arm * np.sin(0.3)), angle=-1.1))
    model.add("weld", Fixed(i="wheel", j=Marker(body="ground", angle=0.9)))
    model.add("sun_pin", Revolute(i="wheel", j="carrier"))
    model.add("planet_pin", Revolute(i="planet", j=carrier.at(arm, 0)))
    model.add("teeth", Gear(joint_1="sun_pin", joint_2="planet_pin", ratio=ratio))
    model.add("push", AppliedTorque(i="carrier", torque=torque))
    solution = stiffmbs.run(model, duration=1.5, rtol=1e-9)
    assert not solution.notes  # nothing is turned at the start
    speed = 1 + 1 / ratio
    alpha = torque / (inertia + mass * arm**2 + planet * speed**2)
    turned = alpha * solution.time**2 / 2
    np.testing.assert_allclose(solution["carrier.angle"], 0.3 + turned, atol=1e-7)
    np.testing.assert_allclose(solution["planet.angle"], -1.1 + speed * turned, atol=1e-6)
    np.testing.assert_allclose(solution["teeth.torque"], planet * speed * alpha / ratio, rtol=1e-9)


def test_gear_with_an_offset_turns_its_wheels_into_place():
    model = Model()
    for name, x in (("a", 0), ("b", 1)):
        model.add(name, Body(mass=1, inertia=1, position=(x, 0)))
        model.add(f"pin_{name}", Revolute(i=name, j=Marker(body="ground", point=(x, 0))))
    model.add("teeth", Gear(joint_1="pin_a", joint_2="pin_b", ratio=2, offset="10 deg"))
    solution = stiffmbs.run(model, duration=0.1)
    assert solution["a.angle"][0] + 2 * solution["b.angle"][0] == pytest.approx(np.radians(10), abs=1e-12)


@pytest.mark.parametrize("radius", [0.05, -0.05])
def test_pinion_moves_its_rack(radius):
    """x'' = (T/R)/(m + I/R^2): the teeth push the rack with m x''."""
    mass, inertia, torque, slope = 2.0, 0.01, 0.3, 0.5
    model = Model()
    model.add("bar", Body(mass=mass, inertia=1, position=(0.4, 0.1), angle=slope))
    model.add("wheel", Body(mass=1, inertia=inertia, angle=2.0))
    guide = Marker(body="ground", point=(0.4, 0.1), angle=slope)
    model.add("guide", Prismatic(i="bar", j=guide))
    model.add("pin", Revolute(i="wheel", j="ground"))
    model.add("teeth", RackAndPinion(rack="guide", pinion="pin", pitch_radius=radius))
    model.add("push", AppliedTorque(i="wheel", torque=torque))
    solution = stiffmbs.run(model, duration=1, rtol=1e-9)
    a = torque / radius / (mass + inertia / radius**2)
    along = np.array([[np.cos(slope)], [np.sin(slope)]])
    way = np.stack([solution["bar.x"] - 0.4, solution["bar.y"] - 0.1])
    np.testing.assert_allclose(way, a * solution.time**2 / 2 * along, atol=1e-7)
    np.testing.assert_allclose(solution["wheel.angle"], 2 + a * solution.time**2 / 2 / radius, atol=1e-6)
    np.testing.assert_allclose(reaction(solution, "teeth"), mass * a * along * np.ones_like(solution.time), rtol=1e-9)
    np.testing.assert_allclose(solution["teeth.torque"], 0, atol=1e-12)


@pytest.mark.long
def test_couplers_of_a_winch_and_of_two_slides():
    """A drum lifts a weight (m per rad), which moves a counterweight in a slot: one acceleration for all."""
    lift, share, drum, mass, other, torque = 0.2, -0.5, 0.05, 3.0, 1.5, 8.0
    model = Model(gravity=(0, -G))
    model.add("drum", Body(mass=1, inertia=drum))
    model.add("weight", Body(mass=mass, inertia=1, position=(1, 0.2)))
    model.add("counterweight", Body(mass=other, inertia=1, position=(2, 0.7)))
    model.add("pin", Revolute(i="drum", j="ground"))
    upwards = Marker(body="ground", point=(1, 0), angle="90 deg")
    model.add("shaft", Prismatic(i=Marker(body="weight", angle="90 deg"), j=upwards))
    model.add("slot", PointOnLine(i="counterweight", j=Marker(body="ground", point=(2, 0), angle="90 deg")))
    model.add("rope", Coupler(joint_1="shaft", joint_2="pin", scale=lift))
    model.add("lever", Coupler(joint_1="slot", joint_2="shaft", scale=share))
    model.add("push", AppliedTorque(i="drum", torque=torque))
    solution = stiffmbs.run(model, duration=1, rtol=1e-9)
    a = (torque / lift - G * (mass + share * other)) / (drum / lift**2 + mass + share**2 * other)
    rise = a * solution.time**2 / 2
    np.testing.assert_allclose(solution["weight.y"], 0.2 + rise, atol=1e-6)
    np.testing.assert_allclose(solution["counterweight.y"], 0.7 + share * rise, atol=1e-6)
    np.testing.assert_allclose(solution["drum.angle"], rise / lift, atol=1e-6)
    np.testing.assert_allclose(solution["rope.fy"], (torque - drum * a / lift) / lift, rtol=1e-9)
    np.testing.assert_allclose(solution["lever.fy"], other * (G + share * a), rtol=1e-9)


def two_wheels():
    model = Model()
    for name in ("a", "b", "c"):
        model.add(name, Body(mass=1, inertia=1))
    model.add("pin_a", Revolute(i="a", j="ground"))
    model.add("pin_b", Revolute(i="b", j="ground"))
    model.add("on_b", Revolute(i="c", j="b"))
    model.add("slide", Prismatic(i="c", j="ground"))
    model.add("slide_on_b", Prismatic(i="c", j="b"))
    model.add("weld", Fixed(i="c", j="a"))
    return model


OPEN_TABLE = {"table": [[0, 1], [1, 1]], "ends": "periodic"}
SPLINE = {"table": [[0, 1], [1, 1], [2 * np.pi, 1]]}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Distance(i="a", j="b", length=0), r"Distance: length: found 0, expected a length greater than 0 m"),
        (lambda: Distance(i="a", j="b"), r"length: found nothing, expected a value"),
        (lambda: PointOnLine(i="a", j="a"), r"x: found 'a' on both sides, expected two different bodies"),
        (lambda: PointOnLine(i="a"), r"j: found nothing"),
        (lambda: Gear(joint_1="pin_a", joint_2="pin_b", ratio=0), r"ratio: found 0, expected a number other than 0"),
        (lambda: Gear(joint_1="pin_a", joint_2="slide", ratio=1), r"x.joint_2: found 'slide' of the type prismatic, expected a revolute"),
        (lambda: Gear(joint_1="pin_a", joint_2="on_b", ratio=1), r"x.joint_2: found marker j of 'on_b' on 'b' and that of 'pin_a' on 'ground', expected both on the carrier"),
        (lambda: Gear(joint_1="pin_a", joint_2="pin_a", ratio=1), r"x.joint_2: found 'pin_a' a second time"),
        (lambda: Gear(joint_1="pin_z", joint_2="pin_a", ratio=1), r"x.joint_1: found the unknown joint 'pin_z'"),
        (lambda: RackAndPinion(rack="slide", pinion="pin_a", pitch_radius=0), r"pitch_radius: found 0"),
        (lambda: RackAndPinion(rack="pin_a", pinion="pin_b", pitch_radius=1), r"x.rack: found 'pin_a' of the type revolute, expected a prismatic"),
        (lambda: RackAndPinion(rack="slide_on_b", pinion="pin_a", pitch_radius=1), r"expected both on the carrier"),
        (lambda: Coupler(joint_1="slide", joint_2="weld", scale=1), r"x.joint_2: found 'weld' of the type fixed, expected a joint with a coordinate"),
        (lambda: Coupler(joint_1="slide", joint_2="pin_a", scale=0), r"scale: found 0"),
        (lambda: Coupler(joint_1="slide", joint_2="slide", scale=2), r"'slide' a second time"),
        (lambda: PointOnCurve(i="a", j="b"), r"found neither of 'y' and 'radius', expected exactly one"),
        (lambda: PointOnCurve(i="a", j="b", y="x", radius=1), r"found both of 'y' and 'radius', expected exactly one"),
        (lambda: PointOnCurve(i="a", j="b", y="2*t"), r"y: found t in '2\*t', expected a formula without it"),
        (lambda: PointOnCurve(i="a", j="b", y="a.x"), r"y: found a.x in 'a.x', expected a formula without coordinates"),
        (lambda: PointOnCurve(i="a", j="b", radius="angle"), r"radius: found 'angle', which is -6.28319 at angle -6.28319 and .* expected a formula that repeats every turn"),
        (lambda: PointOnCurve(i="a", j="b", radius="1 + step(angle, 0, 0, 1, 1)*step(angle, 2, 1, 3, 0)"), r"expected a formula that repeats every turn"),
        (lambda: PointOnCurve(i="a", j="b", radius=OPEN_TABLE), r"found a table with periodic ends over 1 rad, expected a periodic one over a full turn"),
        (lambda: PointOnCurve(i="a", j="b", radius=SPLINE), r"found a table with natural ends over 6.28318531 rad, expected a periodic one"),
    ],
)  # fmt: skip
def test_wrong_joints_are_refused_in_one_sentence(make, words):
    with pytest.raises(InputError, match=words) as raised:
        two_wheels().add("x", make())
    assert "\n" not in str(raised.value)


SCENE = """
bodies:
  a: {mass: 1, inertia: 1}
  b: {mass: 1, inertia: 1}
  c: {mass: 1, inertia: 1}
joints:
  teeth: {type: gear, joint_1: pin_a, joint_2: pin_b, ratio: 17/31}
  pin_a: {type: revolute, i: a, j: ground}
  pin_b: {type: revolute, i: b, j: ground}
  slide: {type: prismatic, i: c, j: ground}
  rod: {type: distance, i: a, j: b, length: 125 mm}
  slot: {type: point_on_line, i: a, j: {body: b, angle: 90 deg}}
  rack: {type: rack_and_pinion, rack: slide, pinion: pin_a, pitch_radius: -50 mm, offset: 1 cm}
  rope: {type: coupler, joint_1: slide, joint_2: pin_b, scale: 2 mm/rev}
  wire: {type: point_on_curve, i: a, j: b, y: 2*x^2}
  cam: {type: point_on_curve, i: a, j: b, radius: {table: [[0, 10 mm], [180 deg, 20 mm], [360 deg, 10 mm]], ends: periodic}}
"""


def test_scenes_say_the_same_as_python():
    cam = {"table": [[0, "10 mm"], ["180 deg", "20 mm"], ["360 deg", "10 mm"]], "ends": "periodic"}
    expected = {
        "rod": Distance(i="a", j="b", length=0.125),
        "slot": PointOnLine(i="a", j=Marker(body="b", angle=np.pi / 2)),
        "teeth": Gear(joint_1="pin_a", joint_2="pin_b", ratio=17 / 31),
        "rack": RackAndPinion(rack="slide", pinion="pin_a", pitch_radius=-0.05, offset=0.01),
        "rope": Coupler(joint_1="slide", joint_2="pin_b", scale=0.002 / (2 * np.pi)),
        "wire": PointOnCurve(i="a", j="b", y="2*x^2"),
        "cam": PointOnCurve(i="a", j="b", radius=cam),
    }
    joints = stiffmbs.read_scene(SCENE).joints
    assert {name: joints[name] for name in expected} == expected
    with pytest.raises(
        InputError, match=r"line 14, joints.rope.scale: found 'zero', expected|joints.rope.scale: found"
    ):
        stiffmbs.read_scene(SCENE.replace("2 mm/rev", "zero"))


def test_force_on_a_rod_with_coincident_points_is_told():
    model = Model()
    model.add("a", Body(mass=1, inertia=1))
    model.add("rod", Distance(i="a", j="ground", length=1))
    model.add("push", AppliedForce(i="a", force=(1, 0)))
    with pytest.raises(stiffmbs.AssemblyError, match=r"rod|singular"):
        stiffmbs.run(model, duration=0.1)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", [{}, {"presolve": False}, {"solver": "projected"}, {"solver": "auto"}], ids=str)
@pytest.mark.parametrize("turns", [-2, -1, 1, 3])
@pytest.mark.parametrize("on", ["i", "j"])
@pytest.mark.parametrize("kind", [Fixed, Prismatic])
def test_markers_drawn_whole_turns_apart_wind_up_no_spring(kind, on, turns, settings):
    """A body stays in the turn in which it is drawn, and a torsion spring on it as it is drawn."""
    angles = {"i": 1.5, "j": 1.5, on: 1.5 + 2 * np.pi * turns}
    model = Model()
    model.add("block", Body(mass=2.0, inertia=0.1))
    model.add("arm", Body(mass=1.0, inertia=0.2, angle=0.01))
    i, j = (Marker(body=body, angle=angles[side]) for side, body in (("i", "block"), ("j", "ground")))
    model.add("joint", kind(i=i, j=j))
    model.add("pin", Revolute(i="arm", j="block"))
    model.add("spring", TorsionSpring(i="arm", j="block", stiffness=10.0))
    solution = stiffmbs.run(model, duration=0.5, points=11, rtol=1e-8, **settings)
    np.testing.assert_allclose(solution["block.angle"], 0.0, atol=1e-9)
    turned = 0.01 * np.cos(np.sqrt(10.0 / 0.2) * solution.time)
    np.testing.assert_allclose(solution["arm.angle"], turned, atol=1e-6)


def test_the_equation_of_a_distance_is_its_stretch():
    """To first order: assembly and messages measure equations of positions in metres."""
    model = Model(gravity=(0, 0))
    model.add("a", Body(mass=1, inertia=1, position=(2.002, 0)))
    model.add("rod", Distance(i="a", j="ground", length=2))
    state = State(stiffmbs.compile_model(model.data()))
    state.evaluate("position", 0.0)
    assert state.vector("position", "C") == pytest.approx(0.002, rel=1e-3)


def test_a_weld_between_turning_bodies_keeps_their_angle():
    """Two bodies at 0.3 rad spin about their centre of mass at 2 rad/s; the equation itself is solved."""
    scene = stiffmbs.read_scene("""
bodies:
  a: {mass: 1, inertia: 1, angle: 0.3, omega: 2}
  b: {mass: 1, inertia: 1, position: [0.5, 0.2], angle: 0.3, omega: 2}
joints: {weld: {type: fixed, i: a, j: {body: b, point: [-0.5, -0.2]}}}
run: {duration: 1, rtol: 1e-9, presolve: false}
""")
    solution = stiffmbs.run(scene)
    np.testing.assert_allclose(solution["a.angle"], solution["b.angle"], atol=1e-7)
    assert solution["a.angle"][-1] > 1.5
