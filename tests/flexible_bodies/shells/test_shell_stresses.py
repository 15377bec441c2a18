"""Stresses on both surfaces of shells: closed forms, patches, folds and steps of thickness, and bodies in a run."""

import json
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from stiffmbs import load_scene
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.run import run
from stiffmbs.commands.main import main
from stiffmbs.flexible_bodies.shells.surfaces import surfaces_of
from stiffmbs.flexible_bodies.stress import principal_stresses, von_mises
from stiffmbs.results.flexible_motion import FlexibleMotion
from stiffmbs.show.drawing.deformed import deformed_body

from .meshes import KINDS, places, shell, surface, under
from .published import STRESSES

TURN = Rotation.from_rotvec([0.4, -0.7, 0.3]).as_matrix()
LENGTH, WIDTH, THICK, FORCE = 1.0, 0.2, 0.01, 100.0


def shuffled(cells, seed=0):
    """Return the elements in another order, with other first nodes and normals."""
    random = np.random.default_rng(seed)
    found = {}
    for kind, own in cells.items():
        own = random.permutation(own)
        own = np.array([np.roll(each, random.integers(len(each))) for each in own])
        flipped = random.random(len(own)) < 0.5
        found[kind] = np.where(flipped[:, None], own[:, ::-1], own)
    return found


def stresses(of, displacements):
    """Return points on both surfaces of a shell, and the stresses there of displacements, shape (nodes, 6)."""
    found = surfaces_of(of)
    return found, found.stresses(displacements.reshape(-1, 1))[0]


