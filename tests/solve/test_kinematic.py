"""Kinematic analysis and inverse dynamics: the chapter's slider-crank, dead centres, branches."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, ConstraintEquation, InputError, Marker, Model, Prismatic, Revolute

R, L = 0.125, 0.35


def turn(examples, *changes, points=181):
    scene = stiffmbs.load_scene(examples / "crank_slider.yaml", list(changes))
    return stiffmbs.run(scene, points=points)


def slider(theta, rate):
    """Position, velocity of the slider: x_A = -(r cos th + sqrt(L^2 - r^2 sin^2 th))."""
    root = np.sqrt(L**2 - R**2 * np.sin(theta) ** 2)
    x = -(R * np.cos(theta) + root)
    return x, rate * R * np.sin(theta) * (1 + R * np.cos(theta) / root)


def test_slider_of_the_chapter_at_73_instants(examples):
    solution = turn(examples, points=73)
    x, v = slider(25 * solution.time, 25)
    assert np.max(np.abs(solution["slider.x"] - x)) < 1e-14
    assert np.max(np.abs(solution["slider.vx"] - v)) < 1e-13
    assert np.max(np.abs(solution["slider.y"])) < 1e-14


def moment(theta):
    return -5000 * R * np.sin(theta) * (1 + R * np.cos(theta) / np.sqrt(L**2 - R**2 * np.sin(theta) ** 2))


@pytest.mark.parametrize(
    ("masses", "rate", "largest"),
    [((1e-6, 1e-6, 1e-6), 25, 9.455e-6), ((1.0, 0.8, 0.5), 25, 5.48278), ((1.0, 0.8, 0.5), 300, 789.5203)],
)
def test_moment_of_the_motor_against_virtual_work(examples, masses, rate, largest):
    """The motor's torque on the crank is minus the multiplier of its equation, which is the chapter's moment."""
    changes = [(f"{name}_mass", f"{m} kg") for name, m in zip(("crank", "rod", "slider"), masses, strict=True)]
    solution = turn(examples, *changes, ("rate", f"{rate} rad/s"))
    difference = np.max(np.abs(-solution["motor.torque"] - moment(rate * solution.time)))
    digits = len(f"{largest:g}".replace(".", "").split("e")[0].lstrip("0"))
    assert difference == pytest.approx(largest, rel=0.6 * 10.0 ** (1 - digits))


def test_accelerations_are_the_rates_of_velocities(examples):
    solution = turn(examples, points=2001)
    rate = np.gradient(solution["slider.vx"], solution.time, edge_order=2)
    np.testing.assert_allclose(solution["slider.ax"][2:-2], rate[2:-2], atol=2e-3)


def test_a_driven_crank_passes_its_dead_centres(examples):
    solution = turn(examples, ("run.duration", "10*2*pi/rate"), points=1001)
    x, _ = slider(25 * solution.time, 25)
    assert np.max(np.abs(solution["slider.x"] - x)) < 1e-12


def four_bar(drive):
    """A crank of 1 m on a coupler of 2 m and a rocker of 1.5 m, ground 3 m: the crank cannot turn fully."""
    model = Model("four-bar", gravity=(0, -9.81))
    lengths = {"crank": 1.0, "coupler": 2.0, "rocker": 1.5}
    points = {"crank": ((0, 0), 1.2), "rocker": ((3, 0), None)}
    start = points["crank"][1]
    b = np.array([np.cos(start), np.sin(start)])
    d = np.array([3.0, 0.0])
    gap = np.linalg.norm(d - b)
    along = (lengths["coupler"] ** 2 - lengths["rocker"] ** 2 + gap**2) / (2 * gap)
    across = np.sqrt(lengths["coupler"] ** 2 - along**2)
    unit = (d - b) / gap
    c = b + along * unit + across * np.array([-unit[1], unit[0]])
    for name, (p, q) in {"crank": ((0, 0), b), "coupler": (b, c), "rocker": (d, c)}.items():
        p, q = np.array(p, dtype=float), np.array(q)
        angle = np.arctan2(*(q - p)[::-1])
        model.add(name, Body(mass=1, inertia=0.1, position=tuple((p + q) / 2), angle=angle))
    half = {name: length / 2 for name, length in lengths.items()}
    model.add("a", Revolute(i=Marker(body="crank", point=(-half["crank"], 0)), j="ground"))
    model.add(
        "b",
        Revolute(
            i=Marker(body="coupler", point=(-half["coupler"], 0)), j=Marker(body="crank", point=(half["crank"], 0))
        ),
    )
    model.add(
        "c",
        Revolute(
            i=Marker(body="coupler", point=(half["coupler"], 0)), j=Marker(body="rocker", point=(half["rocker"], 0))
        ),
    )
    model.add("d", Revolute(i=Marker(body="rocker", point=(-half["rocker"], 0)), j=Marker(body="ground", point=(3, 0))))
    model.add("motor", ConstraintEquation(zero=f"crank.angle - ({drive})"))
    return model


def test_a_locked_mechanism_names_instant_and_pose():
    """The coupler and the rocker stretch straight where the crank's end is 3.5 m from the rocker's pivot."""
    locks_at = np.arccos((1 + 9 - 3.5**2) / 6) - 1.2  # law of cosines for the crank's angle
    solution = stiffmbs.run(four_bar("1.2 + t"), duration=2.0, points=201, solver="kinematic")
    assert solution.outcome.name == "STOPPED"
    reported = float(solution.message.split("t = ")[1].split(" s")[0])
    assert reported == pytest.approx(locks_at, abs=1e-6)
    assert "crank at" in solution.message
    assert solution.time[-1] <= locks_at
    assert solution["constraint.position"].max() < 1e-12


@pytest.mark.long
def test_the_branch_is_kept_at_coarse_output():
    """Two output points over a swing to near the dead centre and back: the same branch as with many."""
    drive = "1.2 + 0.72*sin(pi*t)"
    coarse = stiffmbs.run(four_bar(drive), duration=2.0, points=3, solver="kinematic")
    fine = stiffmbs.run(four_bar(drive), duration=2.0, points=2001, solver="kinematic")
    assert coarse.outcome.name == "DONE"
    for name in ("rocker.angle", "coupler.angle"):
        np.testing.assert_allclose(coarse[name], fine[name][::1000], atol=1e-9)


def test_freedoms_are_refused():
    model = Model()
    model.add("a", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="a", j="ground"))
    with pytest.raises(InputError, match=r"2 independent equations for 3 velocities"):
        stiffmbs.run(model, solver="kinematic")


def test_bdf_gives_the_same_motion_and_moment(examples):
    """Inverse dynamics by integration: the driven scene has no freedom left."""
    kinematic = turn(examples)
    scene = stiffmbs.load_scene(examples / "crank_slider.yaml")
    integrated = stiffmbs.run(scene, points=181, solver="bdf", rtol=1e-9)
    np.testing.assert_allclose(integrated["slider.x"], kinematic["slider.x"], atol=1e-8)
    np.testing.assert_allclose(integrated["motor.torque"], kinematic["motor.torque"], atol=1e-4)


def test_a_drive_with_kinks_is_no_lock():
    """Velocities jump at the points of a table of straight lines; an output time may be one of them."""
    way, at = [0.0, 0.5, 0.1, 0.1, 0.7], [0.0, 1.0, 2.0, 3.0, 4.0]
    scene = f"""
