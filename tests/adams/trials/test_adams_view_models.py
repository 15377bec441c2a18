"""Datasets laid out as Adams/View exports them (`tests/data/adams/View_*`) against equations of motion that share no code."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import Akima1DInterpolator, CubicSpline
from scipy.spatial.transform import Rotation

import stiffmbs

from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import near, table
from .test_adams_trial_forces import pair, step

pytestmark = [pytest.mark.long, pytest.mark.sampled(1)]

DATA = Path(__file__).parents[2] / "data" / "adams"


def played(name, end, spacing, rtol=1e-9):
    scene = stiffmbs.load_scene(DATA / f"View_{name}" / "dataset.adm")
    return stiffmbs.run(scene, duration=end, output=spacing, rtol=rtol)


def solved(rates, start, times, max_step=np.inf):
    return solve_ivp(rates, (0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-11, atol=1e-12, max_step=max_step).y


def quintic(x, x0, x1):
    """STEP5 from 0 to 1: value and two derivatives."""
    z = np.clip((x - x0) / (x1 - x0), 0, 1)
    width = x1 - x0
    return (
        z**3 * (10 - 15 * z + 6 * z * z),
        30 * (z * (1 - z)) ** 2 / width,
        60 * z * (1 - z) * (1 - 2 * z) / width**2,
    )


def extrapolated(law, x, y, count):
    """A law within its points, beyond them the polynomial through `count` points at the end."""

    def value(at):
        if x[0] <= at <= x[-1]:
            return law(at)
        part = slice(count) if at < x[0] else slice(-count, None)
        return np.polyval(np.polyfit(x[part] - x[part][0], y[part], count - 1), at - x[part][0])

    return value


def test_a_quarter_car_whose_curves_end_before_its_stroke_does():
    """mm: AKISPL and CUBSPL beyond their points, BISTOP, and a road by HAVSIN and degrees; the wheel does not lift."""
    x, y = np.array([-10.0, -5, 0, 5, 10]), np.array([3500.0, 3310, 3138, 2960, 2800])
    u, w = np.array([-150.0, -50, 0, 50, 150]), np.array([-200.0, -100, 0, 180, 450])
    spring = extrapolated(Akima1DInterpolator(x, y), x, y, 3)
    damper = extrapolated(CubicSpline(u, w, bc_type="not-a-knot"), u, w, 2)

    def stop(gap, rate):
        return max(50 * max(-gap, 0) ** 1.5 - rate * step(gap, -1, 2, 0, 0), 0)

    def strut(length, rate):
        ends = stop(length - 490, rate) - stop(510 - length, -rate)
        return spring(length - 500) - damper(rate) + ends

    def road(t):
        return 30 * (1 - np.cos(np.pi * np.clip((t - 0.2) / 0.15, 0, 1))) / 2 + 10 * np.sin(2 * np.pi * t)

    def rates(t, state):
        a, b, va, vb = state
        speed = (road(t + 1e-6) - road(t - 1e-6)) / 2e-6
        tyre, force = 3579.4 - 200 * (a - road(t) - 300) - 0.1 * (va - speed), strut(b - a, vb - va)
        return [va, vb, (tyre - force) * 1e3 / 45 - 9806.65, force * 1e3 / 320 - 9806.65]

    found = played("QuarterCar", 1.0, 0.02, 1e-8)
    a, b, va, vb = solved(rates, [300, 800, 0, 0], found.t, 2e-3)
    assert (b - a).min() < 490 and (b - a).max() > 510  # mm, both stops and ends of the curve
    assert np.abs(vb - va).max() > 150  # mm/s, the end of the damper's curve
    near(table(found, "PART_2", "y") * 1e3, a[:, None], 1e-7)
    near(table(found, "REQUEST_2", "f2 f3"), np.column_stack([b, vb - va]), 1e-6)
    near(found["REQUEST_2.f4"], [strut(*each) for each in zip(b - a, vb - va, strict=True)], 1e-6)


def test_a_beam_with_shear_and_a_field_with_couplings():
    """Loads of a hundredth of the usual: rotations of Adams and rotation vectors differ by their squares."""
    share, turn, origin = 0.01, euler(30, 40, 50), np.array([0.1, 0.2, 0.3])
    E, G, L, A, J, Iy, Iz = 7e9, 3e8, 0.5, 4e-4, 2e-8, 1e-8, 3e-8
    y, z = 12 * E * Iz * 1.2 / (G * A * L**2), 12 * E * Iy * 1.4 / (G * A * L**2)
    beam = np.diag([E * A / L, 12 * E * Iz / (L**3 * (1 + y)), 12 * E * Iy / (L**3 * (1 + z)), G * J / L,
                    (4 + z) * E * Iy / (L * (1 + z)), (4 + y) * E * Iz / (L * (1 + y))])  # fmt: skip
    beam[1, 5] = beam[5, 1] = -6 * E * Iz / (L**2 * (1 + y))
    beam[2, 4] = beam[4, 2] = 6 * E * Iy / (L**2 * (1 + z))
    field = np.array([
        [4000, 100, 50, 3, 0, 2], [100, 3000, 20, 0, 5, 1], [50, 20, 5000, 1, 2, 3],
        [3, 0, 1, 60, 2, 1], [0, 5, 2, 2, 70, 3], [2, 1, 3, 1, 3, 80],
    ])  # fmt: skip
    damping = np.diag([4, 5, 3, 0.06, 0.05, 0.04])
    damping[0, 1] = damping[1, 0] = 0.1
    damping[2, 4] = damping[4, 2] = 0.01
    free, preload = share * np.array([0, 0.01, -0.01, 0.02, 0, 0.01]), share * np.array([1, 2, -3, 0.1, 0.2, -0.1])
    free[0] = 0.3
    one, two = origin + turn @ [L, 0, 0], origin + turn @ [L + 0.35, 0, 0]
    base, i, j, k = (Marker(-1, origin, turn), Marker(0, one, turn), Marker(0, one + turn @ [0.05, 0, 0], turn),
                     Marker(1, two, turn))  # fmt: skip
    laws = (i, base, beam, 1e-3 * beam, np.array([L, 0, 0, 0, 0, 0]), 0), (k, j, field, damping, free, preload)

    def components(view, first, second, stiffness, viscosity, rest, force):
        axes, gap = view.axes(second), view.point(first) - view.point(second)
        spin = view.spin(second).rate
        seen = axes.T @ (gap.rate - np.cross(spin, gap.value))
        rotation = Rotation.from_matrix(axes.T @ view.axes(first)).as_rotvec()
        strain = np.concatenate([axes.T @ gap.value, rotation]) - rest
        rate = np.concatenate([seen, axes.T @ (view.spin(first).rate - spin)])
        whole = force - stiffness @ strain - viscosity @ rate
        return axes @ whole[:3], axes @ whole[3:]

    def act(view):
        for law in laws:
            pair(view, law[0], law[1], *components(view, *law))

    parts = [
        Part(0.5, tensor(0.002, 0.003, 0.004), one + turn @ [0.02, 0.01, 0], turn),
        Part(0.7, tensor(0.004, 0.003, 0.002, 0.0001, -0.0002, 0.0003), two + turn @ [0.01, -0.02, 0.03], turn),
    ]
    found = played("Beams", 0.1, 0.002, 1e-10)
    history = Mechanism(parts, {}, [act], gravity=(0, 0, -9.80665 * share)).run(found.t, 1e-10)
    for part, name in enumerate(("PART_2", "PART_3")):
        wanted = history.part(part)
        moved = np.column_stack([wanted[axis] - wanted[axis][0] for axis in "xyz"])
        near(table(found, name, "x y z") - table(found, name, "x y z")[0], moved, 5e-4)

    def on_markers(view):
        """Force of the beam on J along x, its torque there about y, and the force of the field on I along z."""
        force, torque = components(view, *laws[0])
        about = -torque - np.cross(view.point(i).value - origin, force)
        return turn.T @ about @ [0, 0, 1], view.axes(j).T @ components(view, *laws[1])[0] @ [0, 0, 1]

    near(table(found, "REQUEST_2", "f4 f7"), history.ask(on_markers), 5e-4)


def test_a_servo_with_a_linear_system_a_filter_and_an_equation_in_milliseconds():
    """mm, ms: LSE with IC and D, TFSISO with a direct part, DIFF, and DIF1 in a force."""
    a, b, c, d = np.array([[-0.2, 0.05], [-0.04, -0.3]]), np.array([0.1, 0.02]), np.array([0.8, 0.3]), 0.05

    def outputs(t, state):
        x, v, s1, s2, lag, q = state
        error = 10 * step(t, 10, 0, 30, 1) - x
        return error, c @ [s1, s2] + d * error, v / 4 + lag, error / 100 - 0.01 * q

    def rates(t, state):
        _, v, s1, s2, lag, q = state
        error, system, filtered, change = outputs(t, state)
        force = 40 * system - 60 * filtered + 20 * q + 3 * s2 + 10 * change
        return [v, force / 2 * 1e-3, *(a @ [s1, s2] + b * error), (0.75 * v - lag) / 12, change]

    found = played("Servo", 0.2, 0.004)
    times = found.t * 1e3
    y = solved(rates, [0, 0, 0.5, -0.25, 0, 0.1], times)
    z = euler(90, 90, 0)[:, 2]
    near(table(found, "PART_2", "x y z") @ z * 1e3, y[0], 1e-7)
    listed = [outputs(t, state) for t, state in zip(times, y.T, strict=True)]
    wanted = [
        [system, filtered, state[5], error, state[2]]
        for (error, system, filtered, _), state in zip(listed, y.T, strict=True)
    ]
    near(table(found, "REQUEST_1", "f2 f3 f4 f6 f7"), wanted, 1e-6)


def test_point_masses_on_springs_in_inches():
    """lbf, lbm, in: SPRINGDAMPERs with and without a reference force, VFORCE with SWEEP and a drag."""
    conversion, gravity = 386.0885826771654, np.array([0, -386.08858, 0])

    def sweep(t):
        z = np.clip(t, 0.1, 0.6) - 0.1
        turns = 0.5 * t + 2.5 * z * z + 2.5 * max(t - 0.6, 0)
        return 2 * quintic(t, 0.1, 0.3)[0] * np.sin(2 * np.pi * turns)

    def spring(gap, rate, stiffness, damping, length, force):
        long = np.linalg.norm(gap)
        return (force - stiffness * (long - length) - damping * rate @ gap / long) * gap / long

    def rates(t, state):
        r, s, v, w = state.reshape(4, 3)
        first = spring(r - [5, 40, 2], v, 2, 0.02, 14, 0)
        second = spring(s - r, w - v, 3, 0.05, 15, 1)
        push = np.array([sweep(t), 0, -0.01 * w[2] * np.linalg.norm(w)])
        accelerations = conversion * (first - second) / 3 + gravity, conversion * (second + push) / 5 + gravity
        return np.concatenate([v, w, *accelerations])

    found = played("Crane", 1.0, 0.02)
    y = solved(rates, [5, 25, 2, 8, 10, 3, 20, 0, -6, 0, 0, 0], found.t, 5e-3)
    places = np.hstack([table(found, name, "x y z") for name in ("POINT_MASS_2", "POINT_MASS_3")])
    near(places / 0.0254, y[:6].T, 1e-7)


def test_a_winch_of_a_gear_and_a_coupler_in_millimetres():
    """Radii of 20 and 40 mm by CV, 50 mm of lift a radian; a motor of 5 N m with a lag, braked."""
    inertia = 400e-6 + 8000e-6 / 4 + 10 * 0.025**2

    def rates(t, state):
        motor = (5000 * (1 - np.exp(-t / 0.1)) - 20 * state[1]) * 1e-3
        return [state[1], (motor - 10 * 9.80665 * 0.025) / inertia]  # z of the slide is downwards

    found = played("Winch", 1.0, 0.02)
    angle, _ = solved(rates, [0, 0], found.t)
    wanted = np.column_stack([np.degrees(angle), -angle / 2, -25 * angle])
    near(table(found, "REQUEST_1", "f2 f3 f4"), wanted, 1e-7)


def test_the_motors_of_an_arm_have_the_torques_of_inverse_dynamics():
    """One by its angle as a sum of STEP5 in lower case over two lines, one by its velocity with ICDISP."""
    found = played("Robot", 1.0, 0.02)
    t, degree = found.t, np.pi / 180
    up, down = quintic(t, 0, 0.5), quintic(t, 0.5, 1)
    a, da, dda = (degree * (60 * one - 90 * other) for one, other in zip(up, down, strict=True))
    z = np.clip((t - 0.1) / 0.3, 0, 1)
    risen = 0.3 * (z - np.sin(np.pi * z) / np.pi) / 2 + np.clip(t - 0.4, 0, None)
    slope = np.pi * np.sin(np.pi * z) / 0.6
    b = degree * (100 * risen - 30 * (1 - np.cos(2 * np.pi * t)) / (2 * np.pi))
    db = degree * (100 * (1 - np.cos(np.pi * z)) / 2 - 30 * np.sin(2 * np.pi * t))
    ddb = degree * (100 * slope - 60 * np.pi * np.cos(2 * np.pi * t))
    g, tip = 9.80665, 0.02 + 2 * 0.1**2
    both, bend = 2 * 0.3 * 0.1 * np.cos(b), 2 * 0.3 * 0.1 * np.sin(b)
    far = 2 * g * 0.1 * np.cos(a + b)
    first = (0.04 + 4 * 0.15**2 + 2 * 0.3**2 + tip + 2 * both) * dda + (tip + both) * ddb
    first = first - bend * (2 * da + db) * db + g * (4 * 0.15 + 2 * 0.3) * np.cos(a) + far
    second = (tip + both) * dda + tip * ddb + bend * da**2 + far
    wanted = np.column_stack([1e3 * first, 1e3 * second, a / degree, b / degree])
    for name, column in zip(("f2", "f3", "f4", "f6"), wanted.T, strict=True):
        near(found[f"REQUEST_1.{name}"], column, 1e-6)
