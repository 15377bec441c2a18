"""Steps over the knots of a spline: their points do not resolve the kink of an acceleration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import stiffmbs

KNOTS = [[-0.5, 0.3], [0, 0.2], [0.3, 0.05], [0.6, 0.2], [1.0, 0.1], [1.5, 0.4], [2.2, 0.3]]
BEAD = """
gravity: [0, -9.81]
bodies: {{bead: {{mass: 1, inertia: 0.1, position: [0, 0.2], velocity: [2, {slope}]}}}}
joints: {{wire: {{type: point_on_curve, i: bead, j: ground, y: {{table: {knots}, ends: natural}}}}}}
run: {{duration: 0.6, points: 61}}
"""


@pytest.mark.long
@pytest.mark.parametrize("rtol", [1e-5, 1e-6])
def test_knots_of_a_curve(rtol):
    """The quadrature by the points of the steps gave 5 and 23 times the true error."""
    curve = CubicSpline(*np.transpose(KNOTS), bc_type="natural")

    def rates(_, y):
        slope, bend = float(curve(y[0], 1)), float(curve(y[0], 2))
        return [y[1], -(slope * bend * y[1] ** 2 + 9.81 * slope) / (1 + slope**2)]

    scene = stiffmbs.read_scene(BEAD.format(slope=2 * float(curve(0, 1)), knots=KNOTS))
    found = stiffmbs.run(scene, solver="radau", rtol=rtol, errors=True)
    exact = solve_ivp(rates, (0, 0.6), [0.0, 2.0], "DOP853", found.time, rtol=1e-11, atol=1e-13, max_step=2e-3).y
    for channel, truth in (("bead.x", exact[0]), ("bead.vx", exact[1])):
        ratio = found.errors[channel].over_time / np.abs(found[channel] - truth).max()
        assert 0.5 < ratio < 8.0, ratio


SLED = """
dimensions: 3
gravity: [0, -9.81, 0]
bodies:
  sled:
    mass: 1
    inertia: [0.02, 0.02, 0.02]
    position: [0, 0.2, 0]
    orientation: {{x: [1, {slope}, 0], z: [0, 0, 1]}}
    velocity: [2, {rise}, 0]
    omega: [0, 0, {omega}]
joints: {{wire: {{type: tangent_to_curve, i: sled, j: ground, y: {{table: {knots}, ends: natural}}}}}}
run: {{duration: 0.6, points: 61}}
"""


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("rtol", [1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_knots_at_which_accelerations_jump(rtol):
    """Polynomials through states of bdf on both sides of a knot gave 18 to 370 times the true error.

    The angle follows the slope of the curve: the third derivative of a spline is in the acceleration. Against the energy.
    """
    curve = CubicSpline(*np.transpose(KNOTS), bc_type="natural")

    def squared(x):
        """Return twice the kinetic energy in that of a unit speed x'."""
        slope, bend = curve(x, 1), curve(x, 2)
        return 1 + slope**2 + 0.02 * (bend / (1 + slope**2)) ** 2

    energy = 0.5 * 4 * squared(0) + 9.81 * 0.2
    slope, bend = float(curve(0, 1)), float(curve(0, 2))
    scene = SLED.format(slope=slope, rise=2 * slope, omega=2 * bend / (1 + slope**2), knots=KNOTS)
    found = stiffmbs.run(stiffmbs.read_scene(scene), solver="bdf", rtol=rtol, errors=True)
    exact = solve_ivp(
        lambda _, x: np.sqrt(2 * (energy - 9.81 * curve(x)) / squared(x)),
        (0, 0.6), [0.0], "DOP853", found.time, rtol=1e-11, atol=1e-13, max_step=1e-3,
    ).y[0]  # fmt: skip
    speed = np.sqrt(2 * (energy - 9.81 * curve(exact)) / squared(exact))
    for channel, truth in (("sled.x", exact), ("sled.vx", speed)):
        ratio = found.errors[channel].over_time / np.abs(found[channel] - truth).max()
        assert 0.5 < ratio < 8.0, ratio
