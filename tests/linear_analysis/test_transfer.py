"""Transfer functions against closed forms and against runs of small amplitude."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import AppliedForce, Body, Marker, Model, Revolute
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.commands.main import main
from stiffmbs.elements.spatial.orientation import matrix
from stiffmbs.errors import InputError
from stiffmbs.linear_analysis.transfer import Transfer

from ..conftest import EXAMPLES

OSCILLATOR = """
parameters: {road: 0, push: 0}
bodies: {a: {mass: 2, inertia: 1, position: [0, 1], markers: {end: {point: [0.5, 0]}}}}
joints:
  rail: {type: prismatic, i: a, j: {body: ground, point: [0, 1]}}
forces:
  spring: {type: force, i: a, force: ["-50*(a.x - road) - 4*a.vx + push", 0]}
"""
DRIVEN = """
parameters: {travel: 0}
gravity: [0, -9.81]
bodies:
  cart: {mass: 3, inertia: 1}
  bob: {mass: 1, inertia: 0.02, position: [0, -0.5]}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: {body: bob, point: [0, 0.5]}, j: cart}
  drive: {type: drive, joint: rail, position: travel}
forces:
  air: {type: force, i: bob, force: ["-0.3*bob.vx", 0]}
"""


def test_a_force_and_a_road_on_an_oscillator():
    """x = F/(k + d s + m s^2), and the road acts as the force k times its height."""
    made = lambda **values: stiffmbs.read_scene(  # noqa: E731
        OSCILLATOR, [(f"parameters.{name}", repr(value)) for name, value in values.items()]
    )
    found = transfer(
        made(),
        {"road": lambda value: made(road=value), "push": lambda value: made(push=value)},
        ["a.x", "a.vx", "a.ax"],
    )
    frequencies = np.array([0.05, 0.7, 5.0])
    s = 2j * np.pi * frequencies
    x = 1 / (50 + 4 * s + 2 * s**2)
    expected = np.stack(
        [np.stack([50 * x, x], -1), np.stack([50 * x * s, x * s], -1), np.stack([50 * x * s**2, x * s**2], -1)], 1
    )
    np.testing.assert_allclose(found.response(frequencies), expected, rtol=1e-7)
    space = found.state_space()
    direct = [space.C @ np.linalg.solve(value * np.eye(len(space.A)) - space.A, space.B) + space.D for value in s]
    np.testing.assert_allclose(direct, expected, rtol=1e-7)


def test_a_force_at_a_marker_turns_its_body_too():
    text = "bodies: {a: {mass: 2, inertia: 4, markers: {end: {point: [0.5, 0]}}}}"
    found = transfer(stiffmbs.read_scene(text), ["a.end.fy", "a.torque"], ["a.ay", "a.alpha"])
    np.testing.assert_allclose(found.d, [[0.5, 0], [0.125, 0.25]], atol=1e-9)


def test_an_input_may_move_a_constraint():
    """A pendulum of which the pivot is driven: J angle'' + d L^2 angle' + m g L angle = -(m L s^2 + d L s) travel."""
    made = lambda value: stiffmbs.read_scene(DRIVEN, [("parameters.travel", repr(value))])  # noqa: E731
    found = transfer(made(0.0), {"travel": made}, ["cart.x", "bob.x", "bob.angle"])
    s = 2j * np.pi * np.array([0.1, 0.66, 3.0])
    inertia, drag = 0.02 + 0.5**2, 0.3
    angle = -(0.5 * s**2 + drag * 0.5 * s) / (inertia * s**2 + drag * 0.25 * s + 9.81 * 0.5)
    expected = np.stack([np.ones(3), 1 + 0.5 * angle, angle], -1)[:, :, None]
    np.testing.assert_allclose(found.response(s.imag / (2 * np.pi)), expected, rtol=1e-6, atol=1e-8)
    with pytest.raises(
        InputError, match=r"output 'bob.vx': found a velocity, acceleration or reaction, expected a displ"
    ):
        transfer(made(0.0), {"travel": made}, ["bob.vx"])


@pytest.mark.parametrize("formula", ["bob.vx", "2*vr(bob, ground)", "fx(drive)", "hinge.torque + 1", "accx(cart)"])
def test_a_request_that_feels_a_moved_constraint_is_refused_as_its_channels_are(formula):
    text = f"{DRIVEN}\nrequests: {{place: dx(bob), felt: '{formula}', through: felt - place}}"
    made = lambda value: stiffmbs.read_scene(text, [("parameters.travel", repr(value))])  # noqa: E731
    found = transfer(made(0.0), {"travel": made}, ["place", "bob.x"])
    np.testing.assert_allclose(found.c[0], found.c[1], atol=1e-9)
    with pytest.raises(InputError, match=r"output 'through': found a velocity, acceleration or reaction"):
        transfer(made(0.0), {"travel": made}, ["through"])


