"""Linearly implicit Euler and its extrapolation: orders, stiff bushings, bounded work, states, and what they refuse."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.model.read_scene import read_scene

ARM = Path(__file__).parents[2] / "bench" / "scenes" / "arm.xml"
SCHEMES = {"linearly_implicit_euler": 1, "extrapolated_euler": 2}
WITH_STATES = """
gravity: [0, -9.81]
bodies:
  mass: {mass: 2, inertia: 0.1, position: [0.3, 0], markers: {end: {point: [-0.3, 0]}}}
joints:
  pin: {type: revolute, i: mass.end, j: ground}
states:
  filtered: {rate: 20*(mass.vy - filtered), start: 0.2}
  level: {zero: level^3 + level - 2 - mass.angle, start: 1}
forces:
  actuator: {type: force, i: mass, force: [0, -30*filtered + 5*level]}
"""


def error(scene, scheme, step, duration, reference):
    found = stiffmbs.run(scene, solver="projected", scheme=scheme, step=step, duration=duration, points=5, errors=False)
    channels = [name for name in reference if name.rpartition(".")[2] in ("x", "y", "z", "vx", "vy", "vz")]
    return max(np.abs(found[name] - reference[name]).max() for name in channels)


def exact(scene, duration):
    return stiffmbs.run(scene, solver="bdf", rtol=1e-10, duration=duration, points=5, errors=False)


@pytest.mark.parametrize("name", ["cart_pendulum.yaml", "heavy_top.yaml", "half_car.yaml", "arm", "states"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_errors_have_the_order_of_the_scheme(examples, scheme, name):
    scenes = {"arm": lambda: ARM, "states": lambda: read_scene(WITH_STATES)}
    scene = scenes.get(name, lambda: stiffmbs.load_scene(examples / name))()
    reference = exact(scene, 0.2)
    errors = [error(scene, scheme, step, 0.2, reference) for step in (1e-3, 2.5e-4)]
    assert np.log(errors[0] / errors[1]) / np.log(4) == pytest.approx(SCHEMES[scheme], abs=0.2)


@pytest.mark.parametrize("stiffness", ["1e5 N/m", "1e9 N/m"])
@pytest.mark.parametrize(
    ("scheme", "factors", "close"), [("linearly_implicit_euler", 1, 3e-3), ("extrapolated_euler", 3, 2e-4)]
)
def test_stiff_bushings_need_no_shorter_steps_and_no_iterations(examples, scheme, factors, close, stiffness):
    car = stiffmbs.load_scene(examples / "half_car.yaml", [("parameters.k_b", stiffness)])
    reference = stiffmbs.run(car, solver="bdf", rtol=1e-9, duration=1, points=21)
    found = stiffmbs.run(car, solver="projected", scheme=scheme, step=1e-3, duration=1, points=21, errors=False)
    assert 1000 <= found.solver["steps"] < 1010  # a few more at breakpoints
    assert found.solver["factorizations"] == factors * found.solver["steps"]
    for name in ("chassis.y", "front.y", "rear.y"):
        np.testing.assert_allclose(found[name], reference[name], rtol=0, atol=close)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_constraints_are_satisfied_at_the_end_of_each_step(examples, scheme):
    found = stiffmbs.run(examples / "spatial_chain.yaml", solver="projected", scheme=scheme, step=1e-3, duration=0.2)
    assert found["constraint.position"].max() < 1e-11
    assert found["constraint.velocity"].max() < 1e-11


@pytest.mark.parametrize("scheme", SCHEMES)
def test_contacts_are_not_located_which_a_note_tells(examples, scheme):
    found = stiffmbs.run(examples / "bouncing_ball.yaml", solver="projected", scheme=scheme, step=1e-3, duration=0.5)
    assert any(f"{scheme} does not locate breakpoints" in str(note) for note in found.notes)


@pytest.mark.parametrize(
    ("named", "section", "entry"),
    [
        ("forces.rubbing", "forces", "rubbing: {type: joint_friction, joint: pin, radius: 10 mm, friction: 0.2}"),
        ("states.load", "states", "load: {rate: fy(pin) - load, start: 0}"),
    ],
)
def test_what_depends_on_reactions_is_refused_by_name(named, section, entry):
    scene = read_scene(WITH_STATES.replace(f"{section}:", f"{section}:\n  {entry}"))
    with pytest.raises(InputError, match=f"on which {named} depend.*use solver bdf or radau"):
        stiffmbs.run(scene, solver="projected", scheme="extrapolated_euler", step=1e-3, duration=0.1)


SPINNING = """
dimensions: 3
bodies: {a: {mass: 1, inertia: [2e-3, 2e-3, 3e-3], omega: [0, 0, 50]}}
joints: {r: {type: revolute, i: a, j: ground}}
forces: {tq: {type: torque, i: a, torque: [0, 0, "-1e-3*r.angle"]}}
"""


@pytest.mark.parametrize("scheme", SCHEMES)
def test_angles_in_space_are_counted_beyond_a_turn(scheme):
    """Turn counters stood still, and a torsional spring over 13 turns pulled towards the nearest one."""
    t, w = np.linspace(0.0, 0.2, 5), np.sqrt(1e-3 / 3e-3)
    errors = []
    for step in (1e-3, 5e-4):
        found = stiffmbs.run(
            read_scene(SPINNING), solver="projected", scheme=scheme, step=step, duration=0.2, points=5, errors=False
        )
        errors.append(np.abs(found["r.angle"] - 50 / w * np.sin(w * t)).max())
    assert errors[0] < 0.01 and errors[0] / errors[1] == pytest.approx(2 ** SCHEMES[scheme], rel=0.05)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("step, is_noted", [(1e-2, True), (5e-4, False)])
def test_a_growth_that_steps_do_not_resolve_is_noted(scheme, step, is_noted):
    """Where a motion grows faster than 1/h, a step reverses it: the body came to rest on top of a hill, without a word."""
    scene = read_scene("""
        bodies: {a: {mass: 1, inertia: 1, position: [1e-6, 0]}}
        joints: {rail: {type: prismatic, i: a, j: ground}}
        forces: {hill: {type: force, i: a, force: ["1e6*a.x - 1e7*a.x^3", 0]}}
    """)
    settings = {"solver": "projected", "scheme": scheme, "step": step}
    found = stiffmbs.run(scene, **settings, points=11, errors=False)
    assert any("grows faster than a step" in note for note in found.notes) == is_noted
    sim = stiffmbs.simulation(scene, **settings)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        sim.step(0.1)
        sim.steps(2, dt=0.1)
    assert len(told) == is_noted


def test_an_algebraic_state_without_a_solution_stops_the_run():
    """The linear equation of a step has one: the state went on at another solution, far away."""
    scene = read_scene("""
        bodies: {a: {mass: 1, inertia: 1}}
        states: {Q: {zero: Q^3 - 0.3*Q - t + 0.5, start: -0.9}}
        forces: {f: {type: force, i: a, force: [0.1*Q, 0]}}
    """)
    found = stiffmbs.run(
        scene, solver="projected", scheme="extrapolated_euler", step=0.01, duration=1, points=101, errors=False
    )
    assert found.t[-1] == pytest.approx(0.56)
    assert "no solution near their last values" in found.message
