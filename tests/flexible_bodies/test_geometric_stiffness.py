"""Geometric stiffness by interface forces, weight and rotation, against beams in numpy; conservation and invariance."""

import meshio
import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre
from scipy.linalg import eigh
from scipy.optimize import curve_fit

from stiffmbs import load_scene
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.run import run
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.quaternions import rotated
from stiffmbs.compile.state import State
from stiffmbs.errors import InputError

from .bars import HEIGHT, LENGTH, MASS, WIDTH, E, mesh_of_bar

EI = E * WIDTH * HEIGHT**3 / 12
"""Bending stiffness about y, the smaller one."""
EULER = np.pi**2 * EI / (4 * LENGTH**2)
BODY = """
    type: flexible
    mesh: bar.vtu
    units: {length: 1 mm}
    material: {E: 210 GPa, nu: 0, density: 7850 kg/m^3}
    interfaces:
      a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}
      b: {plane: {point: [400 mm, 0, 0], normal: [1, 0, 0]}}
    modes: 3
"""


def frequency(tension=lambda x: 0 * x, tip=0.0):
    """Return the lowest angular frequency of a clamped Bernoulli beam with a tension and a point mass at the end."""
    return np.sqrt(lowest_eigenvalue(EI, tension, tip))


def lowest_eigenvalue(bending_stiffness, tension, tip=0.0):
    """Return the square of its lowest angular frequency, which is negative beyond buckling."""
    shapes = [Polynomial([0, 0, 1]) * Legendre.basis(k, domain=[0, LENGTH]).convert(kind=Polynomial) for k in range(10)]
    x, weights = np.polynomial.legendre.leggauss(30)
    x, weights = LENGTH * (x + 1) / 2, LENGTH * weights / 2
    w, slope, curvature = (np.array([shape.deriv(k)(x) for shape in shapes]) for k in (0, 1, 2))
    end = np.array([shape(LENGTH) for shape in shapes])
    stiffness = (bending_stiffness * weights * curvature) @ curvature.T + (weights * tension(x) * slope) @ slope.T
    mass = (MASS / LENGTH * weights * w) @ w.T + tip * np.outer(end, end)
    return eigh(stiffness, mass, eigvals_only=True)[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("geometric")
    mesh_of_bar("hexahedron27", along=8, across=1).write(found / "bar.vtu")
    return found


def scene(folder, rest, body=BODY, **changes):
    (folder / "scene.yaml").write_text(f"dimensions: 3\nbodies:\n  bar:{body}{rest}")
    return load_scene(folder / "scene.yaml", [(name.replace("__", "."), value) for name, value in changes.items()])


CLAMP = "joints:\n  clamp: {type: fixed, i: bar.a, j: {body: ground, point: [0, 15 mm, 10 mm]}}\n"
RUN = "run: {duration: 1 ms, solver: radau}\n"


def lowest(model):
    """Return the lowest angular frequency about the equilibrium."""
    at_rest = equilibrium(model).solution
    return 2 * np.pi * min(mode.natural_frequency for mode in modes(model, start_from=at_rest).modes)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", ["rigid", "average"])
@pytest.mark.parametrize("part", [0.2, 0.5, 0.8, -5.0])
def test_a_column_under_a_force_at_its_end(folder, part, kind):
    """The frequency falls to zero at Euler's load; the force keeps its direction."""
    body = BODY.replace("[400 mm, 0, 0], normal: [1, 0, 0]}", f"[400 mm, 0, 0], normal: [1, 0, 0]}}, type: {kind}")
    force = f"forces: {{P: {{type: force, i: bar.b, force: [{-part * EULER}, 0, 0]}}}}\n"
    expected = frequency(lambda x: -part * EULER + 0 * x)
    assert lowest(scene(folder, CLAMP + force + RUN, body)) == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize("part", [0.5, 0.8, -0.8])
def test_a_column_under_a_heavy_load(folder, part):
    """A mass on a standing column (positive) and on a hanging one, with the weight of the column."""
    mass, g = 20 * MASS, part * EULER / (20 * MASS)
    load = f"  load: {{mass: {mass}, inertia: [1e-9, 1e-9, 1e-9], position: [{LENGTH}, 15 mm, 10 mm]}}\ngravity: [{-g}, 0, 0]\n"
    grip = "  grip: {type: fixed, i: load, j: bar.b}\n"
    expected = frequency(lambda x: -g * (mass + MASS * (1 - x / LENGTH)), mass)
    assert lowest(scene(folder, load + CLAMP + grip + RUN)) == pytest.approx(expected, rel=3e-3)


@pytest.mark.long
def test_a_column_of_two_bodies(folder, tmp_path):
    """Each half has half of the stiffness change; the frequency is that of one body."""
    mesh = mesh_of_bar("hexahedron27", along=8, across=1)
    mesh.points[:, 0] /= 2
    mesh.write(tmp_path / "bar.vtu")
    half = BODY.replace("400 mm", "200 mm")
    second = f"  upper:{half}    position: [200 mm, 0, 0]\n"
    joint = "  joined: {type: fixed, i: upper.a, j: bar.b}\n"
    force = f"forces: {{P: {{type: force, i: upper.b, force: [{-0.5 * EULER}, 0, 0]}}}}\n"
    found = lowest(scene(tmp_path, second + CLAMP + joint + force + RUN, half))
    assert found == pytest.approx(frequency(lambda x: -0.5 * EULER + 0 * x), rel=3e-3)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("part", "tip"), [(2.0, 0.0), (1.0, 2 * MASS)])
