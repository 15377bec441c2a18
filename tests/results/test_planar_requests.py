"""Requests in the plane: every kind of them against channels, by hand."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, spatial
from stiffmbs.results.scales import scales

SCENE = """
gravity: [0, -9.81]
parameters: {length: 0.4, spare: 2 N}
tables: {curve: {table: [[-10, -5], [0, 0], [10, 20]], lines: true}}
markers: {pivot: {point: [0.2, 0.1], angle: 0.5}}
bodies:
  bar:
    mass: 2
    inertia: 0.05
    position: [0.6, 0.1]
    omega: 30
    velocity: [0, 12]
    markers: {end: {point: [-0.4, 0]}, tip: {point: [0.4, 0.1], angle: 0.7}}
  arm: {mass: 1, inertia: 0.02, position: [0.9 + 0.3*cos(0.2), 0.15 + 0.3*sin(0.2)], angle: 0.2, markers: {tip: {point: [0.2, 0.1], angle: -0.3}}}
joints:
  hinge: {type: revolute, i: bar.end, j: ground.pivot}
  weld: {type: fixed, i: {body: arm, point: [-0.3, 0], angle: -0.2}, j: {body: bar, point: [0.3, 0.05]}}
  motor: {type: drive, joint: hinge, velocity: 30 + sin(4*t)}
forces:
  spring: {type: spring_damper, i: bar.tip, j: {body: ground, point: [0, 1]}, stiffness: 100, damping: 2, free_length: 0.5}
requests:
  place: {x: "dx(bar.tip, arm.tip)", y: "dy(bar.tip, ground.pivot)", along: "dx(bar.tip, ground.pivot, arm.tip)", m: "dm(bar.tip)"}
  rate: {x: "vx(bar.tip)", y: "vy(bar.tip, ground, ground.pivot)", m: "vm(bar.tip)", r: "vr(bar.tip, ground.pivot)"}
  turned: {z: "az(bar.tip, arm.tip)", ground: "az(bar, ground.pivot)", back: "az(ground.pivot, bar.tip)", w: "wz(bar)", still: "wz(arm, bar)"}
  faster: {x: "accx(bar.tip)", y: "accy(bar.tip, ground, bar)", m: "accm(bar.tip)", z: "wdtz(bar)"}
  own: {ax: bar.ax, alpha: arm.alpha, fx: hinge.fx, torque: motor.torque}
  push: {x: fx(hinge), j: fy(hinge.j), m: fm(spring), along: "fx(spring, bar.tip)", t: tz(motor), tj: tz(spring.j), ti: tz(spring)}
  of_run: {sum: energy.kinetic + energy.potential, open: constraint.position}
  counted: mod(bar.angle, 2*pi)
  whole: {trunc: trunc(bar.angle), round: round(bar.angle), floor: floor(-bar.angle), ceil: ceil(bar.angle)}
  twice: 2*effort + push.x
  effort: fm(hinge)*length
  loaded: effort/length + spare
  looked_up: curve(bar.omega - 29) + t
run: {duration: 1, rtol: 1e-9, output: 0.0005}
"""


@pytest.fixture(scope="module")
def solution():
    return stiffmbs.run(stiffmbs.read_scene(SCENE))


def point(solution, body, xi, eta):
    """A point of a body, shape (2, n)."""
    c, s = np.cos(solution[f"{body}.angle"]), np.sin(solution[f"{body}.angle"])
    return np.array([solution[f"{body}.x"] + c * xi - s * eta, solution[f"{body}.y"] + s * xi + c * eta])


def velocity(solution, body, xi, eta):
    x, y = point(solution, body, xi, eta) - [solution[f"{body}.x"], solution[f"{body}.y"]]
    w = solution[f"{body}.omega"]
    return np.array([solution[f"{body}.vx"] - w * y, solution[f"{body}.vy"] + w * x])


def acceleration(solution, body, xi, eta):
    x, y = point(solution, body, xi, eta) - [solution[f"{body}.x"], solution[f"{body}.y"]]
    w, a = solution[f"{body}.omega"], solution[f"{body}.alpha"]
    return np.array([solution[f"{body}.ax"] - a * y - w * w * x, solution[f"{body}.ay"] + a * x - w * w * y])


def along(vectors, angle):
    """Vectors in axes that are turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vectors[0] + s * vectors[1], c * vectors[1] - s * vectors[0]])


TIP, ARM_TIP, PIVOT = (0.4, 0.1), (0.2, 0.1), np.array([[0.2], [0.1]])


def near(found, expected, tolerance=1e-11):
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance * np.abs(expected).max())


