"""Requests in space: measures, accelerations, angles, and what joints and forces do, against channels and derivatives."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.results.scales import scales
from stiffmbs.results.solution import channel_ranges

SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {length: 0.4}
markers: {pivot: {point: [1, 2, 3], orientation: {euler: zxz, angles: [0.3, 0.9, -0.4]}}}
bodies:
  top:
    mass: 2
    inertia: [[0.02, 0.001, 0], [0.001, 0.03, 0], [0, 0, 0.02]]
    center_of_mass: [0.01, 0, 0.2]
    position: [1, 2, 3]
    orientation: {euler: zxz, angles: [0.3, 0.9, -0.4]}
    omega: [1, 0.5, 20]
    markers: {foot: {point: [0, 0, 0]}, head: {point: [0.1, 0, 0.4], orientation: {euler: xyz, angles: [0.5, 0.6, 0.7]}}}
  arm: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1.5, 2, 3], markers: {tip: {point: [0.3, 0.1, 0.2]}}}
joints:
  ball: {type: spherical, i: top.foot, j: ground.pivot}
  hinge: {type: revolute, i: ground.pivot, j: {body: arm, point: [-0.5, 0, 0], orientation: {euler: zxz, angles: [0.3, 0.9, -0.4]}}}
requests:
  far: dm(top.head, arm.tip)
  place: {x: "dx(top.head, ground.pivot, arm.tip)", y: "dy(top.head, ground.pivot, arm.tip)", z: "dz(top.head, ground.pivot, arm.tip)"}
  rate: {x: "vx(top.head)", y: "vy(top.head)", z: "vz(top.head)", r: "vr(top.head, arm.tip)", m: "vm(top.head)"}
  turn: {x: "wx(top.head, ground, top)", y: "wy(top.head, ground, top)", z: "wz(top.head, ground, top)", m: "wm(top)"}
  faster: {x: "accx(top.head)", y: "accy(top.head)", z: "accz(top.head)", m: "accm(top.head)", wx: "wdtx(top)", wy: "wdty(top)", wz: "wdtz(top)", wm: "wdtm(top)"}
  euler: {psi: "psi(top, ground)", theta: "theta(top, ground)", phi: "phi(top, ground)"}
  q: {q0: "q0(top.head, ground)", q1: "q1(top.head, ground)", q2: "q2(top.head, ground)", q3: "q3(top.head, ground)"}
  about: {x: "ax(arm, ground.pivot)", z: "az(arm, ground.pivot)"}
  push:
    x: fx(ball)
    own: fx(ball, top)
    on_ground: fz(ball.j)
    m: fm(ball)
    t: tx(hinge)
    tj: tx(hinge.j)
    ti: ty(hinge.i, arm.tip)
  read: 2*ball.fx + top.x*length + t + abs(branch(t - 0.5, -1, 0, 1)) + mod(7 + t, 2)
run: {duration: 1, rtol: 1e-9, output: 0.0005}
"""


@pytest.fixture(scope="module")
def solution():
    return stiffmbs.run(stiffmbs.read_scene(SCENE))


def vectors(solution, name, components="xyz"):
    return np.column_stack([solution[f"{name}.{c}"] for c in components])


def slopes(solution, values):
    return np.gradient(values, solution.t, axis=0, edge_order=2)


def matrices(solution, name):
    """Shape (n, 3, 3), the axes in the columns."""
    w, x, y, z = (solution[f"{name}.q{k}"] for k in range(4))
    return np.moveaxis(np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]), -1, 0)  # fmt: skip


def in_ground(solution, body, point, center=(0, 0, 0)):
    return vectors(solution, body) + matrices(solution, body) @ (np.array(point) - center)


def test_distances_and_places(solution):
    head = in_ground(solution, "top", (0.1, 0, 0.4), (0.01, 0, 0.2))
    tip = in_ground(solution, "arm", (0.3, 0.1, 0.2))
    np.testing.assert_allclose(solution["far"], np.linalg.norm(head - tip, axis=1), rtol=1e-12)
    along = np.einsum("nji,nj->ni", matrices(solution, "arm"), head - (1, 2, 3))
    np.testing.assert_allclose(vectors(solution, "place"), along, atol=1e-12)


def test_rates_are_slopes_of_places(solution):
    head = in_ground(solution, "top", (0.1, 0, 0.4), (0.01, 0, 0.2))
    np.testing.assert_allclose(vectors(solution, "rate"), slopes(solution, head), atol=3e-3)
    np.testing.assert_allclose(solution["rate.r"], slopes(solution, solution["far"]), atol=3e-3)
    np.testing.assert_allclose(solution["rate.m"], np.linalg.norm(vectors(solution, "rate"), axis=1), rtol=1e-12)


