"""Pendulums in space against closed forms and minimal coordinates, by both integrators."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.spatial import Body, Distance, Marker, Model, Revolute, Spherical, Universal

from ..minimal_coordinates import Link, motion, poses
from ..spatial_channels import axes, vector
from ..spatial_closed_forms import symmetric_top, zxz
from ..spatial_mechanisms import rod

G = (0, 0, -9.81)
SOLVERS = pytest.mark.parametrize(
    "settings", [{"rtol": 1e-11}, {"solver": "projected", "scheme": "dop853", "rtol": 1e-11}], ids=["bdf", "dop853"]
)


@SOLVERS
def test_spherical_pendulum_of_a_point_mass(settings):
    """On a rod without mass, by Jacobi's functions."""
    mass, length, nutation, rate = 2.0, 0.7, 2.2, 2.0
    model = Model(gravity=G)
    start = length * np.array([0, -np.sin(nutation), np.cos(nutation)])
    bob = Body(mass=mass, inertia=(1, 1, 1), position=start, velocity=(-rate * start[1], 0, 0))
    model.add("bob", bob)
    model.add("rod", Distance(i="bob", j="ground", length=length))
    solution = stiffmbs.run(model, duration=5.0, points=101, **settings)
    tilt, heading, spin = symmetric_top(
        solution.time,
        transverse=mass * length**2,
        axial=0.0,
        weight=mass * 9.81 * length,
        nutation=nutation,
        precession_rate=rate,
        spin=0.0,
    )
    np.testing.assert_allclose(vector(solution, "bob"), length * zxz(heading, tilt, spin)[:, :, 2], atol=1e-8)


@pytest.mark.sampled(2)
@pytest.mark.long
@SOLVERS
def test_a_bar_hung_by_a_universal_joint(settings):
    """Against two angles: of the cross about the ground's arm, x, and of the bar about its own, y."""
    center = (0, 0, -0.45)
    links = [Link((1, 0, 0)), Link((0, 1, 0), (0, 0, 0), center, 2.0, np.diag([0.13, 0.14, 0.02]), 0)]
    start, rates = np.array([0.5, -0.4]), np.array([1.0, 3.0])
    pose = poses(links, start)[1]
    model = Model(gravity=G)
    bar = Body(
        mass=2.0,
        inertia=links[1].inertia,
        center_of_mass=center,
        orientation=pose.turn,
        velocity=pose.translation @ rates,
        omega=pose.turn.T @ pose.rotation @ rates,
    )
    handle = model.add("bar", bar)
    arm = Marker(body="ground", orientation={"z": (1, 0, 0)})
    model.add("cross", Universal(i=handle.at(0, 0, 0, {"z": (0, 1, 0)}), j=arm))
    solution = stiffmbs.run(model, duration=3.0, points=61, **settings)
    q, _ = motion(links, solution.time, start, rates)
    np.testing.assert_allclose(axes(solution, "bar"), [poses(links, angles)[1].turn for angles in q.T], atol=2e-8)


@SOLVERS
def test_spherical_pendulum(settings):
    """A rod without spin on a ball joint: Jacobi's functions for its height, a quadrature for its heading."""
    mass, length, width = 1.5, 0.8, 0.02
    _, inertia = rod((0, 0, 1), length, mass, width)
    across = inertia[0, 0] + mass * length**2 / 4
    nutation, rate = 2.4, 3.0
    model = Model(gravity=G)
    body = Body(
        mass=mass,
        inertia=inertia,
        center_of_mass=(0, 0, length / 2),
        orientation={"euler": "zxz", "angles": [0, nutation, 0]},
        velocity=(length / 2 * rate * np.sin(nutation), 0, 0),
        omega=(0, rate * np.sin(nutation), 0),
    )
    model.add("rod", body)
    model.add("ball", Spherical(i="rod", j="ground"))
    solution = stiffmbs.run(model, duration=5.0, points=101, **settings)
    tilt, heading, spin = symmetric_top(
        solution.time,
        transverse=across,
        axial=inertia[2, 2],
        weight=mass * 9.81 * length / 2,
        nutation=nutation,
        precession_rate=rate,
        spin=0.0,
    )
    turn = zxz(heading, tilt, spin)
    np.testing.assert_allclose(vector(solution, "rod"), length / 2 * turn[:, :, 2], atol=1e-8)
    np.testing.assert_allclose(axes(solution, "rod"), turn, atol=1e-7)


