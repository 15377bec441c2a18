"""Channels that a simulation reads one by one, against those that a solution computes together."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.dynamics.dynamics import Dynamics

PLANE = """
gravity: [0, -9.81]
parameters: {k: 30 N/m}
tables: {law: {table: [[-2, 1], [0, 0], [2, 3]], lines: true}}
inputs: {push: 2 N}
bodies:
  cart: {mass: 2, inertia: 0.1, velocity: [0.3, 0]}
  bar: {mass: 1, inertia: 0.04, position: [0.3, 0], omega: 2, markers: {tip: {point: [0.3, 0], angle: 20 deg}}}
states: {lag: {rate: cart.vx - lag}}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: cart}
forces:
  spring: {type: spring_damper, i: bar.tip, j: {body: ground, point: [2, 0]}, stiffness: k, damping: 0.3}
  motor: {type: force, i: cart, force: [push, 0]}
requests:
  place: {x: dx(bar.tip), y: "dy(bar.tip, cart, bar)", distance: "dm(bar.tip, cart)", angle: "az(bar.tip, cart)"}
  speed: {x: vx(bar.tip), m: vm(bar.tip), r: "vr(bar.tip, cart)", w: wz(bar)}
  acceleration: {x: accx(bar.tip), m: accm(bar.tip), w: wdtz(bar)}
  load: {x: fx(hinge), along: "fy(hinge, bar)", m: fm(hinge), second: tz(hinge.j), spring: "fx(spring.j, bar)"}
  rate: hinge.angle_rate*2 + slow
  slow: 0.1*t + lag
  table: law(bar.x) + max(bar.x, 0.2, cart.x) - min(1, bar.y) + step(t, 0, 0, 1, 2) + branch(bar.y, 1, 2, 3)
  rest: mod(10*bar.angle, 3) + floor(bar.x) + sign(bar.y) + abs(bar.y)^0.5 + atan2(bar.y, bar.x) + (-2)^3
  energy_share: energy.kinetic/energy.total
  never: sqrt(-1 - bar.x^2)
  pole: 1/(bar.x - bar.x)
  power: push*cart.vx
run: {duration: 1, rtol: 1e-7}
"""
SPACE = """
dimensions: 3
gravity: [0, 0, -9.81]
inputs: {push: 1 N m}
bodies:
  a:
    mass: 2
    inertia: [[0.3, 0.02, 0], [0.02, 0.2, 0.01], [0, 0.01, 0.4]]
    position: [0.3, 0, 0]
    omega: [0, 7, 0]
    velocity: [0, 0, -2.1]
    markers: {m: {point: [0.1, 0.2, 0.3], orientation: {z: [1, 1, 0]}}, pin: {point: [-0.3, 0, 0], orientation: {z: [0, 1, 0]}}}
  b: {mass: 1, inertia: [0.1, 0.1, 0.2], position: [1, 0, 1], omega: [1, 2, 9], velocity: [1, 0, 2]}
markers: {pin: {orientation: {z: [0, 1, 0]}}}
joints: {hinge: {type: revolute, i: a.pin, j: ground.pin}}
forces:
  motor: {type: torque, i: a, torque: [0, push, 0]}
  bushing: {type: bushing, i: b, j: a.m, stiffness: [100, 110, 120, 3, 4, 5]}
requests:
  place: {x: dx(a.m), z: "dz(b, a.m, a.m)", m: dm(a.m), turn: "az(a.pin, ground.pin)", tilt: "ax(b, a.m)", roll: "ay(b, a.m)"}
  euler: {psi: "psi(b, a.m)", theta: "theta(b, a.m)", phi: "phi(b, a.m)", q0: "q0(b, a.m)", q3: "q3(b, a.m)"}
  speed: {x: vx(a.m), z: "vz(b, a.m, a.m)", m: vm(a.m), r: "vr(b, a.m)", wx: "wx(b, a.m, b)", wm: wm(b)}
  acceleration: {x: accx(a.m), z: "accz(b, a.m, a.m)", m: accm(a.m), w: "wdty(b, a.m, a.m)", wm: wdtm(b)}
  load: {x: fx(hinge), y: "fy(hinge, a.m)", m: fm(hinge), t: "tx(hinge, a.m)", tm: tm(hinge), second: tx(bushing.j), third: "tz(bushing.j, b)"}
  joint: hinge.angle_acceleration + hinge.angle_rate^2