LEVER = """
parameters: {offset: 0 m, load: 3 kg}
gravity: [0, -9.81]
bodies:
  bar: {mass: load, inertia: 0.4, markers: {pivot: {point: [offset - 0.3, 0]}, tip: {point: [0.3, 0]}}}
joints:
  hinge: {type: revolute, i: bar.pivot, j: {body: ground, point: [-0.3, 0]}}
forces:
  spring: {type: spring_damper, i: bar.tip, j: {body: ground, point: [0.3, 0.5]}, stiffness: 400, damping: 5, free_length: 0.4}
"""


@pytest.mark.parametrize("parameter, value", [("offset", 0.0), ("load", 3.0)])
def test_slow_inputs_move_the_equilibrium(parameter, value):
    """A pivot on the bar that is shifted changes a constraint and the arms of its reaction; a mass changes weight and inertia."""
    made = lambda shift: stiffmbs.read_scene(LEVER, [(f"parameters.{parameter}", repr(value + shift))])  # noqa: E731
    poses = [stiffmbs.equilibrium(made(shift)).channels["bar.angle"] for shift in (-1e-4, 1e-4)]
    scene = made(0.0).model_copy(update={"start": "equilibrium"})
    found = transfer(scene, {parameter: made}, ["bar.angle"])
    slow = found.response(np.array([1e-6]))[0, 0, 0]
    np.testing.assert_allclose(slow, (poses[1] - poses[0]) / 2e-4, rtol=1e-5)


def test_a_prescribed_velocity_is_no_input():
    made = lambda speed: stiffmbs.read_scene(  # noqa: E731
        DRIVEN.replace("position: travel", "velocity: travel"), [("parameters.travel", repr(speed))]
    )
    with pytest.raises(InputError, match=r"input 'travel': found a velocity that a joint prescribes"):
        transfer(made(0.0), {"travel": made}, ["bob.angle"])


def test_small_runs_follow_the_response():
    """The half car under a small harmonic force, after 12 s of settling: amplitude and phase within 1e-4."""
    scene = stiffmbs.load_scene(EXAMPLES / "half_car.yaml", [("V", "1e-9"), ("parameters.k_b", "1e5")])
    frequency, size = 2.0, 1.0
    outputs = ["chassis.y", "front_bushing.fy"]
    expected = transfer(scene, ["chassis.front_seat.fy"], outputs).response(np.array([frequency]))[0, :, 0]
    shaken = scene.model_copy(
        update={
            "forces": {
                **scene.forces,
                "shaker": stiffmbs.AppliedForce(
                    i="chassis.front_seat", force=(0, f"{size}*sin({2 * np.pi * frequency!r}*t)")
                ),
            }
        }
    )
    found = stiffmbs.run(shaken, duration=20.0, output=0.01, rtol=1e-10)
    last = found.t >= 10 - 1e-9
    basis = np.column_stack(
        [np.sin(2 * np.pi * frequency * found.t), np.cos(2 * np.pi * frequency * found.t), np.ones(len(found.t))]
    )
    for k, name in enumerate(outputs):
        sine, cosine, _ = np.linalg.lstsq(basis[last], found[name][last], rcond=None)[0]
        assert abs(sine + 1j * cosine - expected[k] * size) < 1e-4 * abs(expected[k]) * size


