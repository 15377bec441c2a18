"""Published problems and machines with a closed form, apart from those that have a file of their own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs

A01_AT_TEN_SECONDS = (-0.275087462577, -0.961419205099)
"""The exact place of the simple pendulum (elliptic functions)."""


@pytest.fixture(scope="module")
def solved(examples):
    return lambda name, *changes, **settings: stiffmbs.run(
        stiffmbs.load_scene(examples / f"{name}.yaml", list(changes)), **settings
    )


@pytest.mark.parametrize(("solver", "rtol"), [("bdf", 1e-11), ("projected", 1e-10)])
def test_simple_pendulum(solved, solver, rtol):
    """IFToMM A01; the benchmark asks for 5e-5 J."""
    solution = solved("simple_pendulum", solver=solver, rtol=rtol)
    assert solution.energy_drift() < 1e-8
    assert (solution["bob.x"][-1], solution["bob.y"][-1]) == pytest.approx(A01_AT_TEN_SECONDS, abs=5e-9)
    assert solution["constraint.position"].max() < 1e-11


def test_four_bars_at_the_second_published_instant(solved):
    """IFToMM A02 with N = 2: twenty seconds, through every flat pose."""
    solution = solved("four_bars", duration=20.0, rtol=1e-9)
    top = solution["v0.x"][-1] * 2, solution["v0.y"][-1] * 2
    assert top == pytest.approx((0.839746574269, 0.542978536412), abs=3e-5)


def sprung_piston(t, bearing, zeta, r=0.04, L=0.14, speed=100 * np.pi, m=0.5, rod=0.6):
    """The slider-crank with an elastic bearing in two coordinates: the rod's angle and the piston's place, DOP853."""
    damping = 2 * zeta * np.sqrt(bearing * m)
    inertia = rod * L**2 / 12

    def rates(t, y):
        psi, x, omega, v = y
        phi = speed * t
        pin = r * np.array([np.cos(phi), np.sin(phi)])
        pin_v, pin_a = speed * np.array([-pin[1], pin[0]]), -(speed**2) * pin
        along = L * np.array([np.cos(psi), np.sin(psi)])
        across = np.array([-along[1], along[0]])
        gap = np.array([x, 0.0]) - pin - along
        gap_v = np.array([v, 0.0]) - pin_v - omega * across
        force = bearing * gap + damping * gap_v  # on the rod's end
        # about the crank pin: J psi'' + (L/2) m across_hat . a_pin = across . force
        turning = inertia + rod * L**2 / 4
        alpha = (across @ force - rod * (across / 2) @ pin_a) / turning
        return [omega, v, alpha, -force[0] / m]

    pull = m * r * speed**2 * (1 + r / L)
    start = [0.0, r + L + pull / bearing, -speed * r / L, 0.0]
    found = solve_ivp(rates, (0, t[-1]), start, method="DOP853", rtol=1e-11, atol=1e-13, t_eval=t)
    return found.y


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("bearing", "tolerance"), [("1e6", 1e-8), ("1e9", 1e-9)])
def test_slider_crank_at_3000_rpm_with_an_elastic_bearing(solved, bearing, tolerance):
    """Against two equations derived by hand."""
    solution = solved("elastic_bearing", ("bearing", f"{bearing} N/m"), duration=0.02, points=201, rtol=1e-9)
    psi, x, *_ = sprung_piston(solution.time, float(bearing), 0.05)
    np.testing.assert_allclose(solution["piston.x"], x, atol=tolerance)
    np.testing.assert_allclose(solution["rod.angle"], psi, atol=10 * tolerance)


def test_a_stiffer_bearing_gives_way_less(solved):
    """In proportion: the piston's inertia is the same."""
    give = [
        solved("elastic_bearing", ("bearing", f"{k:g} N/m"), ("zeta", "1"), rtol=1e-8)["give"][200:].max()
        for k in (1e7, 1e8, 1e9)
    ]
    assert give[0] / give[1] == pytest.approx(10, rel=0.15)
    assert give[1] / give[2] == pytest.approx(10, rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize("links", [10, 40])
def test_a_swinging_chain_keeps_its_energy(solved, links):
    solution = solved("chain", ("N", str(links)), rtol=1e-9)
    falls = solution["energy.potential"][0] - solution["energy.potential"].min()
    assert solution.energy_drift() < 1e-5 * falls
    assert solution["constraint.position"].max() < 1e-10


CAR_AXIS = """
gravity: [0, -1]
parameters: {w: 10 rad/s, amplitude: 0.1 m}
variables: {y_road: amplitude*sin(w*t), x_road: "sqrt((1 m)^2 - y_road^2)", stretched: "sqrt((r.x - x_road)^2 + (r.y - y_road)^2)"}
bodies:
  l: {mass: 5e-4, inertia: 1, position: [0, 0.5], velocity: [-0.5, 0]}
  r: {mass: 5e-4, inertia: 1, position: [1, 0.5], velocity: [-0.5, 0]}
joints:
  axle: {type: distance, i: l, j: r, length: 1}
  axis: {type: equation, zero: l.x*x_road + l.y*y_road}
forces:
  left: {type: spring_damper, i: l, j: ground, stiffness: 1, free_length: 0.5}
  right:
    type: force
    i: r
    j: ground
    force: ["1 N/m*(0.5 m/stretched - 1)*(r.x - x_road)", "1 N/m*(0.5 m/stretched - 1)*(r.y - y_road)"]
"""
CAR_AXIS_AT_3 = {
    "l.x": 0.0493455784275402809, "l.y": 0.496989460230171154, "r.x": 1.04174252488542152, "r.y": 0.373911027265361257,
    "l.vx": -0.0770583684040972358, "l.vy": 0.00744686658723778553, "r.vx": 0.0175568157537232222, "r.vy": 0.770341043779251976,
}  # fmt: skip
"""Of the Test Set for IVP Solvers, problem 'car axis' (Mazzia, Magherini, release 2.4)."""


@pytest.mark.parametrize("settings", [{"rtol": 1e-9}, {"rtol": 1e-9, "solver": "projected"}])
def test_the_car_axis_of_the_test_set_for_initial_value_problems(settings):
    solution = stiffmbs.run(stiffmbs.read_scene(CAR_AXIS), duration=3.0, **settings)
    for channel, expected in CAR_AXIS_AT_3.items():
        assert solution[channel][-1] == pytest.approx(expected, abs=1e-6)