@pytest.mark.parametrize("kind", KINDS)
def test_bending_of_a_cantilever(kind):
    """6 M / (b t^2), of opposite sign on both surfaces, in any position and order of the elements."""
    nodes, cells, grid = surface(48, 12, lambda a, b: (LENGTH * a, WIDTH * b, 0.0), kind)
    of = shell(nodes @ TURN.T, shuffled(cells), 210e9, 0.0, THICK)
    force = np.zeros((len(nodes), 6))
    force[grid[-1], :3] = np.outer(np.r_[0.5, np.ones(11), 0.5] / 12, FORCE * TURN[:, 2])
    found, stress = stresses(of, under(of.stiffness(), places(grid[0], range(6)), force.ravel()))
    moments = FORCE * (LENGTH - nodes[found.nodes, 0])
    upper = np.sign(found.arms @ TURN[:, 2])
    expected = -upper * 6 * moments / (WIDTH * THICK**2)
    tensors = np.einsum("n,a,b->nab", expected, TURN[:, 0], TURN[:, 0])
    error = stress - np.stack([tensors[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)
    assert np.abs(error).max() < 4e-3 * np.abs(expected).max()
    np.testing.assert_allclose(np.abs(found.arms @ TURN[:, 2]), THICK / 2)
    assert len(found.nodes) == 2 * len(nodes)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", KINDS)
def test_constant_strains_and_curvatures_are_exact(kind, seed):
    """An irregular plate in any position: both surfaces have the strain of the plane and half of the thickness times the curvature."""
    random = np.random.default_rng(seed)
    nodes, cells, grid = surface(4, 4, lambda a, b: (a, b, 0.0), kind)
    nodes[grid[1:-1, 1:-1], :2] += random.uniform(-0.06, 0.06, (3, 3, 2))
    slope, (kx, ky, kxy) = random.standard_normal((2, 2)), random.standard_normal(3)
    x, y, _ = nodes.T
    motion = np.zeros((len(nodes), 6))
    motion[:, :2] = nodes[:, :2] @ slope.T
    motion[:, 2] = -(kx * x**2 + ky * y**2 + kxy * x * y) / 2
    motion[:, 3], motion[:, 4] = -(ky * y + kxy * x / 2), kx * x + kxy * y / 2
    motion[:, 5] = (slope[1, 0] - slope[0, 1]) / 2
    turn = Rotation.random(random_state=seed).as_matrix()
    motion = (motion.reshape(-1, 2, 3) @ turn.T).reshape(-1, 6)
    E, nu, thickness = 2.0, 0.3, 0.02
    found, stress = stresses(shell(nodes @ turn.T, shuffled(cells, seed), E, nu, thickness), motion)
    z = found.arms @ turn[:, 2]
    assert np.sort(z)[[0, -1]] == pytest.approx([-thickness / 2, thickness / 2])
    xx, yy, xy = (
        plane + z * curvature
        for plane, curvature in zip((slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]), (kx, ky, kxy), strict=True)
    )
    tensors = np.zeros((len(z), 3, 3))
    tensors[:, 0, 0], tensors[:, 1, 1] = (E / (1 - nu**2) * each for each in (xx + nu * yy, yy + nu * xx))
    tensors[:, 0, 1] = tensors[:, 1, 0] = E / (2 * (1 + nu)) * xy
    tensors = turn @ tensors @ turn.T
    expected = np.stack([tensors[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)
    np.testing.assert_allclose(stress, expected, atol=1e-9 * np.abs(expected).max())


def test_the_stress_jumps_at_a_step_of_thickness():
    nodes, cells, grid = surface(16, 4, lambda a, b: (LENGTH * a, WIDTH * b, 0.0))
    of = shell(nodes, cells, 210e9, 0.0, THICK)
    thick = nodes[of.triangles, 0].mean(axis=1) < LENGTH / 2
    of.thickness[thick] *= 2
    force = np.zeros((len(nodes), 6))
    force[grid[-1], 2] = np.array([0.5, 1, 1, 1, 0.5]) / 4 * FORCE
    found, stress = stresses(of, under(of.stiffness(), places(grid[0], range(6)), force.ravel()))
    at_step = found.nodes == grid[8, 2]
    bending = 6 * FORCE * LENGTH / 2 / (WIDTH * THICK**2)
    np.testing.assert_allclose(np.sort(stress[at_step, 0]), bending * np.array([-1, -0.25, 0.25, 1]), rtol=0.02)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("angle", [90, 40, 10])
def test_a_fold_has_the_stresses_of_both_sides(angle, kind):
    """An angle under a force along one leg: each leg has its own stress and points along the fold, also in a sharp V."""
    leg = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    nodes, cells, grid = surface(4, 4, lambda a, b: (a, *((0.5 - b, 0.0) if b < 0.5 else (b - 0.5) * leg)), kind)
    motion = np.zeros((len(nodes), 6))
    motion[grid[:, :3], 1] = 1e-3 * nodes[grid[:, :3], 1]  # stretches one leg across the fold; the other one is at rest
    found, stress = stresses(shell(nodes, shuffled(cells), 1.0, 0.0, THICK), motion)
    fold = np.isin(found.nodes, grid[:, 2])
    assert fold.sum() == 4 * 5 and (~fold).sum() == 2 * 4 * 5
    np.testing.assert_allclose(np.sort(stress[fold, 1]), np.repeat([0.0, 1e-3], 10), atol=1e-12)


def test_a_junction_has_the_stresses_of_each_plate():
    """A plate with a web under its middle: the stretch of one half is neither in the other half nor in the web."""
    nodes, cells, grid = surface(4, 4, lambda a, b: (a, b - 0.5, 0.0))
    web, _, on_web = surface(4, 2, lambda a, b: (a, 0.0, -b))
    numbers = np.empty(len(web), dtype=int)
    numbers[on_web[:, 0]], numbers[on_web[:, 1:].ravel()] = grid[:, 2], len(nodes) + np.arange(10)
    nodes = np.vstack([nodes, web[on_web[:, 1:].ravel()]])
    of_web = surface(4, 2, lambda a, b: (a, 0.0, -b))[1]["quad"]
    motion = np.zeros((len(nodes), 6))
    motion[grid[:, :3], 1] = 1e-3 * nodes[grid[:, :3], 1]
    cells = shuffled({"quad": np.vstack([cells["quad"], numbers[of_web]])})
    found, stress = stresses(shell(nodes, cells, 1.0, 0.0, THICK), motion)
    junction = np.isin(found.nodes, grid[:, 2])
    np.testing.assert_allclose(np.sort(stress[junction, 1]), np.repeat([0.0, 1e-3], [20, 10]), atol=1e-12)


@pytest.mark.parametrize("half", [10, 30, 60])
def test_the_tip_of_a_cone_has_an_outside(half):
    """Also that of a sharp one, where normals on opposite sides point away from each other."""
    radius, height = np.sin(np.radians(half)), np.cos(np.radians(half))
    around = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    rim = np.column_stack([radius * np.cos(around), radius * np.sin(around), np.full(32, height)])
    cells = {"triangle": np.column_stack([np.zeros(32, dtype=int), 1 + np.arange(32), 1 + (np.arange(32) + 1) % 32])}
    of = shell(np.vstack([np.zeros(3), rim]), shuffled(cells), 1.0, 0.0, THICK)
    found = surfaces_of(of)
    (tip,) = np.unique(np.abs(found.arms[found.nodes == 0] @ [0, 0, 1]).round(12))
    assert len(found.nodes) == 2 * 33 and tip == pytest.approx(THICK / 2)
    for corners, points in zip(of.triangles, found.corners, strict=True):
        normal = np.cross(*(of.places[corners[1:]] - of.places[corners[0]]))
        side = 0 if normal @ (of.places[corners].mean(axis=0) * [1, 1, 0]) > 0 else 1
        assert found.arms[points[list(corners).index(0), side], 2] < 0.0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", STRESSES)
def test_published_stresses(name, kind):
    coarse, fine = (abs(STRESSES[name](kind, n) - 1) for n in (16, 32))
    assert fine < 0.05
    assert fine < 0.65 * coarse


BODY = """
    type: flexible
    mesh: plate.vtu
    units: {length: 1 m}
    material: {E: 210 GPa, nu: 0, density: 7800 kg/m^3}
    thickness: 10 mm
    modes: 4
    stress_colors: true
    interfaces: {a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, b: {plane: {point: [1, 0, 0], normal: [1, 0, 0]}}}
"""
REST = """joints: {clamp: {type: fixed, i: plate.a, j: {body: ground, point: [0, 0.1, 0]}}}
forces: {P: {type: force, i: plate.b, force: [0, 0, 100]}}
run: {duration: 20 ms, points: 11, solver: radau}
"""


@pytest.fixture(scope="module")
def cantilever(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cantilever")
    nodes, cells, _ = surface(16, 4, lambda a, b: (LENGTH * a, WIDTH * b, 0))
    meshio.Mesh(nodes, list(cells.items())).write(folder / "plate.vtu")
    (folder / "scene.yaml").write_text(f"dimensions: 3\nbodies:\n  plate:{BODY}{REST}")
    return folder


def test_a_body_in_equilibrium_has_the_stress_of_a_beam(cantilever):
    scene = load_scene(cantilever / "scene.yaml")
    motion = FlexibleMotion(scene, equilibrium(scene).solution, "plate")
    stress, nodes = motion.stress()[0], motion.stress_nodes
    x = motion.model.nodes[nodes, 0]
    inside = (x > 0.1) & (x < 0.9)
    expected = 6 * FORCE * (LENGTH - x) / (WIDTH * THICK**2)
    np.testing.assert_allclose(np.abs(stress[inside, 0]), expected[inside], rtol=0.02)
    largest = motion.von_mises()[0]
    np.testing.assert_allclose(largest, [von_mises(stress[nodes == k]).max() for k in range(len(largest))])
    assert motion.peaks()["largest principal"].value == pytest.approx(principal_stresses(stress)[:, 0].max())


class Record(dict):
    """Channels with times, and with errors if they are given."""

    def __init__(self, channels, **fields):
        super().__init__(channels)
        vars(self).update(fields)


def test_a_held_strip_has_the_strain_energy_and_the_tension_of_its_stretch(cantilever):
    """Both ends are held, and the middle moves by more than the thickness: most of the strain is of second order."""
    middle = {"m": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}}
    held = [
        ("bodies.plate.interfaces.m", middle["m"]),
        ("forces.P", {"type": "force", "i": "plate.m", "force": [0, 0, "1e5*t*t/1e-4"]}),
    ]
    held += [
        ("joints.other", {"type": "fixed", "i": "plate.b", "j": {"body": "ground", "point": [1, 0.1, 0]}}),
        ("gravity", [0, 0, 0]),
    ]
    scene = load_scene(cantilever / "scene.yaml", held)
    solution = run(scene)
    motion = FlexibleMotion(scene, solution, "plate")
    assert solution["plate.m.z"].max() > THICK
    np.testing.assert_allclose(motion.strain_energy().sum(axis=1), solution["energy.potential"], rtol=1e-6, atol=1e-9)
    place, error = "plate.modes1.x", 1e-9
    peak = motion.peaks()["von Mises"]
    moved = {key: value + error * (key == place) for key, value in solution.items()}
    changed = FlexibleMotion(scene, Record(moved, t=solution.t), "plate").peaks()["von Mises"].value - peak.value
    places = [key for key in solution if ".modes" in key and key[-2:] in (".x", ".y", ".z")]
    errors = {key: SimpleNamespace(over_time=error * (key == place)) for key in places}
    verified = FlexibleMotion(scene, Record(solution, t=solution.t, errors=errors), "plate")
    assert verified.error_of_stress(peak) == pytest.approx(abs(changed), rel=1e-3)


def test_commands_and_pictures_have_the_stresses(cantilever):
    scene, out = load_scene(cantilever / "scene.yaml"), cantilever / "plate.xdmf"
    motion = FlexibleMotion(scene, run(scene), "plate")
    found = CliRunner().invoke(main, ["stresses", str(cantilever / "scene.yaml"), "plate", "-o", str(out), "--json"])
    assert found.exit_code == 0, found.output
    peak = json.loads(found.stdout)["stress"]["von Mises"]
    assert peak["value"] == pytest.approx(motion.von_mises().max(), rel=1e-6)
    assert 0 < peak["error"] < 0.1 * peak["value"]
    with meshio.xdmf.TimeSeriesReader(out) as reader:
        reader.read_points_cells()
        _, fields, _ = reader.read_data(10)
    np.testing.assert_allclose(fields["von Mises"], motion.von_mises()[10], rtol=1e-4, atol=1e3)
    (solid,) = deformed_body("plate.frame", scene.bodies["plate.frame"]).solids
    assert len(solid.vertices) == 2 * 85 and len(solid.faces) == 2 * 64
    colors = np.linalg.norm(sum(of[0] for of in solid.stresses.values()), axis=1)
    assert np.ptp(solid.vertices[:, 2]) == pytest.approx(THICK) and colors.max() > 0.0
    for face in solid.faces:  # outward normals
        corner, one, other = solid.vertices[face[:3]]
        assert np.cross(one - corner, other - corner)[2] * corner[2] > 0.0
