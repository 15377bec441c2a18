"""Free coordinates of joints, their rates and accelerations, against body poses and differences in time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.spatial.spatial_kinds import JOINTS

SPACING = 2e-3
WEIGHTS = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}  # eighth order, centred
SLOT = "0.1*sin(2*x)"


def rate(values):
    return sum(w * (np.roll(values, -k) - np.roll(values, k)) for k, w in WEIGHTS.items())[4:-4] / SPACING


def assert_follows(solution, joint, name, expected, angle):
    """A coordinate is as expected, up to whole turns that do not change, and its derivatives are those in time."""
    value, first, second = (solution[f"{joint}.{name}{order}"] for order in ("", "_rate", "_acceleration"))
    turns = (value - np.unwrap(expected)) / (2 * np.pi) if angle else value - expected
    np.testing.assert_allclose(turns, np.round(turns[0]) if angle else 0, atol=1e-9)
    np.testing.assert_allclose(rate(value), first[4:-4], atol=1e-6 * max(1, abs(first).max()))
    np.testing.assert_allclose(rate(first), second[4:-4], atol=1e-6 * max(1, abs(second).max()))


def run(model):
    return stiffmbs.run(
        model, duration=40 * SPACING, points=41, rtol=1e-11, solver="projected", scheme="dop853", presolve=False
    )


def about_z(angle):
    return Rotation.from_rotvec([0, 0, angle])


def cross(a, b):
    """Orientation of marker i of a universal joint with the angles a of the cross and b of marker i on it."""
    z = np.array([np.cos(a), np.sin(a), 0])
    x = Rotation.from_rotvec(b * z).apply([0, 0, 1])
    return Rotation.from_matrix(np.column_stack([x, np.cross(z, x), z]))


ANGLE, D = "angle", "displacement"
XY = (f"{D}_x", f"{D}_y")
KINDS = {
    "revolute": (lambda c, a, b, any_: ((0, 0, 0), about_z(a)), (ANGLE,)),
    "prismatic": (lambda c, a, b, any_: ((0, 0, c[2]), about_z(0)), (D,)),
    "cylindrical": (lambda c, a, b, any_: ((0, 0, c[2]), about_z(a)), (D, ANGLE)),
    "screw": (lambda c, a, b, any_: ((0, 0, c[2]), about_z(a)), (D, ANGLE)),
    "universal": (lambda c, a, b, any_: ((0, 0, 0), cross(a, b)), ("angle_1", "angle_2")),
    "planar": (lambda c, a, b, any_: ((c[0], c[1], 0), about_z(a)), (*XY, ANGLE)),
    "point_on_plane": (lambda c, a, b, any_: ((c[0], c[1], 0), any_), XY),
    "point_on_line": (lambda c, a, b, any_: ((0, 0, c[2]), any_), (D,)),
    "parallel": (lambda c, a, b, any_: (c, about_z(a)), (*XY, f"{D}_z", ANGLE)),
    "orientation": (lambda c, a, b, any_: (c, about_z(0)), (*XY, f"{D}_z")),
    "revolute_spherical": (lambda c, a, b, any_: ((0.4 * np.cos(a), 0.4 * np.sin(a), 0), any_), ("angle_1",)),
    "point_on_curve": (lambda c, a, b, any_: ((c[0], 0.1 * np.sin(2 * c[0]), 0), any_), XY),
}
"""Displacement of marker i and its orientation in the axes of marker j, and the free coordinates, by kind in space."""
FIELDS = {"screw": {"pitch": 0.2}, "point_on_curve": {"y": SLOT}, "revolute_spherical": {"length": 0.4}}


def measured(name, kind, d, turned):
    """Return a coordinate from displacements (n, 3) and orientations of marker i in the axes of marker j."""
    x, z, of_z = turned[:, :, 0], turned[:, :, 2], turned[:, 2, :]
    if kind == "revolute_spherical":
        return np.arctan2(d[:, 1], d[:, 0])
    match name:
        case "angle":
            return np.arctan2(x[:, 1], x[:, 0])
        case "angle_1":
            return np.arctan2(z[:, 1], z[:, 0])
        case "angle_2":
            return np.arctan2(-of_z[:, 1], of_z[:, 0])
    return d[:, "xyz".index(name[-1]) if name[-2] == "_" else 2]


def frames(solution, body, marker):
    """Return position and orientation of a marker over time."""
    p = np.stack([solution[f"{body}.q{k}"] for k in (1, 2, 3, 0)], axis=-1)
    turned = Rotation.from_quat(p)
    point = np.stack([solution[f"{body}.{c}"] for c in "xyz"], axis=-1) + turned.apply(marker["point"])
    return point, turned * Rotation.from_quat(np.roll(marker["orientation"], -1))


def quaternion(rotation):
    return tuple(np.roll(rotation.as_quat(), 1))


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@given(seed=st.integers(0, 10**6), angles=st.tuples(st.floats(-3.1, 3.1), st.floats(-2.5, 2.5)))
@settings(max_examples=4, deadline=None)
def test_coordinates_in_space(kind, seed, angles):
    rng = np.random.default_rng(seed)
    placed, names = KINDS[kind]
    free = Rotation.random(random_state=seed)
    d, turn = placed(rng.uniform(-0.5, 0.5, 3), *angles, free)
    on_a, on_b, body_b = (Rotation.random(random_state=seed + k) for k in (1, 2, 3))
    i, j = ({"point": tuple(rng.uniform(-0.3, 0.3, 3)), "orientation": quaternion(on)} for on in (on_a, on_b))
    of_j = body_b * on_b
    body_a = of_j * turn * on_a.inv()
    at_b = rng.uniform(-1, 1, 3)
    at_a = at_b + body_b.apply(j["point"]) + of_j.apply(d) - body_a.apply(i["point"])
    model = spatial.Model(gravity=(0, 0, -9.81))
    for name, at, turned, marker in (("a", at_a, body_a, {"i": i}), ("b", at_b, body_b, {"j": j})):
        model.add(
            name,
            spatial.Body(
                mass=1, inertia=(0.2, 0.25, 0.3), position=at, orientation=quaternion(turned), markers=marker,
                velocity=rng.uniform(-2, 2, 3), omega=rng.uniform(-3, 3, 3),
            ),
        )  # fmt: skip
    model.add("joint", JOINTS[kind](i="a.i", j="b.j", **FIELDS.get(kind, {})))
    solution = run(model)
    (p_i, r_i), (p_j, r_j) = frames(solution, "a", i), frames(solution, "b", j)
    apart, turned = r_j.inv().apply(p_i - p_j), (r_j.inv() * r_i).as_matrix()
    reported = [c.removeprefix("joint.") for c in solution.channels if c.startswith("joint.")]
    assert [c for c in reported if c.partition("_")[0] in (ANGLE, D)] == [
        f"{name}{order}" for name in names for order in ("", "_rate", "_acceleration")
    ]
    for name in names:
        assert_follows(solution, "joint", name, measured(name, kind, apart, turned), name.startswith(ANGLE))


IN_PLANE = {
    "revolute": (stiffmbs.Revolute, {}, (ANGLE,)),
    "prismatic": (stiffmbs.Prismatic, {}, (D,)),
    "point_on_line": (stiffmbs.PointOnLine, {}, (D, ANGLE)),
    "point_on_curve": (stiffmbs.PointOnCurve, {"y": SLOT}, (*XY, ANGLE)),
}


@pytest.mark.parametrize("kind", IN_PLANE)
@given(seed=st.integers(0, 10**6), turn=st.floats(-9, 9))
@settings(max_examples=4, deadline=None)
def test_coordinates_in_the_plane(kind, seed, turn):
    rng = np.random.default_rng(seed)
    element, fields, names = IN_PLANE[kind]
    s = rng.uniform(-0.5, 0.5)
    d = {"revolute": (0, 0), "point_on_curve": (s, 0.1 * np.sin(2 * s))}.get(kind, (s, 0))
    turn = 0.0 if kind == "prismatic" else turn
    (on_a, on_b), angle_i, angle_j, angle_b = rng.uniform(-0.3, 0.3, (2, 2)), *rng.uniform(-2, 2, 3)
    angle_a = angle_b + angle_j + turn - angle_i

    def rotated(angle, x):
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ np.asarray(x)

    at_a = rotated(angle_b, on_b) + rotated(angle_b + angle_j, d) - rotated(angle_a, on_a)
    model = stiffmbs.Model(gravity=(0, -9.81))
    for name, at, angle in (("a", at_a, angle_a), ("b", (0, 0), angle_b)):
        velocity, omega = rng.uniform(-2, 2, 2), rng.uniform(-3, 3)
        model.add(name, stiffmbs.Body(mass=1, inertia=0.2, position=at, angle=angle, velocity=velocity, omega=omega))
    i = stiffmbs.Marker(body="a", point=on_a, angle=angle_i)
    model.add("joint", element(i=i, j=stiffmbs.Marker(body="b", point=on_b, angle=angle_j), **fields))
    solution = run(model)
    a, b = (solution[f"{name}.angle"] for name in "ab")
    point_i, point_j = (
        [solution[f"{n}.x"] + np.cos(angle) * p[0] - np.sin(angle) * p[1],
         solution[f"{n}.y"] + np.sin(angle) * p[0] + np.cos(angle) * p[1]]
        for n, angle, p in (("a", a, on_a), ("b", b, on_b))
    )  # fmt: skip
    x, y = np.subtract(point_i, point_j)
    axis = b + angle_j
    expected = {
        ANGLE: a + angle_i - axis, D: x * np.cos(axis) + y * np.sin(axis),
        f"{D}_x": x * np.cos(axis) + y * np.sin(axis), f"{D}_y": y * np.cos(axis) - x * np.sin(axis),
    }  # fmt: skip
    for name in names:
        np.testing.assert_allclose(solution[f"joint.{name}"], expected[name], atol=1e-12)
        assert_follows(solution, "joint", name, expected[name], False)


ALONG_Y = {"z": (0, 1, 0)}


def spun(duration, output, torque=0.0, **requests):
    """A flywheel in space that turns 40 rad/s about y, with a torque about its axis and the moment of inertia 0.5."""
    model = spatial.Model()
    wheel = model.add("wheel", spatial.Body(mass=1, inertia=(0.3, 0.5, 0.3), omega=(0, 40, 0)))
    model.add(
        "hinge", spatial.Revolute(i=wheel.at(0, 0, 0, ALONG_Y), j=spatial.Marker(body="ground", orientation=ALONG_Y))
    )
    if torque:
        model.add("motor", spatial.AppliedTorque(i="wheel", torque=(0, torque, 0)))
    for name, formula in requests.items():
        model.request(name, formula)
    return stiffmbs.run(model, duration=duration, output=output, rtol=1e-8)


@pytest.mark.parametrize("requests", [{}, {"counted": "hinge.angle"}], ids=["followed", "counted"])
@pytest.mark.parametrize("torque", [0.0, -20.0])
def test_angles_in_space_count_full_turns_between_output_times(requests, torque):
    solution = spun(6.0, 1.5, torque, **requests)
    t = solution.time
    np.testing.assert_allclose(solution["hinge.angle"], 40 * t + torque * t**2, rtol=1e-6)
    np.testing.assert_allclose(solution["hinge.angle_rate"], 40 + 2 * torque * t, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(solution["hinge.angle_acceleration"], 2 * torque, atol=1e-6)


def test_uncertain_turns_are_noted_unless_they_are_counted():
    """A torsional oscillation of 24 rad at 10 Hz, with output times every 0.11 s."""
    model = spatial.Model()
    model.add("wheel", spatial.Body(mass=1, inertia=(0.3, 0.3, 0.5), omega=(0, 0, 1500)))
    model.add("hinge", spatial.Revolute(i="wheel", j="ground"))
    model.add("spring", spatial.TorsionSpring(i="wheel", j="ground", stiffness=2000.0))
    coarse = stiffmbs.run(model, duration=2, output=0.11, rtol=1e-7)
    assert any("the revolutions of hinge.angle are uncertain" in note for note in coarse.notes)
    model.request("counted", "hinge.angle")
    counted = stiffmbs.run(model, duration=2, output=0.11, rtol=1e-7)
    assert not any("the revolutions of hinge.angle are uncertain" in note for note in counted.notes)
    frequency = np.sqrt(2000 / 0.5)
    np.testing.assert_allclose(counted["hinge.angle"], 1500 / frequency * np.sin(frequency * counted.time), atol=1e-2)


def test_turns_are_uncertain_where_a_prediction_over_too_long_an_interval_agrees_by_chance():
    """A torsional oscillation of 24 rad at 10 Hz with outputs at the ends: changes are known up to full turns."""
    model = spatial.Model()
    model.add("wheel", spatial.Body(mass=1, inertia=(0.3, 0.3, 0.5), omega=(0, 0, 1500)))
    model.add("hinge", spatial.Revolute(i="wheel", j="ground"))
    model.add("spring", spatial.TorsionSpring(i="wheel", j="ground", stiffness=2000.0))
    for duration in np.linspace(0.5, 0.6, 12):
        solution = stiffmbs.run(model, duration=duration, points=2)
        assert any("the revolutions of hinge.angle are uncertain" in note for note in solution.notes), duration


ARM = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {c: 0.3}
parts:
  arm:
    bodies:
      beam:
        mass: 1
        inertia: [0.02, 0.03, 0.01]
        position: [0.3, 0.1, 0]
        markers: {pin: {point: [-0.3, 0, 0], orientation: {z: [0, 1, 0], x: [1, 0, 0]}}}
    markers: {pin: {point: [0, 0.1, 0], orientation: {z: [0, 1, 0], x: [1, 0, 0]}}}
    joints: {hinge: {type: revolute, i: beam.pin, j: mount.pin}}
    states: {turned: {rate: "ANGLE_RATE"}}
    forces: {damper: {type: torque, i: beam, torque: [0, "-c*ANGLE_RATE - 5*ANGLE + turned", 0]}}
use:
  left: {part: arm, position: [0, 1, 0]}
  right: {part: arm, position: [0, -1, 0], mirror: "y"}
run: {duration: 0.5, rtol: 1e-9, points: 51}
"""


