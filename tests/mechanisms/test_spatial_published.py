"""Published problems in space, against elliptic functions, quadratures and equations in minimal coordinates."""

import numpy as np
import pytest

import stiffmbs

from ..minimal_coordinates import Link, cross, motion, poses
from ..spatial_channels import axes, vector
from ..spatial_closed_forms import free_body, symmetric_top, zxz
from ..spatial_mechanisms import Bricard, Governor, SliderCrank, rod

BDF = {"rtol": 1e-11}
EXPLICIT = {"solver": "projected", "scheme": "dop853", "rtol": 1e-10}
SOLVERS = pytest.mark.parametrize("settings", [BDF, EXPLICIT], ids=["bdf", "dop853"])
SOLVERS_OF_LONG_RUNS = pytest.mark.parametrize(
    "settings", [BDF, pytest.param(EXPLICIT, marks=pytest.mark.long)], ids=["bdf", "dop853"]
)


@pytest.fixture(scope="module")
def solved(examples):
    return lambda name, *changes, **settings: stiffmbs.run(
        stiffmbs.load_scene(examples / f"{name}.yaml", list(changes)), **settings
    )


@SOLVERS
@pytest.mark.parametrize("rate", [0.0, -2.0], ids=["cusps", "loops"])
def test_heavy_top(solved, settings, rate):
    """Nutation over 10 s to 1e-8, in closed form; precession and spin by quadrature."""
    solution = solved("heavy_top", ("precession", f"{rate} rad/s"), **settings)
    nutation, precession, spin = symmetric_top(
        solution.time, transverse=0.1, axial=0.04, weight=0.2 * 9.81, nutation=0.6, precession_rate=rate, spin=40.0
    )
    turned = axes(solution, "top")
    np.testing.assert_allclose(np.arccos(turned[:, 2, 2]), nutation, atol=1e-8)
    np.testing.assert_allclose(turned, zxz(precession, nutation, spin), atol=1e-7)
    np.testing.assert_allclose(vector(solution, "top"), 0.2 * turned[:, :, 2], atol=1e-12)


@SOLVERS
def test_dzhanibekov(solved, settings):
    """A hundred seconds and some nineteen turns over: energy, angular momentum, rates and orientation."""
    solution = solved("dzhanibekov", **settings)
    J = np.array([0.1, 0.2, 0.3])
    omega = vector(solution, "nut", "w")
    turned = axes(solution, "nut")
    momentum = np.einsum("nij,nj->ni", turned, J * omega)
    np.testing.assert_allclose(solution["energy.kinetic"], solution["energy.kinetic"][0], rtol=1e-8)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-8)
    expected, exact = free_body(solution.time, J, (0.05, 4.0, 0.02))
    assert np.sum(np.diff(np.sign(omega[:, 1])) != 0) > 15
    np.testing.assert_allclose(omega, expected, atol=2e-5)
    np.testing.assert_allclose(turned, exact, atol=5e-6)


@pytest.fixture(scope="module")
def bricard_reference():
    """The corner opposite the ground over time."""
    mechanism = Bricard()
    return lambda t: np.array([mechanism.corners(angles)[2] for angles in mechanism.motion(t)[:2].T])


@pytest.mark.sampled(2)
@pytest.mark.long
@SOLVERS_OF_LONG_RUNS
def test_bricard(solved, bricard_reference, settings):
    """Ten seconds: energy to 1e-7 J, and the path by the one coordinate."""
    solution = solved("bricard", **settings)
    assert np.ptp(solution["energy.total"]) < 1e-7
    corner = vector(solution, "rod3") + axes(solution, "rod3")[:, :, 0] / 2
    np.testing.assert_allclose(corner, bricard_reference(solution.time), atol=1e-8)


def self_stress(mechanism, angles):
    """Whether each component of the hinges' force and torque belongs to the wrench they hold each other with, (6, 6).

    That wrench does no work on any hinge's screw; it is the same through the whole loop.
    """
    at = poses(mechanism.links, mechanism.hinges(angles))
    hinges = [*((pose.hinge, pose.rotation[:, k]) for k, pose in enumerate(at)), (np.array([0, 0, 1]), np.eye(3)[0])]
    work = np.array([[*cross(foot, axis), *axis] for foot, axis in hinges])
    force, torque = np.split(np.linalg.svd(work)[2][-1], 2)
    return np.array([[*force, *(torque - cross(foot, force))] for foot, _ in hinges])


@pytest.mark.long
def test_bricard_has_one_redundant_equation_and_its_self_stress_is_not_determined(examples):
    found = stiffmbs.check(stiffmbs.load_scene(examples / "bricard.yaml"))
    assert (found.degrees_of_freedom, found.equations, found.rank) == (1, 30, 29)
    assert len(found.redundant) == 1
    mechanism = Bricard()
    held = max(
        (np.abs(self_stress(mechanism, angles)) for angles in mechanism.motion(np.linspace(0, 2, 11))[:2].T),
        key=lambda part: np.sum(part > 1e-9),
    )
    names = ("fx", "fy", "fz", "tx", "ty", "tz")
    expected = {
        f"hinge{k + 1}.{name}" for k in range(6) for name, part in zip(names, held[k], strict=True) if part > 1e-9
    }
    assert set(found.not_unique) == expected


