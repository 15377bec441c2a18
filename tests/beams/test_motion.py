"""Beams in motion: converged values from independent methods, conservation laws, and all solvers."""

import json
import math

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLE_SCENES
from .scenes import cantilever, flying, flying_in_space, pendulum, right_angle, spin_up


def solved(text, **changes):
    solution = stiffmbs.run(stiffmbs.read_scene(text) if isinstance(text, str) else text, **changes)
    assert solution.outcome.name == "DONE", solution.message
    return solution


def at(solution, *channels, row=-1):
    return np.array([solution[channel][row] for channel in channels])


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_every_solver_follows_a_rubber_pendulum(solver):
    found = solved(pendulum(16), solver=solver)
    assert at(found, "rod.end.x", "rod.end.y") == pytest.approx([0.4365307, -0.8979809], abs=2e-4)
    energy = found["energy.total"]
    assert np.ptp(energy) < 1e-5 * np.max(np.abs(found["energy.kinetic"]))


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("n", "interpolation", "tolerance"), [(128, "pairs", 1e-6), (32, "spectral", 1e-5)])
def test_both_interpolations_converge_to_finite_elements_of_high_order(n, interpolation, tolerance):
    """Simo-Reissner beam by 8 elements of order 10 and 12 of order 8 (x, y and angle interpolated), which agree to 2e-7.

    The release excites waves with a kink, so Romberg's extrapolation to order six of elements of second order is 7e-6 off.
    """
    text = pendulum(n).replace("type: beam", f"type: beam, interpolation: {interpolation}")
    found = solved(text, solver="projected", duration=0.6, points=4)
    for row, expected in {1: (0.9482441, -0.1854195), 2: (0.4365307, -0.8979809), 3: (-0.6370967, -0.7484997)}.items():
        assert at(found, "rod.end.x", "rod.end.y", row=row) == pytest.approx(expected, abs=tolerance)


@pytest.mark.long
def test_the_error_of_a_pendulum_in_space_is_of_fourth_order():
    expected = np.array([0.1955840, 0.4683335, -0.8644481])
    errors = [
        np.max(np.abs(at(solved(pendulum(n, 3), solver="radau"), "rod.end.x", "rod.end.y", "rod.end.z") - expected))
        for n in (8, 16)
    ]
    assert errors[1] < 1e-4 and math.log2(errors[0] / errors[1]) > 3


@pytest.mark.long
def test_a_spinning_beam_stiffens():
    """Largest lag of the tip in the hub's frame 0.5738; a linear beam in a moving frame diverges."""
    found = solved(spin_up(8))
    rows = (3, 5, 8)
    assert [found["lag"][row] for row in rows] == pytest.approx([-0.2172674, -0.4684762, -0.5428415], abs=1.5e-4)


def test_momentum_and_energy_of_a_flying_beam_are_kept():
    found = solved(flying(8, 5.0), points=101)
    free = found.t > 2.51
    energy = found["energy.total"][free]
    assert np.ptp(energy) < 1e-6 * energy[0]
    mass = nodes_of(found, "rod", 8)
    momentum = sum(m * np.array([found[f"rod.{node}.vx"], found[f"rod.{node}.vy"]]) for node, m in mass.items())
    assert np.ptp(momentum[:, free], axis=1) == pytest.approx(0, abs=1e-9)
    assert momentum[:, -1] == pytest.approx([8 * 2.5, 0], abs=1e-6)


@pytest.mark.long
def test_a_flying_beam_converges_to_finite_elements_of_high_order():
    """The load starts and ends with a jump, so that extrapolations are wrong in the fourth digit.

    The expected values are those of `python -m tests.beams.high_order 16 6`; 64 spectral elements agree to 1.3e-4.
    """
    text = flying(32, 10.0).replace("type: beam", "type: beam, interpolation: spectral")
    found = solved(text)
    expected = {5: (5.620177, 4.764298, 15.408506, 4.264528), 10: (25.408755, 4.790207, 15.624379, 4.151323)}
    names = [f"rod.{end}.{axis}" for end in ("start", "end") for axis in "xy"]
    for row, values in expected.items():
        assert at(found, *names, row=row) == pytest.approx(values, abs=1.2e-3)