def arms(angle, angle_rate, **settings):
    return stiffmbs.run(stiffmbs.read_scene(ARM.replace("ANGLE_RATE", angle_rate).replace("ANGLE", angle)), **settings)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_formulas_of_forces_and_states_in_mirrored_parts_use_coordinates(solver):
    found = arms("hinge.angle", "hinge.angle_rate", solver=solver)
    measured = arms("az(beam.pin, mount.pin)", "wz(beam.pin, mount.pin, mount.pin)", solver=solver)
    for name in ("left.beam.z", "right.beam.z", "left.turned", "left.hinge.angle"):
        np.testing.assert_allclose(found[name], measured[name], atol=1e-7)
    np.testing.assert_allclose(found["right.hinge.angle"], -found["left.hinge.angle"], atol=1e-9)
    np.testing.assert_allclose(found["left.turned"], found["left.hinge.angle"], atol=1e-7)


SLIDER = """
gravity: [0, -9.81]
parameters: {m: 1}
bodies: {bar: {mass: m, inertia: 0.02, position: [0.3, 0], omega: 20, velocity: [0, 6]}, cart: {mass: 1, inertia: 0.1}}
joints:
  hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: cart}
  rail: {type: prismatic, i: cart, j: ground}
  motor: {type: drive, joint: rail, position: 0.1*sin(3*t)}
run: {duration: 1, rtol: 1e-9, points: 101}
"""


