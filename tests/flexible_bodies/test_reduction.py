"""The reduction keeps mass and rigid motions, agrees with the reference bar, and converges from above."""

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.finite_elements import FiniteElements
from stiffmbs.flexible_bodies.interfaces import Interface
from stiffmbs.flexible_bodies.matrices import from_archive
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import reduce

from .bars import HEIGHT, LENGTH, MASS, NU, REFERENCES, STEEL, WIDTH, E, bar, face, mesh_of_bar

REFERENCE_BAR = REFERENCES / "a_bar_hex20.npz"
with_references = pytest.mark.skipif(not REFERENCE_BAR.exists(), reason="without the reference data")
FREE = {
    0: "190.3619 316.1435 645.0386 1066.9869 1446.5872 2845.2223",
    5: "159.1054 264.6019 438.1271 719.1489 852.7999 1446.5872 2331.5407 2525.7062 2845.2223 3954.5828",
    20: "159.0391 263.5550 436.2237 715.5088 849.4679 1319.5565 1375.0379 1391.7540 2059.0749 2214.2318",
}
HELD = {
    0: "25.29869 42.08149 247.3658 409.8983 728.6272 1427.3016",
    5: "25.18041 41.88130 157.2752 259.8524 438.4132 717.3635 728.6272 853.4004 1427.3016 2855.4648",
    20: "25.18000 41.87849 157.2174 259.5366 437.7311 662.5596 714.4155 851.0426 1297.1346 1367.6897",
}
FIXED = "160.2989 263.8391 438.8570 712.5419 852.7278 1331.8452 1361.0748 1394.3970 2057.0912 2181.9740"
MESH = "159.0333 263.5150 436.1615 715.1389 848.9206 1318.1775 1371.8774 1390.4389 2054.4463 2207.4770"


def _numbers(text):
    return np.array(text.split(), dtype=float)


def _reference_bar():
    model = from_archive(REFERENCE_BAR.read_bytes(), 1.0, 1.0, 1.0)
    ends = [
        Interface(name, "rigid", nodes, model.nodes[nodes].mean(axis=0))
        for name, nodes in (("a", model.groups["ifA"]), ("b", model.groups["ifB"]))
    ]
    return model, ends


@with_references
@pytest.mark.parametrize("count", FREE)
def test_frequencies_of_the_reference_bar(count):
    model, ends = _reference_bar()
    body = reduce(model, ends, count)
    np.testing.assert_allclose(body.frequencies[:10], _numbers(FREE[count])[: len(body.frequencies)], rtol=1e-6)
    held = body.held_frequencies([0])[:10]
    np.testing.assert_allclose(held, _numbers(HELD[count])[: len(held)], rtol=1e-6)
    assert body.mass == pytest.approx(11.775, rel=1e-12)
    assert body.rigid_frequencies.max() < 0.01
    assert (body.frequencies[: min(count, 10)] >= _numbers(MESH)[: min(count, 10)]).all()
    if count >= 10:
        np.testing.assert_allclose(body.fixed_frequencies[:10], _numbers(FIXED), rtol=1e-6)


@with_references
def test_without_interfaces_the_modes_are_those_of_the_free_mesh():
    model, _ = _reference_bar()
    np.testing.assert_allclose(reduce(model, [], 12).frequencies[:10], _numbers(MESH), rtol=1e-6)


@with_references
def test_frequencies_of_the_reference_body_with_six_points():
    model = from_archive((REFERENCES / "g_body.npz").read_bytes(), 1.0, 1.0, 1.0)
    points = [Interface(f"p{k}", "point", np.array([k]), model.nodes[k]) for k in model.groups["interface_nodes"]]
    body = reduce(model, points, 60)
    np.testing.assert_allclose(body.frequencies[:5], [108.7735, 156.8278, 334.2178, 363.2246, 364.2162], rtol=2e-5)
    assert body.mass == pytest.approx(5.544, rel=1e-9)


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return bar(tmp_path_factory.mktemp("bar"))


