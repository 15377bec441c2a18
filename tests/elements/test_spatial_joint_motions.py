"""Motions through joints in space against formulas worked by hand, over many turns."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation as rotation

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.spatial.orientation import about

from ..rolling import Disc
from ..spatial_channels import axes, vector
from ..spatial_closed_forms import zxz

G = 9.81
TURN = 2 * np.pi
ALONG_X = {"z": (1, 0, 0), "x": (0, 1, 0)}
ALONG_MINUS_X = {"z": (-1, 0, 0), "x": (0, 1, 0)}
BOTH = pytest.mark.parametrize("solver", [{}, {"solver": "projected", "scheme": "dop853"}], ids=["bdf", "dop853"])


def wheel(**fields):
    return spatial.Body(**({"mass": 1.0, "inertia": (0.02, 0.02, 0.03)} | fields))


def two_shafts(bend, joint, drive):
    """Two shafts through the origin, along x and bent from it about z, the first one driven, the second kept in line."""
    model = spatial.Model()
    model.add("first", wheel())
    model.add("second", wheel(orientation=about(2, bend)))
    model.add(
        "bearing",
        spatial.Revolute(i={"body": "first", "orientation": ALONG_X}, j={"body": "ground", "orientation": ALONG_X}),
    )
    line = {"z": (np.cos(bend), np.sin(bend), 0)}
    model.add(
        "in_line",
        spatial.Parallel(i={"body": "second", "orientation": ALONG_X}, j={"body": "ground", "orientation": line}),
    )
    model.add("joint", joint)
    model.add("motor", spatial.Drive(joint="bearing", position=drive))
    return model


@pytest.mark.parametrize("bend", [0.0, 0.4, 1.0])
def test_a_universal_joint_turns_unevenly(bend):
    """tan theta_2 = cos(bend) tan theta_1, the first arm starting across the plane of both shafts."""
    joint = spatial.Universal(i="first", j={"body": "second", "orientation": {"z": (0, 1, 0)}})
    solution = stiffmbs.run(two_shafts(bend, joint, "7*t"), duration=10 * TURN / 7, points=401, rtol=1e-8)
    angle = 7 * solution.time
    ratio = np.cos(bend) / (np.cos(angle) ** 2 + (np.cos(bend) * np.sin(angle)) ** 2)
    np.testing.assert_allclose(solution["second.wx"], 7 * ratio, atol=1e-7)
    np.testing.assert_allclose(solution["first.wx"], 7, atol=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("of_second", [ALONG_X, ALONG_MINUS_X], ids=["same", "opposite"])
@pytest.mark.parametrize("bend", np.radians([0, 20, 40, 60]))
def test_shafts_in_a_constant_velocity_joint_turn_alike(bend, of_second):
    joint = spatial.ConstantVelocity(
        i={"body": "first", "orientation": ALONG_X}, j={"body": "second", "orientation": of_second}
    )
    solution = stiffmbs.run(two_shafts(bend, joint, "2*t + sin(3*t)"), duration=10, points=201, rtol=1e-8)
    np.testing.assert_allclose(solution["second.wx"], 2 + 3 * np.cos(3 * solution.time), atol=1e-7)


@pytest.mark.long
@pytest.mark.parametrize("of_second", [ALONG_X, ALONG_MINUS_X], ids=["same", "opposite"])
def test_the_reaction_of_a_constant_velocity_joint_in_a_formula(of_second):
    """A force that reads the torque in the joint reads that which is reported, whichever sense the axes are drawn with."""
    joint = spatial.ConstantVelocity(
        i={"body": "first", "orientation": ALONG_X}, j={"body": "second", "orientation": of_second}
    )
    model = two_shafts(0.4, joint, "2*t + sin(3*t)")
    model.add("probe", spatial.Body(mass=1.0, inertia=(0.1, 0.1, 0.1)))
    model.add("read", spatial.AppliedForce(i="probe", force=("tx(joint)", "ty(joint)", "tz(joint)")))
    solution = stiffmbs.run(model, duration=1.0, points=41, rtol=1e-8)
    assert np.abs(solution["joint.tx"]).max() > 0.1
    for axis in "xyz":
        np.testing.assert_allclose(solution[f"read.f{axis}"], solution[f"joint.t{axis}"], atol=1e-6)


PITCH, MASS, INERTIA = 0.05, 1.3, 0.0004


def falling_nut(*joints):
    """A nut on a vertical spindle, its origin and axes off its centre of mass and off its principal axes."""
    model = spatial.Model(gravity=(0, 0, -G))
    nut = wheel(mass=MASS, inertia=(0.001, 0.001, INERTIA), position=(0.3, 0.2, 0.1), orientation=about(2, 1.0))
    model.add("nut", nut)
    ground = spatial.Marker(body="ground", point=(0.3, 0.2, 0))
    for name, joint in joints:
        model.add(name, joint(ground))
    return model


@pytest.mark.sampled(3)
@pytest.mark.long
@BOTH
@pytest.mark.parametrize(
    ("sense", "joints"),
    [
        (1, [("screw", lambda ground: spatial.Screw(i="nut", j=ground, pitch=PITCH))]),
        (-1, [("screw", lambda ground: spatial.Screw(i="nut", j=ground, pitch=-PITCH))]),
        (
            1,
            [
                ("sleeve", lambda ground: spatial.Cylindrical(i="nut", j=ground)),
                ("screw", lambda ground: spatial.Thread(i="nut", j=ground, pitch=PITCH)),
            ],
        ),
        (
            1,
            [
                ("sleeve", lambda ground: spatial.Cylindrical(i="nut", j=ground)),
                ("screw", lambda _: spatial.Coupler(joint_1="sleeve.displacement", joint_2="sleeve.angle", scale=PITCH / TURN)),
            ],
        ),
    ],
    ids=["right-handed", "left-handed", "thread", "coupler"],
)  # fmt: skip
def test_a_nut_falls_slowly_by_its_own_turning(sense, joints, solver):
    """a = g/(1 + I (2 pi/p)^2/m), and the thread's force is what holds the rest of the weight."""
    solution = stiffmbs.run(falling_nut(*joints), duration=2.0, rtol=1e-9, **solver, points=41)
    per_metre = sense * TURN / PITCH
    a = G / (1 + INERTIA * per_metre**2 / MASS)
    fallen = a * solution.time**2 / 2
    assert fallen[-1] > 10 * PITCH
    np.testing.assert_allclose(solution["nut.z"], 0.1 - fallen, atol=1e-7)
    np.testing.assert_allclose(solution["nut.wz"], -per_metre * a * solution.time, atol=1e-5)
    expected = zxz(1.0 - per_metre * fallen, 0 * fallen, 0 * fallen)
    np.testing.assert_allclose(axes(solution, "nut"), expected, atol=1e-5)
    np.testing.assert_allclose(solution["screw.fz"], MASS * (G - a), rtol=1e-9)
    np.testing.assert_allclose(solution["screw.tz"], -INERTIA * per_metre * a, rtol=1e-9)


