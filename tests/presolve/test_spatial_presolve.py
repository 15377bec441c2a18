"""The presolve in space: the same numbers with fewer unknowns, and every line of its report."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.elements.spatial.orientation import conjugate, matrix, rotated
from stiffmbs.model.read_scene import read_scene
from stiffmbs.spatial import (
    Body,
    Drive,
    Fixed,
    Gear,
    Marker,
    Model,
    Orientation,
    PointOnPlane,
    Prismatic,
    Revolute,
    Spherical,
    SpringDamper,
    TorsionSpring,
)

from .test_presolve import assert_same, both

WELDED = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  arm:
    mass: 2
    inertia: [0.02, 0.3, 0.3]
    position: [0.5, 0, 0]
    omega: [0, 0.3, 1]
    velocity: [0, 0.5, -0.15]
    markers: {end: {point: [0.5, 0, 0]}}
  head:
    mass: 1
    inertia: [[0.03, 0.01, -0.004], [0.01, 0.05, 0.002], [-0.004, 0.002, 0.06]]
    center_of_mass: [0.1, 0.05, -0.2]
    position: [1, 0, 0]
    orientation: {z: [1, 0, 1], x: [0, 1, 0]}
  tip: {mass: 0.5, inertia: [0.001, 0.002, 0.0025], position: [0.929, 0.1, 0.212], orientation: [0.5096, 0.2263, 0.4408, 0.7034]}
  lonely: {mass: 1, inertia: [0.1, 0.2, 0.25], position: [0, 3, 0], omega: [0.1, 4, 0.1]}
joints:
  ball: {type: spherical, i: {body: arm, point: [-0.5, 0, 0]}, j: ground}
  weld: {type: fixed, i: head, j: {body: arm, point: [0.5, 0, 0], orientation: {z: [1, 0, 1], x: [0, 1, 0]}}}
  cap: {type: fixed, i: tip, j: {body: head, point: [0.1, 0.2, 0.1], orientation: {euler: xyz, angles: [0.2, 0.4, 0.1]}}}
forces:
  spring: {type: spring_damper, i: tip, j: ground, stiffness: 50 N/m, damping: 1, free_length: 0.5}
  push: {type: force, i: {body: tip, point: [0.1, 0, 0.2]}, axes: body, force: ["3*sin(5*t)", 1, "-0.4*vx(tip)"]}
  twist: {type: torque, i: head, axes: body, torque: [0.5, "0.1*t", 0.2]}
  mount: {type: bushing, i: {body: head, point: [0, 0.1, 0]}, j: {body: ground, point: [1, 0, 0.2], orientation: {x: [0, 1, 0]}}, stiffness: [90, 70, 50, 3, 2, 1], damping: [1, 1, 1, 0.1, 0.1, 0.1]}
  other: {type: spring_damper, i: {body: lonely, point: [0.2, 0, 0.1]}, j: ground, stiffness: 50 N/m, free_length: 0.5}
run: {duration: 1, points: 51}
"""


@pytest.mark.long
@pytest.mark.parametrize(("solver", "scheme"), [("bdf", "dop853"), ("projected", "dop853")])
def test_welded_bodies_and_independent_mechanisms(solver, scheme):
    with_it, without = both(read_scene(WELDED), solver=solver, scheme=scheme, rtol=1e-10)
    assert_same(with_it, without, 5e-6)
    assert with_it.presolve == (
        "bodies merged by fixed joints: arm, head and tip",
        "2 independent mechanisms solved separately: arm, head and tip; lonely",
        f"{4 * 13 + 2 * 15} unknowns reduced to {2 * 13 + 2 * 3}",
    )


@pytest.mark.long
def test_differences_shrink_with_the_tolerance():
    gaps = []
    for rtol in (1e-5, 1e-7, 1e-9):
        with_it, without = both(read_scene(WELDED), rtol=rtol)
        gaps.append(max(np.max(np.abs(with_it[name] - without[name])) for name in ("tip.x", "head.q1", "lonely.wy")))
    assert gaps[0] < 1e-2
    assert gaps[1] < 0.1 * gaps[0]
    assert gaps[2] < 0.1 * gaps[1]


