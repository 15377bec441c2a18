"""Bodies whose quaternions don't follow their spin: steps that don't depend on speed, and the numbers of the plain body."""

import math

import numpy as np
import pytest

from stiffmbs import load_scene, read_scene, run
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.warm import usual_kinds
from stiffmbs.compile.compile_model import kinds_of
from stiffmbs.presolve.reduced_model import ReducedModel
from stiffmbs.presolve.spinning_bodies import spinning
from stiffmbs.spatial import (
    AppliedForce,
    AppliedTorque,
    Body,
    Drive,
    FialaTyre,
    Fixed,
    Marker,
    Model,
    Orientation,
    Revolute,
    Spherical,
    TorsionSpring,
    WheelTorque,
)

AXLE = {"z": (0, 1, 0)}
WHEEL = {"mass": 20, "inertia": (0.7, 1.2, 0.7)}
DRIVEN = "60*sin(3*t) - 5*wy(wheel, fork)"
IN_ITS_AXES = "60*sin(3*t) - 5*wy(wheel, fork, wheel)"


def hub(body, along=0.0):
    return Marker(body=body, point=(0, along, 0), orientation=AXLE)


def rolling(speed=10.0, torque="0", **wheel):
    """A wheel in a fork that stays upright, on a level road."""
    model = Model("unicycle", gravity=(0, 0, -9.81))
    place = {"position": (0, 0, 0.29), "velocity": (speed, 0, 0)}
    model.add("fork", Body(mass=180, inertia=(5, 6, 7), **place))
    model.add("wheel", Body(**{**WHEEL, **wheel}, **place, omega=(0, speed / 0.2967, 0)))
    model.add("upright", Orientation(i="fork", j="ground"))
    model.add("pin", Revolute(i=hub("wheel"), j=hub("fork")))
    tyre = {"slip_stiffness": 8e4, "cornering_stiffness": 6e4, "mu_static": 1, "mu_sliding": 0.8, "width": 0.2}
    model.add("tyre", FialaTyre(i="wheel", radius=0.3, stiffness=2e5, damping=2000, **tyre))
    model.add("drive", AppliedTorque(i="wheel", j="fork", torque=(0, torque, 0)))
    return model


def top(spin, inertia=(0.05, 0.05, 0.02)):
    """A heavy top on a ball joint."""
    model = Model("top", gravity=(0, 0, -9.81))
    lean = (math.sin(0.5), 0.0, math.cos(0.5))
    place = {"position": tuple(0.3 * x for x in lean), "orientation": {"z": lean, "y": (0, 1, 0)}}
    model.add("top", Body(mass=1, inertia=inertia, **place, omega=(0, 0, spin)))
    model.add("ball", Spherical(i=Marker(body="top", point=(0, 0, -0.3)), j="ground"))
    return model


def spins(model, *turns):
    return spinning(model.data(), {name: np.array(turns) for name in model.bodies} if turns else {})


def steps(model, duration, **settings):
    return model.run(duration=duration, output=0.05, rtol=1e-6, **settings).solver["steps"]


@pytest.mark.long
def test_steps_do_not_depend_on_speed():
    counts = [steps(rolling(speed), 4) for speed in (5, 20, 80)]
    assert max(counts) <= 1.2 * min(counts)
    assert steps(rolling(80), 1, presolve=False) > 4 * max(counts)


@pytest.mark.long
def test_a_car_takes_steps_that_do_not_depend_on_speed(examples):
    """Straight ahead from steady motion, with the drag that the driver works against: nothing rings."""
    counts = []
    for speed in (5, 20, 80):
        found = run(load_scene(examples / "car.yaml", (("V", f"{speed} m/s"),)), duration=4, solver="bdf")
        counts.append(found.solver["steps"])
        assert np.ptp(found["rear.left.tyre.load"]) < 1e-3
    assert max(counts) <= 1.2 * min(counts)


def with_torque_off_the_axle():
    model = rolling(15)
    model.add("motor", WheelTorque(i=Marker(body="wheel", point=(0.1, 0, 0.05)), j="fork", torque="60*sin(3*t)"))
    return model


@pytest.mark.parametrize(
    "model",
    [rolling(15, DRIVEN), rolling(15, IN_ITS_AXES, inertia=(0.7, 0.7, 0.7)), top(80), with_torque_off_the_axle()],
    ids=["wheel", "ball", "top", "torque off the axle"],
)
def test_the_numbers_are_those_of_the_plain_body(model):
    settings = {"duration": 0.6, "output": 0.02, "rtol": 1e-8}
    one, plain = model.run(**settings), model.run(**settings, presolve=False)
    assert any("spin" in line for line in one.presolve) and not plain.presolve
    for name, expected in plain.channels.items():
        if not name.startswith("constraint"):
            scale = max(1.0, np.abs(expected).max())
            assert np.abs(one[name] - expected).max() <= 2e-5 * scale, name


@pytest.mark.long
def test_usual_bearings_of_spinning_bodies_are_compiled_ahead():
    usual = usual_kinds()
    for model in (rolling(), top(80)):
        data = model.data()
        axes = spinning(data, {name: np.array([0, 0, 80.0]) for name in model.bodies})
        spun = ReducedModel(data, data.bodies, axes=axes)
        found = [kind for kind in kinds_of(spun) if kind.spins]
        assert {kind.element.kind for kind in found} & {"revolute", "spherical"}
        assert set(found) <= set(usual)


