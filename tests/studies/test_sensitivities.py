"""Sensitivities: closed forms of their own derivatives, jumps at breakpoints and events, differences of converged runs."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import InputError, sensitivities
from stiffmbs.studies.outputs import outputs_of
from tests.studies.oscillator import SLED, oscillation, slope

BY_BOTH = pytest.mark.parametrize("solver", ["bdf", "radau"])


@pytest.mark.sampled(9)
@BY_BOTH
@pytest.mark.parametrize("of", ["sled.x", "rms(sled.x)", "final(3*sled.x^2 + sin(sled.x))", "integral(abs(sled.x))/2"])
def test_those_of_a_damped_oscillation(of, solver):
    t = np.linspace(0, 2, 41)
    outputs = {
        "sled.x": lambda x: x, "rms(sled.x)": lambda x: np.sqrt(np.trapezoid(x * x, t) / 2),
        "final(3*sled.x^2 + sin(sled.x))": lambda x: (3 * x * x + np.sin(x))[-1],
        "integral(abs(sled.x))/2": lambda x: np.trapezoid(np.abs(x), t) / 2,
    }  # fmt: skip
    found = sensitivities(stiffmbs.read_scene(SLED), ["k", "c", "x0", "m"], of, solver=solver)
    for name, value in (("k", 100.0), ("c", 1.0), ("x0", 0.1), ("m", 2.0)):
        exact = slope(lambda **p: outputs[of](oscillation(t, **p)), name, value)
        np.testing.assert_allclose(found.to[name], exact, rtol=1e-5, atol=1e-6 * np.abs(exact).max())


PUSHED = """
parameters: {F: 3 N, T: 0.4 s, m: 2 kg}
bodies: {sled: {mass: m, inertia: 1, velocity: [0.5, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  push: {type: force, i: sled, force: ["branch(t - T, F, 0, 0)", 0]}
run: {duration: 1, rtol: 1e-6}
"""


@pytest.mark.sampled(2)
@BY_BOTH
def test_a_force_that_ends_at_an_instant_that_moves(solver):
    """x = v + F/m (T - T^2/2) at 1 s."""
    found = sensitivities(stiffmbs.read_scene(PUSHED), ["F", "T", "m"], "final(sled.x)", solver=solver)
    assert found.value == pytest.approx(0.5 + 1.5 * 0.32, rel=1e-8)
    expected = {"F": 0.32 / 2, "T": 1.5 * 0.6, "m": -3 * 0.32 / 4}
    assert found.to == pytest.approx(expected, rel=1e-7)


SWITCHED = """
parameters: {y: -0.0995525}
bodies: {bar: {mass: 1.966, inertia: 0.1}}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.0710, y]}, j: {body: ground, point: [-0.0710, y]}}}
forces:
  push: {type: force, i: bar, force: [0, "3.37*step(t, 0.0586, 0, 0.156, 1)"]}
  held: {type: spring_damper, i: bar, j: {body: ground, point: [-0.8067, -0.3361]}, stiffness: 98.5, damping: 0.249, free_length: 0.3}