bodies: {{sled: {{mass: 1, inertia: 1}}}}
joints:
  rail: {{type: prismatic, i: sled, j: ground}}
  motor: {{type: drive, joint: rail, position: {{table: {[list(point) for point in zip(at, way, strict=True)]}, lines: true}}}}
run: {{duration: 4, points: 41, solver: kinematic}}
"""
    solution = stiffmbs.run(stiffmbs.read_scene(scene))
    assert solution.outcome.name == "DONE", solution.message
    np.testing.assert_allclose(solution["sled.x"], np.interp(solution.time, at, way), atol=1e-14)
    between = np.abs(solution.time - np.round(solution.time)) > 0.01
    rates = np.diff(way)[np.minimum(solution.time.astype(int), 3)]
    np.testing.assert_allclose(solution["sled.vx"][between], rates[between], atol=1e-14)


def test_a_drive_without_a_value_is_not_called_a_dead_centre():
    """sqrt(1 - t) has no real value after 1 s; times zero it changes nothing before."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add("motor", ConstraintEquation(zero="sled.x - t - 0*sqrt(1 - t)"))
    solution = stiffmbs.run(model, duration=2.0, points=21, solver="kinematic")
    assert solution.outcome.name == "STOPPED"
    assert "locks" not in solution.message
    assert "finite" in solution.message
    assert solution.time[-1] <= 1.0