def random_turn(rng):
    p = rng.normal(size=4)
    return tuple(p / np.linalg.norm(p))


def random_body(rng, **place):
    turn = matrix(random_turn(rng))
    moments = rng.uniform(0.6, 1.0, 3) * rng.uniform(0.01, 0.2)
    tensor = turn @ np.diag(moments) @ turn.T
    centre = tuple(rng.uniform(-0.2, 0.2, 3))
    return Body(mass=rng.uniform(0.3, 3), inertia=tensor.tolist(), center_of_mass=centre, **place)


def welded_at(model, name, parent, rng):
    """A body fixed to another at random places and axes of both."""
    here, there, at = random_turn(rng), random_turn(rng), tuple(rng.uniform(-0.5, 0.5, 3))
    holder = model.bodies[parent]
    A = matrix(holder.orientation) @ matrix(there) @ matrix(here).T
    point = rng.uniform(-0.3, 0.3, 3)
    place = np.array(holder.position) + matrix(holder.orientation) @ at - A @ point
    model.add(name, random_body(rng, position=tuple(place), orientation=A.tolist()))
    i = Marker(body=name, point=tuple(point), orientation=here)
    model.add(f"weld_{name}", Fixed(i=i, j=Marker(body=parent, point=at, orientation=there)))


@pytest.mark.long
@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(seed=st.integers(0, 10**6), welds=st.integers(1, 3))
def test_random_welds_on_a_double_pendulum(seed, welds):
    rng = np.random.default_rng(seed)
    model = Model(gravity=tuple(rng.uniform(-9, 9, 3)))
    model.add("upper", random_body(rng, orientation=random_turn(rng), omega=tuple(rng.uniform(-1, 1, 3))))
    upper = model.bodies["upper"]
    A, elbow = matrix(upper.orientation), rng.uniform(-0.5, 0.5, 3)
    model.add("lower", random_body(rng, position=tuple(A @ elbow), orientation=random_turn(rng)))
    model.add(
        "ball",
        Spherical(i=Marker(body="upper", point=(0.4, 0.1, 0)), j=Marker(body="ground", point=tuple(A @ (0.4, 0.1, 0)))),
    )
    hinge = matrix(model.bodies["lower"].orientation).T @ A
    model.add(
        "elbow",
        Revolute(i=Marker(body="lower", orientation=hinge.tolist()), j=Marker(body="upper", point=tuple(elbow))),
    )
    model.add("coil", SpringDamper(i="lower", j="ground", stiffness=20, free_length=0.2))
    for k in range(welds):
        welded_at(model, f"extra{k}", str(rng.choice(list(model.bodies))), rng)
    with_it, without = both(model, duration=0.3, points=11, rtol=1e-9)
    assert_same(with_it, without, 1e-4)
    job = prepare(model)
    assert len(job.subsystems[0].dynamics.system.bodies) == 2


def test_two_welded_halves_are_a_whole():
    """Halves of a rod, each described by itself, swing as the rod does."""
    half = {"mass": 1, "inertia": (0.002, 1 / 12, 1 / 12)}
    across = {"z": (0, 1, 0)}
    halves, whole = Model(gravity=(0, 0, -9.81)), Model(gravity=(0, 0, -9.81))
    halves.add("inner", Body(position=(0.5, 0, 0), **half))
    halves.add("outer", Body(position=(1.5, 0, 0), **half))
    halves.add("weld", Fixed(i=Marker(body="outer", point=(-0.5, 0, 0)), j=Marker(body="inner", point=(0.5, 0, 0))))
    whole.add("rod", Body(mass=2, inertia=(0.004, 8 / 12, 8 / 12), position=(1, 0, 0)))
    for model, body, end in ((halves, "inner", -0.5), (whole, "rod", -1)):
        i = Marker(body=body, point=(end, 0, 0), orientation=across)
        model.add("hinge", Revolute(i=i, j=Marker(body="ground", orientation=across)))
    one, other = (stiffmbs.run(model, duration=1.0, points=21, rtol=1e-10) for model in (halves, whole))
    assert one.presolve[0] == "bodies merged by fixed joints: inner and outer"
    np.testing.assert_allclose((one["inner.x"] + one["outer.x"]) / 2, other["rod.x"], atol=1e-8)
    np.testing.assert_allclose(one["hinge.fz"], other["hinge.fz"], atol=1e-6)
    np.testing.assert_allclose(one["energy.kinetic"], other["energy.kinetic"], atol=1e-7)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(10))