def test_angular_velocities(solution):
    np.testing.assert_allclose(vectors(solution, "turn"), vectors(solution, "top", ("wx", "wy", "wz")), atol=1e-11)
    np.testing.assert_allclose(solution["turn.m"], np.linalg.norm(vectors(solution, "turn"), axis=1), rtol=1e-12)


def test_accelerations_are_slopes_of_velocities(solution):
    inner = slice(5, -5)
    np.testing.assert_allclose(
        vectors(solution, "faster")[inner], slopes(solution, vectors(solution, "rate"))[inner], atol=0.05
    )
    omega = np.einsum("nij,nj->ni", matrices(solution, "top"), vectors(solution, "top", ("wx", "wy", "wz")))
    wdt = vectors(solution, "faster", ("wx", "wy", "wz"))
    np.testing.assert_allclose(wdt[inner], slopes(solution, omega)[inner], atol=0.05)
    np.testing.assert_allclose(solution["faster.wm"], np.linalg.norm(wdt, axis=1), rtol=1e-12)


def test_angles_and_quaternions_turn_the_axes(solution):
    psi, theta, phi = (solution[f"euler.{name}"] for name in ("psi", "theta", "phi"))
    z = matrices(solution, "top")[:, :, 2]
    expected = np.column_stack([np.sin(psi) * np.sin(theta), -np.cos(psi) * np.sin(theta), np.cos(theta)])
    np.testing.assert_allclose(z, expected, atol=1e-12)
    nodes = matrices(solution, "top")[:, 2, :2]  # the ground's z in the top's x and y
    np.testing.assert_allclose(nodes, np.sin(theta)[:, None] * np.column_stack([np.sin(phi), np.cos(phi)]), atol=1e-12)
    head = matrices(solution, "q")
    cx, cy, cz, sx, sy, sz = (f(a) for f in (np.cos, np.sin) for a in (0.5, 0.6, 0.7))
    of_head = np.array([
        [cy * cz, -cy * sz, sy],
        [cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy],
        [sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy],
    ])  # fmt: skip
    np.testing.assert_allclose(head, matrices(solution, "top") @ of_head, atol=1e-10)
    assert np.max(np.abs(np.diff(solution["q.q0"]))) < 0.02  # without jumps of sign


def test_angles_go_on_over_whole_turns():
    text = """
dimensions: 3
bodies: {wheel: {mass: 1, inertia: [1, 1, 1], omega: [0, 0, 70]}}
joints: {axle: {type: revolute, i: wheel, j: ground}}
requests: {angle: "az(wheel, ground)"}
run: {duration: 2, output: 0.1}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    np.testing.assert_allclose(solution["angle"], 70 * solution.t, atol=1e-3)


def test_forces_of_joints_in_any_axes_and_on_both_bodies(solution):
    force = vectors(solution, "ball", ("fx", "fy", "fz"))
    np.testing.assert_array_equal(solution["push.x"], force[:, 0])
    np.testing.assert_allclose(solution["push.own"], np.einsum("nj,nj->n", matrices(solution, "top")[:, :, 0], force))
    np.testing.assert_array_equal(solution["push.on_ground"], -force[:, 2])
    np.testing.assert_allclose(solution["push.m"], np.linalg.norm(force, axis=1))
    torque = vectors(solution, "hinge", ("tx", "ty", "tz"))
    np.testing.assert_allclose(solution["push.t"], torque[:, 0])
    np.testing.assert_allclose(solution["push.tj"], -torque[:, 0], atol=1e-9)  # the points coincide
    np.testing.assert_allclose(solution["push.ti"], np.einsum("nj,nj->n", matrices(solution, "arm")[:, :, 1], torque))


def test_the_torque_on_the_second_body_is_about_its_own_point():
    """A slider's guide pushes up; at the rail's own marker that is a torque which grows with the way."""
    text = """
dimensions: 3
gravity: [0, 0, -10]
markers: {rail: {orientation: {z: [1, 0, 0], x: [0, 1, 0]}}}
bodies: {slider: {mass: 1, inertia: [1, 1, 1], velocity: [2, 0, 0], markers: {foot: {orientation: {z: [1, 0, 0], x: [0, 1, 0]}}}}}
joints: {guide: {type: prismatic, i: slider.foot, j: ground.rail}}
requests: {at_i: ty(guide), at_j: ty(guide.j)}
run: {duration: 1}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    np.testing.assert_allclose(solution["at_i"], 0, atol=1e-9)
    np.testing.assert_allclose(solution["at_j"], 10 * 2 * solution.t, atol=1e-6)  # -10 N at x: r x F = +10 x about y


