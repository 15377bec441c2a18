"""Geometric stiffening by displacements of second order, and stresses, against closed forms and an exact beam."""

import json

import meshio
import numpy as np
import pytest
from click.testing import CliRunner
from skfem import MeshHex, MeshHex2
from skfem.io.meshio import to_meshio

from stiffmbs import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.results.flexible_motion import FlexibleMotion

from .bars import HEIGHT, LENGTH, WIDTH, bar, face, mesh_of_bar

SPIN_UP = "branch(t - 15, 6/15*(t^2/2 + (15/(2*pi))^2*(cos(2*pi*t/15) - 1)), 6*7.5, 6*(t - 7.5))"


def spinning_beam(folder, stiffening):
    """A beam on a hub that is brought to 6 rad/s in 15 s (Kane, Ryan, Banerjee 1987), as a solid of 10 hexahedra."""
    side = np.sqrt(12 * 5e-4)
    across = np.linspace(-side / 2, side / 2, 2)
    to_meshio(MeshHex2.from_mesh(MeshHex.init_tensor(np.linspace(0, 10, 11), across, across))).write(folder / "arm.vtu")
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
    found = spinning_beam(tmp_path, "true")
    assert found["lag"].min() == pytest.approx(-0.573835, rel=3e-3)
    assert found["lag"][round(3 / 0.02)] == pytest.approx(-0.2172674, abs=1e-3)
    assert any("included by displacements of second order" in note for note in found.notes)


@pytest.mark.long
def test_without_stiffening_the_beam_softens(tmp_path):
    """The lag keeps growing; after 3 s, with a small lag, it is that of an independent program with linear strains."""
    found = spinning_beam(tmp_path, "false")
    assert found["lag"][round(3 / 0.02)] == pytest.approx(-0.2183, abs=2e-3)
    assert found["lag"][-1] < -0.63
    assert any("not included" in note for note in found.notes)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron27"])
def test_forces_of_second_order_are_derivatives_of_the_cubic_strain_energy(tmp_path, kind):
    """The cubic part of the energy of E = sym G + G^T G/2 is the integral of sigma(G) : G^T G / 2."""
    solid = bar(tmp_path, kind, along=2, across=1).solid
    at, weights = solid.gradients()
    shapes = np.random.default_rng(0).standard_normal((3 * (solid.nodes.max() + 1), 3))

    def cubic(u):
        G = solid.displacement_gradient(at, u)
        return np.einsum("abep,caep,cbep,ep->", solid.stress(G), G, G, weights) / 2

    signs = [(a, b, c) for a in (1, -1) for b in (1, -1) for c in (1, -1)]
    expected = sum(np.prod(sign) * cubic(shapes @ sign) for sign in signs) / 8  # third derivative by polarisation
    found = solid.second_order_forces(shapes)
    assert found[0, 1] @ shapes[:, 2] == pytest.approx(expected, rel=1e-9)


def test_a_bent_bar_becomes_shorter(tmp_path):
    """Foreshortening of the end: half the integral of the square of the slope, from the mode's own displacements."""
    from stiffmbs.flexible_bodies.reduction import reduce

    model = bar(tmp_path, "hexahedron27", along=10, across=1)
    body = reduce(model, [face(model, 0.0, "a"), face(model, LENGTH, "b")], 4, stiffening=True)
    axis = np.flatnonzero(np.linalg.norm(model.nodes[:, 1:] - (WIDTH / 2, HEIGHT / 2), axis=1) < 1e-9)
    axis = axis[np.argsort(model.nodes[axis, 0])]
    for mode in (0, 1):  # along z, then along y
        across = body.modes[:, mode].reshape(-1, 3)[axis]
        slope = np.gradient(across, model.nodes[axis, 0], axis=0, edge_order=2)[:, 1:]
        shorter = np.trapezoid((slope**2).sum(axis=1), model.nodes[axis, 0]) / 2
        a, b = body.second_markers[:, 0, mode, mode] / 2
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
        (["bar", "-o", "m.vtu"], "-o m.vtu: found the type '.vtu', expected .xdmf"),
        (["bar", "--node", "99999"], "nodes: found node 99999, expected 0 to"),
    ],
)
def test_mistakes_of_the_command_are_one_sentence(loaded_bar, monkeypatch, arguments, message):
    monkeypatch.chdir(loaded_bar)
    result = CliRunner().invoke(main, ["stresses", "bar.yaml", *arguments])
    assert result.exit_code == 2 and message in result.output and result.output.count("\n") == 1


def test_stresses_need_a_mesh(tmp_path):
    from stiffmbs.flexible_bodies.finite_elements import FiniteElements
    from stiffmbs.flexible_bodies.stress import nodal_stresses

    model = bar(tmp_path, along=2, across=1)
    with pytest.raises(InputError, match="found a body described by matrices"):
        nodal_stresses(FiniteElements(model.nodes, model.stiffness, model.mass), np.zeros((len(model.nodes) * 3, 1)))
