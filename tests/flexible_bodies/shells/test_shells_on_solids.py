"""Meshes with solids and shells: bonded skins, welded edges, mass, stresses, loads, and what is refused."""

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.areas import unit_loads
from stiffmbs.flexible_bodies.description import FlexibleBody, Material
from stiffmbs.flexible_bodies.interfaces import Interface
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.mirrored import mirrored
from stiffmbs.flexible_bodies.reduction import reduce, rigid_body
from stiffmbs.flexible_bodies.second_order import stress_of
from stiffmbs.flexible_bodies.shells.welds import welded_nodes
from stiffmbs.flexible_bodies.stress import stress_points

from ..bars import STEEL
from .mixed import block, both, end_moved, plate, written

LENGTH, WIDTH, DEEP = 400.0, 20.0, 20.0
UNCOUPLED = Material(E=2.1e11, nu=0.0, density=7850.0)


def skinned(folder, core, skin, counts=(10, 1, 1)):
    """Return a bar with skins of 1 mm on its faces at the bottom and at the top."""

    def at(z):
        return plate(counts[0], counts[1], lambda a, b: (LENGTH * a, WIDTH * b, z), "quad8")

    parts = {"core": block(counts, (LENGTH, WIDTH, DEEP)), "low": at(0.0), "top": at(DEEP)}
    return both(folder, parts, {"core": core, "low": skin, "top": skin}, {"low": 1e-3, "top": 1e-3})


def joined_bar(folder, material, counts=(20, 4, 4)):
    """Return a bar of 10 mm of which one half are solids and the other one are shells in its middle surface."""
    half = block(counts, (LENGTH / 2, WIDTH, 10.0))
    rest = plate(2 * counts[0], 2 * counts[1], lambda a, b: (LENGTH / 2 * (1 + a), WIDTH * b, 5.0))
    return both(folder, {"half": half, "rest": rest}, material, {"rest": 10e-3})


def held_and_loaded(model):
    x = model.nodes[:, 0]
    return np.flatnonzero(x < 1e-9), np.flatnonzero(x > 0.4 - 1e-9)


@pytest.mark.parametrize(("stiffness", "precision"), [(2.1e11, 0.002), (1e8, 0.002)])
def test_the_deflection_of_a_bar_with_skins_is_that_of_a_sandwich(tmp_path, stiffness, precision):
    """E. Ventsel, T. Krauthammer, Thin plates and shells (2001), sandwich beams. A soft core takes the shear force: the skins have slopes that it has not."""
    core, skin = Material(E=stiffness, nu=0.0, density=100.0), Material(E=7e10, nu=0.0, density=2700.0)
    model = skinned(tmp_path, core, skin, (20, 1, 1))
    assert len(welded_nodes(model.solid, model.shell)) == 0
    bending = stiffness * 0.02**4 / 12 + 2 * 7e10 * (0.02e-3 * 0.01**2 + 0.02e-9 / 12)
    expected = 0.4**3 / (3 * bending) + 0.4 / (stiffness / 2 * 0.02**2)
    assert end_moved(model, *held_and_loaded(model), 2) == pytest.approx(expected, rel=precision)


def test_a_shell_welded_to_the_end_of_a_solid_bends_with_it(tmp_path):
    model = joined_bar(tmp_path, UNCOUPLED)
    welded = welded_nodes(model.solid, model.shell)
    np.testing.assert_allclose(model.nodes[welded, 0], 0.2)
    for component, inertia in ((2, 0.02 * 0.01**3 / 12), (1, 0.01 * 0.02**3 / 12)):
        expected = 0.4**3 / (3 * 2.1e11 * inertia) + 0.4 / (5 / 6 * 2.1e11 / 2 * 2e-4)
        assert end_moved(model, *held_and_loaded(model), component) == pytest.approx(expected, rel=0.015)
    assert end_moved(model, *held_and_loaded(model), 0) == pytest.approx(0.4 / (2.1e11 * 2e-4), rel=0.03)


