"""Drives by formula, table, step, harmonic and velocity: the motion prescribed, and what the motor has to do for it."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Drive, Fixed, InputError, Marker, Model, Prismatic, Revolute

INERTIA, MASS = 0.4, 2.5
KNOTS = np.linspace(0, 2, 81)


def rotor(**drive):
    """A wheel about its centre, drawn at 0.2 rad, with a drive."""
    model = Model()
    model.add("wheel", Body(mass=1, inertia=INERTIA, angle=0.2))
    model.add("pin", Revolute(i="wheel", j="ground"))
    model.add("motor", Drive(**drive))
    return stiffmbs.run(model, duration=2, rtol=1e-8, points=201)


def cubic_step(t):
    """STEP from 0 at 0.5 s to 1 at 1.5 s, and its second derivative."""
    z = np.clip(t - 0.5, 0, 1)
    return z**2 * (3 - 2 * z), np.where((z > 0) & (z < 1), 6 - 12 * z, 0)


LAWS = {
    "formula": ({"joint": "pin", "position": "0.2 + 3*t - t^3/2"}, lambda t: (0.2 + 3 * t - t**3 / 2, -3 * t), 1e-9),
    "coordinate": ({"coordinate": "wheel.angle", "position": "0.2 + t^2"}, lambda t: (0.2 + t * t, 2 + 0 * t), 1e-9),
    "scaled coordinate": (
        {"coordinate": "2*wheel.angle", "position": "0.4 + 2*t^2"}, lambda t: (0.2 + t * t, 2 + 0 * t), 1e-9
    ),
    "harmonic": (
        {"joint": "pin", "position": "0.2 + 10 deg*sin(2*pi*t)"},
        lambda t: (0.2 + np.radians(10) * np.sin(2 * np.pi * t), -np.radians(10) * (2 * np.pi) ** 2 * np.sin(2 * np.pi * t)),
        1e-9,
    ),
    "step": (
        {"joint": "pin", "position": "0.2 + step(t, 0.5, 0, 1.5, 1)"},
        lambda t: (0.2 + cubic_step(t)[0], cubic_step(t)[1]), 1e-9,
    ),
    "table": (
        {"joint": "pin", "position": {"table": [[t, 0.2 + np.sin(t)] for t in KNOTS], "ends": "not-a-knot"}},
        lambda t: (0.2 + np.sin(t), -np.sin(t)), 1e-3,
    ),
    "velocity": ({"joint": "pin", "velocity": "3*t^2 - 1"}, lambda t: (0.2 + t**3 - t, 6 * t), 1e-5),
    "velocity of a coordinate": (
        {"coordinate": "wheel.angle", "velocity": "cos(t)"}, lambda t: (0.2 + np.sin(t), -np.sin(t)), 1e-5
    ),
    "table of velocity": (
        {"joint": "pin", "velocity": {"table": [[t, np.cos(t)] for t in KNOTS], "ends": "not-a-knot"}},
        lambda t: (0.2 + np.sin(t), -np.sin(t)), 1e-3,
    ),
}  # fmt: skip


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("drive", "motion", "accuracy"), LAWS.values(), ids=LAWS.keys())
def test_rotor_follows_its_drive_and_the_motor_turns_its_inertia(drive, motion, accuracy):
    solution = rotor(**drive)
    angle, acceleration = motion(solution.time)
    breakpoint = np.isin(np.round(solution.time, 9), (0.5, 1.5)) & (
        drive.get("position") == LAWS["step"][0]["position"]
    )
    np.testing.assert_allclose(solution["wheel.angle"], angle, atol=accuracy)
    np.testing.assert_allclose(
        solution["motor.torque"][~breakpoint], INERTIA * acceleration[~breakpoint], atol=10 * accuracy
    )


def test_drive_of_a_slide_pushes_along_its_axis():
    """On a slope: m (s'' + g sin) along it, none of it across."""
    slope = 0.4
    model = Model(gravity=(0, -9.81))
    model.add("block", Body(mass=MASS, inertia=1, angle=slope))
    model.add("slide", Prismatic(i="block", j=Marker(body="ground", angle=slope)))
    model.add("motor", Drive(joint="slide", position="0.1*(1 - cos(4*t))"))
    solution = stiffmbs.run(model, duration=2, rtol=1e-8)
    s = 0.1 * (1 - np.cos(4 * solution.time))
    np.testing.assert_allclose(np.hypot(solution["block.x"], solution["block.y"]), s, atol=1e-9)
    push = MASS * (1.6 * np.cos(4 * solution.time) + 9.81 * np.sin(slope))
    np.testing.assert_allclose(solution["motor.fx"], push * np.cos(slope), atol=1e-9)
    np.testing.assert_allclose(solution["motor.fy"], push * np.sin(slope), atol=1e-9)
    np.testing.assert_allclose(solution["motor.torque"], 0, atol=1e-12)


def test_velocity_drive_starts_where_it_is_drawn_and_keeps_its_joint():
    """A wheel that is drawn turned, driven at constant speed: no torque, no drift."""
    solution = rotor(joint="pin", velocity="30 rpm")
    np.testing.assert_allclose(solution["wheel.angle"], 0.2 + np.pi * solution.time, atol=1e-9)
    np.testing.assert_allclose(solution["motor.torque"], 0, atol=1e-9)
    np.testing.assert_allclose(solution["wheel.omega"], np.pi, atol=1e-12)


def test_drive_of_a_measure_pulls_along_it():
    """The distance of a mass from ground grows as prescribed: a rope that is wound up."""
    model = Model()
    model.add("mass", Body(mass=MASS, inertia=1, position=(0.6, 0.8)))
    model.add("winch", Drive(coordinate="dm(mass, ground)", position="1 + t^2/10"))
    solution = stiffmbs.run(model, duration=1, rtol=1e-8)
    np.testing.assert_allclose(solution["mass.x"], 0.6 * (1 + solution.time**2 / 10), atol=1e-9)
    np.testing.assert_allclose(solution["winch.fx"], 0.6 * MASS * 0.2, atol=1e-9)
    np.testing.assert_allclose(solution["winch.fy"], 0.8 * MASS * 0.2, atol=1e-9)


R, L, LOAD, RATE = 0.125, 0.35, 5000.0, 25.0


def crank_slider(masses, drive):
    """The chapter's slider-crank, driven clockwise from its inner dead centre."""
    crank, rod, slider = masses
    model = Model()
    model.add("crank", Body(mass=crank, inertia=crank * R**2 / 12, position=(-R / 2, 0), angle="pi"))
    model.add("rod", Body(mass=rod, inertia=rod * L**2 / 12, position=(-R - 0.1, 0), angle="pi"))
    model.add("slider", Body(mass=slider, inertia=slider * 1e-3, position=(-R - L, 0)))
    model.add("ground_pin", Revolute(i=Marker(body="crank", point=(-R / 2, 0)), j="ground"))
    model.add("crank_pin", Revolute(i=Marker(body="rod", point=(-0.1, 0)), j=Marker(body="crank", point=(R / 2, 0))))
    model.add("wrist_pin", Revolute(i=Marker(body="rod", point=(L - 0.1, 0)), j="slider"))
    model.add("guide", Prismatic(i="slider", j="ground"))
    model.add("motor", drive)
    model.add("push", AppliedForce(i="slider", force=(LOAD, 0)))
    return stiffmbs.run(model, duration=2 * np.pi / RATE, points=181, rtol=1e-8)