run: {duration: 1, rtol: 1e-7}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", [{}, {"solver": "projected"}], ids=["bdf", "dop853"])
@pytest.mark.parametrize("scene", [PLANE, SPACE], ids=["plane", "space"])
def test_a_channel_read_alone_is_that_of_all_channels(scene, solver):
    """Both are taken at one state; body coordinates that are read alone are not projected onto the constraints."""
    sim = stiffmbs.simulation(stiffmbs.read_scene(scene), **solver)
    for k in range(4):
        sim.step(0.05, inputs={"push": float(k // 2)})
        alone = {name: sim[name] for name in sim.channels}
        sim._instant.forget()
        one_by_one = {name: sim[name] for name in reversed(list(sim.channels))}
        for found in (alone, one_by_one):
            for name, expected in sim.channels.items():
                np.testing.assert_allclose(found[name], expected, rtol=1e-7, atol=1e-7, err_msg=name)


def test_positions_and_velocities_are_read_without_a_report(monkeypatch):
    """Also of bodies next to one whose own axes are not principal ones: a reading took 400 us in place of 1 us."""
    sim = stiffmbs.simulation(stiffmbs.read_scene(SPACE))
    sim.step(0.01)
    names = [f"{body}.{name}" for body in "ab" for name in ("x", "y", "z", "vx", "vy", "vz")]
    names += ["b.wx", "b.wy", "b.wz", "hinge.angle"]
    expected = sim.channels
    sim.step(1e-12)

    def no_report(*_, **named):
        raise AssertionError("a report was computed")

    monkeypatch.setattr(Dynamics, "report", no_report)
    assert {name: sim[name] for name in names} == pytest.approx({name: expected[name] for name in names}, abs=1e-6)


def test_an_unknown_channel_is_named_with_similar_ones():
    sim = stiffmbs.simulation(stiffmbs.read_scene(PLANE))
    with pytest.raises(stiffmbs.InputError, match=r"found no channel 'hinge.angl' \(did you mean 'hinge.angle'"):
        sim["hinge.angl"]


def wheel(**requests):
    model = stiffmbs.spatial.Model()
    axis = {"z": (0, 1, 0)}
    body = model.add("wheel", stiffmbs.spatial.Body(mass=1, inertia=(0.3, 0.5, 0.3), omega=(0, 40, 0)))
    ground = stiffmbs.spatial.Marker(body="ground", orientation=axis)
    model.add("hinge", stiffmbs.spatial.Revolute(i=body.at(0, 0, 0, axis), j=ground))
    for name, formula in requests.items():
        model.request(name, formula)
    return model


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("requests", [{}, {"turn": "hinge.angle"}], ids=["followed", "counted"])
def test_an_angle_counts_full_turns_over_the_steps(requests, tmp_path):
    sim = stiffmbs.simulation(wheel(**requests))
    for _ in range(1500):  # more than are kept at a time
        sim.step(0.02)
    np.testing.assert_allclose(sim["hinge.angle"], 40 * 30.0, rtol=1e-5)
    np.testing.assert_allclose(sim.channels["hinge.angle"], 40 * 30.0, rtol=1e-5)
    sim.save(tmp_path / "state.npz")
    again = stiffmbs.simulation(wheel(**requests))
    again.load(tmp_path / "state.npz")
    again.step(0.02)
    expected = 40 * 30.02 if not requests else again["turn"]
    np.testing.assert_allclose(again["hinge.angle"], expected, rtol=1e-5)
    sim.reset()
    assert sim["hinge.angle"] == 0