@pytest.mark.parametrize("kind", ["rigid", "average"])
def test_mass_centre_and_inertia_are_those_of_the_cuboid(model, kind):
    body = reduce(model, [face(model, 0.0, "a", kind), face(model, LENGTH, "b", kind)], 5)
    assert body.mass == pytest.approx(MASS, rel=1e-10)
    np.testing.assert_allclose(body.centre, [LENGTH / 2, WIDTH / 2, HEIGHT / 2], rtol=1e-9)
    squares = np.array([LENGTH, WIDTH, HEIGHT]) ** 2
    np.testing.assert_allclose(body.inertia, np.diag(MASS / 12 * (squares.sum() - squares)), atol=1e-12)


@pytest.mark.parametrize("kind", ["rigid", "average"])
def test_modes_are_orthonormal_and_free_of_rigid_motion(model, kind):
    body = reduce(model, [face(model, 0.0, "a", kind), face(model, LENGTH, "b", kind)], 5)
    by_mass = model.mass @ body.modes
    np.testing.assert_allclose(body.modes.T @ by_mass, np.eye(len(body.frequencies)), atol=1e-8)
    np.testing.assert_allclose(model.rigid_modes(body.centre).T @ by_mass, 0.0, atol=1e-9)
    stiffness = body.modes.T @ (model.stiffness @ body.modes)
    squares = (2 * np.pi * body.frequencies) ** 2
    np.testing.assert_allclose(stiffness, np.diag(squares), atol=1e-7 * squares.max())


def test_a_rigid_interface_moves_rigidly_in_every_mode(model):
    end = face(model, LENGTH, "b")
    body = reduce(model, [face(model, 0.0, "a"), end], 5)
    np.testing.assert_allclose(
        end.rigid(model) @ body.markers[1], body.modes[end.entries(model)], atol=1e-10 * np.abs(body.modes).max()
    )


def test_an_average_interface_is_softer_than_a_rigid_one(model):
    rigid, average = (
        reduce(model, [face(model, 0.0, "a", kind), face(model, LENGTH, "b", kind)], 10).held_frequencies([0])
        for kind in ("rigid", "average")
    )
    assert (average[:4] < rigid[:4]).all()
    np.testing.assert_allclose(average[:2], rigid[:2], rtol=0.02)


def test_more_modes_lower_the_frequencies(model):
    ends = [face(model, 0.0, "a"), face(model, LENGTH, "b")]
    few, many = (reduce(model, ends, count).frequencies[:10] for count in (4, 16))
    assert (many <= few * (1 + 1e-9)).all()


def test_modes_up_to_a_frequency(model):
    ends = [face(model, 0.0, "a"), face(model, LENGTH, "b")]
    all_modes = reduce(model, ends, 8).fixed_frequencies
    highest = (all_modes[4] + all_modes[5]) / 2
    np.testing.assert_allclose(reduce(model, ends, None, highest).fixed_frequencies, all_modes[:5], rtol=1e-9)


def test_the_frequencies_are_the_same_in_another_frame(model):
    ends = [face(model, 0.0, "a"), face(model, LENGTH, "b")]
    expected = reduce(model, ends, 6)
    turned, _ = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))
    turned *= np.sign(np.linalg.det(turned))
    from scipy.sparse import block_diag, csr_array

    T = csr_array(block_diag([turned] * len(model.nodes)))
    moved = FiniteElements(model.nodes @ turned.T + [3.0, -2.0, 1.0], T @ model.stiffness @ T.T, T @ model.mass @ T.T)
    there = [Interface(end.name, "rigid", end.nodes, moved.nodes[end.nodes].mean(axis=0)) for end in ends]
    found = reduce(moved, there, 6)
    np.testing.assert_allclose(found.frequencies, expected.frequencies, rtol=1e-7)
    np.testing.assert_allclose(found.inertia, turned @ expected.inertia @ turned.T, atol=1e-9)