def test_moments_of_no_distribution_of_mass_are_kept_by_welds(seed):
    """Bodies with `any_moments` among those that are merged, in any place."""
    rng = np.random.default_rng(seed)
    model = Model(gravity=(0, 0, -9.81))
    model.add("b0", random_body(rng, omega=(0.1, 0.2, 0.3)))
    for k in range(1, 3):
        welded_at(model, f"b{k}", f"b{rng.integers(k)}", rng)
    chosen = set(rng.choice(3, size=rng.integers(1, 4), replace=False).tolist())
    for k in chosen:
        body = model.bodies[f"b{k}"]
        turn = matrix(random_turn(rng))
        tensor = (turn @ np.diag([5.0, 30.0, 90.0]) @ turn.T).tolist()
        kept = body.model_dump(include={"mass", "center_of_mass", "position", "orientation", "omega"})
        model.bodies[f"b{k}"] = Body(**kept, inertia=tensor, any_moments=True)
    model.add("pin", Spherical(i="b0", j="ground"))
    with_it, without = both(model, duration=0.3, points=11, rtol=1e-9)
    assert any("bodies merged by fixed joints" in line for line in with_it.presolve)
    assert_same(with_it, without, 1e-4)


def cart(rail, **changes):
    """A cart with a tilted tensor of inertia on a rail of given axes, a pendulum on a ball and a spring to a point."""
    model = Model(gravity=(0.3, -9.81, 1))
    tensor = ((0.3, 0.01, 0.02), (0.01, 0.4, 0), (0.02, 0, 0.45))
    model.add("cart", Body(mass=3, inertia=tensor, center_of_mass=(0.1, 0.2, 0), orientation=rail, **changes))
    model.add("bar", Body(mass=1, inertia=(0.1, 0.3, 0.3), position=(0.3, 0, 0), omega=(0, 1, 0)))
    at = matrix(model.bodies["cart"].orientation) @ (0.1, -0.2, 0.3)
    j = Marker(body="ground", point=tuple(at), orientation=rail)
    model.add("rail", Prismatic(i=Marker(body="cart", point=(0.1, -0.2, 0.3)), j=j))
    model.add("ball", Spherical(i=Marker(body="bar", point=(-0.3, 0, 0)), j="cart"))
    model.add(
        "spring", SpringDamper(i="cart", j=Marker(body="ground", point=(1, 1, 1)), stiffness=100, free_length=0.5)
    )
    return model


@pytest.mark.parametrize(
    ("rail", "lines"),
    [
        ({"x": (1, 0, 0), "z": (0, 0, 1)}, ("cart.x, cart.y and cart.orientation", "")),
        ({"z": (1, 2, 0.5), "x": (0.3, 1, 0)}, ("cart.orientation", "cart.x (0.5 of cart.y) and cart.z (0.25 of cart.y)")),
        ({"z": (3, 0, 4), "x": (0, 1, 0)}, ("cart.y and cart.orientation", "cart.x (0.75 of cart.z)")),
    ],
    ids=["along z", "slanted", "across y"],
)  # fmt: skip
def test_a_cart_keeps_one_coordinate(rail, lines):
    with_it, without = both(cart(rail), duration=1.0, points=21, rtol=1e-10)
    still, tied = lines
    assert with_it.presolve[0] == f"coordinates fixed by constant equations: {still}"
    assert not tied or with_it.presolve[1] == f"coordinates in a constant ratio: {tied}"
    assert with_it.presolve[-1] == "42 unknowns reduced to 21"  # 7 + 1 coordinates, 6 + 1 velocities, 3 + 3 of the ball
    assert_same(with_it, without, 1e-5)
    np.testing.assert_allclose(with_it["cart.q0"], with_it["cart.q0"][0], atol=1e-15)


