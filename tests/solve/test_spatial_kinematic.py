"""Kinematic analysis in space: driven linkages through full turns against closed forms, and those that lock."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import stiffmbs
from stiffmbs import InputError
from stiffmbs.spatial import AppliedForce, Body, Distance, Drive, Marker, Model, Prismatic, Revolute

from ..spatial_loops import CRANK, ground, parallelogram, slider_crank

START, SPEED = 0.7, 7.0


def driven(law=f"{START} + {SPEED}*t", **shape):
    model = slider_crank(START, cross=True, **shape)
    model.add("motor", Drive(joint="bearing", position=law))
    return model


def slider_at(angle, height=0.4, length=1.5):
    """Place of the slider and its rate by the crank's angle."""
    y, z = CRANK * np.cos(angle), CRANK * np.sin(angle) - height
    x = np.sqrt(length**2 - y**2 - z**2)
    return x, (CRANK * np.sin(angle) * y - CRANK * np.cos(angle) * z) / x


@pytest.mark.long
def test_a_slider_crank_through_two_turns():
    solution = stiffmbs.run(driven(), duration=2.0, points=201, solver="kinematic")
    x, slope = slider_at(START + SPEED * solution.time)
    np.testing.assert_allclose(solution["slider.x"], x, atol=1e-13)
    np.testing.assert_allclose(solution["slider.vx"], SPEED * slope, atol=1e-12)
    np.testing.assert_allclose(
        np.gradient(solution["slider.vx"], solution.time)[1:-1], solution["slider.ax"][1:-1], atol=0.2
    )
    assert solution["constraint.position"].max() < 1e-13
    p = np.stack([solution[f"rod.q{k}"] for k in range(4)])
    assert np.abs(np.sum(p**2, axis=0) - 1).max() < 1e-14


@pytest.mark.long
def test_the_motor_does_the_work():
    solution = stiffmbs.run(driven(), duration=2.0, points=2001, solver="kinematic")
    power = SPEED * solution["motor.tx"]
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(solution.time))])
    np.testing.assert_allclose(
        work, solution["energy.total"] - solution["energy.total"][0], atol=5e-4 * np.abs(work).max()
    )


@pytest.mark.long
def test_dynamics_give_the_same_motion_and_forces():
    kinematic, dynamic = (
        stiffmbs.run(driven(), duration=1.0, points=21, rtol=1e-9, solver=solver) for solver in ("kinematic", "bdf")
    )
    for name in ("rod.x", "rod.wx", "slider.vx", "motor.tx", "big_end.fy", "guide.tz", "small_end.fx"):
        np.testing.assert_allclose(dynamic[name], kinematic[name], atol=1e-6 * (1 + np.abs(kinematic[name]).max()))


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["kinematic", "bdf", "projected"])
def test_a_motor_that_asks_for_more_than_a_rod_allows(solver):
    shape = {"height": 0.4, "length": 0.75}
    reach = lambda angle: 0.75**2 - (CRANK * math.cos(angle)) ** 2 - (CRANK * math.sin(angle) - 0.4) ** 2  # noqa: E731
    locked = (brentq(reach, math.pi, 1.5 * math.pi) - START) / SPEED
    solution = stiffmbs.run(driven(**shape), duration=2.0, points=401, solver=solver)
    assert solution.outcome.name == "STOPPED"
    assert solution.time[-1] == pytest.approx(locked, abs=0.01)
    before = solution.time < locked - 0.01
    expected, _ = slider_at(START + SPEED * solution.time[before], **shape)
    np.testing.assert_allclose(solution["slider.x"][before], expected, atol=1e-4)
    joints = ("bearing", "big_end", "small_end", "guide", "motor")
    if solver == "kinematic":
        assert float(solution.message.split("t = ")[1].split()[0]) == pytest.approx(locked, abs=1e-6)
        assert "locks" in solution.message
        assert "do not allow" in solution.message and any(joint in solution.message for joint in joints)
        assert "last pose: crank at (" in solution.message
    else:
        assert any(f"'{joint}'" in solution.message for joint in joints)


