"""Brakes and driving torques between wheels and what carries them."""

import math

import numpy as np
import pytest

from stiffmbs import InputError, read_scene, run
from stiffmbs.spatial import Body, Brake, Model, Revolute, WheelTorque

I, C = 1.2, 300.0
AXLE = {"z": (0, 1, 0)}


def hub(spin=0.0, fixed=True):
    """A wheel on an upright that is held, or free."""
    model = Model("hub", gravity=(0, 0, 0))
    model.add("wheel", Body(mass=20, inertia=(0.7, I, 0.7), omega=(0, spin, 0)))
    model.add("upright", Body(mass=10, inertia=(0.5, 0.5, 0.5)))
    model.add("bearing", Revolute(i={"body": "wheel", "orientation": AXLE}, j={"body": "upright", "orientation": AXLE}))
    if fixed:
        from stiffmbs.spatial import Fixed

        model.add("held", Fixed(i="upright", j="ground"))
    return model


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_brake_stops_a_wheel_and_holds_it(solver):
    """At C/I per second, but for the lag in which the torque builds up, and then not a turn more."""
    model = hub(spin=60.0)
    model.add("brake", Brake(i="wheel", j="upright", torque=C))
    found = model.run(duration=1.0, solver=solver, rtol=1e-7)
    sliding = (found.time > 0.1) & (found.time < 0.2)
    slopes = np.polyfit(found.time[sliding], found["wheel.wy"][sliding], 1)
    assert slopes[0] == pytest.approx(-C / I, rel=1e-4)
    at_rest = found.time > 0.5
    assert np.abs(found["wheel.wy"][at_rest]).max() < 1e-4
    assert found["brake.braking"].max() < C * (1 + 1e-6)


@pytest.mark.long
def test_a_held_wheel_does_not_creep():
    """Against a torque below the brake's it turns by -a log(1 - M/C) and stays; with a larger one it turns away."""
    angles = {}
    for moment in (0.5 * C, 1.2 * C):
        model = hub()
        model.add("brake", Brake(i="wheel", j="upright", torque=C))
        model.add("motor", WheelTorque(i="wheel", j="upright", torque=f"step(t, 0, 0, 5, {moment})"))
        found = model.run(duration=10.0, rtol=1e-6)
        assert found.success
        turned = 2 * np.arctan2(found["wheel.q2"], found["wheel.q0"])
        angles[moment] = np.unwrap(turned)
    assert angles[0.5 * C][-1] == pytest.approx(0.01 * -math.log(1 - 0.5), rel=2e-3)
    assert np.ptp(angles[0.5 * C][found.time > 6]) < 1e-7
    assert angles[1.2 * C][-1] > 1


@pytest.mark.long
@pytest.mark.parametrize("torque", [{"torque": C}, None], ids=["brake", "motor"])
def test_the_carrier_takes_the_opposite_torque(torque):
    model = hub(spin=20.0, fixed=False)
    element = Brake(i="wheel", j="upright", **torque) if torque else WheelTorque(i="wheel", j="upright", torque="50*t")
    model.add("element", element)
    found = model.run(duration=0.3, rtol=1e-8)
    momentum = I * found["wheel.wy"] + 0.5 * found["upright.wy"]
    assert momentum == pytest.approx(np.full(len(momentum), I * 20.0), rel=1e-8)
    assert np.ptp(found["upright.wy"]) > 1


@pytest.mark.long
def test_a_wheel_with_a_brake_keeps_its_spin_as_a_coordinate():
    """Steps don't grow with the speed, which a wheel solved for by its quaternion would cost."""
    steps = []
    for spin in (15.0, 150.0):
        model = hub(spin=spin)
        model.add("brake", Brake(i="wheel", j="upright", torque="step(t, 1, 0, 1.5, 20)"))
        steps.append(model.run(duration=1.0, solver="bdf", rtol=1e-5).solver["steps"])
    assert steps[1] < 1.5 * steps[0] + 20


SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  wheel: {mass: 300, inertia: [3, 1.2, 3], position: [0, 0, 0.3], velocity: [VELOCITY, 0, 0], omega: [0, VELOCITY/0.3, 0]}
  carrier: {mass: 1, inertia: [1, 1, 1], position: [0, 0, 0.3], velocity: [VELOCITY, 0, 0]}
joints:
  hub: {type: revolute, i: {body: wheel, orientation: {z: [0, 1, 0]}}, j: {body: carrier, orientation: {z: [0, 1, 0]}}}
  upright: {type: orientation, i: carrier, j: ground}
forces:
  tyre:
    type: fiala_tyre
    i: wheel
    radius: 300 mm
    stiffness: 200 N/mm
    damping: 2000
    slip_stiffness: 80 kN
    cornering_stiffness: 60000
    mu_static: 1
    mu_sliding: 0.8
    relaxation: [30 cm, 50 cm]
    road: {type: formula, z: SLOPE*x}
  brake: {type: brake, i: wheel, j: carrier, torque: TORQUE}
run: {duration: 5 s, rtol: 1e-6}
"""


@pytest.mark.long
def test_a_braked_wheel_stops_and_stands_on_a_slope():
    text = SCENE.replace("VELOCITY", "3").replace("SLOPE", "0.1").replace("TORQUE", "500 N m")
    found = run(read_scene(text))
    assert found.success
    assert found["wheel.x"][-1] < 9 / (2 * 500 / 0.3 / 304) + 0.2
    still = found.time > 4
    assert np.ptp(found["wheel.x"][still]) < 1e-6
    assert found["brake.braking"][-1] == pytest.approx(0.3 * 301 * 9.81 * math.sin(math.atan(-0.1)), rel=0.05)


def test_messages():
    with pytest.raises(InputError, match="windup: found 0, expected an angle greater than 0"):
        Brake(i="a", j="b", torque=1, windup=0)