def test_distances_and_places(solution):
    tip, arm_tip = point(solution, "bar", *TIP), point(solution, "arm", *ARM_TIP)
    near(solution["place.x"], (tip - arm_tip)[0])
    near(solution["place.y"], (tip - PIVOT)[1])
    near(solution["place.along"], along(tip - PIVOT, solution["arm.angle"] - 0.3)[0])
    near(solution["place.m"], np.hypot(*tip))


def test_velocities(solution):
    tip, fast = point(solution, "bar", *TIP) - PIVOT, velocity(solution, "bar", *TIP)
    near(solution["rate.x"], fast[0])
    near(solution["rate.y"], along(fast, 0.5)[1])
    near(solution["rate.m"], np.hypot(*fast))
    np.testing.assert_allclose(solution["rate.r"], np.sum(tip * fast, axis=0) / np.hypot(*tip), atol=1e-9)


def test_angles_and_their_rates(solution):
    bar, arm = solution["bar.angle"], solution["arm.angle"]
    np.testing.assert_allclose(solution["turned.z"], bar + 0.7 - (arm - 0.3), atol=1e-12)
    np.testing.assert_allclose(solution["turned.ground"], bar - 0.5, atol=1e-12)
    np.testing.assert_allclose(solution["turned.back"], 0.5 - bar - 0.7, atol=1e-12)
    np.testing.assert_array_equal(solution["turned.w"], solution["bar.omega"])
    np.testing.assert_allclose(solution["turned.still"], solution["arm.omega"] - solution["bar.omega"], atol=1e-12)


def test_accelerations(solution):
    of_tip = acceleration(solution, "bar", *TIP)
    near(solution["faster.x"], of_tip[0])
    near(solution["faster.y"], along(of_tip, solution["bar.angle"])[1])
    near(solution["faster.m"], np.hypot(*of_tip))
    np.testing.assert_array_equal(solution["faster.z"], solution["bar.alpha"])


def test_channels_are_read_as_they_are(solution):
    for name, channel in {"ax": "bar.ax", "alpha": "arm.alpha", "fx": "hinge.fx", "torque": "motor.torque"}.items():
        np.testing.assert_array_equal(solution[f"own.{name}"], solution[channel])
    near(solution["of_run.sum"], solution["energy.total"])
    np.testing.assert_array_equal(solution["of_run.open"], solution["constraint.position"])


def test_what_joints_and_forces_do(solution):
    spring = np.array([solution["spring.fx"], solution["spring.fy"]])
    np.testing.assert_array_equal(solution["push.x"], solution["hinge.fx"])
    np.testing.assert_array_equal(solution["push.j"], -solution["hinge.fy"])
    near(solution["push.m"], np.hypot(*spring))
    near(solution["push.along"], along(spring, solution["bar.angle"] + 0.7)[0])
    np.testing.assert_array_equal(solution["push.t"], solution["motor.torque"])
    np.testing.assert_array_equal(solution["push.ti"], solution["spring.torque"])
    np.testing.assert_allclose(solution["push.tj"], 0, atol=1e-9)  # its force goes through both points


def test_the_torque_on_the_second_body_is_about_its_own_point():
    """A slider's guide pushes up; at the rail's own marker that is a torque which grows with the way."""
    text = """
gravity: [0, -10]
bodies: {slider: {mass: 1, inertia: 1, velocity: [2, 0]}}
joints: {guide: {type: prismatic, i: slider, j: ground}}
requests: {at_i: tz(guide), at_j: tz(guide.j)}
run: {duration: 1}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    np.testing.assert_allclose(solution["at_i"], 0, atol=1e-9)
    np.testing.assert_allclose(solution["at_j"], -10 * 2 * solution.t, atol=1e-6)


def test_functions_and_tables(solution):
    angle = solution["bar.angle"]
    np.testing.assert_allclose(solution["counted"], np.mod(angle, 2 * np.pi), atol=1e-12)
    for name, expected in {"trunc": np.trunc(angle), "floor": np.floor(-angle), "ceil": np.ceil(angle)}.items():
        np.testing.assert_array_equal(solution[f"whole.{name}"], expected)
    np.testing.assert_array_equal(solution["whole.round"], np.floor(angle + 0.5))
    x = solution["bar.omega"] - 29
    near(solution["looked_up"], np.where(x < 0, 0.5, 2.0) * x + solution.t)


def test_requests_name_other_requests_in_any_order(solution):
    force = np.hypot(solution["hinge.fx"], solution["hinge.fy"])
    near(solution["effort"], 0.4 * force)
    near(solution["twice"], 0.8 * force + solution["hinge.fx"])
    near(solution["loaded"], force + 2)


def test_requests_use_variables_that_read_any_channel():
    head = SCENE.partition("requests:")[0]
    text = (
        head
        + """