def test_flapping_of_a_rotating_beam(folder, part, tip):
    """The frequency rises with the speed (Southwell); the angular velocity is given relative to the frequency at rest."""
    rate = part * frequency()
    expected = frequency(lambda x: rate**2 * (MASS / LENGTH * (LENGTH**2 - x**2) / 2 + tip * LENGTH), tip)
    period = 2 * np.pi / expected
    moving = f"    omega: [0, 0, {rate}]\n    velocity: [0, {rate * LENGTH / 2}, 0]\n    damping: {{stiffness: {0.01 / frequency()}}}\n    position: [0, -15 mm, -10 mm]\n"
    load = f"  load: {{mass: {tip}, inertia: [1e-9, 1e-9, 1e-9], position: [{LENGTH}, 0, 0], velocity: [0, {rate * LENGTH}, 0], omega: [0, 0, {rate}]}}\n"
    joints = f'joints:\n  hub: {{type: revolute, i: bar.a, j: ground}}\n  motor: {{type: drive, joint: hub, position: "{rate}*t"}}\n'
    pulse = f"100*step5(t, 0, 0, {period / 2}, 1)*step5(t, {period / 2}, 1, {period}, 0)"
    rest = f'forces: {{P: {{type: force, i: bar.b, force: [0, 0, "{pulse}"]}}}}\nrun: {{duration: {6 * period}, points: 601, rtol: 1e-7, solver: radau}}\n'
    grip = "  grip: {type: fixed, i: load, j: bar.b}\n" if tip else ""
    found = run(scene(folder, (load if tip else "") + joints + grip + rest, BODY + moving))
    after = found.t > 1.5 * period

    def swing(t, a, b, c, rate, damping):
        return (a * np.cos(rate * t) + b * np.sin(rate * t)) * np.exp(-damping * t) + c

    up = found["bar.b.z"][after]
    (_, _, _, damped, decay), _ = curve_fit(swing, found.t[after], up, [0, up.max(), 0, expected, 0.01 * expected])
    assert np.hypot(damped, decay) == pytest.approx(expected, rel=4e-3)
    (note,) = (note for note in found.notes if "stiffness" in note)
    assert "'bar': loads and rotation change the stiffness" in note and note.endswith("is included")


BOW = f"""joints: {{}}
forces:
  bow: {{type: spring_damper, i: {{body: bar.a, point: [0, 0, 5 mm]}}, j: bar.b, stiffness: 1e6 N/m, free_length: {LENGTH - EULER * 1e-6}}}
run: {{duration: 3 ms, points: 31, rtol: 1e-8, solver: radau}}
"""
"""A string between the ends that pulls with Euler's load of a clamped column, a quarter of that of the free bar."""
SPIN = "    omega: [30, 50, 200]\n    velocity: [1, 2, 3]\n"


