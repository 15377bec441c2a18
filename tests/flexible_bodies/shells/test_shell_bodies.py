"""Flexible bodies of shells: rigid motions, mass, interfaces, geometric stiffening, and runs against solids and beams."""

import json

import meshio
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from skfem import MeshHex, MeshHex2
from skfem.io.meshio import to_meshio

from stiffmbs import load_scene
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.run import run
from stiffmbs.commands.main import main
from stiffmbs.flexible_bodies.description import FlexibleBody, Material
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.flexible_bodies.reduction import reduce, rigid_body, static_solver
from stiffmbs.flexible_bodies.second_order import displacement_of_second_order, stress_of
from stiffmbs.flexible_bodies.shells.stress import _Motion
from stiffmbs.show.drawing.deformed import deformed_body

from ..bars import face
from ..test_geometric_stiffness import lowest_eigenvalue
from .meshes import KINDS, surface

LENGTH, WIDTH, THICK = 0.4, 0.1, 4e-3
ALUMINIUM = Material(E=7e10, nu=0.3, density=2700.0)
MASS = LENGTH * WIDTH * THICK * ALUMINIUM.density
TURN = Rotation.from_rotvec([0.4, -0.7, 0.3]).as_matrix()
PLACES = {
    "flat": lambda a, b: (LENGTH * a, WIDTH * b, 0),
    "turned": lambda a, b: TURN @ [LENGTH * a, WIDTH * b, 0],
    "folded": lambda a, b: (LENGTH * a, WIDTH * min(b, 0.5), WIDTH * max(b - 0.5, 0)),
    "twisted": lambda a, b: (LENGTH * a, WIDTH * (b - 0.5) * np.cos(a), WIDTH * (b - 0.5) * np.sin(a)),
}


def plate(folder, kind="quad", along=8, across=4, place=PLACES["flat"], thickness=THICK):
    """Return the model of a plate along x, from its file in mm, and its nodes by rows and columns."""
    nodes, cells, grid = surface(along, across, lambda a, b: 1000 * np.array(place(a, b)), kind)
    meshio.Mesh(nodes, list(cells.items())).write(folder / "plate.vtu")
    model = from_mesh(folder / "plate.vtu", 1e-3, ALUMINIUM, thickness=thickness)
    model.check()
    return model, grid


@pytest.mark.parametrize("kind", KINDS)
def test_mass_centre_and_inertia_are_those_of_a_block(tmp_path, kind):
    """With the thickness, by rotary inertia."""
    turn = TURN @ np.diag([1.0, 1.0, 0.0])
    model, _ = plate(tmp_path, kind, place=lambda a, b: turn @ [LENGTH * a, WIDTH * b, 0] + [1, 2, 3])
    mass, centre, inertia = rigid_body(model)
    assert mass == pytest.approx(MASS, rel=1e-12)
    np.testing.assert_allclose(centre, TURN @ [LENGTH / 2, WIDTH / 2, 0] + [1, 2, 3], rtol=1e-12)
    squares = np.array([LENGTH, WIDTH, THICK]) ** 2
    expected = TURN @ np.diag(MASS / 12 * (squares.sum() - squares)) @ TURN.T
    np.testing.assert_allclose(inertia, expected, atol=1e-9 * inertia.max())


@pytest.mark.parametrize("kind", KINDS)
def test_inertia_of_a_tube_is_that_of_a_hollow_cylinder(tmp_path, kind):
    """Of 48 facets, whose mean square of the radius is 0.3 % smaller."""
    radius, length, thick = 0.05, 0.2, 0.002

    def place(a, b):
        return radius * np.cos(2 * np.pi * b), radius * np.sin(2 * np.pi * b), length * a

    nodes, cells, grid = surface(2, 48, lambda a, b: 1000 * np.array(place(a, b)), kind)
    same = np.arange(len(nodes))
    same[grid[:, -1]] = grid[:, 0]
    meshio.Mesh(nodes, [(name, same[own]) for name, own in cells.items()]).write(tmp_path / "tube.vtu")
    mass, _, inertia = rigid_body(from_mesh(tmp_path / "tube.vtu", 1e-3, ALUMINIUM, thickness=thick))
    assert mass == pytest.approx(2 * np.pi * radius * thick * length * 2700, rel=2e-3)
    squares = 2 * (radius**2 + thick**2 / 4)  # of inner and outer radius
    along = mass / 2 * squares
    np.testing.assert_allclose(np.diagonal(inertia), [along / 2 + mass * length**2 / 12] * 2 + [along], rtol=4e-3)


