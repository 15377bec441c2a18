"""Classical problems of rolling, skating and sliding bodies, with equations of velocities and contacts."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs

SOLVERS = [{"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected"}, {"solver": "bdf", "formulation": "index1"}]


def solved(scene, settings):
    solution = stiffmbs.run(stiffmbs.read_scene(scene), rtol=1e-9, **settings)
    assert solution.success, solution.message
    return solution


@pytest.mark.parametrize("settings", SOLVERS)
def test_chaplygins_sleigh_turns_until_it_runs_straight_on(settings):
    """A blade at distance a behind the centre: v = V tanh(k t + c) and w = W / cosh(k t + c) (Neimark and Fufaev 1972, ch. II)."""
    m, inertia, a, v, w = 2.0, 0.3, 0.25, 0.3, 3.0
    solution = solved(
        f"""
bodies:
  sleigh: {{mass: {m}, inertia: {inertia}, position: [{a}, 0], velocity: [{v}, {a * w}], omega: {w}, markers: {{blade: {{point: [{-a}, 0]}}}}}}
joints: {{skate: {{type: velocity_equation, zero: "vy(sleigh.blade, ground, sleigh)"}}}}
requests: {{speed: "vx(sleigh.blade, ground, sleigh)"}}
run: {{duration: 5 s, points: 251}}
""",
        settings,
    )
    about_blade = inertia + m * a**2
    energy = m * v**2 + about_blade * w**2
    fastest, quickest = np.sqrt(energy / m), np.sqrt(energy / about_blade)
    rate = a * quickest**2 / fastest
    phase = rate * solution.time + np.arctanh(v / fastest)
    speed, omega = fastest * np.tanh(phase), quickest / np.cosh(phase)
    angle = 2 * quickest / rate * (np.arctan(np.exp(phase)) - np.arctan(np.exp(phase[0])))
    np.testing.assert_allclose(solution["speed"], speed, atol=1e-7)
    np.testing.assert_allclose(solution["sleigh.omega"], omega, atol=1e-7)
    np.testing.assert_allclose(solution["sleigh.angle"], angle, atol=1e-7)
    across = m * speed * omega * (1 - m * a**2 / about_blade)
    np.testing.assert_allclose(np.hypot(solution["skate.fx"], solution["skate.fy"]), np.abs(across), atol=1e-6)


@pytest.mark.parametrize("settings", SOLVERS[:3])
def test_a_ball_that_rolls_in_a_vertical_tube_goes_up_and_down(settings):
    """The centre goes round at the rate W and oscillates at sqrt(2/7) W about a height that its spin decides (Routh 1905, art. 230)."""
    m, a, b, rate, spin, g = 2.0, 0.1, 0.9, 3.0, 5.0, 9.81
    inertia = 0.4 * m * a**2
    solution = solved(
        f"""
dimensions: 3
gravity: [0, 0, {-g}]
bodies:
  ball: {{mass: {m}, inertia: [{inertia}, {inertia}, {inertia}], position: [{b}, 0, 0], velocity: [0, {b * rate}, 0], omega: [{spin}, 0, {-b * rate / a}]}}
variables: {{ex: ball.x/{b}, ey: ball.y/{b}}}
joints:
  wall: {{type: equation, zero: "ball.x^2 + ball.y^2 - {b**2}"}}
  around: {{type: velocity_equation, zero: "ex*vy(ball) - ey*vx(ball) + {a}*wz(ball)"}}
  upwards: {{type: velocity_equation, zero: "vz(ball) + {a}*(wx(ball)*ey - wy(ball)*ex)"}}
run: {{duration: 4 s, points: 201}}
""",
        settings,
    )
    slow = np.sqrt(2 / 7) * rate
    height = -(5 * g + 2 * a * rate * spin) / (7 * slow**2) * (1 - np.cos(slow * solution.time))
    np.testing.assert_allclose(solution["ball.z"], height, atol=1e-6)
    np.testing.assert_allclose(solution["ball.x"], b * np.cos(rate * solution.time), atol=1e-6)


RATTLEBACK = {
    "mass": 1.0,
    "axes": np.array([0.2, 0.03, 0.02]),
    "moments": (2.0e-4, 1.6e-3, 1.7e-3),
    "skew": np.radians(5),
}


def skew(x):
    """Return the matrix of the cross product with a vector."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def rattleback_rates(t, y, inertia):
    """Return the rates of the vertical and of the angular velocity, both in body axes (Garcia and Hubbard 1988)."""
    up, w = y[:3], y[3:]
    m, squares, g = RATTLEBACK["mass"], RATTLEBACK["axes"] ** 2, 9.81
    turning, size = skew(w), np.sqrt(squares @ up**2)
    up_rate = -turning @ up
    contact = -squares * up / size
    contact_rate = -squares * up_rate / size + squares * up * (squares @ (up * up_rate)) / size**3
    arm = skew(contact)
    force = m * (-turning @ contact_rate - turning @ turning @ contact + g * up)  # without angular acceleration
    moment = arm @ force - turning @ inertia @ w
    return np.concatenate([up_rate, np.linalg.solve(inertia - m * arm @ arm, moment)])