POSE = ["x", "y", "z", "q0", "q1", "q2", "q3"]
RATES = ["vx", "vy", "vz", "wx", "wy", "wz"]


def angular_momentum(model, found):
    """Return the angular momentum about the origin from the mass matrix of the equations, shape (times, 3)."""
    system = compile_model(model)
    state, momenta = State(system), []
    for row in range(len(found.t)):
        total = np.zeros(3)
        for k, name in enumerate(system.bodies):
            pose = [found[f"{name}.{part}"][row] for part in POSE]
            rates = [found[f"{name}.{part}"][row] for part in RATES]
            state.q[7 * k : 7 * k + 7], state.u[6 * k : 6 * k + 6] = pose, rates
        state.evaluate("motion", 0.0)
        by_velocity = state.matrix("motion", "inertia") @ state.u + system.mass * state.u
        for k, name in enumerate(system.bodies):
            if ".modes" not in name:
                p, spin = by_velocity[6 * k : 6 * k + 3], by_velocity[6 * k + 3 : 6 * k + 6]
                total += np.cross(state.q[7 * k : 7 * k + 3], p) + rotated(state.q[7 * k + 3 : 7 * k + 7], spin)
        momenta.append(total)
    return np.array(momenta)


def test_free_flight_of_a_bent_bow_keeps_energy_and_angular_momentum(folder):
    model = scene(folder, BOW, BODY + SPIN, run__presolve="false", run__rtol="1e-11")
    found = run(model)
    total = found["energy.total"]
    assert np.ptp(found["energy.potential"]) > 1e-4 * total[0]
    assert np.ptp(total) < 1e-9 * total[0]
    momentum = angular_momentum(model, found)
    assert np.abs(momentum - momentum[0]).max() < 1e-9 * np.abs(momentum).max()


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_solvers_agree(folder, solver):
    expected, found = (run(scene(folder, BOW, BODY + SPIN, run__solver=each)) for each in ("radau", solver))
    for axis in "xyz":
        np.testing.assert_allclose(found[f"bar.b.{axis}"], expected[f"bar.b.{axis}"], atol=1e-7)


@pytest.mark.long
def test_a_turned_mesh_moves_as_before(folder):
    """The mesh with other axes and another origin, placed as before."""
    expected = run(scene(folder, BOW, BODY + SPIN, run__rtol="1e-10"))
    mesh = meshio.read(folder / "bar.vtu")
    meshio.Mesh(mesh.points[:, [2, 0, 1]] + [100, 200, 300], mesh.cells).write(folder / "turned.vtu")
    body = (BODY + SPIN).replace("bar.vtu", "turned.vtu").replace("normal: [1, 0, 0]", "normal: [0, 1, 0]")
    body = body.replace("point: [0, 0, 0]", "point: [0, 200 mm, 0]").replace("[400 mm, 0, 0]", "[0, 600 mm, 0]")
    body = body.replace("omega: [30, 50, 200]", "omega: [200, 30, 50]")
    placed = "    orientation: {x: [0, 0, 1], z: [0, 1, 0]}\n    position: [-200 mm, -300 mm, -100 mm]\n"
    bow = BOW.replace("point: [0, 0, 5 mm]", "point: [5 mm, 0, 0]")
    found = run(scene(folder, bow, body + placed, run__rtol="1e-10"))
    for axis in "xyz":
        np.testing.assert_allclose(found[f"bar.b.{axis}"], expected[f"bar.b.{axis}"], atol=1e-9)


@pytest.mark.long
def test_notes_without_stiffening_have_the_number(folder):
    """Twice the static force, as the string pulls suddenly: half of Euler's load of the free bar."""
    found = [
        next(note for note in run(scene(folder, BOW, BODY + SPIN, **changes)).notes if "change the stiffness" in note)
        for changes in ({}, {"bodies__bar__stiffening": "false"})
    ]
    assert found[0].endswith("is included") and found[1].endswith("is not included (stiffening: false)")
    with_it, without = (float(note.split(" by ")[1].split(" %")[0]) for note in found)
    assert with_it == pytest.approx(-50, abs=6) and without == pytest.approx(with_it, abs=6)