states: {z: {rate: "branch(bar.vy - 0.0339, 1, 0, -1)", start: 0}}
run: {duration: 0.1, points: 17, rtol: 1e-6}
"""


@pytest.mark.long
def test_short_steps_before_an_event_do_not_spoil_those_along_radau():
    """The last steps before the event take 1e-12 s and less; bdf has the formula of another method."""
    along_bdf, along_radau = (
        sensitivities(stiffmbs.read_scene(SWITCHED), ["y"], "final(z)", solver=solver).to["y"]
        for solver in ("bdf", "radau")
    )
    assert along_radau == pytest.approx(along_bdf, rel=1e-8)


@pytest.mark.long
def test_an_event_at_which_a_force_jumps():
    """A sled at speed v meets a constant resistance behind x = a: x = a + v s - R/(2 m) s^2, s = 1 - a/v."""
    text = PUSHED.replace("F: 3 N, T: 0.4 s", "R: 0.6 N, a: 0.2 m").replace(
        "branch(t - T, F, 0, 0)", "branch(sled.x - a, 0, 0, -R)"
    )
    found = sensitivities(stiffmbs.read_scene(text), ["R", "a", "bodies.sled.velocity.0"], "final(sled.x)")
    s, v, a, R, m = 0.6, 0.5, 0.2, 0.6, 2.0
    assert found.value == pytest.approx(a + v * s - R / (2 * m) * s * s, rel=1e-8)
    expected = {
        "R": -s * s / (2 * m), "a": 1 + (v - R / m * s) * (-1 / v),
        "bodies.sled.velocity.0": s + (v - R / m * s) * a / v**2,
    }  # fmt: skip
    assert found.to == pytest.approx(expected, rel=1e-7)


@pytest.mark.long
def test_kinks_of_a_table_of_straight_lines():
    """Against the variational equations of x'' = k p(x) for the velocity v at the start and for k, integrated from kink to kink."""
    table = np.array([[-2, 33], [-0.2, 0.6], [0.1, -0.3], [2, -82]])
    text = PUSHED.replace("F: 3 N, T: 0.4 s", "v: 1 m/s, k: 2").replace("branch(t - T, F, 0, 0)", "k*p(sled.x) N")
    text = text.replace("velocity: [0.5, 0]", "velocity: [v, 0]").replace("duration: 1,", "duration: 12,")
    scene = stiffmbs.read_scene(f"tables: {{p: {{table: {table.tolist()}, lines: true}}}}\n{text}")
    slopes = np.diff(table[:, 1]) / np.diff(table[:, 0])
    piece = 1

    def rates(t, y):
        x, v, x_v, v_v, x_k, v_k = y
        force, slope = table[piece, 1] + slopes[piece] * (x - table[piece, 0]), slopes[piece]
        return [v, force, v_v, slope * x_v, v_k, slope * x_k + force / 2]

    t, y = 0.0, np.array([0.0, 1, 0, 1, 0, 0])
    while t < 12:
        edges = [lambda t, y, at=at: y[0] - at for at in table[piece : piece + 2, 0]]
        for edge, direction in zip(edges, (-1, 1), strict=True):
            edge.terminal, edge.direction = True, direction
        found = solve_ivp(rates, (t, 12), y, method="DOP853", rtol=1e-12, atol=1e-13, events=edges)
        t, y = found.t[-1], found.y[:, -1]
        piece += len(found.t_events[1]) - len(found.t_events[0])
    found = sensitivities(scene, ["v", "k"], "final(sled.x)")
    assert found.value == pytest.approx(y[0], abs=1e-8)
    assert found.to == pytest.approx({"v": y[2], "k": y[4]}, rel=1e-6)


@pytest.mark.long
def test_a_bounce_on_a_stiff_floor():
    """A lossless bounce lasts pi/w and ends with the speed that it began with; the motion before and behind is free."""
    text = """
parameters: {h: 0.5 m, k: 1e6 N/m}
gravity: [0, -10]
bodies: {ball: {mass: 1, inertia: 1, position: [0, h]}}
joints: {upright: {type: prismatic, i: {body: ball, angle: 90 deg}, j: {body: ground, angle: 90 deg}}}
forces: {floor: {type: force, i: ball, force: [0, "k*max(0, -ball.y)"]}}
run: {duration: 0.6, rtol: 1e-8}
"""

    def height(h=0.5, k=1e6):
        fall, speed, w = np.sqrt(h / 5), np.sqrt(20 * h), np.sqrt(k)
        contact = 2 / w * (np.pi - np.arctan(speed * w / 10))
        rest = 0.6 - fall - contact
        return speed * rest - 5 * rest**2

    found = sensitivities(stiffmbs.read_scene(text), ["h", "k"], "final(ball.y)")
    assert found.value == pytest.approx(height(), rel=1e-6)
    assert found.to["h"] == pytest.approx(slope(height, "h", 0.5), rel=1e-5)
    assert found.to["k"] == pytest.approx(slope(height, "k", 1e6), rel=1e-5)


def test_lengths_that_assembly_follows():
    """A slider-crank at constant speed: the slider is r cos(a) + sqrt(L^2 - r^2 sin(a)^2) from the pin."""
    angle = 25.0 * 0.1

    def place(r=0.125, L=0.35):
        return -r * np.cos(angle) - np.sqrt(L**2 - (r * np.sin(angle)) ** 2)

    found = sensitivities("examples/crank_slider.yaml", ["r", "L", "rate"], "final(slider.x)", duration=0.1)
    assert found.value == pytest.approx(place(), rel=1e-8)
    assert found.to["r"] == pytest.approx(slope(place, "r", 0.125), rel=1e-7)
    assert found.to["L"] == pytest.approx(slope(place, "L", 0.35), rel=1e-7)


def test_a_start_that_no_joint_changes():
    """A throw: x = (v0 + x0/s) t and y = x0 - g t^2/2."""
    text = """