INTERFACES = {
    "free": {},
    "rigid node": {"a": {"nodes": [7]}},
    "points": {"a": {"nodes": [0], "type": "point"}, "b": {"nodes": [44], "type": "point"}},
    "point and rigid": {"a": {"nodes": [0], "type": "point"}, "b": {"nodes": [40]}},
    "average": {"a": {"nodes": [0, 1, 5, 6], "type": "average", "weights": "area"}, "b": {"nodes": [44]}},
}


@pytest.mark.parametrize("name", INTERFACES)
def test_a_reduction_with_all_modes_has_the_frequencies_of_the_mesh(tmp_path, name):
    """Six rigid modes at zero; the reduction itself loses nothing, whatever holds the body."""
    model, _ = plate(tmp_path)
    body = FlexibleBody.model_validate(
        {"mesh": "plate.vtu", "units": {"length": 1e-3}, "material": ALUMINIUM.model_dump(), "thickness": THICK,
         "interfaces": INTERFACES[name], "modes": 40}
    )  # fmt: skip
    interfaces = body.interfaces_on(model)
    found = reduce(model, interfaces, 40)
    flexible = np.flatnonzero(model.mass.diagonal() > 0)
    rest = np.setdiff1d(np.arange(model.size), flexible)  # rotations about the normal, without mass
    K, M = model.stiffness.toarray(), model.mass.toarray()[np.ix_(flexible, flexible)]
    own = K[np.ix_(flexible, flexible)] - K[np.ix_(flexible, rest)] @ np.linalg.solve(
        K[np.ix_(rest, rest)], K[np.ix_(rest, flexible)]
    )
    expected = np.sqrt(np.abs(eigh(own, M, eigvals_only=True, subset_by_index=[0, 11]))) / (2 * np.pi)
    assert max(found.rigid_frequencies.max(), expected[:6].max()) < 2e-5 * found.frequencies[0]
    np.testing.assert_allclose(found.frequencies[:6], expected[6:], rtol=5e-5)
    assert found.nodes == 45 and found.displacements.shape == (45, 3, len(found.frequencies))


def test_an_edge_holds_a_cantilever(tmp_path):
    """Leissa (1973) for a length of twice the width: 3.4408 at nu = 0.3, and the clamped rotations of a single rigid node."""
    model, _ = plate(tmp_path, along=16, across=8, place=lambda a, b: (0.2 * a, 0.1 * b, 0), thickness=5e-4)
    body = reduce(model, [face(model, 0.0, "root")], 5)
    D = ALUMINIUM.E * 5e-4**3 / (12 * (1 - 0.09))
    first = 3.4408 / 0.2**2 * np.sqrt(D / (2700 * 5e-4)) / (2 * np.pi)
    assert body.held_frequencies([0])[0] == pytest.approx(first, rel=5e-3)
    assert body.fixed_frequencies[0] == pytest.approx(body.held_frequencies([0])[0], rel=1e-6)


