"""The spatial references hold by themselves: each against a second derivation or a conservation law."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from ..minimal_coordinates import Link, energies, motion, poses
from ..rolling import Disc
from ..spatial_closed_forms import free_body, hertz_impact, matrices, screw_fall, steady_rolling, symmetric_top, zxz
from ..spatial_mechanisms import Bricard, Governor, SliderCrank, solved

TOP = {"transverse": 0.1, "axial": 0.04, "weight": 2.0}
STARTS = {
    "cusped": {"nutation": 0.6, "precession_rate": 0.0, "spin": 40.0},
    "looping": {"nutation": 0.6, "precession_rate": -2.0, "spin": 40.0},
    "let go at the bottom of its nutation": {"nutation": 1.2, "precession_rate": 4.0, "spin": 40.0},
    "spherical pendulum": {"nutation": 2.5, "precession_rate": 3.0, "spin": 0.0},
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("start", STARTS.values(), ids=STARTS)
def test_symmetric_top_against_its_reduced_equation(start):
    """u' and the two momenta, integrated in time."""
    A, C, weight = TOP.values()
    axis = C * start["spin"]
    upright = A * start["precession_rate"] * np.sin(start["nutation"]) ** 2 + axis * np.cos(start["nutation"])

    def rates(_, y):
        _, tilt, _, w = y
        turning = (upright - axis * np.cos(tilt)) / (A * np.sin(tilt) ** 2)
        gyration = turning * np.sin(tilt) * (A * turning * np.cos(tilt) - axis) + weight * np.sin(tilt)
        return [turning, w, start["spin"] - turning * np.cos(tilt), gyration / A]

    t = np.linspace(0, 10, 501)
    precession, nutation, spin, _ = solved(rates, t, [0, start["nutation"], 0, 0], rtol=1e-13)
    exact = symmetric_top(t, **TOP, **start)
    for found, expected in zip(exact, (nutation, precession, spin), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-10)


@pytest.mark.long
def test_symmetric_top_against_three_hinges():
    """A gimbal of massless rings in minimal coordinates."""
    t = np.linspace(0, 2, 21)
    A, C, weight = TOP.values()
    mass, length = 1.0, weight / 9.81
    inertia = np.diag([A - mass * length**2, A - mass * length**2, C])
    body = Link((0, 0, 1), (0, 0, 0), (0, 0, length), mass, inertia, 1)
    links = [Link((0, 0, 1)), Link((1, 0, 0), parent=0), body]
    q, u = motion(links, t, [0, 0.6, 0], [-2.0, 0, 40.0 + 2.0 * np.cos(0.6)])
    nutation, precession, spin = symmetric_top(t, **TOP, **STARTS["looping"])
    np.testing.assert_allclose(q, [precession, nutation, spin], atol=1e-9)
    np.testing.assert_allclose(energies(links, q, u), energies(links, q, u)[0], rtol=1e-11)


@pytest.mark.sampled(6)
@pytest.mark.long
@pytest.mark.parametrize(
    "omega",
    [
        (0.05, 4.0, 0.02),
        (1.0, 0.5, -3.0),
        *(pytest.param(o, marks=pytest.mark.long) for o in ((0.02, -4.0, 0.3), (-3.0, 0.2, 0.1))),
    ],
)
def test_free_body_against_euler_equations(omega):
    J = np.array([0.1, 0.2, 0.3])

    def rates(_, y):
        w, p = y[:3], y[3:]
        a, b, c = w
        turning = np.array([[0, -a, -b, -c], [a, 0, c, -b], [b, -c, 0, a], [c, b, -a, 0]])
        return [*(np.cross(J * w, w) / J), *(turning @ p / 2)]

    t = np.linspace(0, 100, 501)
    y = solved(rates, t, [*omega, 1, 0, 0, 0], rtol=1e-13)
    w, turn = free_body(t, J, omega)
    np.testing.assert_allclose(w, y[:3].T, atol=2e-8)
    np.testing.assert_allclose(turn, matrices(y[3:] / np.linalg.norm(y[3:], axis=0)), atol=2e-8)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", turn, J * w), np.tile(J * omega, (501, 1)), atol=1e-12)