parameters: {x0: 2 m, v0: 3 m/s}
gravity: [0, -10]
bodies: {ball: {mass: 1, inertia: 1, position: [0, x0], velocity: [v0 + x0/(1 s), 0]}}
run: {duration: 0.5}
"""
    found = sensitivities(stiffmbs.read_scene(text), ["x0", "v0"], "final(ball.x + 2*ball.y)")
    assert found.value == pytest.approx(2.5 + 2 * (2 - 1.25), rel=1e-8)
    assert found.to == pytest.approx({"x0": 2.5, "v0": 0.5}, rel=1e-8)


def test_a_changed_copy_of_a_scene_is_refused():
    """What it was read from says nothing of the change."""
    scene = stiffmbs.read_scene(SLED)
    same = sensitivities(scene.model_copy(), ["k"], "final(sled.x)")
    assert same.to == sensitivities(scene, ["k"], "final(sled.x)").to
    longer = scene.model_copy(update={"run": scene.run.model_copy(update={"duration": 3.0})})
    with pytest.raises(InputError, match="a changed copy of a scene"):
        sensitivities(longer, ["k"], "final(sled.x)")


@pytest.mark.long
def test_a_start_in_equilibrium():
    text = SLED.replace("-k*sled.x", "9 - k*sled.x") + "start: equilibrium\n"
    found = sensitivities(stiffmbs.read_scene(text), ["k", "c"], "final(sled.x)")
    assert found.value == pytest.approx(0.09, rel=1e-9)
    assert found.to == pytest.approx({"k": -0.09 / 100, "c": 0.0}, rel=1e-7, abs=1e-9)


LONG = partial(pytest.param, marks=pytest.mark.long)


def differences(scene, path, value, of, **settings):
    """By central differences of fourth order of converged runs."""
    h, (output,) = 1e-3 * abs(value), outputs_of(of)
    f = [
        output.value(
            stiffmbs.run(stiffmbs.load_scene(scene, [(path, repr(value + shift * h))]), rtol=1e-11, **settings)
        )
        for shift in (-2, -1, 1, 2)
    ]
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("scene", "name", "value", "of", "settings"),
    [
        ("cart_pendulum", "bodies.bar.mass", None, "final(rail.fy)", {"duration": 0.5}),
        ("cart_pendulum", "bodies.bar.inertia", None, "rms(hinge.fx)", {"duration": 0.5}),
        ("heavy_top", "tilt", 0.6, "final(top.x)", {"duration": 0.3}),
        LONG("heavy_top", "top_mass", 1.0, "final(energy.kinetic)", {"duration": 0.3}),
        LONG("spatial_slider_crank", "L", 0.3, "final(slider.x)", {"duration": 0.3}),
        LONG("cam_follower", "eccentricity", 0.01, "final(follower.y)", {"duration": 0.02}),
        LONG("elastic_bearing", "bearing", 1e9, "final(give)", {"duration": 0.01}),
        LONG("half_car", "V", 15.0, "final(front_bushing.fy)", {"duration": 1.0}),
    ],
)
@BY_BOTH
def test_differences_of_converged_runs(scene, name, value, of, settings, solver):
    file = f"examples/{scene}.yaml"
    if value is None:
        value = getattr(stiffmbs.load_scene(file).bodies["bar"], name.rpartition(".")[2])
    found = sensitivities(file, [name], of, solver=solver, **settings)
    assert found.to[name] == pytest.approx(differences(file, name, value, of, solver="bdf", **settings), rel=1e-5)


REFERRING = """
dimensions: 2
gravity: [0, -9.81]
parameters: {{at: {at}}}
bodies: {{a: {{mass: 1, inertia: 1}}, b: {{mass: 2, inertia: 1, position: [1, 0]}}, c: {{mass: 1, inertia: 0.5, position: [2, 0], velocity: [0.3, 0]}}}}
joints:
  p: {{type: prismatic, i: {{body: a, point: [at, 0], angle: 20 deg}}, j: {{body: ground, point: [0.05, 0], angle: 20 deg}}}}
  q: {{type: prismatic, i: {{body: b, point: [0.2*at, 0]}}, j: {{body: ground, point: [1, 0]}}}}
  r: {{type: prismatic, i: {{body: c, point: [at, at]}}, j: {{body: ground, point: [2, at]}}}}
  {referring}
forces:
  s: {{type: spring_damper, i: a, j: {{body: b, point: [0, 0.5]}}, stiffness: 40, damping: 1, free_length: 0.5}}
  {force}