def test_the_effort_of_a_drive_is_its_force_along_the_coordinate_and_its_power_that_of_the_energy():
    solution = stiffmbs.run(stiffmbs.read_scene(SLIDER), points=2001)
    np.testing.assert_allclose(solution["motor.effort"], solution["motor.fx"], atol=1e-9)
    power = solution["motor.effort"] * solution["rail.displacement_rate"]
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(solution.time))])
    change = solution["energy.total"] - solution["energy.total"][0]
    np.testing.assert_allclose(work, change, atol=1e-4 * np.abs(change).max())


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("channel", ["hinge.angle", "hinge.angle_rate", "hinge.angle_acceleration", "motor.effort"])
def test_sensitivities_of_coordinates_and_efforts(channel):
    found = stiffmbs.sensitivities(stiffmbs.read_scene(SLIDER), of=f"final({channel})", to=["m"]).to["m"]
    high, low = (stiffmbs.run(stiffmbs.read_scene(SLIDER, [("m", m)]))[channel][-1] for m in (1.001, 0.999))
    np.testing.assert_allclose(found, (high - low) / 0.002, rtol=2e-3)


@pytest.mark.parametrize(
    ("formula", "sentence"),
    [
        ("-hinge.angel", r"'hinge.angel' \(did you mean 'angle'\?\).*expected one of hinge.angle, hinge.angle_rate"),
        ("-hinge.angle_acceleration", "which is an acceleration, expected one of hinge.angle, hinge.angle_rate"),
        ("motor.angle", "a joint of the type drive, which has no coordinates"),
        ("3 N*hinge.angle_rate", r"expected a torque in N m"),
    ],
)
def test_names_that_are_no_coordinates_are_refused(formula, sentence):
    with pytest.raises(stiffmbs.InputError, match=sentence):
        stiffmbs.read_scene(SLIDER + f"forces: {{f: {{type: torque, i: bar, torque: {formula}}}}}")


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(("driven", "expected"), [(None, np.pi), ("-pi", -np.pi), ("3*pi", 3 * np.pi)])
def test_half_a_turn_at_the_start_does_not_depend_on_rounding(driven, expected):
    """The sign of an initial angle of half a turn is positive, and a drive finds its turn, in any axes."""
    for axes in Rotation.random(6, random_state=np.random.default_rng(7)):
        hinge = spatial.Marker(body="ground", orientation=axes.as_matrix())
        model = spatial.Model(gravity=(0, 0, 0))
        turned = (axes * Rotation.from_euler("z", np.pi)).as_matrix()
        model.add("bar", spatial.Body(mass=1, inertia=(1, 1, 1), orientation=turned))
        model.add("hinge", spatial.Revolute(i="bar", j=hinge))
        if driven:
            model.add("motor", spatial.Drive(joint="hinge", position=driven))
        for requests in ({}, {"angle": "hinge.angle"}):
            model.requests.update(requests)
            solution = model.run(duration=0.01, points=2)
            assert solution["hinge.angle"][0] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("driven", ["370 deg", "-200 deg + 2*t"])
def test_a_request_of_a_driven_angle_has_the_turns_of_its_drive(driven):
    model = spatial.Model(gravity=(0, 0, 0))
    model.add("bar", spatial.Body(mass=1, inertia=(1, 1, 1)))
    model.add("hinge", spatial.Revolute(i="bar", j="ground"))
    model.add("motor", spatial.Drive(joint="hinge", position=driven))
    alone = model.run(duration=0.1, points=2)["hinge.angle"]
    model.requests.update(angle="hinge.angle")
    requested = model.run(duration=0.1, points=2)
    assert alone[0] == pytest.approx(np.radians(370 if driven == "370 deg" else -200))
    np.testing.assert_allclose([requested["angle"], requested["hinge.angle"]], [alone, alone], rtol=1e-9)