@SOLVERS
def test_conical_pendulum_goes_round_evenly_and_its_force_is_the_one_that_does_it(settings):
    """The rate at which a point mass goes round is sqrt(g / (l cos a))."""
    mass, length, angle, small = 2.0, 0.5, 0.6, 1e-8
    rate = np.sqrt(9.81 / (length * np.cos(angle)))
    radius = length * np.sin(angle)
    model = Model(gravity=G)
    bob = Body(
        mass=mass,
        inertia=(small, small, small),
        center_of_mass=(radius, 0, -length * np.cos(angle)),
        velocity=(0, radius * rate, 0),
        omega=(0, 0, rate),
    )
    model.add("bob", bob)
    model.add("eye", Spherical(i="bob", j="ground"))
    solution = stiffmbs.run(model, duration=2.0, points=21, **settings)
    x, y, z = radius * np.cos(rate * solution.time), radius * np.sin(rate * solution.time), -length * np.cos(angle)
    np.testing.assert_allclose(vector(solution, "bob"), np.stack([x, y, np.full_like(x, z)], axis=-1), atol=1e-7)
    pull = np.stack([-mass * rate**2 * x, -mass * rate**2 * y, np.full_like(x, mass * 9.81)], axis=-1)
    np.testing.assert_allclose(np.stack([solution[f"eye.f{c}"] for c in "xyz"], axis=-1), pull, atol=1e-5)


def column_with_two_arms():
    """A column that turns about the vertical, an arm on a level hinge, and a second one on a hinge along the first."""
    arm, arm_inertia = rod((1, 0, 0), 0.6, 1.0, 0.05)
    tip, tip_inertia = rod((0, 0, -1), 0.4, 0.5, 0.05)
    return [
        Link((0, 0, 1), mass=4.0, inertia=np.diag([0.3, 0.3, 0.05])),
        Link((0, 1, 0), (0.2, 0, 0), arm, 1.0, arm_inertia, 0),
        Link((1, 0, 0), (0.6, 0, 0), tip, 0.5, tip_inertia, 1),
    ]


@pytest.mark.sampled(2)
@pytest.mark.long
@SOLVERS
def test_a_double_pendulum_on_a_turning_column(settings):
    """Bodies on three hinges whose axes are all at right angles, against three hinge angles."""
    links, start, rates = column_with_two_arms(), np.array([0.0, 0.4, 0.3]), np.array([5.0, 0.0, 1.0])
    model, before = Model(gravity=G), Marker(body="ground")
    for k, (name, pose) in enumerate(zip(("column", "arm", "tip"), poses(links, start), strict=True)):
        link = links[k]
        body = Body(
            mass=link.mass,
            inertia=link.inertia,
            center_of_mass=link.center,
            position=pose.hinge,
            orientation=pose.turn,
            velocity=pose.translation @ rates,
            omega=pose.turn.T @ pose.rotation @ rates,
        )
        along = {"z": link.axis}
        handle = model.add(name, body)
        at = Marker(body=before.body, point=link.offset, orientation=along)
        model.add(f"{name}_hinge", Revolute(i=handle.at(0, 0, 0, along), j=at))
        before = handle.at(0, 0, 0)
    solution = stiffmbs.run(model, duration=2.0, points=41, **settings)
    q, _ = motion(links, solution.time, start, rates)
    at = [poses(links, angles) for angles in q.T]
    for k, name in enumerate(("column", "arm", "tip")):
        np.testing.assert_allclose(vector(solution, name), [pose[k].center for pose in at], atol=2e-8)
        np.testing.assert_allclose(axes(solution, name), [pose[k].turn for pose in at], atol=2e-8)