def table(slope):
    """A plate that keeps its axes on a plane, or two of them."""
    model = Model(gravity=(0.4, 0.2, -9.81))
    model.add("plate", Body(mass=2, inertia=(0.1, 0.2, 0.25), velocity=(0.3, 0, 0)))
    model.add("upright", Orientation(i="plate", j="ground"))
    for k, name in enumerate(slope):
        normal = Marker(body="ground", orientation={"z": name})
        model.add(f"plane{k}", PointOnPlane(i=Marker(body="plate", point=(0.1 * k, 0, 0.2)), j=normal))
    return model


@pytest.mark.parametrize(
    ("normals", "kept"),
    [([(0, 0, 1)], 2), ([(1, 0, 1)], 2), ([(0, 0, 1), (0, 1, 0)], 1), ([(1, 1, 1), (0, 1, 0)], 1), ([(1, 2, 3), (3, -1, 2)], 1)],
)  # fmt: skip
def test_a_plate_on_planes(normals, kept):
    model = table(normals)
    for k in range(len(normals)):  # through where the points are drawn
        j = model.joints[f"plane{k}"].j
        model.joints[f"plane{k}"] = PointOnPlane(
            i=model.joints[f"plane{k}"].i, j=Marker(body="ground", point=(0.1 * k, 0, 0.2), orientation=j.orientation)
        )
    with_it, without = both(model, duration=1.0, points=11, rtol=1e-9)
    assert_same(with_it, without, 1e-6)
    (subsystem,) = prepare(model).subsystems or [prepare(model)]
    assert subsystem.dynamics.coordinates.independent.sum() == kept
    assert subsystem.dynamics.coordinates.independent_u.sum() == kept


def test_a_plane_with_three_slopes_stays():
    """One equation in three coordinates saves none."""
    model = table([(1, 2, 3)])
    assert prepare(model).dynamics.coordinates.independent.sum() == 3


def test_sliders_on_sliders_stand_upright():
    """The second slider's orientation stands still as soon as the first one's does."""
    model = Model(gravity=(1, 2, -9))
    for k, axis in enumerate([(1, 0, 0), (0, 1, 0), (1, 0, 1)]):
        model.add(f"slide{k}", Body(mass=1 + k, inertia=(0.1, 0.2, 0.25)))
        j = Marker(body=f"slide{k - 1}" if k else "ground", orientation={"z": axis})
        model.add(f"rail{k}", Prismatic(i=Marker(body=f"slide{k}", orientation={"z": axis}), j=j))
    with_it, without = both(model, duration=0.5, points=6, rtol=1e-11)
    assert with_it.presolve[0].startswith(
        "coordinates fixed by constant equations: slide0.y, slide0.z, slide0.orientation"
    )
    assert "slide2.orientation" in with_it.presolve[0]
    assert_same(with_it, without, 1e-5)


def test_what_turns_is_not_held():
    """A block that slides on a turning arm, and a universal joint, keep their orientations."""
    model = Model(gravity=(0, 0, -9.81))
    model.add("arm", Body(mass=1, inertia=(0.1, 0.2, 0.25), omega=(0, 0, 1)))
    model.add("block", Body(mass=1, inertia=(0.1, 0.2, 0.25), omega=(0, 0, 1)))
    model.add("hinge", Revolute(i="arm", j="ground"))
    along = {"z": (1, 0, 0)}
    model.add("slot", Prismatic(i=Marker(body="block", orientation=along), j=Marker(body="arm", orientation=along)))
    with_it, without = both(model, duration=0.5, points=6, rtol=1e-9)
    assert with_it.presolve[0] == "coordinates fixed by constant equations: arm.x, arm.y and arm.z"
    assert_same(with_it, without, 1e-6)