def test_a_fast_top_takes_steps_by_its_precession():
    assert steps(top(300), 1) < steps(top(300), 1, presolve=False) / 4


def test_rigid_parts_spin_as_one_body():
    model = rolling(20)
    model.add("rim", Body(mass=5, inertia=(0.1, 0.2, 0.1), position=(0, 0.04, 0.29), velocity=(20, 0, 0)))
    model.add("weld", Fixed(i="rim", j=Marker(body="wheel", point=(0, 0.04, 0))))
    model.add("rub", AppliedForce(i="rim", force=(0, 0, -50)))
    one, plain = (model.run(duration=0.3, output=0.02, rtol=1e-8, presolve=p) for p in (True, False))
    assert any("orientation: wheel and rim" in line for line in one.presolve)
    for name in ("rim.q0", "rim.q2", "rim.wy", "rim.z", "weld.fx", "weld.tx", "pin.fz"):
        assert one[name] == pytest.approx(plain[name], abs=1e-5 * max(1.0, np.abs(plain[name]).max()))


@pytest.mark.parametrize(
    ("name", "element"),
    [
        ("off", AppliedForce(i=Marker(body="wheel", point=(0.1, 0, 0)), force=(0, 0, 1))),
        ("body_axes", AppliedForce(i="wheel", axes="body", force=(0, 0, 1))),
        ("seen", AppliedForce(i="fork", force=("wheel.q1", 0, 0))),
        ("across", AppliedForce(i="fork", force=("wheel.wx", 0, 0))),
        ("angle", AppliedForce(i="fork", force=("sin(ay(wheel, fork))", 0, 0))),
        ("axes", AppliedForce(i="fork", force=("vx(fork, ground, wheel)", 0, 0))),
        ("axis_across", AppliedForce(i="fork", force=("wx(wheel, fork, wheel)", 0, 0))),
        ("spring", TorsionSpring(i=hub("wheel"), j=hub("fork"), stiffness=1)),
        ("motor", Drive(joint="pin", velocity="30")),
        ("reaction", AppliedForce(i="fork", force=("0.01*fx(pin)", 0, 0))),
    ],
)
def test_what_sees_the_angle_of_the_spin_keeps_the_plain_body(name, element):
    model = rolling()
    assert spins(model) == {"wheel": "y"}
    model.add(name, element)
    assert spins(model) == {}


def test_the_shafts_of_a_driveline_spin_apart(examples):
    """Their rates are about their own axes."""
    content = (examples / "car.yaml").read_text()
    entry = """\
  driveline:
    use: driveline
    on: chassis
    drive: all
    position: [0, 0, -height]
    mounts: {front_left: front.left.wheel, front_right: front.right.wheel, rear_left: rear.left.wheel, rear_right: rear.right.wheel}
"""
    scene = read_scene(content.replace("\nforces:", f"\n{entry}forces:"), file=examples / "car.yaml")
    shafts = {f"driveline.{name}.input": "y" for name in ("main", "front", "rear")}
    wheels = {f"{end}.{side}.wheel": "y" for end in ("front", "rear") for side in ("left", "right")}
    assert spinning(scene, {}) == shafts | wheels


def test_a_wobbling_wheel_is_a_plain_body():
    assert spins(rolling(inertia=(0.7, 1.2, 0.7000001))) == {}
    assert spins(rolling(inertia=((0.7, 1e-7, 0), (1e-7, 1.2, 0), (0, 0, 0.7)))) == {}
    assert spins(rolling(center_of_mass=(1e-6, 0, 0))) == {}
    assert spins(rolling(center_of_mass=(0, 0.01, 0))) == {"wheel": "y"}


def test_a_free_body_spins_by_its_start():
    assert spins(top(80), 1, 2, 80) == {"top": "z"}
    assert spins(top(80), 1, 2, 6) == spins(top(80), 90, 2, 80) == spins(top(80, (0.05, 0.04, 0.02)), 1, 2, 80) == {}


def test_a_request_of_the_angle_keeps_counting_turns():
    model = rolling()
    model.request("turned", "ay(wheel, fork)")
    assert spins(model) == {}


def test_auto_keeps_spins_apart_where_it_begins_with_implicit_steps():
    found = rolling(20).run(duration=20, output=0.5, solver="auto")
    assert any("auto chose radau" in note for note in found.notes)
    assert any("spin" in line for line in found.presolve)
    assert found.solver["steps"] < 500


def test_explicit_steps_follow_the_spin():
    assert not any("spin" in line for line in top(80).run(duration=0.1, solver="auto").presolve)


def test_a_part_of_a_model_takes_no_rows():
    """As a monitor shows them before the first row of a run."""
    scene = """
dimensions: 3
bodies: {wheel: {mass: 1, inertia: [0.1, 0.2, 0.1], omega: [0, 30, 0]}}
joints: {axle: {type: revolute, i: {body: wheel, orientation: {z: [0, 1, 0]}}, j: {body: ground, orientation: {z: [0, 1, 0]}}}}
run: {duration: 1, points: 2}
"""
    job = prepare(read_scene(scene))
    (subsystem,) = job.subsystems
    own, whole = subsystem.start, job.start
    q, u = np.empty((0, len(whole.q))), np.empty((0, len(whole.u)))
    subsystem.part.put(np.empty((0, len(own.q))), np.empty((0, len(own.u))), q, u)
    assert len(q) == len(u) == 0
