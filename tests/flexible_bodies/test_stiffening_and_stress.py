"""Geometric stiffening and stresses, against closed forms, the exact strain energy and an exact beam."""

import json

import meshio
import numpy as np
import pytest
from click.testing import CliRunner
from skfem import MeshHex, MeshHex2
from skfem.io.meshio import to_meshio

from stiffmbs import load_scene
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.run import run
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.reduction import reduce, static_solver
from stiffmbs.flexible_bodies.second_order import displacement_of_second_order, stress_of
from stiffmbs.results.flexible_motion import FlexibleMotion, Quadratic

from .bars import HEIGHT, LENGTH, WIDTH, bar, face, mesh_of_bar

SPIN_UP = "branch(t - 15, 6/15*(t^2/2 + (15/(2*pi))^2*(cos(2*pi*t/15) - 1)), 6*7.5, 6*(t - 7.5))"


def spinning_beam(folder, stiffening):
    """A beam on a hub that is brought to 6 rad/s in 15 s (Kane, Ryan, Banerjee 1987), as a solid of 16 hexahedra."""
    side = np.sqrt(12 * 5e-4)
    across = np.linspace(-side / 2, side / 2, 2)
    to_meshio(MeshHex2.from_mesh(MeshHex.init_tensor(np.linspace(0, 10, 17), across, across))).write(folder / "arm.vtu")
    (folder / "arm.yaml").write_text(f"""
dimensions: 3
bodies:
  arm:
    type: flexible
    mesh: arm.vtu
    units: {{length: 1 m}}
    material: {{E: {2.8e7 / side**2}, nu: 0, density: {1.2 / side**2}}}
    interfaces:
      root: {{plane: {{point: [0, 0, 0], normal: [1, 0, 0]}}}}
      tip: {{plane: {{point: [10, 0, 0], normal: [1, 0, 0]}}}}
    modes: 10
    stiffening: {stiffening}
variables: {{angle: "{SPIN_UP}"}}
joints:
  hub: {{type: revolute, i: arm.root, j: ground}}
  motor: {{type: drive, joint: hub, position: "{SPIN_UP}"}}
requests: {{lag: arm.tip.y*cos(angle) - arm.tip.x*sin(angle)}}
run: {{duration: 7 s, output: 20 ms, rtol: 1e-6, solver: radau}}
""")
    return run(load_scene(folder / "arm.yaml", []))


@pytest.mark.long
def test_a_beam_that_is_spun_up_stiffens(tmp_path):
    """Largest lag of an exact beam: 0.573835 m at 6.762 s, by Richardson extrapolation."""
    found = spinning_beam(tmp_path, "auto")
    assert found["lag"].min() == pytest.approx(-0.573835, rel=1e-3)
    assert found["lag"][round(3 / 0.02)] == pytest.approx(-0.2172674, abs=3e-4)
    assert any("this geometric stiffness is included" in note for note in found.notes)


@pytest.mark.long
def test_without_stiffening_the_beam_softens(tmp_path):
    """The lag keeps growing; after 3 s, with a small lag, it is that of an independent program with linear strains."""
    found = spinning_beam(tmp_path, "false")
    assert found["lag"][round(3 / 0.02)] == pytest.approx(-0.2183, abs=2e-3)
    assert found["lag"][-1] < -0.63
    assert any("not included (stiffening: false)" in note for note in found.notes)


@pytest.mark.parametrize("kind", ["rigid", "average"])
@pytest.mark.parametrize("element", ["tetra10", "hexahedron27"])
def test_the_strain_energy_is_that_of_finite_strains_up_to_the_fourth_order(tmp_path, element, kind):
    """The energy of Green's strain of first and second order displacements, by integration over the mesh."""
    model = bar(tmp_path, element, along=4, across=1)
    interfaces = [face(model, 0.0, "a", kind), face(model, LENGTH, "b", kind)]
    body = reduce(model, interfaces, 3)
    solver, _ = static_solver(model, interfaces, model.rigid_modes(body.centre))
    (block,) = model.solid.blocks
    at, weights = block.gradients()
    q = 1e-3 * np.random.default_rng(0).standard_normal(len(body.frequencies)) / (1 + body.frequencies / 200) ** 2
    terms, stiffness = body.second_order, (2 * np.pi * body.frequencies) ** 2
    of_second_order = displacement_of_second_order(model, stress_of(model), interfaces, solver, body.modes @ q)
    p = q + terms.static @ np.einsum("ikl,k,l->i", terms.stretch, q, q) / 2

    def energy(q, of_second_order):
        G = block.displacement_gradient(at, body.modes @ q + of_second_order)
        strain = (G + G.swapaxes(0, 1) + np.einsum("caep,cbep->abep", G, G)) / 2
        return np.einsum("abep,abep,ep->", block.stress(strain), strain, weights) / 2

    expected, linear = energy(q, of_second_order), stiffness @ q**2 / 2
    assert abs(linear - expected) > 1e-4 * expected
    assert stiffness @ p**2 / 2 == pytest.approx(expected, rel=1e-6)
    by_mass = (model.mass @ of_second_order).reshape(-1, 3)
    np.testing.assert_allclose(by_mass.sum(axis=0), np.einsum("klc,k,l->c", terms.first, q, q) / 2, rtol=1e-6)
    moments = (model.nodes - body.centre).T @ by_mass
    found = np.einsum("klab,k,l->ab", terms.moments, q, q) / 2
    np.testing.assert_allclose(found, moments, atol=1e-9 * np.abs(moments).max())