def test_a_body_that_nothing_lets_move():
    model = Model(gravity=(0, 0, -9.81))
    model.add("stone", Body(mass=2, inertia=(1, 1, 1)))
    model.add("floor", Fixed(i="stone", j="ground"))
    solution = stiffmbs.run(model, duration=1.0, points=5)
    np.testing.assert_allclose(solution["floor.fz"], 2 * 9.81, rtol=1e-12)


def driven_and_welded(rng):
    """A motor turns a wheel on which a body is welded askew, a gear takes it to a second one; a third turns by itself."""
    model = Model(gravity=(1, 2, -9.81))
    for k in range(3):
        model.add(f"wheel{k}", Body(mass=1, inertia=(0.1, 0.1, 0.2), position=(k, 0, 0), omega=(0, 0, 9.0 * (k == 2))))
        model.add(f"pin{k}", Revolute(i=f"wheel{k}", j=Marker(body="ground", point=(k, 0, 0))))
    model.add("mesh", Gear(joint_1="pin0", joint_2="pin1", ratio=1.3))
    model.add("motor", Drive(joint="pin0", position="8*t + 5*t^2"))
    model.add("coil", TorsionSpring(i="wheel2", j="ground", stiffness=2))
    welded_at(model, "askew", "wheel1", rng)
    welded_at(model, "more", "wheel2", rng)
    return model


@pytest.mark.long
def test_turns_are_counted_where_mechanisms_are_solved_apart():
    model = driven_and_welded(np.random.default_rng(4))
    with_it, without = both(model, duration=2.0, points=21, rtol=1e-10)
    assert_same(with_it, without, 1e-5)
    assert with_it.presolve[:2] == (
        "bodies merged by fixed joints: wheel1 and askew",
        "bodies merged by fixed joints: wheel2 and more",
    )
    assert any(
        "independent mechanisms solved separately: wheel0, wheel1 and askew; wheel2 and more" in line
        for line in with_it.presolve
    )
    t = with_it.time
    np.testing.assert_allclose(with_it["wheel0.q3"] ** 2, np.sin((8 * t + 5 * t**2) / 2) ** 2, atol=1e-7)


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("kind", ["bushing", "field"])
def test_a_bushing_on_merged_bodies_starts_at_the_angle_that_is_drawn(kind, seed):
    """The quaternions of merged bodies have the signs of those that are drawn, so that no bushing is wound up by a turn."""
    rng = np.random.default_rng(seed)
    base, cap, hung = (tuple(q / np.linalg.norm(q)) for q in rng.standard_normal((3, 4)))
    tensor = [[0.3, 0.02, 0], [0.02, 0.4, 0.01], [0, 0.01, 0.5]]
    scene = {
        "dimensions": 3,
        "gravity": [0, 0, -9.81],
        "bodies": {
            "base": {"mass": 1, "inertia": [0.5, 0.3, 0.4], "orientation": base},
            "cap": {"mass": 1, "inertia": tensor, "position": [0, 0.2, 0], "orientation": cap},
            "hung": {"mass": 1, "inertia": tensor, "position": [0, 0, -0.5], "orientation": hung},
        },
        "joints": {
            "weld": {"type": "fixed", "i": _level("cap", cap), "j": _level("base", base, rotated(conjugate(base), (0, 0.2, 0)))},
        },
        "forces": {
            "rubber": {
                "type": kind, "i": _level("hung", hung), "j": _level("cap", cap), "stiffness": [50, 60, 70, 3, 4, 5],
                "damping": [1, 1, 1, 0.1, 0.1, 0.1], "preload": [0, 0, 0, 0.1, 0, 0],
            },
        },
    }  # fmt: skip
    assert_same(*both(read_scene(json.dumps(scene, default=list)), duration=0.2, points=6, rtol=1e-9), 1e-5)


def _level(body, orientation, point=(0, 0, 0)):
    """A marker along the ground's axes, as a matrix, which has two quaternions."""
    return {"body": body, "point": list(point), "orientation": matrix(conjugate(orientation)).tolist()}