@pytest.mark.long
def test_a_driven_velocity_is_integrated(examples):
    """A motor whose speed bends at 30 ms: the crank's angle is the integral of it, and all else as under that position."""
    speed, turned = "-25 - 200*max(t - 0.03, 0)", "pi - 25*t - 100*max(t - 0.03, 0)^2"
    found, wanted = (
        turn(examples, ("joints.motor", f"{{type: drive, joint: ground_pin, {drive}}}"), points=41)
        for drive in (f'velocity: "{speed}"', f'position: "{turned}"')
    )
    for name, tolerance in (("crank.angle", 1e-9), ("slider.x", 1e-9), ("slider.vx", 1e-8), ("slider.ax", 1e-6)):
        np.testing.assert_allclose(found[name], wanted[name], rtol=0, atol=tolerance)
    np.testing.assert_allclose(found["motor.torque"], wanted["motor.torque"], rtol=0, atol=1e-6)


def test_a_driven_velocity_leaves_no_freedom_to_dynamics():
    model = Model()
    model.add("a", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="a", j="ground"))
    model.add("b", Body(mass=1, inertia=1))
    model.add("pin", Revolute(i="b", j="a"))
    model.add("pull", stiffmbs.Drive(joint="rail", velocity="1"))
    with pytest.raises(InputError, match=r"5 independent equations for 6 velocities"):
        stiffmbs.run(model, solver="kinematic")


@pytest.mark.long
@pytest.mark.parametrize("force", [1e20, 1e23])
def test_steps_follow_the_drive_where_forces_leave_no_digit_of_accelerations(force):
    model = Model(gravity=(0, -9.81))
    rod = model.add("rod", Body(mass=2, inertia=0.3, position=(1, 0)))
    model.add("pin", Revolute(i=rod.at(-1, 0), j="ground"))
    model.add("motor", stiffmbs.Drive(joint="pin", position="sin(2*t)"))
    model.add("push", stiffmbs.AppliedForce(i="rod", force=(f"{force!r} N", f"{force!r} N*cos(30*rod.angle)")))
    solution = stiffmbs.run(model, solver="kinematic", duration=1.0, points=11)
    assert solution.solver["steps"] < 5000
    np.testing.assert_allclose(solution["rod.angle"], np.sin(2 * solution.time), atol=1e-12)


DRIVES = {
    "a rest before a table": ("p(max(t - 0.31006039054210555, 0))", lambda t: 0.2 * max(t - 0.31006039054210555, 0.0)),
    "a short pulse from rest": (
        "step5(t, 1.3, 0, 1.300015, 1) - step5(t, 1.3001, 0, 1.300115, 1)", lambda t: float(1.300015 <= t <= 1.3001)
    ),
    "equal up to rounding": (
        "max(p(max(t - 0.3, 0))*0, -(step5(t, 1.8907912372657665, 0, 1.8919030802843428, 1) - step5(t, 1.8930149233029192, 0, 1.8941267663214953, 1)))", lambda t: 0.0
    ),
}  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled(12)
@pytest.mark.parametrize("solver", ["kinematic", "bdf", "radau"])
@pytest.mark.parametrize("what", sorted(DRIVES))
def test_a_drive_along_a_rail_never_locks(what, solver):
    """Runs stopped at kinks that were located to 1e-11 s only, at pulses of a millionth of the run, and where branches are equal."""
    text, exact = DRIVES[what]
    scene = {
        "gravity": [0, 0],
        "bodies": {"b": {"mass": 1, "inertia": 1}},
        "joints": {
            "rail": {"type": "prismatic", "i": "b", "j": "ground"},
            "motor": {"type": "drive", "joint": "rail", "position": text},
        },
        "tables": {"p": {"table": [[0, 0], [5, 1], [10, 2]], "spline": True}},
    }
    found = stiffmbs.run(stiffmbs.read_scene(json.dumps(scene)), solver=solver, duration=10, points=101)
    assert found.success, found.message
    np.testing.assert_allclose(found["b.x"], [exact(t) for t in found.time], rtol=0, atol=1e-8)