REFERRING = {
    "drive": lambda of: spatial.Drive(
        joint=f"screw.{of}", position="1 + t + t^2" if of == "angle" else "0.1 + 0.01*t^2"
    ),
    "coupler": lambda of: spatial.Coupler(joint_1=f"screw.{of}", joint_2="sleeve.displacement", scale=2.0),
    "gear": lambda of: spatial.Gear(joint_1="screw.angle", joint_2="sleeve.angle", ratio=2.0),
}


@pytest.mark.sampled(15)
@pytest.mark.long
@pytest.mark.parametrize(
    "solver", [{}, {"presolve": False}, {"solver": "projected"}], ids=["bdf", "as-is", "projected"]
)
@pytest.mark.parametrize("of", ["angle", "displacement"])
@pytest.mark.parametrize("kind", REFERRING)
@pytest.mark.parametrize("offset", [None, 0.1], ids=["as-drawn", "given"])
def test_elements_that_refer_to_a_screw(offset, kind, of, solver):
    """A screw whose offset is taken from its drawn pose moves as one with that offset given."""
    joints = [
        (
            "screw",
            lambda ground: spatial.Screw(i="nut", j=ground, pitch=PITCH, offset=offset and offset - PITCH / TURN),
        ),
        ("sleeve", lambda ground: spatial.Cylindrical(i="ring", j=ground)),
        ("referring", lambda _: REFERRING[kind](of)),
    ]
    model = falling_nut(joints[0])
    model.add("ring", wheel(position=(0.3, 0.2, 0.0)))
    for name, joint in joints[1:]:
        model.add(name, joint(spatial.Marker(body="ground", point=(0.3, 0.2, 0))))
    solution = stiffmbs.run(model, duration=0.4, points=9, rtol=1e-9, **solver)
    assert solution.success
    turn, advance = solution["nut.wz"][-1], solution["nut.vz"][-1]
    np.testing.assert_allclose(advance, PITCH * turn / TURN, rtol=1e-6, atol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("ratio", [17 / 31, -3.0, np.sqrt(2)], ids=["17/31", "internal", "irrational"])
def test_bevel_gears_mesh_over_many_turns(ratio):
    """theta_1 + ratio theta_2 = 0 from the drawn start, however many turns, and the motor turns both wheels."""
    model = spatial.Model()
    model.add("a", wheel(orientation=about(2, 2.8)))
    model.add("b", wheel(position=(1, 0, 0), orientation={"z": (1, 0, 1), "y": (0, 1, 0)}))
    model.add("pin_a", spatial.Revolute(i="a", j="ground"))
    axis = spatial.Marker(body="ground", point=(1, 0, 0), orientation={"z": (1, 0, 1), "x": (0, 1, 0)})
    model.add("pin_b", spatial.Revolute(i="b", j=axis))
    model.add("teeth", spatial.Gear(joint_1="pin_a", joint_2="pin_b", ratio=ratio))
    model.add("motor", spatial.Drive(joint="pin_a", position="2.8 + 5*t^2"))
    solution = stiffmbs.run(model, duration=4.0, points=81, rtol=1e-8)
    turned = -5 * solution.time**2 / ratio
    assert abs(turned[-1]) > 4 * TURN
    zero = np.zeros_like(turned)
    start = axes(solution, "b")[0]
    np.testing.assert_allclose(axes(solution, "b"), start @ zxz(turned, zero, zero), atol=1e-9)
    np.testing.assert_allclose(solution["motor.tz"], 0.03 * 10 * (1 + 1 / ratio**2), rtol=1e-6)
    np.testing.assert_allclose(solution["teeth.tz"], -0.03 * 10 / ratio**2, rtol=1e-6)


@pytest.mark.long
@BOTH
def test_a_pinion_carries_its_rack_on_turn_after_turn(solver):
    """M s'' = F, I theta'' = -F R + ..., let roll down a slope of 30 degrees: (M + I/R^2) s'' = M g sin."""
    radius, mass, slope = 0.04, 2.0, np.radians(30)
    model = spatial.Model(gravity=(0, 0, -G))
    down = (np.cos(slope), 0, -np.sin(slope))
    model.add("bar", wheel(mass=mass))
    model.add("pinion", wheel(orientation={"y": (0, 1, 0), "z": down}))
    line = {"z": down, "y": (0, 1, 0)}
    model.add(
        "slide", spatial.Prismatic(i={"body": "bar", "orientation": line}, j={"body": "ground", "orientation": line})
    )
    across = {"z": (0, 1, 0)}
    model.add(
        "pin",
        spatial.Revolute(i={"body": "pinion", "orientation": across}, j={"body": "ground", "orientation": across}),
    )
    model.add("teeth", spatial.RackAndPinion(rack="slide", pinion="pin", pitch_radius=radius))
    solution = stiffmbs.run(model, duration=2.0, points=41, rtol=1e-9, **solver)
    a = mass * G * np.sin(slope) / (mass + 0.02 / radius**2)
    way = a * solution.time**2 / 2
    assert way[-1] > 4 * TURN * radius
    np.testing.assert_allclose(vector(solution, "bar"), np.outer(way, down), atol=1e-7)
    np.testing.assert_allclose(solution["pinion.wy"], a * solution.time / radius, atol=1e-5)
    force = mass * (a - G * np.sin(slope))
    np.testing.assert_allclose(solution["teeth.fx"], force * np.cos(slope), rtol=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("start", [0.3, np.pi, 3.5, -20.0])
def test_drives_turn_and_push_a_sleeve_over_many_turns(start):
    model = spatial.Model()
    model.add("sleeve", wheel(orientation=about(2, start)))
    model.add("shaft", spatial.Cylindrical(i="sleeve", j="ground"))
    model.add("turn", spatial.Drive(joint="shaft.angle", position=f"{start} + 9*t - sin(t)"))
    model.add("push", spatial.Drive(joint="shaft.displacement", position="0.1*sin(5*t)"))
    solution = stiffmbs.run(model, duration=7.5, points=76, rtol=1e-8)
    t = solution.time
    zero = np.zeros_like(t)
    np.testing.assert_allclose(axes(solution, "sleeve"), zxz(start + 9 * t - np.sin(t), zero, zero), atol=1e-9)
    np.testing.assert_allclose(solution["sleeve.z"], 0.1 * np.sin(5 * t), atol=1e-10)
    np.testing.assert_allclose(solution["push.fz"], -2.5 * np.sin(5 * t), atol=1e-8)
    np.testing.assert_allclose(solution["turn.tz"], 0.03 * np.sin(t), atol=1e-8)


@pytest.mark.long
def test_a_measured_angle_is_driven_over_many_turns():
    model = spatial.Model()
    model.add("arm", wheel())
    model.add("pin", spatial.Revolute(i="arm", j="ground"))
    model.add("motor", spatial.Drive(coordinate="az(arm, ground)", position="8*t"))
    solution = stiffmbs.run(model, duration=8.0, points=81, rtol=1e-8)
    np.testing.assert_allclose(solution["arm.wz"], 8, atol=1e-9)


@pytest.mark.long
@BOTH
def test_a_disc_rolls_without_slipping(solver):
    """The plane by a user's equation of positions, rolling by two of velocities, which have no position form."""
    disc, nutation, rates = Disc(0.3, 2.0, 0.045, 0.09), 1.2, np.array([0.3, 1.5, 4.0])
    axis = (
        "2*(coin.q1*coin.q3 + coin.q0*coin.q2)",
        "2*(coin.q2*coin.q3 - coin.q0*coin.q1)",
        "(1 - 2*coin.q1^2 - 2*coin.q2^2)",
    )
    sine = f"sqrt(1 - {axis[2]}^2)"
    up = [f"(-{axis[2]}*{axis[0]}/{sine})", f"(-{axis[2]}*{axis[1]}/{sine})", sine]  # the steepest diameter
    rolling = (
        f"coin.vx - 0.3*(wy(coin)*{up[2]} - wz(coin)*{up[1]})",
        f"coin.vy - 0.3*(wz(coin)*{up[0]} - wx(coin)*{up[2]})",
    )
    model = spatial.Model(gravity=(0, 0, -G))
    model.add(
        "coin",
        spatial.Body(
            mass=disc.mass,
            inertia=(disc.transverse, disc.transverse, disc.axial),
            position=(0, 0, disc.radius * np.sin(nutation)),
            orientation={"euler": "zxz", "angles": [0, nutation, 0]},
            omega=rates,
            velocity=np.cross(_about_x(nutation) @ rates, disc.radius * _about_x(nutation)[:, 1]),
        ),
    )
    model.add("plane", spatial.ConstraintEquation(zero=f"coin.z - 0.3*{sine}"))
    model.add("rolling", spatial.VelocityEquation(zero=rolling))
    solution = stiffmbs.run(model, duration=3.0, points=61, rtol=1e-10, **solver)
    heading, tilt, spin, *_, x, y = disc.rolling(solution.time, nutation, rates)
    np.testing.assert_allclose(axes(solution, "coin"), zxz(heading, tilt, spin), atol=1e-7)
    np.testing.assert_allclose(vector(solution, "coin")[:, :2], np.stack([x, y], axis=-1), atol=1e-7)
    assert solution.energy_drift() < 1e-7


def _about_x(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


@BOTH
def test_a_knife_edge_on_a_slope_draws_a_cycloid(solver):
    """phi = w t, v = (a/w) sin(w t): x = a sin^2(w t)/(2 w^2), y = a (w t - sin(2 w t)/2)/(2 w^2); the edge holds 2 m a sin."""
    a, w, mass = 3.0, 2.0, 1.5
    model = stiffmbs.Model(gravity=(a, 0))
    model.add("sled", stiffmbs.Body(mass=mass, inertia=0.2, omega=w))
    model.add("edge", stiffmbs.VelocityEquation(zero="sled.vy*cos(sled.angle) - sled.vx*sin(sled.angle)"))
    solution = stiffmbs.run(model, duration=4.0, points=81, rtol=1e-9, **solver)
    turned = w * solution.time
    np.testing.assert_allclose(solution["sled.x"], a * np.sin(turned) ** 2 / (2 * w**2), atol=1e-7)
    np.testing.assert_allclose(solution["sled.y"], a * (turned - np.sin(2 * turned) / 2) / (2 * w**2), atol=1e-7)
    held = 2 * mass * a * np.sin(turned)
    np.testing.assert_allclose(solution["edge.fx"], -held * np.sin(turned), atol=1e-6)
    np.testing.assert_allclose(solution["edge.fy"], held * np.cos(turned), atol=1e-6)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda m: m.Drive(joint="sleeve", position="t"), "x.joint: found 'sleeve' of the type cylindrical, expected sleeve.displacement or sleeve.angle"),
        (lambda m: m.Drive(joint="sleeve.turn", position="t"), "x.joint: found 'sleeve.turn' of the type cylindrical, expected sleeve.displacement or"),
        (lambda m: m.Drive(joint="pin.displacement", position="t"), "found 'pin.displacement' of the type revolute, expected pin.angle"),
        (lambda m: m.Drive(joint="nothing.angle", position="t"), "x.joint: found the unknown joint 'nothing', expected one of"),
        (lambda m: m.Gear(joint_1="sleeve.displacement", joint_2="pin", ratio=2), "x.joint_1: found 'sleeve.displacement' .* expected a revolute"),
        (lambda m: m.Coupler(joint_1="pin", joint_2="pin.angle", scale=2), "found 'pin.angle' a second time"),
        (lambda m: m.Coupler(joint_1="pin", joint_2="ball", scale=2), "found 'ball' of the type spherical, expected a joint with a coordinate"),
        (lambda m: m.Screw(i="a", j="b", pitch=0), "pitch: found 0, expected a length other than 0 m"),
        (lambda m: m.VelocityEquation(zero="a.x - 1"), "zero: found 'a.x - 1', expected a formula with a velocity such as cart.vx"),
        (lambda m: m.VelocityEquation(zero="3*t"), "zero: found '3\\*t', expected a formula with a body's coordinate"),
        (lambda m: m.RevoluteSpherical(i="a", j="b", length=0), "length: found 0"),
    ],
)  # fmt: skip
def test_wrong_joints_are_refused_in_one_sentence(make, words):
    model = spatial.Model()
    for name in "ab":
        model.add(name, wheel())
    model.add("pin", spatial.Revolute(i="a", j="ground"))
    model.add("sleeve", spatial.Cylindrical(i="b", j="ground"))
    model.add("ball", spatial.Spherical(i="b", j="a"))
    with pytest.raises(stiffmbs.InputError, match=words) as raised:
        model.add("x", make(spatial))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("over", [0, 180])