def test_a_bent_bar_becomes_shorter(tmp_path):
    """Foreshortening of the end: half the integral of the square of the slope, from the mode's own displacements."""
    model = bar(tmp_path, "hexahedron27", along=10, across=1)
    body = reduce(model, [face(model, 0.0, "a"), face(model, LENGTH, "b")], 4)
    axis = np.flatnonzero(np.linalg.norm(model.nodes[:, 1:] - (WIDTH / 2, HEIGHT / 2), axis=1) < 1e-9)
    axis = axis[np.argsort(model.nodes[axis, 0])]
    terms = body.second_order
    for mode in (0, 1):  # along z, then along y
        across = body.modes[:, mode].reshape(-1, 3)[axis]
        slope = np.gradient(across, model.nodes[axis, 0], axis=0, edge_order=2)[:, 1:]
        shorter = np.trapezoid((slope**2).sum(axis=1), model.nodes[axis, 0]) / 2
        q = -terms.static @ terms.stretch[:, mode, mode] / 2
        a, b = body.markers[:, 0] @ q
        assert a - b == pytest.approx(shorter, rel=0.02)


SCENE = """
dimensions: 3
bodies:
  bar:
    type: flexible
    mesh: bar.vtu
    units: {length: 1 mm}
    material: {E: 210 GPa, nu: 0.3, density: 7850 kg/m^3}
    interfaces:
      a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}
      b: {plane: {point: [400 mm, 0, 0], normal: [1, 0, 0]}, type: average}
    modes: 4
    damping: 0.7
joints: {clamp: {type: fixed, i: bar.a, j: {body: ground, point: [0, 15 mm, 10 mm]}}}
forces: {P: {type: force, i: bar.b, force: [0, 100, 0]}}
run: {duration: 300 ms, points: 4, solver: radau, rtol: 1e-6}
"""


