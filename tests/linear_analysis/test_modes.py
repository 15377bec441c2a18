"""State matrices against differences of accelerations, and modes against closed forms."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.polynomial import laguerre

import stiffmbs
from stiffmbs.analyses.linearised.at_state import at_state
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.commands.main import main
from stiffmbs.linear_analysis.modes import Motion
from stiffmbs.linear_analysis.state_space import state_matrix
from stiffmbs.linear_analysis.tangent_space import linearised

from ..conftest import EXAMPLES

STEP = 1e-5


def read(text):
    return stiffmbs.read_scene(text)


def example(name, *changes):
    return stiffmbs.load_scene(EXAMPLES / f"{name}.yaml", changes)


def frequencies(found):
    return np.array([mode.natural_frequency for mode in found.modes])


@pytest.mark.parametrize(
    "name, at",
    [
        ("bar_pendulum", 0.3), ("cart_pendulum", 1.3), ("half_car", 2.0), ("four_bars", 0.2), ("crank_slider", 0.1),
        ("heavy_top", 0.2), ("bricard", 0.5),
        *(pytest.param(*each, marks=pytest.mark.long) for each in (("rolling_disc", 0.4), ("door", 0.3), ("spatial_slider_crank", 0.2))),
    ],
)  # fmt: skip
def test_accelerations_vary_as_the_state_matrix_says(name, at):
    """u' at states a small step apart on the constraints, against v' = A z; in motion, with every term of it."""
    found = at_state(example(name), at=at)
    system, state = found.dynamics.system, found.dynamics.state
    scale = system.per_velocity(system.size, 1.0)
    linear = linearised(found.dynamics, found.t, found.acceleration)
    chosen = state_matrix(linear, scale)
    q, u = state.q.copy(), state.u.copy()
    random = np.random.default_rng(3)
    for _ in range(3):
        z = random.normal(size=len(chosen.matrix))
        rates = []
        for step in (-STEP, STEP):
            state.q[:] = system.of_body.moved(q, linear.own_axes @ chosen.poses @ z * step)
            state.u[:] = u + linear.own_axes @ chosen.velocities @ z * step
            found.dynamics.assemble(found.t)
            found.dynamics.correct_velocities(found.t)
            status, acceleration = found.dynamics.accelerate(found.t)
            assert status == 0
            rates.append(acceleration)
        differences = (rates[1] - rates[0]) / (2 * STEP)
        predicted = linear.own_axes @ (chosen.accelerations - linear.spin @ chosen.velocities) @ z
        np.testing.assert_allclose(
            differences / scale, predicted / scale, atol=2e-5 * np.max(np.abs(predicted / scale))
        )


def test_heave_pitch_and_wheel_hop_of_a_half_car():
    """Against the eigenvalues of its own M, D and K: a chassis on a vertical guide over two wheels on theirs."""
    m, inertia, a, b, k, d, wheel, tyre = 700.0, 1200.0, 1.2, 1.5, 2.0e4, 1.5e3, 40.0, 2.0e5
    front, rear = (m * 9.81 * arm / (a + b) for arm in (b, a))
    text = f"""
gravity: [0, -9.81]
bodies:
  chassis: {{mass: {m}, inertia: {inertia}, position: [0, 1], markers: {{f: {{point: [{a}, 0]}}, r: {{point: [-{b}, 0]}}}}}}
  front: {{mass: {wheel}, inertia: 1, position: [{a}, 0.5]}}
  rear: {{mass: {wheel}, inertia: 1, position: [-{b}, 0.5]}}
joints:
  guide: {{type: point_on_line, i: chassis, j: {{body: ground, angle: 90 deg}}}}
  front_guide: {{type: prismatic, i: front, j: {{body: ground, point: [{a}, 0], angle: 90 deg}}}}
  rear_guide: {{type: prismatic, i: rear, j: {{body: ground, point: [-{b}, 0], angle: 90 deg}}}}
forces:
  front_spring: {{type: spring_damper, i: chassis.f, j: front, stiffness: {k}, damping: {d}, free_length: {0.5 + front / k}}}
  rear_spring: {{type: spring_damper, i: chassis.r, j: rear, stiffness: {k}, damping: {d}, free_length: {0.5 + rear / k}}}
  front_tyre: {{type: spring_damper, i: front, j: {{body: ground, point: [{a}, 0]}}, stiffness: {tyre}, free_length: {0.5 + (front + wheel * 9.81) / tyre}}}
  rear_tyre: {{type: spring_damper, i: rear, j: {{body: ground, point: [-{b}, 0]}}, stiffness: {tyre}, free_length: {0.5 + (rear + wheel * 9.81) / tyre}}}