def test_channels_parameters_and_functions(solution):
    t = solution.t
    expected = 2 * solution["ball.fx"] + 0.4 * solution["top.x"] + t + np.where(t == 0.5, 0, 1) + np.mod(7 + t, 2)
    np.testing.assert_allclose(solution["read"], expected, atol=1e-12)


@pytest.mark.parametrize(
    "request_text, words",
    [
        ("dx(nobody)", r"requests.r: found the unknown body 'nobody'"),
        ("dx(top.knee)", r"requests.r: found 'top.knee', expected one of its markers \(foot, head\)"),
        ("fx(rope)", r"requests.r: found 'rope' in 'fx\(rope\)', expected a joint or a force"),
        ("fx(ball.k)", r"requests.r: found 'ball.k'"),
        ("dm(top, arm, ground)", r"requests.r: found 3 markers in 'dm\(top, arm, ground\)', expected 1 to 2"),
        ("fx()", r"requests.r: found 0 names in 'fx\(\)'"),
        ("top.speed", r"requests.r: found 'top.speed' in 'top.speed', expected one of top.x, top.y, top.z, "),
        ("ball.torque", r"requests.r: found 'ball.torque'"),
        ("what", r"requests.r: found the unknown name 'what'"),
        ("twice(t)", r"requests.r: found the unknown function 'twice'"),
        ("sin()", r"requests.r: found 0 arguments in 'sin\(\)', expected 1"),
        ("2*mod(t)", r"requests.r: found 1 arguments in 'mod\(t\)', expected 2"),
        ("min()", r"requests.r: found 0 arguments in 'min\(\)', expected 1 or more"),
        ("step(t, 0, 1)", r"requests.r: found 3 arguments in 'step\(t, 0, 1\)', expected 5"),
        ("{x: what}", r"requests.r.x: found the unknown name 'what'"),
        ("{two words: t}", r"requests.r: found component with the name 'two words'"),
        ("{}", r"requests.r: found {}, expected a formula"),
        ("[t]", r"requests.r: found \['t'\], expected a formula"),
    ],
)
def test_requests_that_cannot_be_are_told(request_text, words):
    head = SCENE.partition("requests:")[0]
    with pytest.raises(InputError, match=words):
        stiffmbs.read_scene(f"{head}requests:\n  r: {request_text}\n")


def test_what_has_no_number_is_reported_as_none(tmp_path):
    bodies = "{a: {mass: 1, inertia: [1, 1, 1]}}"
    requests = "{root: sqrt(-1), over: 1/0, late: sqrt(t - 1), half: round(0.5 + 0*t), under: round(-2.5)}"
    scene = stiffmbs.read_scene(f"{{dimensions: 3, bodies: {bodies}, requests: {requests}, run: {{duration: 2}}}}")
    solution = stiffmbs.run(scene)
    ranges = channel_ranges(solution)
    sizes = scales(solution.channels, 1.0, solution.requested)
    assert sizes["root"] == sizes["over"] == 0 and sizes["half"] == 1 and sizes["under"] == 3
    assert np.isnan(ranges["root"]["max"])
    assert not np.isfinite(ranges["over"]["max"])
    assert ranges["late"]["max"] == pytest.approx(1.0)
    assert ranges["half"]["max"] == 1.0
    assert ranges["under"]["max"] == -3.0


def test_requests_from_python():
    from stiffmbs.spatial import Body, Model

    model = Model()
    model.add("stone", Body(mass=1, inertia=(1, 1, 1), velocity=(1, 2, 3)))
    model.request("speed", "vm(stone)")
    model.request("way", {"x": "dx(stone)", "y": "2*stone.y"})
    solution = stiffmbs.run(model, duration=1)
    np.testing.assert_allclose(solution["speed"], np.sqrt(14))
    np.testing.assert_allclose(solution["way.y"], 4 * solution.t, atol=1e-9)
    with pytest.raises(InputError, match="taken or reserved"):
        model.request("stone", "1")


def test_a_parameter_of_any_name_keeps_its_value():
    text = """
dimensions: 3
parameters: {term0: 5, term1: 7}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [3, 0, 0]}}
requests: {far: term0 + term1*dx(ball)}
run: {duration: 0.1, points: 2}
"""
    assert stiffmbs.run(stiffmbs.read_scene(text))["far"] == pytest.approx(26)
