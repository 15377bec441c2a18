"""Single bodies in space against closed forms, by both integrators."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.spatial import Body, ConstraintEquation, Cylindrical, Marker, Model, Revolute, Screw, TorsionSpring

from ..closed_forms import oscillation
from ..minimal_coordinates import turned
from ..rolling import Disc
from ..spatial_channels import axes, vector
from ..spatial_closed_forms import free_body, matrices, screw_fall, zxz

G = (0, 0, -9.81)
SOLVERS = pytest.mark.parametrize(
    "settings", [{"rtol": 1e-11}, {"solver": "projected", "scheme": "dop853", "rtol": 1e-11}], ids=["bdf", "dop853"]
)


@SOLVERS
def test_a_free_body_in_axes_that_are_not_principal(settings):
    """Products of inertia, an origin off the centre of mass, a turned start: rates and orientation in the own axes."""
    J, omega = np.array([0.1, 0.2, 0.3]), np.array([1.0, 2.0, -0.7])
    skew = turned(np.array([2, -1, 2]) / 3, 0.8)  # principal axes in own axes, as columns
    start = turned(np.array([1, 2, 2]) / 3, 1.1)  # own axes in ground axes
    center = np.array([0.3, -0.2, 0.5])
    model = Model()
    stone = Body(
        mass=2,
        inertia=skew @ np.diag(J) @ skew.T,
        center_of_mass=center,
        position=-start @ center,
        orientation=start,
        velocity=(1, -2, 0.5),
        omega=skew @ omega,
    )
    model.add("stone", stone)
    solution = stiffmbs.run(model, duration=5.0, points=51, **settings)
    w, turn = free_body(solution.time, J, omega)
    np.testing.assert_allclose(vector(solution, "stone", "w"), w @ skew.T, atol=1e-8)
    np.testing.assert_allclose(axes(solution, "stone"), start @ skew @ turn @ skew.T, atol=1e-8)
    np.testing.assert_allclose(vector(solution, "stone"), np.outer(solution.time, [1, -2, 0.5]), atol=1e-10)


@SOLVERS
def test_a_coin_spins_on_a_plane_without_friction(settings):
    """A user's own position equation, nonlinear in the quaternion: the rim touches the plane."""
    disc, nutation, turning, spin = Disc(0.3, 2.0, 0.045, 0.09), 1.3, 6.0, 2.0
    model = Model(gravity=G)
    coin = Body(
        mass=disc.mass,
        inertia=(disc.transverse, disc.transverse, disc.axial),
        position=(0, 0, disc.radius * np.sin(nutation)),
        orientation={"euler": "zxz", "angles": [0, nutation, 0]},
        omega=(0, turning * np.sin(nutation), spin),
    )
    model.add("coin", coin)
    model.add("plane", ConstraintEquation(zero="coin.z - 0.3*sqrt(1 - (1 - 2*coin.q1^2 - 2*coin.q2^2)^2)"))
    solution = stiffmbs.run(model, duration=3.0, points=61, **settings)
    heading, tilt, turn, _ = disc.sliding(solution.time, nutation, turning, spin)
    np.testing.assert_allclose(axes(solution, "coin"), zxz(heading, tilt, turn), atol=1e-7)
    np.testing.assert_allclose(vector(solution, "coin")[:, :2], 0, atol=1e-9)


def test_a_spinning_body_falls_along_its_axis_on_a_cylindrical_joint():
    model = Model(gravity=G)
    model.add("bead", Body(mass=1, inertia=(0.1, 0.2, 0.25), omega=(0, 0, 7)))
    model.add("wire", Cylindrical(i="bead", j="ground"))
    solution = stiffmbs.run(model, duration=1.0, points=11, rtol=1e-9)
    np.testing.assert_allclose(solution["bead.z"], -9.81 * solution.time**2 / 2, atol=1e-8)
    np.testing.assert_allclose(solution["bead.wz"], 7, atol=1e-9)
    np.testing.assert_allclose(axes(solution, "bead")[:, 0, 0], np.cos(7 * solution.time), atol=1e-7)