def nodes_of(solution, name, n, length=10.0, mass_per_length=1.0):
    from stiffmbs.model.beams.stiffness import node_weights

    names = ["start", *(f"node{k}" for k in range(1, n)), "end"]
    return dict(zip(names, node_weights(n) * length / n * mass_per_length, strict=True))


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "channels", "expected", "tolerance"),
    [
        (flying_in_space, ("rod.start.x", "rod.start.y", "rod.start.z"), (19.213600, 1.625556, -2.127248), 1e-3),
        (right_angle, ("frame.elbow.z", "frame.end.z"), (4.642067, 3.508934), 1e-3),
    ],
)  # fmt: skip
def test_thick_beams_are_of_second_order(text, channels, expected, tolerance):
    """Their large rotary inertia is lumped; Richardson extrapolation removes most of the error."""
    coarse, fine = (at(solved(text(n)), *channels) for n in (16, 32))
    assert np.max(np.abs(fine - expected)) < 4e-3
    assert np.max(np.abs(fine + (fine - coarse) / 3 - expected)) < tolerance


@pytest.mark.long
def test_flying_spaghetti_in_the_plane():
    """The load starts with a jump, so waves of the length of an element are excited and limit the order to 1.5."""
    channels, expected = (
        ("rod.start.x", "rod.start.y", "rod.end.x", "rod.end.y"),
        (4.4300259, -0.7851762, 5.9452208, 8.9706652),
    )
    errors = [np.max(np.abs(at(solved(flying(n)), *channels) - expected)) for n in (8, 32)]
    assert errors[1] < 2e-3 and errors[0] / errors[1] > 8


@pytest.mark.long
def test_whirl_of_a_shaft_with_a_disc():
    """Timoshenko shaft with rotary and gyroscopic inertia at 200 rad/s, from a p-version finite element model."""
    spin = 200
    scene = stiffmbs.read_scene(f"""
dimensions: 3
bodies:
  shaft:
    type: beam
    start: [0, 0, 0]
    end: [1, 0, 0]
    elements: 24
    stations: {{seat: 1/3}}
    section: {{type: circle, diameter: 30 mm}}
    material: {{E: 2.1e11, nu: 0.3, density: 7850}}
    omega: [{spin}, 0, 0]
  disc: {{mass: 10, inertia: [0.1125, 0.05625, 0.05625], position: [1/3, 0, 0], omega: [{spin}, 0, 0]}}
joints:
  seat: {{type: fixed, i: disc, j: shaft.seat}}
  left: {{type: spherical, i: shaft.start, j: ground}}
  right: {{type: point_on_line, i: shaft.end, j: {{body: ground, orientation: {{z: [1, 0, 0]}}}}}}
""")
    found = sorted(mode.frequency * math.tau for mode in stiffmbs.modes(scene).modes)[1:5]
    assert found == pytest.approx([191.83284, 196.15700, 953.53732, 1080.93587], rel=1e-4)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("spin", "expected"),
    [(200, [191.83284, 196.15700, 953.53732, 1080.93587]), (400, [189.46186, 198.12374, 883.13087, 1131.68886])],
)
def test_whirl_of_the_rotor_of_the_examples(spin, expected):
    """Whirl frequencies at two speeds, rad/s, from the same finite element model."""
    changes = [("spin", spin), ("unbalance", 0), ("c", 0), ("n", 24)]
    scene = stiffmbs.load_scene(EXAMPLE_SCENES["rotor"], changes)
    rates = sorted(mode.natural_frequency * math.tau for mode in stiffmbs.modes(scene).modes)
    found = [rate for rate in rates if rate > 1][:4]
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_thick_cantilever_has_the_frequencies_of_timoshenko(dimensions):
    """The rotary inertia of a section belongs to its height; values by Ritz' method with 14 polynomials."""
    start, end = ("[0, 0]", "[1.2, 0]") if dimensions == 2 else ("[0, 0, 0]", "[1.2, 0, 0]")
    scene = stiffmbs.read_scene(f"""dimensions: {dimensions}
bodies:
  rod: {{type: beam, start: {start}, end: {end}, elements: 16, interpolation: spectral,
    section: {{type: rectangle, width: 0.03, height: 0.05}}, material: {{E: 7e10, nu: 0.33, density: 2700}}}}
joints: {{clamp: {{type: fixed, i: rod.start, j: ground}}}}
""")
    found = np.array([mode.frequency for mode in stiffmbs.modes(scene).modes])
    for expected in (28.51963219, 177.24878958, 489.858282):
        assert np.abs(found / expected - 1).min() < 2e-5