@pytest.mark.parametrize("place", PLACES)
def test_a_turn_of_the_held_edge_has_no_strain_of_second_order(tmp_path, place):
    model, grid = plate(tmp_path, place=PLACES[place])
    interface = face(model, 0.0, "root")
    interface = type(interface)("root", "rigid", grid[0], model.nodes[grid[0]].mean(axis=0))
    solver, _ = static_solver(model, [interface], model.rigid_modes(model.nodes.mean(axis=0)))
    turn = np.array([0.3, -0.5, 0.4])
    displacement = model.rigid_modes(interface.point)[:, 3:] @ turn
    found = displacement_of_second_order(model, stress_of(model), [interface], solver, displacement).reshape(-1, 6)
    expected = np.cross(turn, np.cross(turn, model.nodes - interface.point)) / 2
    np.testing.assert_allclose(found[:, :3], expected, atol=1e-8 * np.abs(expected).max())
    np.testing.assert_allclose(found[:, 3:], 0.0, atol=1e-7)


@pytest.mark.parametrize("kind", ["rigid", "average"])
@pytest.mark.parametrize("place", PLACES)
def test_the_strain_energy_is_that_of_second_order_strains_up_to_the_fourth_order(tmp_path, place, kind):
    model, grid = plate(tmp_path, place=PLACES[place], along=6)
    ends = [np.concatenate(grid[:2]), np.concatenate(grid[-2:])]
    interfaces = [
        type(face(model, 0.0, "a"))(name, kind, nodes, model.nodes[nodes].mean(axis=0))
        for name, nodes in zip("ab", ends, strict=True)
    ]
    body = reduce(model, interfaces, 3)
    solver, _ = static_solver(model, interfaces, model.rigid_modes(body.centre))
    q = 1e-4 * np.random.default_rng(0).standard_normal(len(body.frequencies)) / (1 + body.frequencies / 200) ** 2
    terms, stiffness, stress = body.second_order, (2 * np.pi * body.frequencies) ** 2, stress_of(model)
    first = body.modes @ q
    second = displacement_of_second_order(model, stress, interfaces, solver, first)
    expected = 0.0
    for part in stress.parts():
        strain = _Motion(part, first[:, None]).strain(part)
        strain += np.einsum("tpai,ti->tpa", part.strains, part.components((first + second)[:, None])[..., 0])
        expected += (strain * part.resultants(strain)).sum() / 2
    p = q + terms.static @ np.einsum("ikl,k,l->i", terms.stretch, q, q) / 2
    linear = stiffness @ q**2 / 2
    assert abs(linear - expected) > 1e-5 * expected
    assert stiffness @ p**2 / 2 == pytest.approx(expected, rel=1e-2 * abs(linear / expected - 1))
    by_mass = (model.mass @ second).reshape(-1, 6)[:, :3].sum(axis=0)
    expected_first = np.einsum("klc,k,l->c", terms.first, q, q) / 2
    np.testing.assert_allclose(by_mass, expected_first, atol=1e-6 * np.abs(expected_first).max())


BODY = """
    type: flexible
    mesh: {mesh}.vtu
    units: {{length: 1 mm}}
    material: {{E: 70 GPa, nu: 0.3, density: 2700 kg/m^3}}
    interfaces:
      a: {{plane: {{point: [0, 0, 0], normal: [1, 0, 0]}}, point: [0, 50 mm, 0]}}
      b: {{plane: {{point: [400 mm, 0, 0], normal: [1, 0, 0]}}, point: [400 mm, 50 mm, 0]}}
    modes: 6
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("shells")
    plate(found, along=16)
    axes = [np.linspace(0, 400, 25), np.linspace(0, 100, 7), np.linspace(-2, 2, 2)]
    to_meshio(MeshHex2.from_mesh(MeshHex.init_tensor(*axes))).write(found / "solid.vtu")
    return found


def scene(folder, mesh, body, rest, nu=0.3):
    own = BODY.format(mesh=mesh).replace("nu: 0.3", f"nu: {nu}") + body
    (folder / "scene.yaml").write_text(f"dimensions: 3\nbodies:\n  plate:{own}{rest}")
    return load_scene(folder / "scene.yaml")


SHELL = "    thickness: 4 mm\n"
CLAMP = "joints:\n  clamp: {type: fixed, i: plate.a, j: {body: ground, point: [0, 50 mm, 0]}}\n"


@pytest.mark.parametrize("part", [0.5, 0.8, -2.0])
def test_a_column_under_a_force_at_its_end(folder, part):
    """The change of the square of the frequency, which is zero at Euler's load, is that of a beam."""
    bending = 7e10 * WIDTH * THICK**3 / 12
    euler = np.pi**2 * bending / (4 * LENGTH**2)
    expected = lowest_eigenvalue(bending, lambda x: -part * euler + 0 * x) / lowest_eigenvalue(bending, lambda x: 0 * x)

    def lowest(force):
        loads = f"forces: {{P: {{type: force, i: plate.b, force: [{-force}, 0, 0]}}}}\nrun: {{duration: 1 ms, solver: radau}}\n"
        model = scene(folder, "plate", SHELL, CLAMP + loads, nu=0)
        found = modes(model, start_from=equilibrium(model).solution).modes
        return min(mode.natural_frequency for mode in found) ** 2

    assert lowest(part * euler) / lowest(0.0) == pytest.approx(expected, rel=4e-3)