"""
    found = modes(read(text))
    reach = np.array([[1, a, -1, 0], [1, -b, 0, -1]])  # of the springs: heave, pitch, front, rear
    stiffness = k * reach.T @ reach + np.diag([0, 0, tyre, tyre])
    damping, mass = d * reach.T @ reach, np.diag([m, inertia, wheel, wheel])
    blocks = np.block(
        [[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    expected = np.linalg.eigvals(blocks)
    got = np.array([value for mode in found.modes for value in mode.eigenvalues])
    assert found.degrees_of_freedom == 4 and not found.notes
    for value in expected:
        assert np.min(np.abs(got - value)) < 1e-8 * abs(value)
    assert [mode.motion for mode in found.modes] == [Motion.OSCILLATING] * 4
    assert next(iter(found.modes[0].participation)) == "chassis"


@pytest.mark.parametrize("count", [2, 12])
def test_a_hanging_chain_of_point_masses(count):
    """w^2 = (g/l) x at the zeros x of the Laguerre polynomial of as high an order; the bodies turn freely beside."""
    bodies = "".join(f"  b{n}: {{mass: 0.7, inertia: 0.1, position: [0, {-0.5 * n}]}}\n" for n in range(1, count + 1))
    joints = "".join(
        f"  d{n}: {{type: distance, i: b{n}, j: {'ground' if n == 1 else f'b{n - 1}'}, length: 0.5}}\n"
        for n in range(1, count + 1)
    )
    found = modes(read(f"gravity: [0, -9.81]\nbodies:\n{bodies}joints:\n{joints}"))
    zeros = laguerre.lagroots([0] * count + [1])
    expected = np.sqrt(9.81 / 0.5 * zeros) / (2 * np.pi)
    assert [mode.motion for mode in found.modes] == [Motion.RIGID] * count + [Motion.OSCILLATING] * count
    np.testing.assert_allclose(frequencies(found)[count:], np.sort(expected), rtol=1e-9)


TOP = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  top: {mass: 2, inertia: [0.05, 0.05, 0.02], position: [0, 0, 0.3], omega: [0, 0, {spin}]}
joints:
  tip: {type: spherical, i: {body: top, point: [0, 0, -0.3]}, j: ground}
"""


@pytest.mark.parametrize("spin", [150.0, 400.0])
def test_a_sleeping_top_precesses_and_nutates(spin):
    """w = (C W +- sqrt(C^2 W^2 - 4 A m g l))/(2 A) about the tip, and the spin itself is free."""
    found = modes(read(TOP.replace("{spin}", str(spin))))
    a, c, weight = 0.05 + 2 * 0.3**2, 0.02, 2 * 9.81 * 0.3
    root = np.sqrt((c * spin) ** 2 - 4 * a * weight)
    slow, fast = (c * spin - root) / (2 * a), (c * spin + root) / (2 * a)
    np.testing.assert_allclose(frequencies(found), [0, slow / (2 * np.pi), fast / (2 * np.pi)], rtol=1e-9, atol=1e-12)
    assert all(mode.is_stable or mode.eigenvalues[0].real < 1e-9 for mode in found.modes)


def test_a_top_that_spins_too_slowly_falls():
    found = modes(read(TOP.replace("{spin}", "10")))
    assert not all(mode.is_stable for mode in found.modes)


@pytest.mark.long
def test_a_free_beam_has_six_rigid_modes_and_bends_as_euler_says():
    """20 pieces of a free-free beam: bending within 1 % of (4.73004/L)^2 sqrt(EI/(rho A))."""
    count, length, side = 20, 1.0, 0.02
    piece, area, second = length / count, side**2, side**4 / 12
    young, shear, density = 2.1e11, 8e10, 7800.0
    mass = density * area * piece
    own = f"mass: {mass}, inertia: [{mass * side**2 / 6}, {mass * (piece**2 + side**2) / 12}, {mass * (piece**2 + side**2) / 12}]"
    bodies = "".join(f"  b{n}: {{{own}, position: [{(n + 0.5) * piece}, 0, 0]}}\n" for n in range(count))
    beams = "".join(
        f"  e{n}: {{type: beam, i: b{n + 1}, j: b{n}, length: {piece}, area: {area}, torsion: {0.1406 * side**4}, iyy: {second}, "
        f"izz: {second}, young: {young}, shear_modulus: {shear}}}\n"
        for n in range(count - 1)
    )
    found = modes(read(f"dimensions: 3\nbodies:\n{bodies}forces:\n{beams}"))
    assert found.degrees_of_freedom == 6 * count
    assert [mode.motion for mode in found.modes[:7]] == [Motion.RIGID] * 6 + [Motion.OSCILLATING]
    expected = (4.730041 / length) ** 2 * np.sqrt(young * second / (density * area)) / (2 * np.pi)
    np.testing.assert_allclose(frequencies(found)[6:8], expected, rtol=1e-2)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    "name, count", [("bricard", 1), ("door", 1), ("rolling_disc", 3), ("four_bar", 0), ("half_car", 9)]
)
def test_as_many_modes_as_degrees_of_freedom(name, count):
    found = modes(example(name))
    assert found.degrees_of_freedom == count == len(found.modes)