def chain_links(count, L=0.1, mass=0.1, width=0.02):
    """The rods of examples/spatial_chain.yaml on hinges about z and y by turns."""
    center, inertia = rod((1, 0, 0), L, mass, width)
    axes = [(0, 0, 1) if k % 2 == 0 else (0, 1, 0) for k in range(count)]
    return [Link(axis, (L if k else 0, 0, 0), center, mass, inertia, k - 1) for k, axis in enumerate(axes)]


@pytest.fixture(scope="module")
def four_rods():
    """Times, and the poses of four rods then by their four hinge angles."""
    links, times = chain_links(4), np.linspace(0, 0.6, 13)
    q, _ = motion(links, times, [0, 0, 0, 0], [5, 0, 0, 0])
    return times, [poses(links, angles) for angles in q.T]


@pytest.mark.sampled(2)
@pytest.mark.long
@SOLVERS
def test_a_chain_of_hinges_in_space(solved, four_rods, settings):
    """Four rods against four hinge angles."""
    times, at = four_rods
    solution = solved("spatial_chain", ("N", "4"), duration=0.6, points=13, **settings)
    np.testing.assert_allclose(solution.time, times, atol=1e-14)
    for k in range(4):
        np.testing.assert_allclose(vector(solution, f"link{k + 1}"), [pose[k].center for pose in at], atol=1e-8)
        np.testing.assert_allclose(axes(solution, f"link{k + 1}"), [pose[k].turn for pose in at], atol=1e-7)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("links", [10, 40])
@pytest.mark.parametrize("joint", ["revolute", "spherical"])
def test_a_long_chain_in_space_keeps_its_energy_and_its_spin(solved, links, joint):
    """Nothing turns a chain about the vertical through its first joint."""
    changes = (("N", str(links)), ("joints.pin{k}.type", joint), ("joints.pin1.type", joint))
    solution = solved("spatial_chain", *changes, duration=1.0, rtol=1e-9)
    falls = solution["energy.potential"][0] - solution["energy.potential"].min()
    assert solution.energy_drift() < 1e-5 * falls
    inertia = np.array([0.1 * 0.02**2 / 6, *[0.1 * (0.1**2 + 0.02**2) / 12] * 2])
    spin = 0.0
    for k in range(1, links + 1):
        place, velocity, omega = (vector(solution, f"link{k}", part) for part in ("", "v", "w"))
        spin = spin + 0.1 * np.cross(place, velocity)[:, 2]
        spin = spin + np.einsum("nj,nj->n", axes(solution, f"link{k}")[:, 2], inertia * omega)
    np.testing.assert_allclose(spin, spin[0], rtol=1e-6)


@pytest.mark.long
def test_stiff_flyball_governor(solved):
    """Ten seconds against three coordinates: spring-dampers in space between turning bodies."""
    solution = solved("governor", rtol=1e-10)
    shaft, rods, slider, *_ = Governor().motion(solution.time[::10])
    column, right = axes(solution, "shaft")[::10], axes(solution, "right")[::10]
    np.testing.assert_allclose(solution["slider.z"][::10], slider, atol=1e-7)
    np.testing.assert_allclose(-right[:, 2, 0], np.sin(rods), atol=1e-7)
    np.testing.assert_allclose(column[:, 0, 0], np.cos(shaft), atol=1e-6)
    np.testing.assert_allclose(column[:, 1, 0], np.sin(shaft), atol=1e-6)
    assert np.ptp(slider) > 0.05


@pytest.fixture(scope="module")
def crank_reference():
    """Angle and speed of the spatial slider-crank over every twentieth output time."""
    return SliderCrank().motion(np.linspace(0, 2, 21))


@pytest.mark.sampled(2)
@pytest.mark.long
@SOLVERS
def test_spatial_slider_crank(solved, crank_reference, settings):
    """Two seconds: the loop in closed form for the crank's angle, and that angle by its one equation of motion."""
    solution = solved("spatial_slider_crank", duration=2.0, points=401, **settings)
    mechanism = SliderCrank()
    crank = axes(solution, "crank")
    angle = np.unwrap(np.arctan2(crank[:, 2, 1], crank[:, 2, 2]))[::20]
    np.testing.assert_allclose(solution["slider.x"][::20], [mechanism.slider(a)[0] for a in angle], atol=1e-11)
    np.testing.assert_allclose(axes(solution, "rod")[::20], [mechanism.rod_axes(a) for a in angle], atol=1e-10)
    exact, speed = crank_reference
    np.testing.assert_allclose(angle, exact, atol=1e-6)
    np.testing.assert_allclose(solution["crank.wx"][::20], speed, atol=1e-5)