@pytest.mark.parametrize(
    "drive",
    [Drive(joint="ground_pin", position=f"pi - {RATE}*t"), Drive(coordinate="crank.angle", velocity=-RATE)],
    ids=["position of the joint", "velocity of the crank"],
)
def test_motor_of_the_slider_crank_against_virtual_work(drive):
    """The torque on the crank is P dx/dphi, minus the multiplier -P r sin th (1 + r cos th/sqrt(...)) of the chapter."""
    solution = crank_slider((1e-6, 1e-6, 1e-6), drive)
    th = RATE * solution.time
    multiplier = -LOAD * R * np.sin(th) * (1 + R * np.cos(th) / np.sqrt(L**2 - (R * np.sin(th)) ** 2))
    np.testing.assert_allclose(solution["motor.torque"], -multiplier, atol=1e-4)


def test_force_of_a_motor_is_the_same_from_an_equation():
    """A drive and the same motion as a formula that stays zero: same motion, same torque."""
    from stiffmbs import ConstraintEquation

    masses = (1.0, 0.8, 0.5)
    driven = crank_slider(masses, Drive(joint="ground_pin", position=f"pi - {RATE}*t"))
    other = crank_slider(masses, ConstraintEquation(zero=f"crank.angle - (pi - {RATE}*t)"))
    np.testing.assert_allclose(driven["motor.torque"], other["motor.torque"], atol=1e-6)
    th = RATE * driven.time
    massless = LOAD * R * np.sin(th) * (1 + R * np.cos(th) / np.sqrt(L**2 - (R * np.sin(th)) ** 2))
    assert np.max(np.abs(driven["motor.torque"] - massless)) == pytest.approx(5.48278, abs=5e-6)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"position": "t"}, r"found neither of 'joint' and 'coordinate', expected exactly one of them"),
        ({"joint": "pin"}, r"found neither of 'position' and 'velocity', expected exactly one of them"),
        ({"joint": "pin", "coordinate": "a.x", "position": 0}, r"found both of 'joint' and 'coordinate'"),
        ({"joint": "pin", "velocity": 1, "position": 0}, r"found both of 'position' and 'velocity'"),
        ({"joint": "pin", "velocity": 1, "i": "a"}, r"found a joint with markers i or j"),
        ({"joint": "pin", "velocity": 1, "j": "a"}, r"found a joint with markers i or j"),
        ({"joint": "weld", "velocity": 1}, r"x.joint: found 'weld' of the type fixed, expected a joint with a coordinate"),
        ({"joint": "none", "velocity": 1}, r"x.joint: found the unknown joint 'none', expected one of pin, weld"),
        ({"coordinate": "2*t", "velocity": 1}, r"coordinate: found '2\*t', expected a formula with a body's coordinate"),
        ({"coordinate": "a.omega", "position": 1}, r"coordinate: found 'a.omega', expected one of a.x, a.y, a.angle"),
        ({"coordinate": "b.x", "position": 1}, r"found the unknown body 'b', expected a, ground"),
        ({"joint": "pin", "position": "a.x"}, r"position: found a.x in 'a.x', expected a formula without coordinates"),
        ({"joint": "pin", "position": {"table": [[1, 0], [0, 0]]}}, r"found 0 after 1 in a table, expected increasing"),
        ({"joint": "pin", "prescribed_position": "t"}, r"found the unknown key 'prescribed_position', expected .*position"),
    ],
)  # fmt: skip
def test_wrong_drives_are_refused_in_one_sentence(fields, words):
    model = Model()
    model.add("a", Body(mass=1, inertia=1))
    model.add("pin", Revolute(i="a", j="ground"))
    model.add("weld", Fixed(i="a", j="ground"))
    with pytest.raises(InputError, match=words) as raised:
        model.add("x", Drive(**fields))
    assert "\n" not in str(raised.value)