variables: {power: motor.torque*bar.omega, spread: "sqrt(2)*dm(bar.tip, arm.tip)"}
requests: {twice: 2*power + spread}
run: {duration: 0.1, points: 5}
"""
    )
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    spread = np.sqrt(2) * np.hypot(*(point(solution, "bar", *TIP) - point(solution, "arm", *ARM_TIP)))
    near(solution["twice"], 2 * solution["motor.torque"] * solution["bar.omega"] + spread)


def test_angles_go_on_over_whole_turns_at_any_output_spacing():
    text = """
bodies: {wheel: {mass: 1, inertia: 1, omega: 70, markers: {mark: {angle: 3}}}}
joints: {axle: {type: revolute, i: wheel, j: ground}}
requests: {angle: "az(wheel.mark, ground)"}
run: {duration: 2, points: 3}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(text))
    np.testing.assert_allclose(solution["angle"], [3, 73, 143], atol=1e-6)


def test_units_are_known_or_follow():
    units = stiffmbs.run(stiffmbs.read_scene(SCENE), duration=1e-3, points=2).requested
    expected = {
        "place.x": "m", "rate.m": "m/s", "turned.z": "rad", "turned.w": "rad/s", "faster.x": "m/s^2", "faster.z": "rad/s^2",
        "own.fx": "N", "own.torque": "N m", "push.m": "N", "push.tj": "N m", "of_run.sum": "J", "counted": "rad",
        "twice": "N", "loaded": "N",
    }  # fmt: skip
    assert {name: units[name] for name in expected} == expected
    assert units["effort"] == ""  # the plain number 0.4 may be a length or none


UNITS = [
    ("energy.total + 3 J", "J"),
    ("hinge.torque*bar.omega", "kg m^2 s^-3"),
    ("bar.x/bar.y", ""),
    ("bar.x/(3 m)", ""),
    ("sqrt(bar.vx^2 + bar.vy^2)", "m/s"),
    ("atan2(bar.y, bar.x)", "rad"),
    ("-abs(az(bar) - 20 deg)", "rad"),
    ("max(bar.x, 2)", "m"),
    ("branch(t - 1, hinge.fx, 0, hinge.fy)", "N"),
    ("sin(bar.angle)", ""),
    ("bar.x + bar.angle", ""),
    ("2*bar.x", ""),
    ("t", "s"),
]


@pytest.mark.parametrize("formula, unit", UNITS)
def test_the_unit_of_a_formula(formula, unit):
    head = SCENE.partition("requests:")[0]
    scene = stiffmbs.read_scene(f'{head}requests: {{r: "{formula}", again: r}}\nrun: {{duration: 1e-3, points: 2}}')
    assert stiffmbs.run(scene).requested == {"r": unit, "again": unit}


WRONG = [
    (
        "{r: {formula: bar.x, unit: mm}}",
        "requests.r: found the component 'formula', expected a formula, whose unit follows",
    ),
    ("{r: dz(bar)}", "requests.r: found the unknown function 'dz'.*, expected one of"),
    ("{r: fz(hinge)}", "requests.r: found the unknown function 'fz'"),
    ("{r: bar.z}", "requests.r: found 'bar.z' in 'bar.z', expected one of bar.x, bar.y, bar.angle, .*, bar.alpha"),
    ("{r: hinge.tz}", "requests.r: found 'hinge.tz'"),
    ("{r: rod.x}", "requests.r: found the unknown body 'rod' in 'rod.x'"),
    ("{r: energy.lost}", "requests.r: found 'energy.lost'"),
    ("{r: fx(rope)}", r"requests.r: found 'rope' in 'fx\(rope\)', expected a joint or a force"),
    ("{r: other}", "requests.r: found the unknown name 'other' in 'other', expected t, .* another channel or request"),
    ("{r: push, push: {x: t}}", "requests.r: found 'push' in 'push', which has components, expected one of push.x"),
    ("{r: push.y, push: {x: t}}", "requests.r: found 'push.y'"),
    (
        "{a: b + 1, b: 2*c, c: a}",
        r"found a request that depends on itself \((a -> b -> c|b -> c -> a|c -> a -> b) -> .\)",
    ),
    ("{a: a}", r"requests.a: found a request that depends on itself \(a -> a\)"),
    ("{length: bar.x, r: length}", "requests.r: found 'length' in 'length', which is a parameter and a request"),
    ("{a: hinge.fx, r: a + 3 m}", "requests.r: found N and m in 'a [+] 3 m'"),
    ("{r: energy.total + 3 N}", "requests.r: found N m and N"),
]