@pytest.mark.long
def test_bricard_closes_and_keeps_its_energy():
    mechanism = Bricard()
    np.testing.assert_allclose(
        mechanism.corners([-np.pi / 2, -np.pi / 2]),
        [[1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]],
        atol=1e-15,
    )
    theta, phi, speed = mechanism.motion(np.linspace(0, 10, 51))
    for angles in zip(theta, phi, strict=True):
        np.testing.assert_allclose(mechanism.corners(angles)[-1], [0, 0, 1], atol=1e-9)
    inertia, height = np.transpose([mechanism.energies(angles) for angles in zip(theta, phi, strict=True)])
    total = inertia * speed**2 / 2 + height
    np.testing.assert_allclose(total, total[0], atol=1e-8)
    assert np.ptp(theta) > 1


def test_bricard_has_one_degree_of_freedom_and_one_redundant_equation():
    """The six screws of its hinges have rank 5, in general poses as well as at the start."""
    mechanism = Bricard()
    for theta in (-np.pi / 2, -1.2, -0.4):
        angles = np.array([theta, -np.arccos(1 / (1 + np.cos(theta)) - 1)])
        at = poses(mechanism.links, mechanism.hinges(angles))
        axes = np.column_stack([at[-1].rotation, [1, 0, 0]])
        feet = [*(pose.hinge for pose in at), np.array([0, 0, 1])]
        screws = np.vstack([axes, np.column_stack([np.cross(p, a) for p, a in zip(feet, axes.T, strict=True)])])
        size = np.linalg.svd(screws, compute_uv=False)
        assert size[4] > 0.05
        assert size[5] < 1e-14


@pytest.mark.long
def test_slider_crank():
    mechanism = SliderCrank()
    assert mechanism.slider(0.0) == pytest.approx((0.2, 0.04), rel=1e-12)
    step, angle = 1e-5, 0.7
    axes = mechanism.rod_axes(angle)
    change = (mechanism.rod_axes(angle + step) - mechanism.rod_axes(angle - step)) / (2 * step)
    turning = change @ axes.T
    np.testing.assert_allclose(mechanism.rod_rate(angle), [turning[2, 1], turning[0, 2], turning[1, 0]], atol=1e-8)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-14)
    angles, speeds = mechanism.motion(np.linspace(0, 1.5, 31))
    found = [mechanism.energies(angle) for angle in angles]
    total = [float(inertia[0, 0]) * w**2 / 2 + height for (inertia, height), w in zip(found, speeds, strict=True)]
    np.testing.assert_allclose(total, total[0], atol=1e-10)


@pytest.mark.long
def test_governor_keeps_its_energy_without_damping_and_loses_it_with():
    t = np.linspace(0, 1, 51)
    for damping, worst in ((0.0, 1e-6), (4e4, np.inf)):
        governor = Governor(damping=damping)
        _, angle, height, w, v = governor.motion(t)
        spin = governor.turning(np.pi / 6) * 2 * np.pi / governor.turning(angle)
        total = sum(governor.energies(angle, height, (spin, w, v)))
        assert np.ptp(total) < worst
        assert total[-1] < total[0] + 1e-6
    assert total[-1] < total[0] - 1e-3
    assert np.ptp(angle) > 0.2


def test_governor_in_balance_does_not_move():
    """The heights of balance follow from the rates; then the whole motion stays there."""
    governor, momentum = Governor(), 40.0
    rest = fsolve(lambda x: governor.rates(np.array([0, *x, 0, 0]), momentum)[3:], [0.5, 0.5], xtol=1e-12)
    t = np.linspace(0, 1, 3)
    _, angle, height, *_ = governor.motion(t, *rest, momentum / governor.turning(rest[0]))
    np.testing.assert_allclose([angle, height], np.tile(rest, (3, 1)).T, atol=1e-9)