def tensor_of_rattleback():
    c, s = np.cos(RATTLEBACK["skew"]), np.sin(RATTLEBACK["skew"])
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return turned @ np.diag(RATTLEBACK["moments"]) @ turned.T


@pytest.mark.long
def test_a_rattleback_reverses_its_spin():
    (a, b, c), w = RATTLEBACK["axes"], np.array([0.02, 0.01, -5.0])
    start = np.cross(np.array([0, 0, -c]), w)  # the velocity of the centre
    solution = solved(
        f"""
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  stone:
    mass: {RATTLEBACK["mass"]}
    inertia: {tensor_of_rattleback().tolist()}
    position: [0, 0, {c}]
    velocity: {start.tolist()}
    omega: {w.tolist()}
    markers: {{x: {{point: [1, 0, 0]}}, y: {{point: [0, 1, 0]}}, z: {{point: [0, 0, 1]}}}}
variables:
  nx: dz(stone.x, stone)
  ny: dz(stone.y, stone)
  nz: dz(stone.z, stone)
  height: sqrt({a**2}*nx^2 + {b**2}*ny^2 + {c**2}*nz^2)
  rx: -{a**2}*nx/height
  ry: -{b**2}*ny/height
  rz: -{c**2}*nz/height
joints:
  table: {{type: equation, zero: dz(stone) - height}}
  along: {{type: velocity_equation, zero: "vx(stone, ground, stone) + stone.wy*rz - stone.wz*ry"}}
  across: {{type: velocity_equation, zero: "vy(stone, ground, stone) + stone.wz*rx - stone.wx*rz"}}
run: {{duration: 2 s, points: 101}}
""",
        {"solver": "bdf"},
    )
    expected = solve_ivp(
        rattleback_rates,
        (0, 2),
        [0, 0, 1, *w],
        args=(tensor_of_rattleback(),),
        method="LSODA",
        rtol=1e-9,
        atol=1e-11,
        t_eval=solution.time,
    ).y
    for k, axis in enumerate("xyz"):
        np.testing.assert_allclose(solution[f"stone.w{axis}"], expected[3 + k], atol=1e-4)
    assert solution["stone.wz"][-1] > 4.9
    np.testing.assert_allclose(solution["energy.total"], solution["energy.total"][0], rtol=1e-6)


@pytest.mark.long
def test_a_tippe_top_turns_over_and_keeps_jelletts_constant():
    """Friction at the contact of a sphere keeps L . r, with r from the centre of mass to the contact (Jellett 1872, ch. VIII)."""
    radius, below, moments = 0.02, 0.003, np.array([2.4e-6, 2.4e-6, 2.1e-6])
    solution = solved(
        f"""
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  top:
    mass: 0.015
    inertia: {moments.tolist()}
    center_of_mass: [0, 0, {-below}]
    position: [0, 0, {radius}]
    orientation: {{euler: zxz, angles: [0, 0.1, 0]}}
    omega: [0, 0, 150]
    markers: {{x: {{point: [1, 0, 0]}}, y: {{point: [0, 1, 0]}}, z: {{point: [0, 0, 1]}}}}
forces:
  table: {{type: sphere_contact, i: top, j: ground, radius: {radius}, stiffness: 1e6, dissipation: 2, friction: 0.3, stiction_velocity: 0.01}}
requests: {{nx: "dz(top.x, top)", ny: "dz(top.y, top)", nz: "dz(top.z, top)"}}
run: {{duration: 1 s, points: 101}}
""",
        {"solver": "bdf"},
    )
    up = np.array([solution[f"n{axis}"] for axis in "xyz"])  # in body axes
    momentum = moments[:, None] * [solution[f"top.w{axis}"] for axis in "xyz"]
    constant = below * momentum[2] - radius * np.sum(momentum * up, axis=0)
    np.testing.assert_allclose(constant, constant[0], rtol=1e-7)
    assert up[2, 0] > 0.99 and up[2, -1] < -0.4
    assert solution["energy.total"][-1] < 0.7 * solution["energy.total"][0]