def test_an_overdamped_oscillator_and_a_mass_in_a_damper():
    text = """
bodies: {a: {mass: 2, inertia: 1}, b: {mass: 3, inertia: 1, position: [0, 1]}}
joints:
  rail: {type: prismatic, i: a, j: ground}
  other: {type: prismatic, i: b, j: {body: ground, point: [0, 1]}}
forces:
  spring: {type: force, i: a, force: [-8*a.x - 10*a.vx, 0]}
  damper: {type: force, i: b, force: [-6*b.vx, 0]}
"""
    found = modes(read(text))
    free, over = found.modes
    assert (free.motion, over.motion) == (Motion.RIGID, Motion.APERIODIC)
    np.testing.assert_allclose(sorted(value.real for value in free.eigenvalues), [-2, 0], atol=1e-12)
    np.testing.assert_allclose(sorted(value.real for value in over.eigenvalues), [-4, -1])
    np.testing.assert_allclose(over.damping_ratio, 1.25)
    assert over.participation == pytest.approx({"a": 1.0, "b": 0.0})


def test_a_pendulum_that_stands_upright_has_no_frequency():
    scene = stiffmbs.read_scene("""
gravity: [0, -9.81]
bodies: {bar: {mass: 1, inertia: 1/12, position: [0, 0.5]}}
joints: {hinge: {type: revolute, i: {body: bar, point: [0, -0.5]}, j: ground}}
""")
    (line,) = [line.split() for line in str(stiffmbs.modes(scene)).splitlines() if line.split()[:1] == ["1"]]
    assert line[1:3] == ["-", "unstable"]
    assert {value.strip(",") for value in line[3:5]} == {"3.83601", "-3.83601"}  # sqrt(1.5 g / L)


def test_the_command_prints_a_table_and_json():
    scene = str(EXAMPLES / "half_car.yaml")
    shown = CliRunner().invoke(main, ["modes", scene])
    assert shown.exit_code == 0 and "9 degrees of freedom" in shown.output
    told = json.loads(CliRunner().invoke(main, ["modes", scene, "--json"]).output)
    assert len(told["modes"]) == told["degrees_of_freedom"] == 9
    second = told["modes"][1]
    assert second["motion"] == "oscillating"
    assert second["frequency"] == pytest.approx(np.hypot(*second["eigenvalue"]) / (2 * np.pi))
    assert second["damping"] == pytest.approx(-second["eigenvalue"][0] / np.hypot(*second["eigenvalue"]))
    wrong = CliRunner().invoke(main, ["modes", "nowhere.yaml"])
    assert wrong.exit_code == 2


def test_masses_of_very_different_size_have_their_own_frequencies():
    """A milligram and 1000 t: each row of the inertia of free motions is measured by itself."""
    masses, stiffness = {"small": 1e-6, "large": 1e6}, 100.0
    scene = {
        "gravity": [0, 0],
        "bodies": {name: {"mass": m, "inertia": 1, "position": [1, 0]} for name, m in masses.items()},
        "joints": {f"rail_{name}": {"type": "prismatic", "i": name, "j": "ground"} for name in masses},
        "forces": {
            f"spring_{name}": {
                "type": "spring_damper",
                "i": name,
                "j": "ground",
                "stiffness": stiffness,
                "free_length": 1,
            }
            for name in masses
        },
    }
    found = modes(read(json.dumps(scene)))
    assert sorted(frequencies(found)) == pytest.approx(
        sorted(np.sqrt(stiffness / m) / (2 * np.pi) for m in masses.values())
    )


@pytest.mark.parametrize("distant", [0.1, 100.0])
def test_modes_of_a_moving_state_say_which_coordinates_they_hold_in(distant):
    """For rotation t, displacement l t and size s: the square is g l sin(t) m/J - r w^2, where r = l^2/(l^2 + s^2)."""
    scene = f"""
    gravity: [0, -9.81]
    bodies: {{b: {{mass: 1, inertia: 0.1, position: [0.5, 0]}}}}
    joints: {{h: {{type: revolute, i: {{body: b, point: [-0.5, 0]}}, j: ground}}}}
    forces: {{f: {{type: spring_damper, i: b, j: {{body: ground, point: [{distant}, 0]}}, stiffness: 0, free_length: 1}}}}
    run: {{duration: 0.2, points: 2, rtol: 1e-10}}
    """
    model = stiffmbs.read_scene(scene)
    end, found = stiffmbs.run(model), stiffmbs.modes(model, at=0.2)
    angle, omega, size = float(end["b.angle"][-1]), float(end["b.omega"][-1]), max(0.5, distant)
    square = 9.81 * 0.5 / 0.35 * np.sin(angle) - 0.25 / (0.25 + size**2) * omega**2
    assert found.modes[0].eigenvalues[0] ** 2 == pytest.approx(square, rel=1e-6)
    assert any(f"relative to the size of the mechanism, {size:.3g} m" in note for note in found.notes)