def test_scenes_say_the_same_as_python():
    scene = stiffmbs.read_scene("""
        bodies: {wheel: {mass: 1, inertia: 0.4, angle: 0.2}}
        joints:
          motor: {type: drive, joint: pin, position: 0.2 + 10 deg*sin(2*pi*t)}
          pin: {type: revolute, i: wheel, j: ground}
        run: {duration: 2, rtol: 1e-8, points: 201}
        """)
    motor = Drive(joint="pin", position="0.2 + 10 deg*sin(2*pi*t)")
    assert scene.joints["motor"] == motor
    expected = rotor(joint="pin", position="0.2 + 10 deg*sin(2*pi*t)")
    found = stiffmbs.run(scene)
    for name in expected:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, atol=1e-12)
    with pytest.raises(InputError, match=r"line 4, joints.motor.position: found the unknown name 'tt'"):
        stiffmbs.read_scene("""
        bodies: {wheel: {mass: 1, inertia: 0.4}}
        joints:
          motor: {type: drive, coordinate: wheel.angle, position: tt}
        """)


def test_a_drive_that_jumps_in_velocity_is_told():
    """The slope of |t - 0.5| turns round: the blow is in the velocities, and in no force."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1, position=(0.5, 0)))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add("motor", Drive(joint="rail", position="abs(t - 0.5)"))
    solution = stiffmbs.run(model, duration=1.0, points=11)
    np.testing.assert_allclose(solution["sled.x"], np.abs(solution.time - 0.5), atol=1e-6)
    assert any("t = 0.5" in note and "sled.vx by 2" in note for note in solution.notes)


@pytest.mark.parametrize(
    "law, wanted",
    [
        ("0.2 + min(2*t, 1)", lambda t: 0.2 + np.minimum(2 * t, 1)),
        ("0.2 + max(0.5 - t, 0)", lambda t: 0.2 + np.maximum(0.5 - t, 0)),
        ("0.2 + branch(t - 0.5, t^2, 0.25, t - 0.25)", lambda t: 0.2 + np.where(t < 0.5, t**2, t - 0.25)),
    ],
)
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_drive_goes_on_behind_its_corner_as_its_formula_does_there(law, wanted, solver):
    """At the breakpoint itself min(2*t, 1) still rises; what it does next is told by the instant behind."""
    model = Model()
    model.add("wheel", Body(mass=1, inertia=INERTIA, angle=wanted(0.0)))
    model.add("pin", Revolute(i="wheel", j="ground"))
    model.add("motor", Drive(joint="pin", position=law))
    solution = stiffmbs.run(model, duration=1.5, output=0.01, solver=solver)
    assert solution.outcome.name == "DONE"
    np.testing.assert_allclose(solution["wheel.angle"], wanted(solution.time), atol=1e-9)
    late = solution.time > 0.501
    slope = (wanted(solution.time + 1e-6) - wanted(solution.time - 1e-6)) / 2e-6
    np.testing.assert_allclose(solution["wheel.omega"][late], slope[late], atol=1e-6)


def test_a_prescribed_motion_in_another_unit_is_refused():
    for kind, position in (("revolute", "3 m"), ("prismatic", "3 rad")):
        scene = f"""
bodies: {{a: {{mass: 1, inertia: 1}}}}
joints: {{pin: {{type: {kind}, i: a, j: ground}}, motor: {{type: drive, joint: pin, position: "{position}*t/(1 s)"}}}}
"""
        with pytest.raises(InputError, match=r"joints\.motor\.position: found"):
            stiffmbs.check(stiffmbs.read_scene(scene))