"""


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("referring", "force", "of"),
    [
        ("d: {{type: drive, joint: p, position: 0.1*sin(3*t)}}", "", ["a.x", "d.fx", "p.fy"]),
        ("d: {{type: coupler, joint_1: p, joint_2: q, scale: -0.5}}", "", ["a.x", "b.vx", "p.fy"]),
        (
            "",
            "f: {{type: joint_friction, joint: r, friction: 0.3, stiction_velocity: 0.01, length: 0.2}}",
            ["c.x", "c.vx"],
        ),
    ],
    ids=["drive", "coupler", "friction"],
)
def test_what_refers_to_a_joint_follows_its_markers(referring, force, of):
    def scene(at):
        return stiffmbs.read_scene(REFERRING.replace("{referring}", referring).replace("{force}", force).format(at=at))

    h = 1e-4
    above, below = (stiffmbs.run(scene(0.3 + shift), duration=0.5, points=6, rtol=1e-10) for shift in (h, -h))
    for each in of:
        found = sensitivities(scene(0.3), ["at"], each, duration=0.5, points=6, rtol=1e-9).to["at"]
        expected = (above[each] - below[each]) / (2 * h)
        np.testing.assert_allclose(
            found, expected, rtol=1e-4, atol=1e-5 * max(1.0, np.abs(expected).max()), err_msg=each
        )


@pytest.mark.long
def test_a_request_changes_with_the_channels_that_it_reads():
    """x = v t + F t^2/(2 m) in a request: the derivatives come by its channels alone, or by its parameter as well."""
    scene = stiffmbs.read_scene("""
parameters: {F: 3 N, m: 2 kg}
bodies: {sled: {mass: m, inertia: 1, velocity: [0.5, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces: {push: {type: force, i: sled, force: [F, 0]}}
requests: {double: 2*sled.x, product: F*sled.x}
run: {duration: 1 s, rtol: 1e-9}
""")
    double, product = (sensitivities(scene, ["F", "m"], f"final({name})") for name in ("double", "product"))
    assert double.to == pytest.approx({"F": 2 / 4, "m": -2 * 3 / 8}, rel=1e-7)
    assert product.to == pytest.approx({"F": 0.5 + 3 / 4 + 3 / 4, "m": -9 / 8}, rel=1e-7)


TABLES = """
parameters: {{p: {p!r}}}
bodies: {{b: {{mass: 2, inertia: 1, position: [0.3, 0]}}, c: {{mass: 1, inertia: 1, position: [1.3, 0]}}}}
joints:
  first: {{type: prismatic, i: b, j: ground}}
  second: {{type: prismatic, i: c, j: ground}}
  drive: {{type: drive, joint: first, {law}: f(t)}}
forces:
  spring: {{type: spring_damper, i: b, j: c, stiffness: 50, damping: 2, free_length: 1}}
  push: {{type: force, i: c, force: ["g(c.x)*cos(c.vx) + h(2*t)", 0]}}
tables:
  f: {{table: [[0, 0.3], [p, 0.5], [1, 0.3], [2, 0.4]], {form}}}
  g: {{table: [[-1, 3], [p, 0.1], [1.2, -0.3], [2*p, -1], [4, -8]], {form}}}
  h: {{table: [[0, 0], [0.2, 5], [p, 0]], {form}, beyond: repeat}}
run: {{duration: 1.7, rtol: 1e-9, points: 101}}
"""


@pytest.mark.long
@pytest.mark.sampled(4)
@BY_BOTH
@pytest.mark.parametrize("law", ["position", "velocity"])
@pytest.mark.parametrize("form", ["lines: true", "spline: true", "akima: true"])
def test_points_of_tables_move(form, law, solver):
    """Tables of time, periodic too, and of a position: against differences of runs.  The points of drives are jumps of velocity."""

    def ends(p):
        found = stiffmbs.run(stiffmbs.read_scene(TABLES.format(p=p, law=law, form=form)), rtol=1e-11, solver=solver)
        return np.array([found[name][-1] for name in ("c.x", "drive.fx")])

    p, h = 0.75, 1e-4
    scene = stiffmbs.read_scene(TABLES.format(p=p, law=law, form=form))
    differences = (8 * (ends(p + h) - ends(p - h)) - (ends(p + 2 * h) - ends(p - 2 * h))) / (12 * h)
    for of, expected in zip(("final(c.x)", "final(drive.fx)"), differences, strict=True):
        found = sensitivities(scene, ["p"], of, solver=solver)
        assert found.to["p"] == pytest.approx(expected, rel=2e-5, abs=2e-6)