SPIN = """gravity: [0, 0, -9.81]
joints:
  hub: {type: revolute, i: {body: plate.a, orientation: {z: [0, 1, 0]}}, j: {body: ground, point: [0, 50 mm, 0], orientation: {z: [0, 1, 0]}}}
  motor: {type: drive, joint: hub, velocity: "60*step5(t, 0, 0, 0.2, 1)"}
run: {duration: 0.25, points: 251, rtol: 1e-7, solver: radau}
"""


def lag(folder, mesh, body):
    """Return the displacement of the end across a plate that spins up about its root, shape (times,)."""
    found = run(scene(folder, mesh, body, SPIN))
    angle = 2 * np.unwrap(np.arctan2(found["plate.a.q2"], found["plate.a.q0"]))
    x, z = (found[f"plate.b.{axis}"] - found[f"plate.a.{axis}"] for axis in "xz")
    return np.sin(angle) * x + np.cos(angle) * z


def test_a_plate_spins_up_as_the_same_plate_of_solids(folder):
    """The lag is 16 mm; geometric stiffening changes it by 5 % at this time."""
    expected = lag(folder, "solid", "")
    largest = np.abs(expected).max()
    found, soft = lag(folder, "plate", SHELL), lag(folder, "plate", SHELL + "    stiffening: false\n")
    assert np.abs(found - expected).max() < 0.015 * largest
    assert np.abs(soft - expected).max() > 0.05 * largest


def test_free_flight_keeps_energy_and_momentum(folder):
    """A thick plate, so that rotary inertia takes part, with a string between its ends that bends it."""
    bow = "forces:\n  bow: {type: spring_damper, i: {body: plate.a, point: [0, 0, 5 mm]}, j: plate.b, stiffness: 1e6 N/m, free_length: 0.39995}\n"
    rest = f"joints: {{}}\n{bow}run: {{duration: 5 ms, points: 51, rtol: 1e-9, solver: radau}}\n"
    found = run(
        scene(folder, "plate", "    thickness: 20 mm\n    omega: [30, 50, 200]\n    velocity: [1, 2, 3]\n", rest)
    )
    total = found["energy.total"]
    assert np.ptp(found["energy.potential"]) > 5e-5 * total[0]
    assert np.ptp(total) < 1e-7 * total[0]


def test_thickness_is_a_parameter_of_the_reduction(folder):
    """Twice the thickness has twice the mass and, in bending, nearly twice the frequencies."""
    described = {"mesh": "plate.vtu", "units": {"length": 1e-3}, "material": ALUMINIUM.model_dump(), "modes": 3}
    thin, thick = (reduced_body(FlexibleBody(**described, thickness=t), folder) for t in (1e-3, 2e-3))
    assert thick.mass == pytest.approx(2 * thin.mass, rel=1e-12)
    np.testing.assert_allclose(thick.frequencies / thin.frequencies, 2.0, rtol=2e-3)