@pytest.mark.parametrize(
    ("twist", "fits"), [(0, True), (59, True), (61, False), (90, False), (119, False), (121, True), (180, True)]
)
def test_a_constant_velocity_joint_is_drawn_with_little_twist(over, twist, fits):
    model = spatial.Model()
    for name in "ab":
        model.add(name, wheel())
    bent = rotation.from_euler("X", 40, degrees=True) * rotation.from_euler("Z", twist, degrees=True)
    axes = (bent * rotation.from_euler("Y", over, degrees=True)).as_matrix()
    shaft = spatial.Marker(body="b", orientation=axes)
    model.add("joint", spatial.ConstantVelocity(i=shaft, j="a"))
    if fits:
        model.data()
        return
    with pytest.raises(stiffmbs.InputError, match=r"joints.joint: found its shafts drawn (61|90|119) degrees twisted"):
        model.data()


def test_an_equation_that_is_not_linear_in_velocities_is_refused():
    model = stiffmbs.Model()
    model.add("sled", stiffmbs.Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("speed", stiffmbs.VelocityEquation(zero="sled.vx^2 + sled.vy^2 - 1"))
    with pytest.raises(stiffmbs.InputError, match=r"speed: .*found .* expected one that is linear in velocities"):
        stiffmbs.run(model, duration=0.1)