def test_damping_is_that_of_the_stiffness():
    """The damping ratio of a mode is half its angular frequency times the damping time."""
    undamped = cantilever(6, stiffness="[1e6, 1e6, 1]")
    damped = undamped.replace("elements: 6", "elements: 6, damping: 1 ms")
    modes = [stiffmbs.modes(stiffmbs.read_scene(text)).modes[:3] for text in (undamped, damped)]
    for free, mode in zip(*modes, strict=True):
        assert mode.damping_ratio == pytest.approx(math.tau * free.frequency * 1e-3 / 2, rel=1e-6)


@pytest.mark.long
def test_a_beam_moves_as_a_rigid_body_without_strain():
    """A straight beam that turns about its centre of mass in space, with the stretch of its spin."""
    found = solved("""
dimensions: 3
bodies:
  bar:
    type: beam
    start: [-1, 0, 0]
    end: [1, 0, 0]
    elements: 4
    stiffness: [1e9, 1e9, 1e9, 1e6, 1e6, 1e6]
    mass_per_length: 1
    inertia_per_length: [2e-3, 1e-3, 1e-3]
    velocity: [0, -2, 0.5]
    omega: [0, 0, 2]
run: {duration: 1 s, points: 3, rtol: 1e-8, solver: radau}
""")
    angle = 2.0
    assert at(found, "bar.end.x", "bar.end.y", "bar.end.z") == pytest.approx(
        [math.cos(angle), math.sin(angle), 0.5], abs=1e-6
    )


def test_an_element_that_is_bent_too_far_stops_the_run():
    text = (
        cantilever(2, torque=0.0)
        .replace("torque: 0.0", 'torque: "30*t"')
        .replace("elements: 2", "elements: 2, damping: 0.1")
    )
    found = stiffmbs.run(stiffmbs.read_scene(text), duration=1.0, solver="radau")
    assert found.outcome.name == "STOPPED" and "divide the beam into more elements" in found.message
    assert "rotates its ends by more than half a revolution" in found.notes[0]


@pytest.mark.long
def test_sensitivities_with_respect_to_stiffness_and_length():
    text = """
parameters: {E: 5 MPa, L: 1 m}
gravity: [0, -2]
bodies:
  s: {type: beam, start: [0, 0], end: [L, 0], elements: 4, section: {type: circle, diameter: 20 mm},
      material: {E: E, density: 1100 kg/m^3}, damping: 10 ms}
joints: {c: {type: fixed, i: s.start, j: ground}}
run: {duration: 0.2, rtol: 1e-9}
"""
    scene = stiffmbs.read_scene(text)
    found = stiffmbs.sensitivities(scene, to=["E", "L"], of="final(s.end.y)")
    for name, value in (("E", 5e6), ("L", 1.0)):
        ends = []
        for factor in (1 - 1e-4, 1 + 1e-4):
            changed = stiffmbs.read_scene(text, [(name, value * factor)])
            ends.append(solved(changed, rtol=1e-10)["s.end.y"][-1])
        assert found.to[name] == pytest.approx((ends[1] - ends[0]) / (2e-4 * value), rel=1e-3)


ROTOR = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  arm: {type: beam, start: [0, 0, 0], end: [1, 0, 0], elements: 6, omega: [0, 0, 60],
        section: {type: rectangle, width: 20 mm, height: 4 mm}, material: {E: 210 GPa, density: 7850}}
joints:
  hub: {type: revolute, i: arm.start, j: ground}