def test_the_sums_of_a_doors_hinge_forces_are_its_weight_and_its_centripetal_force():
    """Five of ten equations are redundant: single components are not told, their sums are right."""
    mass, width, rate = 40.0, 0.9, 2.0
    model = Model(gravity=G)
    body = Body(
        mass=mass,
        inertia=(13.3, 16.0, 2.7),
        center_of_mass=(width / 2, 0, 0),
        velocity=(0, rate * width / 2, 0),
        omega=(0, 0, rate),
    )
    door = model.add("door", body)
    for name, height in (("upper", 0.8), ("lower", -0.8)):
        model.add(name, Revolute(i=door.at(0, 0, height), j=Marker(body="ground", point=(0, 0, height))))
    found = model.check()
    assert (found.degrees_of_freedom, found.equations, found.rank) == (1, 10, 5)
    assert len(found.redundant) == 5
    names = ("fx", "fy", "fz", "tx", "ty")
    assert set(found.not_unique) == {f"{hinge}.{name}" for hinge in ("upper", "lower") for name in names}
    solution = stiffmbs.run(model, duration=2.0, points=21, rtol=1e-9)
    pull = mass * rate**2 * width / 2
    angle = rate * solution.time
    for name, expected in (("fx", -pull * np.cos(angle)), ("fy", -pull * np.sin(angle)), ("fz", mass * 9.81)):
        np.testing.assert_allclose(solution[f"upper.{name}"] + solution[f"lower.{name}"], expected, atol=1e-4)


@SOLVERS
def test_a_closer_shuts_the_door_as_a_damped_oscillator(examples, settings):
    """On two hinges on one axis, of which half the equations are left out."""
    solution = stiffmbs.run(stiffmbs.load_scene(examples / "door.yaml"), **settings)
    about_hinges = 40 * ((0.9**2 + 0.04**2) / 12 + 0.45**2)
    omega = np.sqrt(20 / about_hinges)
    expected = oscillation(solution.time, np.pi / 2, omega, 15 / (2 * about_hinges * omega))
    np.testing.assert_allclose(solution["opening"], expected, atol=1e-8)


@SOLVERS
def test_a_torsion_pendulum_counts_its_turns(settings):
    """About a slanted axis, that swings through nearly two turns each way."""
    axis = {"z": (1, 2, 2)}
    model = Model(gravity=G)
    wheel = model.add("wheel", Body(mass=3, inertia=(0.2, 0.2, 0.2), omega=(2, 4, 4)))
    i, j = wheel.at(0, 0, 0, axis), Marker(body="ground", orientation=axis)
    model.add("axle", Revolute(i=i, j=j))
    model.add("wire", TorsionSpring(i=i, j=j, stiffness=0.05))
    solution = stiffmbs.run(model, duration=20.0, points=201, **settings)
    omega = np.sqrt(0.05 / 0.2)
    angle = 6 / omega * np.sin(omega * solution.time)
    assert np.ptp(angle) > 4 * np.pi
    np.testing.assert_allclose(solution["wire.tz"], -0.05 * angle * 2 / 3, atol=1e-7)
    half = np.stack([np.cos(angle / 2), *np.outer([1 / 3, 2 / 3, 2 / 3], np.sin(angle / 2))])
    np.testing.assert_allclose(axes(solution, "wheel"), matrices(half), atol=1e-7)


@pytest.mark.long
@SOLVERS
def test_a_nut_falls_along_a_screw(settings):
    """Its turning takes most of what its weight does; the thread passes on the torque that turns it."""
    mass, inertia, pitch = 0.5, 1e-3, 0.05
    model = Model(gravity=G)
    model.add("nut", Body(mass=mass, inertia=(8e-4, 8e-4, inertia)))
    model.add("thread", Screw(i="nut", j="ground", pitch=pitch))
    solution = stiffmbs.run(model, duration=2.0, points=41, **settings)
    height = screw_fall(solution.time, pitch=pitch, mass=mass, inertia=inertia)
    np.testing.assert_allclose(solution["nut.z"], height, atol=1e-8)
    np.testing.assert_allclose(
        solution["nut.wz"][1:], 2 * np.pi / pitch * 2 * height[1:] / solution.time[1:], atol=1e-6
    )
    fall = 2 * height[-1] / solution.time[-1] ** 2
    np.testing.assert_allclose(solution["thread.tz"], inertia * 2 * np.pi / pitch * fall, atol=1e-7)
    np.testing.assert_allclose(solution["thread.fz"], mass * (9.81 + fall), atol=1e-7)