def test_an_equilibrium_has_the_note(folder):
    """The static force of half of Euler's load, an eighth of that of the free bar."""
    force = f"forces: {{P: {{type: force, i: bar.b, force: [{-EULER / 2}, 0, 0]}}}}\n"
    (note,) = equilibrium(scene(folder, CLAMP + force + RUN)).notes
    assert float(note.split(" by ")[1].split(" %")[0]) == pytest.approx(-12.5, abs=0.5)


def test_a_load_beyond_buckling_is_noted(folder):
    """Five times Euler's load of the clamped column is more than that of the free bar, which is four times it."""
    force = f"forces: {{P: {{type: force, i: bar.b, force: [{-5 * EULER}, 0, 0]}}}}\n"
    notes = run(scene(folder, CLAMP + force + RUN, run__duration="1 ms")).notes
    assert any("buckles, outside the second-order theory: use a body of type: beam" in note for note in notes)


@pytest.mark.long
@pytest.mark.parametrize("presolve", ["true", "false"])
def test_a_column_buckles_out_of_the_plane_of_its_loads(folder, presolve):
    """A guide holds the end in the weaker direction; in the other one a tiny start grows at the rate of the beam."""
    bending_stiffness = E * HEIGHT * WIDTH**3 / 12
    load = 2 * np.pi**2 * bending_stiffness / (4 * LENGTH**2)
    rate = np.sqrt(-lowest_eigenvalue(bending_stiffness, lambda x: -load + 0 * x))
    guide = "  guide: {type: point_on_plane, i: bar.b, j: {body: ground, point: [0, 15 mm, 10 mm]}}\n"
    rest = f"forces: {{P: {{type: force, i: bar.b, force: [{-load}, 0, 0]}}}}\n"
    rest += "at_start: {push: {type: drive, coordinate: bar.modes1.y, position: 1e-11}}\n"
    rest += f"run: {{duration: {20 / rate}, points: 41, rtol: 1e-8, solver: radau, presolve: {presolve}}}\n"
    found = run(scene(folder, CLAMP + guide + rest))
    deflection = np.abs(found["bar.b.y"] - 0.015)
    assert np.log(deflection[-1] / deflection[-11]) / (5 / rate) == pytest.approx(rate, rel=2e-2)


@pytest.mark.long
def test_the_note_on_a_mesh_with_one_interface_does_not_miss_a_mesh(folder):
    """One interface has no static shapes; the stiffness by rotation is there."""
    one = BODY.replace("      b: {plane: {point: [400 mm, 0, 0], normal: [1, 0, 0]}}\n", "")
    found = run(scene(folder, "joints: {}\n" + RUN, one + "    omega: [0, 0, 1000]\n"))
    (note,) = (note for note in found.notes if "stiffness" in note)
    assert note.endswith("this geometric stiffness is included")


@pytest.mark.long
def test_a_large_deflection_is_noted(folder):
    force = "forces: {P: {type: force, i: bar.b, force: [0, 0, F]}}\nrun: {duration: 0.1, points: 11, solver: radau}\n"
    damped = BODY + "    damping: 1\n"
    small, large = (
        run(scene(folder, CLAMP + force.replace("F", f"{part * 3 * EI / LENGTH**2}"), damped)) for part in (0.05, 0.25)
    )
    assert not any("deforms by up to" in note for note in small.notes)
    assert any("'bar' deforms by up to" in note for note in large.notes)


def test_stiffening_of_matrices_is_refused(folder):
    body = "\n    type: flexible\n    matrices: bar.npz\n    units: {length: 1 m}\n    stiffening: true\n"
    with pytest.raises(InputError, match="found stiffening: true with matrices, expected a mesh"):
        scene(folder, "joints: {}\n", body)