start: {rotation: 60 rad/s}
run: {duration: 50 ms, points: 51, rtol: 1e-8, solver: radau}
"""


def test_a_rotor_starts_in_the_pose_that_centrifugal_forces_stretch():
    """A bar stretches by tan(k L)/k - L with k = rate sqrt(density/E), and does not oscillate."""
    level = ROTOR.replace("-9.81", "0")
    k = 60 * math.sqrt(7850 / 210e9)
    for text, stretch in ((level, math.tan(k) / k - 1), (ROTOR, None)):
        found = stiffmbs.run(stiffmbs.read_scene(text))
        radius = np.hypot(found["arm.end.x"], found["arm.end.y"])
        assert np.ptp(radius) < 1e-9 and np.ptp(found["arm.end.z"]) < 1e-9
        assert stretch is None or radius[0] - 1 == pytest.approx(stretch, rel=1e-3)
    assert -0.01 < found["arm.end.z"][0] < -0.001


def test_a_rotor_that_starts_in_its_pose_at_rest_is_told_the_other_start():
    settled = ROTOR.replace("{rotation: 60 rad/s}", "settled")
    found = stiffmbs.run(stiffmbs.read_scene(settled), duration=1e-3)
    assert "write start: {rotation: [0.0, 0.0, 60.0], about: [0.0, 0.0, 0.0]}" in found.notes[-1]
    across = settled.replace("[0, 0, -9.81]", "[-9.81, 0, 0]")
    for text in (across, settled.replace("omega: [0, 0, 60],", "")):
        assert "write start" not in str(stiffmbs.run(stiffmbs.read_scene(text), duration=1e-3).notes)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("torque", [0, 8.9, pytest.param(9.1, marks=pytest.mark.long)])
def test_a_twisted_shaft_buckles_at_the_torque_of_greenhill_and_has_no_breakpoint(torque):
    """With clamped ends, tan(M L/2EI) = M L/2EI: M = 8.987 EI/L; the gyroscopic terms of the shaft at rest are smooth."""
    found = stiffmbs.modes(
        stiffmbs.read_scene(f"""
dimensions: 3
bodies:
  s: {{type: beam, start: [0, 0, 0], end: [1, 0, 0], elements: 24, stiffness: [1e6, 1e6, 1e6, 1, 1, 1], mass_per_length: 1,
      inertia_per_length: [2e-6, 1e-6, 1e-6]}}
joints:
  a: {{type: fixed, i: s.start, j: ground}}
  b: {{type: cylindrical, i: {{body: s.end, orientation: {{z: [1, 0, 0]}}}}, j: {{body: ground, orientation: {{z: [1, 0, 0]}}}}}}
forces: {{m: {{type: torque, i: s.end, torque: [{torque}, 0, 0]}}}}
start: equilibrium
""")
    )
    assert found.sides == ()
    assert all(mode.frequency > 0 for mode in found.modes[:2]) == (torque < 8.987)


@pytest.mark.parametrize("angle", [-2.5, -1.0, 0.0, 1.0, 2.5])
@pytest.mark.parametrize("element", ["torsion", "hinge"])
def test_a_planar_scene_that_is_turned_does_not_wind_a_spring_on_a_beam(angle, element):
    """The direction of a beam has no turns: a spring between it and a marker that turns with the scene was wound by one."""
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    end = 0.5 * (np.cos(-1.7) * along + np.sin(-1.7) * across)
    scene = {
        "gravity": [0, 0],
        "bodies": {
            "rod": {"type": "beam", "start": [0, 0], "end": end.tolist(), "elements": 2, "material": {"E": 2.1e11, "nu": 0.3, "density": 7800}, "section": {"type": "circle", "diameter": 0.01}}
        },
        "joints": {"hinge": {"type": "revolute", "i": "rod.start", "j": {"body": "ground", "angle": angle}}},
        "forces": {
            "torsion": {"type": "torsion_spring", "i": "rod.start", "j": {"body": "ground", "angle": angle}, "stiffness": 2, "free_angle": 0.3}
        },
        "requests": {"opened": "hinge.angle"},
    }  # fmt: skip
    found = stiffmbs.run(stiffmbs.read_scene(json.dumps(scene)), duration=1e-3, points=2)
    first = found["torsion.torque"][0] / -2 + 0.3 if element == "torsion" else found["hinge.angle"][0]
    assert first == pytest.approx(-1.7)