@pytest.mark.parametrize("requests, words", WRONG)
def test_requests_that_cannot_be_are_told(requests, words):
    head = SCENE.partition("requests:")[0]
    with pytest.raises(InputError, match=words):
        stiffmbs.read_scene(f"{head}requests: {requests}\n")


def test_what_acts_on_more_than_two_bodies_has_no_second_one():
    text = """
bodies: {a: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1, position: [1, 0]}}
joints:
  pin_a: {type: revolute, i: a, j: ground}
  pin_b: {type: revolute, i: b, j: {body: ground, point: [1, 0]}}
  mesh: {type: gear, joint_1: pin_a, joint_2: pin_b, ratio: 2}
requests: {r: "tz(mesh.j)"}
"""
    with pytest.raises(
        InputError, match=r"requests.r: found 'mesh.j' in 'tz\(mesh.j\)', which acts on more than two bodies"
    ):
        stiffmbs.read_scene(text)


def test_a_component_is_measured_by_its_unit_and_not_by_its_name(solution):
    """push.x is a force, place.x a length like all others."""
    sizes = scales(solution.channels, 1.0, solution.requested)
    assert sizes["place.x"] >= 0.1 * sizes["bar.x"]
    pushes = [f"push.{name}" for name in ("x", "j", "m", "along", "t", "tj", "ti")]
    assert sizes["push.x"] == pytest.approx(max(np.abs(solution[name]).max() for name in pushes))


def test_requests_from_python():
    model = stiffmbs.Model()
    stone = model.add("stone", stiffmbs.Body(mass=1, inertia=1, velocity=(3, 4)))
    model.request("speed", "vm(stone)")
    model.request("way", {"x": "dx(stone)", "twice": "2*speed"})
    model.request("symbolic", 2 * stone.x + 1)
    solution = stiffmbs.run(model, duration=1)
    np.testing.assert_allclose(solution["way.twice"], 10)
    np.testing.assert_allclose(solution["symbolic"], 6 * solution.t + 1, atol=1e-9)
    with pytest.raises(InputError, match="unknown name 'later'"):
        model.request("early", "later + 1")
    with pytest.raises(InputError, match="unknown body 'pebble'"):
        model.request("late", "dx(pebble)")
    assert set(model.requests) == {"speed", "way", "symbolic"}


def test_a_request_connects_no_mechanisms():
    """Two pendulums, one a hundred times as long, are solved apart though requests ask for the distance and angle between them."""
    text = """
gravity: [0, -9.81]
bodies:
  a: {mass: 1, inertia: 0.1, position: [1, 0], markers: {end: {point: [-1, 0]}}}
  b: {mass: 1, inertia: 1e-5, position: [0.01, 3], markers: {end: {point: [-0.01, 0]}}}
joints:
  pin_a: {type: revolute, i: a.end, j: ground}
  pin_b: {type: revolute, i: b.end, j: {body: ground, point: [0, 3]}}
run: {duration: 10, points: 11}
"""
    asked = "requests: {far: 'dm(a, b)', turned: 'az(a, b)', sum: energy.total + pin_a.fx}\n"
    alone, reported = (stiffmbs.run(stiffmbs.read_scene(text + more)) for more in ("", asked))
    assert reported.presolve == alone.presolve and any(
        "apart" in line or "mechanisms" in line for line in alone.presolve
    )
    for channel in alone:
        np.testing.assert_array_equal(alone[channel], reported[channel])


SAME = (
    "place.x place.y place.along place.m rate.x rate.y rate.m rate.r turned.z turned.ground turned.back turned.w faster.x "
    "faster.y faster.m faster.z own.ax own.alpha own.fx own.torque push.x push.j push.m push.along push.t push.tj push.ti "
    "of_run.sum twice effort loaded looked_up"
)


@pytest.mark.long
def test_requests_are_the_same_in_space(solution):
    space = stiffmbs.run(spatial.in_space(stiffmbs.read_scene(SCENE)))
    for name in SAME.split():
        bound = 1e-6 * np.abs(solution[name]).max() + 1e-8
        np.testing.assert_allclose(space[name], solution[name], rtol=0, atol=bound, err_msg=name)


def test_scales_of_small_forces_are_theirs():
    """The force of an element in all directions; a tenth of a newton is not taken for one."""
    channels = {"f.fx": np.array([0.0, 0.03]), "f.fy": np.array([-0.1, 0.02]), "b.vx": np.array([2e-3, -1e-3])}
    sizes = scales(channels, 1.0)
    assert sizes["f.fx"] == sizes["f.fy"] == 0.1 and sizes["b.vx"] == 2e-3