DISC = Disc(radius=0.3, mass=2.0, transverse=2 * 0.3**2 / 4, axial=2 * 0.3**2 / 2)


def test_a_disc_rolls_in_a_steady_circle():
    nutation, turning = 1.2, 2.0
    spin, path = steady_rolling(
        radius=0.3, mass=2.0, transverse=DISC.transverse, axial=DISC.axial, nutation=nutation, precession_rate=turning
    )
    t = np.linspace(0, 2 * np.pi / turning, 101)
    state = DISC.rolling(t, nutation, [0, turning * np.sin(nutation), spin])
    np.testing.assert_allclose(state[1], nutation, atol=1e-10)
    np.testing.assert_allclose(state[6:, -1], 0, atol=1e-9)
    assert np.ptp(state[6]) == pytest.approx(2 * path, rel=1e-3)


def test_a_rolling_disc_keeps_its_energy_and_its_contact_does_not_slip():
    t = np.linspace(0, 5, 5001)
    state = DISC.rolling(t, 1.3, [0.2, 0.5, 6.0])
    np.testing.assert_allclose(DISC.rolling_energy(state), DISC.rolling_energy(state)[0], rtol=1e-10)
    turn = zxz(*state[:3])
    place = np.stack([state[6], state[7], DISC.radius * np.sin(state[1])])
    velocity = np.gradient(place, t, axis=1, edge_order=2)
    change = np.gradient(turn, t, axis=0, edge_order=2) @ np.swapaxes(turn, 1, 2)
    omega = np.stack([change[:, 2, 1], change[:, 0, 2], change[:, 1, 0]])
    axis = turn[:, :, 2].T
    foot = -DISC.radius * (np.array([[0], [0], [1]]) - axis[2] * axis) / np.sin(state[1])
    np.testing.assert_allclose((velocity + np.cross(omega, foot, axis=0))[:, 1:-1], 0, atol=2e-4)


def test_a_sliding_coin_keeps_its_energy():
    t, nutation, turning, spin = np.linspace(0, 5, 501), 1.4, 12.0, 1.0
    _, tilt, _, w = DISC.sliding(t, nutation, turning, spin)
    A, R, m = DISC.transverse, DISC.radius, DISC.mass
    upright = A * turning * np.sin(nutation) ** 2 + DISC.axial * spin * np.cos(nutation)
    across = (upright - DISC.axial * spin * np.cos(tilt)) ** 2 / (A * np.sin(tilt) ** 2)
    total = (A + m * R**2 * np.cos(tilt) ** 2) * w**2 + across + 2 * m * 9.81 * R * np.sin(tilt)
    np.testing.assert_allclose(total, total[0], rtol=1e-11)


def test_screw_and_impact():
    """A nut of inertia without pitch falls freely; an impact of unit stiffness integrated in time."""
    assert screw_fall(1.0, pitch=1e9, mass=1, inertia=1) == pytest.approx(-9.81 / 2)
    assert screw_fall(1.0, pitch=2 * np.pi, mass=1, inertia=1) == pytest.approx(-9.81 / 4)
    depth, duration = hertz_impact(mass=2.0, speed=0.3, stiffness=1e4)

    def leaves(_, y):
        return y[0]

    leaves.terminal, leaves.direction = True, -1
    found = solve_ivp(
        lambda _, y: [y[1], -1e4 * max(y[0], 0) ** 1.5 / 2],
        (0, 1),
        [0, 0.3],
        "DOP853",
        events=leaves,
        rtol=1e-10,
        atol=1e-12,
    )
    assert found.t_events[0][-1] == pytest.approx(duration, rel=1e-6)
    assert found.y[0].max() == pytest.approx(depth, rel=1e-2)