def test_cantilever_bends_as_a_beam(model):
    """Static tip compliance of a clamped bar: L^3/(3 E I) with shear, and L/(E A) along."""
    body = reduce(model, [face(model, 0.0, "a", "average"), face(model, LENGTH, "b", "average")], 0)
    tip = _compliance(body)
    area, shear = WIDTH * HEIGHT, 5 / 6 * E / (2 * (1 + NU)) * WIDTH * HEIGHT
    beam = [LENGTH / (E * area)]
    beam += [LENGTH**3 / (3 * E * area * side**2 / 12) + LENGTH / shear for side in (WIDTH, HEIGHT)]
    np.testing.assert_allclose(np.diagonal(tip)[:3], beam, rtol=0.01)


def _compliance(body):
    """Return the compliance of interface 1 with interface 0 held."""
    from scipy.linalg import null_space

    rigid = []
    for k in range(2):
        x, y, z = body.points[k] - body.centre
        rigid.append(
            np.block([[np.eye(3), np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])], [np.zeros((3, 3)), np.eye(3)]])
        )
    rows = [np.hstack([rigid[k], body.markers[k]]) for k in range(2)]
    free = null_space(rows[0])
    stiffness = np.diag(np.append(np.zeros(6), (2 * np.pi * body.frequencies) ** 2))
    at_tip = rows[1] @ free
    return at_tip @ np.linalg.solve(free.T @ stiffness @ free, at_tip.T)


@pytest.mark.parametrize(
    ("nodes", "kind", "message"),
    [
        ([], "rigid", "found no node in its selection"),
        ([5], "rigid", "found 1 node, expected three or more"),
        ([0, 1], "point", "found 2 nodes, expected one"),
    ],
)
def test_unusable_interfaces_are_refused(model, nodes, kind, message):
    with pytest.raises(InputError, match=f"interfaces.a: {message}"):
        reduce(model, [Interface("a", kind, np.array(nodes, dtype=int), np.zeros(3))], 2)


def test_nodes_of_two_interfaces_are_refused(model):
    with pytest.raises(InputError, match=r"interfaces.b: found node .* of interface 'a' too"):
        reduce(model, [face(model, 0.0, "a"), face(model, 0.0, "b")], 2)


@pytest.mark.parametrize("residual", [False, True])
def test_residual_modes_contain_the_static_displacement_under_weight_and_angular_acceleration(tmp_path, residual):
    model = bar(tmp_path, "hexahedron", along=6, across=2)
    ends = [face(model, 0.0, "a"), face(model, LENGTH, "b")]
    body = reduce(model, ends, 1, residual=residual)
    free = np.setdiff1d(np.arange(3 * len(model.nodes)), np.concatenate([end.entries(model) for end in ends]))
    rigid = model.rigid_modes(body.centre)
    exact = np.zeros_like(rigid)
    exact[free] = splu(model.stiffness[free][:, free].tocsc()).solve((model.mass @ rigid)[free])
    basis = np.column_stack([rigid, body.modes])
    for displacement in exact.T:
        rest = displacement - basis @ np.linalg.lstsq(basis, displacement)[0]
        assert (np.linalg.norm(rest) < 1e-7 * np.linalg.norm(displacement)) == residual


@pytest.mark.parametrize("size", [1e-5, 1e-3, 0.03])
def test_held_frequencies_scale_with_the_size_of_the_body(tmp_path, size):
    """Frequencies are inverse to the size; held equations mix translations and rotations."""
    mesh_of_bar("tetra10", along=4, across=1).write(tmp_path / "bar.vtu")
    found = []
    for length in (1e-3, 1e-3 * size):
        model = from_mesh(tmp_path / "bar.vtu", length, STEEL)
        nodes = np.flatnonzero(model.nodes[:, 0] <= 1e-9 * np.ptp(model.nodes[:, 0]))
        body = reduce(model, [Interface("root", "rigid", nodes, model.nodes[nodes].mean(axis=0))], 6)
        found.append(body.held_frequencies([0])[:6] * length)
    assert found[1] == pytest.approx(found[0], rel=1e-6)