def test_the_command_prints_peaks_and_writes_columns(tmp_path):
    scene = tmp_path / "oscillator.yaml"
    scene.write_text(OSCILLATOR)
    told = CliRunner().invoke(
        main,
        [
            "response",
            str(scene),
            "--input",
            "road",
            "--input",
            "a.fx",
            "--output",
            "a.x",
            "-o",
            str(tmp_path / "r.csv"),
        ],
    )
    assert told.exit_code == 0, told.output
    assert "road -> a.x" in told.output and "peak" in told.output
    table = np.loadtxt(tmp_path / "r.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(table[0, 1], 1.0147, rtol=1e-4)
    shown = CliRunner().invoke(
        main, ["response", str(scene), "--input", "a.fx", "--output", "a.x", "--points", "3", "--json"]
    )
    assert len(json.loads(shown.output)["response"]["a.fx"]["a.x"]) == 3


@pytest.mark.parametrize(
    "options, told",
    [
        (["--input", "nothing", "--output", "a.x"], "found no such parameter, expected one of road, push"),
        (["--input", "a.fz", "--output", "a.x"], "input 'a.fz': found no such force"),
        (["--input", "a.fx", "--output", "a.z"], "output 'a.z': found no such channel"),
        (["--input", "a.fx", "--output", "a.x", "--from", "3", "--to", "2"], "found no range"),
    ],
)
def test_wrong_requests_are_told(tmp_path, options, told):
    scene = tmp_path / "oscillator.yaml"
    scene.write_text(OSCILLATOR)
    found = CliRunner().invoke(main, ["response", str(scene), *options])
    assert found.exit_code == 2 and told in found.output


OFFSET = """
dimensions: 3
bodies:
  b: {mass: 2, inertia: %s, center_of_mass: [0.5, -0.2, 0.1], position: [1, 2, 3], orientation: {euler: zxz, angles: [0.3, 0.8, -0.4]},
      omega: %s, markers: {tip: {point: [0.1, 0.7, -0.3]}}}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("omega", ["[0, 0, 0]", "[0.5, -2, 3]"], ids=["at rest", "spinning"])
@pytest.mark.parametrize("inertia", ["[0.3, 0.4, 0.5]", "[[0.3, 0.02, 0.05], [0.02, 0.4, -0.03], [0.05, -0.03, 0.5]]"])
@pytest.mark.parametrize("at", ["b", "b.tip"])
def test_loads_on_a_body_whose_centre_of_mass_is_not_its_origin(inertia, omega, at):
    """A force there moves the centre of mass by F/m; about it r x F, in own axes, changes the angular velocity by I w'."""
    scene = stiffmbs.read_scene(OFFSET % (inertia, omega))
    body = scene.bodies["b"]
    outputs = [f"b.{label}" for label in ("ax", "ay", "az", "wdx", "wdy", "wdz")]
    found = transfer(scene, [f"{at}.{label}" for label in ("fx", "fy", "fz", "tx", "ty", "tz")], outputs)
    axes = matrix(body.orientation)
    arm = np.zeros(3) if at == "b" else np.array([0.1, 0.7, -0.3]) - body.center_of_mass
    turned = np.linalg.solve(np.array(body.inertia), np.hstack([np.cross(arm, axes.T, axisb=0, axisc=0), axes.T]))
    expected = np.vstack([np.eye(3, 6) / 2, turned])
    np.testing.assert_allclose(found.d, expected, atol=1e-8)
    places = transfer(scene, [f"{at}.fy"], ["b.x", "b.y", "b.z", "b.vx", "b.vy", "b.vz"])
    s = 2j * np.pi * 0.7
    moved = np.array([0, 1 / (2 * s**2), 0, 0, 1 / (2 * s), 0])
    np.testing.assert_allclose(places.response(np.array([0.7]))[0, :, 0], moved, atol=1e-7)


def test_an_input_that_turns_principal_axes_is_refused():
    text = OFFSET % ("[[0.3, 0, lean], [0, 0.4, 0], [lean, 0, 0.5]]", "[0, 0, 0]") + "parameters: {lean: 0}\n"
    made = lambda value: stiffmbs.read_scene(text, [("parameters.lean", repr(value))])  # noqa: E731
    with pytest.raises(InputError, match=r"input 'lean': found that it rotates the principal axes of a body"):
        transfer(made(0.0), {"lean": made}, ["b.x"])


@pytest.mark.parametrize("held, gain", [("", 1 / 2), ("{type: force, i: a, force: [-6*a.vx, 0]}", None)])
def test_the_response_of_a_free_body(held, gain):
    """Double zeros as eigenvalues, and a zero that a damper leaves: a = F/(m + d/s), x = a/s^2."""
    text = "bodies: {a: {mass: 2, inertia: 1}}\njoints: {rail: {type: prismatic, i: a, j: ground}}\n"
    found = transfer(
        stiffmbs.read_scene(f"{text}forces: {{held: {held}}}" if held else text), ["a.fx"], ["a.ax", "a.x", "rail.fy"]
    )
    frequencies = np.array([0.01, 0.5, 20.0])
    s = 2j * np.pi * frequencies
    acceleration = np.full(3, gain) if gain else 1 / (2 + 6 / s)
    expected = np.stack([acceleration, acceleration / s**2, np.zeros(3)], -1)
    np.testing.assert_allclose(found.response(frequencies)[:, :, 0], expected, rtol=1e-7, atol=1e-12)
    with pytest.raises(InputError, match="found 0 Hz, the frequency of an unconstrained motion"):
        found.response(np.array([0.0, 1.0]))


@pytest.mark.parametrize("seed", range(3))
def test_the_response_of_free_bodies_in_any_coordinates(seed):
    """A free mass and an oscillator: rounding splits the double zero eigenvalue, whose eigenvectors are nearly parallel."""
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    stiffness = basis @ np.diag([0.0, 90.0, 400.0]) @ basis.T
    a = np.block([[np.zeros((3, 3)), np.eye(3)], [-stiffness, -0.01 * stiffness]])
    b = np.vstack([np.zeros((3, 2)), basis[:, :2]])
    found = Transfer(
        a, b, np.hstack([basis[:, :2].T, np.zeros((2, 3))]), np.zeros((2, 2)), ("f", "g"), ("x", "y"), np.zeros(2)
    )
    w = 2 * np.pi * np.array([0.02, 0.3, 4.0])
    moved = np.array([np.diag([-1 / w_k**2, 1 / (90 + 0.9j * w_k - w_k**2)]) for w_k in w])
    assert found.response(w / (2 * np.pi)) == pytest.approx(moved, rel=1e-11, abs=1e-11)


def test_a_held_body_has_a_response_at_zero_hertz_but_none_at_its_own_frequency():
    text = "bodies: {a: {mass: 2, inertia: 1}}\njoints: {rail: {type: prismatic, i: a, j: ground}}\n"
    found = transfer(
        stiffmbs.read_scene(text + "forces: {f: {type: force, i: a, force: [-50*a.x, 0]}}"), ["a.fx"], ["a.x"]
    )
    np.testing.assert_allclose(found.response(np.array([0.0])), 1 / 50, rtol=1e-7)
    with pytest.raises(InputError, match="the frequency of an undamped mode"):
        found.response(np.array([5 / (2 * np.pi)]))


def test_feedthrough_of_forces_beside_large_reactions():
    """The variation of a force follows the largest reaction: rounding of 3e6 N must not appear in D."""
    model = Model()
    model.add("bar", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("pin", Revolute(i=Marker(body="bar", point=(-1, 0)), j="ground"))
    model.add("pull", AppliedForce(i="bar", force=(3e6, 0)))
    found = transfer(model, ["bar.fx", "bar.fy"], ["pin.fx", "pin.fy"])
    np.testing.assert_allclose(found.d, [[-1, 0], [0, -0.5]], atol=1e-9)


GUIDED_TWICE = """
parameters: {F: 3}
gravity: [0, -9.81]
bodies: {a: {mass: 2, inertia: 1}}
joints:
  left: {type: prismatic, i: {body: a, point: [-0.5, 0]}, j: {body: ground, point: [-0.5, 0]}}
  right: {type: prismatic, i: {body: a, point: [0.5, 0]}, j: {body: ground, point: [0.5, 0]}}
forces: {push: {type: force, i: a, force: [-50*a.x, -F]}}
run: {duration: 0.1}
"""


@pytest.mark.long
def test_a_derivative_of_a_reaction_without_a_unique_value_is_noted():
    """Two guides carry a load together: only the sum of their reactions is unique."""
    scene = stiffmbs.read_scene(GUIDED_TWICE)
    found = transfer(scene, ["a.fy"], ["left.fy", "right.fy", "a.x"])
    assert found.d[:2].sum() == pytest.approx(-1)
    note = "rigid bodies do not determine left.fy and right.fy: the derivatives are those of one possible solution"
    assert found.notes == (note,)
    assert transfer(scene, ["a.fy"], ["a.x"]).notes == ()
    slopes = stiffmbs.sensitivities(scene, "F", "final(left.fy + right.fy)")
    assert (slopes.to["F"], slopes.notes) == (pytest.approx(1), (note,))
    assert stiffmbs.sensitivities(scene, "F", "final(a.x)").notes == ()


def test_modes_of_a_motion_that_is_not_unique_have_a_note():
    friction = "rub: {type: joint_friction, joint: left, friction: 0.3, stiction_velocity: 0.1}"
    scene = stiffmbs.read_scene(GUIDED_TWICE.replace("forces: {", f"forces: {{{friction}, "))
    assert any(note.endswith("the motion is not unique either") for note in stiffmbs.modes(scene).notes)


@pytest.mark.parametrize("frequency", [np.nan, np.inf])
def test_a_frequency_that_is_not_finite_is_refused(frequency):
    found = transfer(stiffmbs.read_scene(OSCILLATOR), ["a.fx"], ["a.x"])
    with pytest.raises(InputError, match="frequencies: found one that is not finite"):
        found.response(np.array([1.0, frequency]))


def test_a_transfer_function_without_outputs_is_refused():
    with pytest.raises(InputError, match="outputs: found none"):
        transfer(stiffmbs.read_scene(OSCILLATOR), ["a.fx"], [])


@pytest.mark.parametrize(("inputs", "outputs", "name"), [("a.fx", ["a.x"], "inputs"), (["a.fx"], "a.x", "outputs")])
def test_one_name_instead_of_a_list_is_refused(inputs, outputs, name):
    with pytest.raises(InputError, match=f"{name}: found 'a.f?x', expected a list of"):
        transfer(stiffmbs.read_scene(OSCILLATOR), inputs, outputs)