@pytest.mark.parametrize("counts", [(4, 2, 3), (16, 2, 6)])
def test_a_plate_that_stands_on_a_block_is_clamped_there(tmp_path, counts):
    """Elements of the block are larger than the thickness of 4 mm, or smaller: the moment acts on nodes within this thickness."""
    base = block(counts, (60.0, 20.0, 30.0), (-30.0, 0.0, -30.0))
    wall = plate(10, 4, lambda a, b: (0.0, 20 * b, 200 * a))
    model = both(tmp_path, {"base": base, "wall": wall}, UNCOUPLED, {"wall": 4e-3})
    z = model.nodes[:, 2]
    found = end_moved(model, np.flatnonzero(z < -0.03 + 1e-9), np.flatnonzero(z > 0.2 - 1e-9), 0)
    assert found == pytest.approx(0.2**3 / (3 * 2.1e11 * 0.02 * 0.004**3 / 12), rel=0.006)


@pytest.fixture
def bar(tmp_path):
    return joined_bar(tmp_path, UNCOUPLED, (10, 2, 2))


def clamp(model):
    held, _ = held_and_loaded(model)
    return Interface("root", "rigid", held, model.nodes[held].mean(axis=0))


def test_mass_rigid_motions_and_frequencies_are_those_of_one_bar(bar):
    """The frequencies of a clamped bar: (1.8751 / L)^2 sqrt(E I / (rho A)) upright, and about the other axis."""
    mass, centre, inertia = rigid_body(bar)
    assert mass == pytest.approx(0.4 * 0.02 * 0.01 * 7850)
    np.testing.assert_allclose(centre, [0.2, 0.01, 0.005], atol=1e-9)
    expected = mass / 12 * np.array([0.02**2 + 0.01**2, 0.4**2 + 0.01**2, 0.4**2 + 0.02**2])
    np.testing.assert_allclose(np.diagonal(inertia), expected, rtol=2e-3)
    found = reduce(bar, [clamp(bar)], 4)
    assert found.rigid_frequencies.max() < 1e-3 * found.frequencies[0]
    first = 1.8751041**2 / (2 * np.pi * 0.4**2) * np.sqrt(2.1e11 / 7850 / 12)
    np.testing.assert_allclose(found.fixed_frequencies[:2], first * np.array([0.01, 0.02]), rtol=0.02)


def test_the_stress_of_a_pulled_bar_is_uniform_in_solids_and_shells(bar):
    stretched = np.zeros((len(bar.nodes), 6))
    stretched[:, 0] = 1e-4 * bar.nodes[:, 0]
    points = stress_points(bar)
    found = points.stresses(stretched.reshape(-1, 1))[0]
    np.testing.assert_allclose(found, np.outer(np.ones(len(found)), [2.1e7, 0, 0, 0, 0, 0]), atol=1.0)
    assert np.array_equal(np.unique(points.nodes), np.arange(len(bar.nodes)))
    force = (bar.stiffness @ stretched.ravel()).reshape(-1, 6)
    inner = (bar.nodes[:, 0] > 1e-9) & (bar.nodes[:, 0] < 0.2 - 1e-9)
    np.testing.assert_allclose(
        force[inner], 0, atol=1e-6 * np.abs(force).max()
    )  # springs take no force in a constant strain
    works = stress_of(bar).works(stretched.reshape(-1, 1), np.column_stack([_tilted(bar)]))
    assert works[0, 0, 0] == pytest.approx(2.1e7 * 2e-4 * 0.4)


def _tilted(model):
    """Return a rotation about y: its strain of second order along x is 1/2."""
    return model.rigid_modes(np.zeros(3))[:, 4]


def test_a_mirrored_mesh_has_mirrored_motions(bar):
    image = mirrored(bar, np.array([1.0, -1.0, 1.0]))
    image.check()
    found = reduce(image, [clamp(image)], 2).fixed_frequencies
    np.testing.assert_allclose(found, reduce(bar, [clamp(bar)], 2).fixed_frequencies, rtol=1e-8)