@pytest.fixture(scope="module")
def loaded_bar(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loaded")
    mesh_of_bar("tetra10", along=16).write(folder / "bar.vtu")
    (folder / "bar.yaml").write_text(SCENE)
    return folder


@pytest.mark.long
def test_the_stress_of_a_loaded_cantilever(loaded_bar):
    """Stress M y/I, displacement of a node at the end, and energy F u/2."""
    scene = load_scene(loaded_bar / "bar.yaml", [])
    motion = FlexibleMotion(scene, run(scene), "bar")
    nodes = motion.model.nodes
    (edge,) = np.flatnonzero(np.linalg.norm(nodes - (LENGTH / 2, WIDTH, HEIGHT / 2), axis=1) < 1e-9)
    bending = 100 * LENGTH / 2 * (WIDTH / 2) / (HEIGHT * WIDTH**3 / 12)
    xx, *others = motion.stress(slice(-1, None))[0, edge]
    assert xx == pytest.approx(-bending, rel=0.03)
    assert np.abs(others).max() < 0.1 * bending
    assert motion.von_mises(slice(-1, None))[0, edge] == pytest.approx(bending, rel=0.03)
    assert motion.principal(slice(-1, None))[0, edge, 2] == pytest.approx(-bending, rel=0.03)
    end = np.flatnonzero(np.abs(nodes[:, 0] - LENGTH) < 1e-9)
    moved = motion.position(end)[-1].mean(axis=0) - nodes[end].mean(axis=0)
    assert motion.strain_energy()[-1].sum() == pytest.approx(100 * moved[1] / 2, rel=1e-3)
    assert moved[1] == pytest.approx(100 * LENGTH**3 / (3 * 2.1e11 * HEIGHT * WIDTH**3 / 12), rel=0.02)


@pytest.mark.long
def test_the_command_reports_peaks_and_writes_the_deformed_mesh(loaded_bar, monkeypatch):
    monkeypatch.chdir(loaded_bar)
    result = CliRunner().invoke(main, ["stresses", "bar.yaml", "bar", "-o", "m.xdmf", "--node", "5", "--json"])
    assert result.exit_code == 0, result.output
    report = json.loads(result.output)
    assert report["stress"]["von Mises"]["value"] > 10e6 and report["displacement"]["5"]["largest"] > 0
    with meshio.xdmf.TimeSeriesReader("m.xdmf") as reader:
        points, cells = reader.read_points_cells()
        t, fields, _ = reader.read_data(reader.num_steps - 1)
    assert t == pytest.approx(0.3) and cells[0].type == "tetra10"
    assert fields["von Mises"].max() > 10e6 and np.abs(fields["moved"]).max() > 1e-4
    assert len(points) == len(fields["moved"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bat"], "found no flexible body 'bat' (did you mean 'bar'?), expected one of bar"),
        (["bar", "-o", "m.vtu"], "-o m.vtu: found the ending '.vtu', expected .xdmf"),
        (["bar", "--node", "99999"], "nodes: found node 99999, expected 0 to"),
    ],
)
def test_mistakes_of_the_command_are_one_sentence(loaded_bar, monkeypatch, arguments, message):
    monkeypatch.chdir(loaded_bar)
    result = CliRunner().invoke(main, ["stresses", "bar.yaml", *arguments])
    assert result.exit_code == 2 and message in result.output and result.output.count("\n") == 1


def test_a_bar_that_bends_by_its_height_has_no_tension(tmp_path):
    """The end is free to move along: both sides have the stress of bending alone, and the mean strain of second order is zero."""
    mesh_of_bar("hexahedron20", along=20, across=2).write(tmp_path / "bar.vtu")
    (tmp_path / "bar.yaml").write_text(SCENE.replace("[0, 100, 0]", "[0, 0, 4 kN]"))
    scene = load_scene(tmp_path / "bar.yaml")
    motion = FlexibleMotion(scene, equilibrium(scene).solution, "bar")
    nodes = motion.model.nodes
    assert np.ptp(motion.position()[0, :, 2]) > 1.9 * HEIGHT
    middle = (np.abs(nodes[:, 0] - LENGTH / 2) < 1e-9) & (np.abs(nodes[:, 1] - WIDTH / 2) < 1e-9)
    below, above = (motion.stress()[0, middle & (np.abs(nodes[:, 2] - z) < 1e-9), 0] for z in (0.0, HEIGHT))
    bending = 6 * 4e3 * LENGTH / 2 / (WIDTH * HEIGHT**2)
    np.testing.assert_allclose([below[0], above[0]], [bending, -bending], rtol=0.02)
    linear = np.tensordot(motion.modal, motion._stress_modes, 1)[0, middle, 0]
    assert abs(linear.mean()) > 0.04 * bending


@pytest.mark.parametrize("times", [2, 1000])
def test_quadratic_functions_do_not_depend_on_the_number_of_times(times):
    """Each by itself, or by products of coordinates."""
    found = Quadratic(lambda u: np.outer(u, u), np.random.default_rng(0).random((3, 4)), times)
    coordinates = np.random.default_rng(1).standard_normal((5, 4))
    displacements = coordinates @ found._modes.T
    assert found(coordinates[:0]).shape == (0, 3, 3)
    np.testing.assert_allclose(found(coordinates), np.einsum("ta,tb->tab", displacements, displacements), rtol=1e-12)
    assert (found._coefficients is None) == (times == 2)


def test_stresses_need_a_mesh(tmp_path):
    from stiffmbs.flexible_bodies.finite_elements import FiniteElements
    from stiffmbs.flexible_bodies.stress import stress_points

    model = bar(tmp_path, along=2, across=1)
    with pytest.raises(InputError, match="found a body described by matrices"):
        stress_points(FiniteElements(model.nodes, model.stiffness, model.mass))


SPINNING = """
dimensions: 3
bodies:
  hub: {mass: 1, inertia: [1, 1, 1], omega: [0, 0, 300]}
  rod:
    type: flexible
    mesh: bar.vtu
    units: {length: 1 mm}
    material: {E: 2.1e11, nu: 0.3, density: 7850}
    interfaces: {root: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}
    modes: MODES
    damping: {stiffness: 1e-3 s}
    omega: [0, 0, 300]
joints:
  pin: {type: revolute, i: hub, j: ground}
  clamp: {type: fixed, i: rod.root, j: hub}
  motor: {type: drive, joint: pin, velocity: 300 rad/s}
run: {duration: 0.02, points: 11, rtol: 1e-5, solver: radau}
"""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("kind", ["tetra10", "tetra"])
def test_modes_that_do_not_carry_a_load_and_elements_of_first_order_are_noted(tmp_path, kind):
    mesh_of_bar(kind, along=8, across=1).write(tmp_path / "bar.vtu")
    shares = []
    for modes in ("4", "4\n    residual_modes: true", "60\n    residual_modes: true"):
        (tmp_path / "scene.yaml").write_text(SPINNING.replace("MODES", modes))
        scene = load_scene(tmp_path / "scene.yaml")
        solution = run(scene)
        shares.append(FlexibleMotion(scene, solution, "rod").unrepresented()[0])
        assert any("elements of first order" in note for note in solution.notes) == (kind == "tetra")
    assert shares[0] > 0.9 and 1e-3 < shares[1] < 0.2 and shares[2] < 1e-2