def test_pictures_show_the_shells(folder):
    model = scene(folder, "plate", SHELL + "    deformation_scale: 20\n", CLAMP + "run: {duration: 1 ms, points: 2}\n")
    part = deformed_body("plate.frame", model.bodies["plate.frame"])
    (solid,) = part.solids
    assert len(solid.faces) == 64 and len(solid.vertices) == 85


def test_commands_report_and_write_a_body_of_shells(folder):
    (folder / "plate.yaml").write_text(
        "mesh: plate.vtu\nunits: {length: 1 mm}\nmaterial: {E: 70 GPa, nu: 0.3, density: 2700 kg/m^3}\nthickness: 4 mm\nmodes: 2\n"
        "interfaces: {root: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}\n"
    )
    runner, shapes = CliRunner(), folder / "shapes.vtu"
    found = runner.invoke(main, ["flexible", str(folder / "plate.yaml"), "--hold", "root", "-o", str(shapes), "--json"])
    assert found.exit_code == 0, found.output
    report = json.loads(found.stdout)
    assert (report["nodes"], report["messages"]) == (85, [])
    assert report["held_frequencies"]["root held"][0] == pytest.approx(20.89, rel=2e-3)
    written = meshio.read(shapes)
    assert all(field.shape == (85, 3) for field in written.point_data.values())
    scene(folder, "plate", SHELL, CLAMP + "run: {duration: 1 ms, points: 2}\n")
    out = folder / "plate.xdmf"
    found = runner.invoke(main, ["stresses", str(folder / "scene.yaml"), "plate", "--node", "84", "-o", str(out)])
    assert found.exit_code == 0, found.output
    assert "von Mises" in found.output and "node 84" in found.output


def test_a_coarse_dome_has_a_note(tmp_path):
    def dome(a, b):
        x, y = a - 0.5, b - 0.5
        return x, y, np.sqrt(1 - x**2 - y**2)

    model, grid = plate(tmp_path, place=dome, along=6, across=6)
    interface = type(face(model, 0.0, "a"))("root", "rigid", grid[0], model.nodes[grid[0]].mean(axis=0))
    (note,) = reduce(model, [interface], 2).notes
    assert "shells with two curvatures and elements of 2.7 times the root of radius and thickness" in note
    model, _ = plate(tmp_path, along=6, across=6)
    assert reduce(model, [], 2).notes == ()


def test_a_plate_sags_under_its_weight_as_the_mesh_does(folder):
    """Residual modes alone: the weight of the mesh, and its static solution, in a scene."""
    body = SHELL + "    residual_modes: true\n    stiffening: false\n"
    model = scene(
        folder,
        "plate",
        body.replace("modes: 6", "modes: 0"),
        "gravity: [0, 0, -9.81]\n" + CLAMP + "run: {duration: 1 ms, solver: radau}\n",
    )
    found = equilibrium(model).solution
    described, place = model.bodies["plate.frame"].source
    mesh = described.model(place)
    held = mesh.entries(np.flatnonzero(mesh.nodes[:, 0] < 1e-9))
    end = np.flatnonzero(mesh.nodes[:, 0] > LENGTH - 1e-9)
    weight = mesh.inertial_forces(np.array([[0.0], [0.0], [-9.81]]), np.zeros((3, 3, 1)), np.zeros(3))[:, 0]
    interfaces = described.interfaces_on(mesh)
    # the end moves as a rigid body in the reduction: so it does here
    rigid = interfaces[1].rigid(mesh)
    others = np.setdiff1d(np.arange(mesh.size), np.concatenate([held, mesh.entries(end)]))
    basis = np.zeros((mesh.size, len(others) + 6))
    basis[others, np.arange(len(others))] = 1.0
    basis[interfaces[1].entries(mesh), len(others) :] = rigid
    expected = np.linalg.solve(basis.T @ (mesh.stiffness @ basis), basis.T @ weight)[len(others) :]
    assert found["plate.b.z"][-1] == pytest.approx(expected[2], rel=2e-5)