def test_a_skin_takes_the_pressure_in_place_of_the_face_under_it(tmp_path):
    model = skinned(tmp_path, STEEL, STEEL, (4, 1, 1))
    top = np.flatnonzero(model.nodes[:, 2] > 0.02 - 1e-9)
    loads = unit_loads(model, top, np.array([0.0, 0.0, 1.0]), 1.0).reshape(-1, 6, 4)
    np.testing.assert_allclose(loads[:, 2].sum(axis=0), [-0.4 * 0.02, 0, 0, 0.4 * 0.02], atol=1e-12)
    end = np.flatnonzero(model.nodes[:, 0] < 1e-9)
    loads = unit_loads(model, end, None, 1.0).reshape(-1, 6, 4)
    assert loads[:, 0, 0].sum() == pytest.approx(0.02 * 0.02)


def test_surfaces_in_no_group_with_a_thickness_are_faces_of_solids(tmp_path):
    bricks = block((4, 2, 2), (LENGTH, WIDTH, DEEP), kind="hexahedron")
    skins = {
        name: plate(4, 2, lambda a, b, z=z: (LENGTH * a, WIDTH * b, z)) for name, z in (("low", 0.0), ("top", DEEP))
    }
    path = written(tmp_path / "both.inp", {"core": bricks} | skins)
    model = from_mesh(path, 1e-3, STEEL, thickness={"top": 1e-3})
    assert set(np.unique(model.nodes[np.unique(model.shell.triangles), 2])) == {0.02}
    assert len(model.groups["low"]) == 15
    with pytest.raises(
        InputError, match=r"found one thickness for a mesh with solids .hexahedron., expected 'thicknesses' by groups"
    ):
        from_mesh(path, 1e-3, STEEL, thickness=1e-3)
    with pytest.raises(InputError, match=r"thicknesses\.lid: found no group of shell elements 'lid'"):
        from_mesh(path, 1e-3, STEEL, thickness={"lid": 1e-3})


@pytest.mark.parametrize("corner", [(LENGTH, WIDTH, DEEP), (LENGTH + 1, WIDTH, DEEP)])
def test_a_shell_at_a_corner_of_a_solid_is_refused(tmp_path, corner):
    bricks = block((4, 2, 2), (LENGTH, WIDTH, DEEP), kind="hexahedron")
    fin = plate(2, 2, lambda a, b: (corner[0] + 50 * a, corner[1] + 50 * b, corner[2]))
    with pytest.raises(
        InputError, match="found 2 parts that are not connected by faces of elements or edges of shells"
    ):
        both(tmp_path, {"core": bricks, "fin": fin}, STEEL, {"fin": 1e-3})


def test_an_interface_on_an_edge_of_solids_is_refused(tmp_path):
    """Rotations of nodes of solids hold nothing; an edge of a shell may be an interface."""
    model = joined_bar(tmp_path, STEEL, (10, 2, 2))
    x, _, z = model.nodes.T
    edge = np.flatnonzero((x < 1e-9) & (z < 1e-9))
    with pytest.raises(InputError, match="found 5 nodes on one line, expected three or more"):
        reduce(model, [Interface("edge", "rigid", edge, model.nodes[edge].mean(axis=0))], 2)
    edge = np.flatnonzero(x > 0.4 - 1e-9)
    assert reduce(model, [Interface("edge", "rigid", edge, model.nodes[edge].mean(axis=0))], 2).frequencies[0] > 1


def test_a_described_body_with_solids_and_shells(tmp_path):
    written(tmp_path / "both.inp", {
        "half": block((4, 2, 2), (200.0, 20.0, 10.0), kind="hexahedron"),
        "rest": plate(4, 2, lambda a, b: (200 + 200 * a, 20 * b, 5.0)),
    })  # fmt: skip
    body = FlexibleBody.model_validate({
        "mesh": "both.inp", "units": {"length": "1 mm"}, "material": STEEL.model_dump(), "thicknesses": {"rest": "10 mm"},
        "interfaces": {"root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}}, "modes": 3,
    }, context={})  # fmt: skip
    model = body.model(tmp_path)
    assert list(model.cells) == ["hexahedron", "quad"]
    assert rigid_body(model)[0] == pytest.approx(0.4 * 0.02 * 0.01 * 7850)