def skew_linkage(twist, length):
    """Crank about z and rocker about an axis that is twisted against it, joined by a rod with a ball at both ends."""
    model = Model("skew")
    axis = {"z": (0, -math.sin(twist), math.cos(twist)), "x": (1, 0, 0)}
    crank = model.add("crank", Body(mass=1, inertia=(0.01, 0.02, 0.02), position=(0.15, 0, 0)))
    model.add("bearing", Revolute(i=crank.at(-0.15, 0, 0), j=ground()))
    pin = np.array([0.3, 0, 0])
    turn = rocker_angle(pin, twist, length)
    pivot, along = np.array([1.0, 0, 0]), direction(turn, twist)
    place = {"position": tuple(pivot + 0.35 * along), "orientation": {"x": tuple(along), "z": axis["z"]}}
    rocker = model.add("rocker", Body(mass=1, inertia=(0.01, 0.02, 0.02), **place))
    model.add("pivot", Revolute(i=rocker.at(-0.35, 0, 0), j=ground(1, 0, 0, axis)))
    model.add("rod", Distance(i=rocker.at(0.35, 0, 0), j=crank.at(0.15, 0, 0), length=length))
    model.add("motor", Drive(joint="bearing", position="5*t"))
    return model


def direction(angle, twist):
    """Of the rocker, in the plane across its axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c, s * math.cos(twist), s * math.sin(twist)])


def rocker_angle(pin, twist, length):
    """From A cos + B sin = C: the rocker's end is at a given distance from the crank's pin."""
    gap = np.array([1.0, 0, 0]) - pin
    a, b = 2 * 0.7 * gap[0], 2 * 0.7 * (gap[1] * math.cos(twist) + gap[2] * math.sin(twist))
    c = length**2 - gap @ gap - 0.7**2
    return math.atan2(b, a) + math.acos(c / math.hypot(a, b))


@pytest.mark.parametrize("twist", [0.0, 0.8, math.pi / 2])
def test_a_linkage_of_skew_axes_through_full_turns(twist):
    solution = stiffmbs.run(skew_linkage(twist, 0.9), duration=3.0, points=151, solver="kinematic")
    assert solution.outcome.name == "DONE"
    for k, t in enumerate(solution.time):
        pin = 0.3 * np.array([math.cos(5 * t), math.sin(5 * t), 0])
        expected = np.array([1.0, 0, 0]) + 0.35 * direction(rocker_angle(pin, twist, 0.9), twist)
        np.testing.assert_allclose([solution[f"rocker.{c}"][k] for c in "xyz"], expected, atol=1e-12)


@pytest.mark.long
def test_a_parallelogram_of_hinges_whose_redundant_equations_are_left_out():
    model = parallelogram(1.0)
    model.add("motor", Drive(joint="foot0", position="1 + 3*t"))
    solution = stiffmbs.run(model, duration=4.0, points=101, solver="kinematic")
    np.testing.assert_allclose(solution["coupler.y"], CRANK * np.sin(1 + 3 * solution.time), atol=1e-12)
    assert any("head1" in note and "left out" in note for note in solution.notes)


def test_freedoms_are_counted():
    model = slider_crank(START)
    model.add("motor", Drive(joint="bearing", position=f"{START} + t"))
    with pytest.raises(InputError, match=r"17 independent equations for 18 velocities"):
        stiffmbs.run(model, solver="kinematic")


@pytest.mark.sampled(5)
@pytest.mark.parametrize("solver", ["bdf", "projected"])
@pytest.mark.parametrize("force", ["sqrt(1 - t)", "1/(1 - t)^2", "sqrt(0.01 - sled.x) + 1"])
def test_a_force_without_a_value_is_named(solver, force):
    model = Model()
    model.add("sled", Body(mass=2, inertia=(1, 1, 1)))
    model.add("tumbler", Body(mass=1, inertia=(1, 2, 2.5), position=(0, 1, 0), omega=(1, 2, 3)))
    along = {"z": (1, 0, 0)}
    model.add("track", Prismatic(i=Marker(body="sled", orientation=along), j=ground(orientation=along)))
    model.add("pull", AppliedForce(i="sled", force=(force, 0, 0)))
    solution = stiffmbs.run(model, duration=2.0, points=41, solver=solver)
    assert solution.outcome.name == "STOPPED"
    assert "'pull'" in solution.message
