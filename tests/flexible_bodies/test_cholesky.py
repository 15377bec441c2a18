"""Factors of stiffness matrices, and assembled matrices, against SciPy and scikit-fem."""

import meshio
import numpy as np
import pytest
import skfem
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array, csc_array, eye_array
from scipy.sparse.linalg import eigsh
from scipy.spatial import cKDTree
from skfem.helpers import dot
from skfem.io.meshio import from_meshio
from skfem.models.elasticity import lame_parameters, linear_elasticity

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies import cholesky
from stiffmbs.flexible_bodies.cholesky import Cholesky, dissection
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.shapes import ELEMENTS
from stiffmbs.flexible_bodies.solid import NodePairs

from .bars import DENSITY, HEIGHT, LENGTH, NU, STEEL, WIDTH, E, bar, face, mesh_of_bar


@pytest.mark.long
@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 10**6), count=st.integers(1, 250), neighbours=st.integers(0, 4), flat=st.booleans(),
    part=st.sampled_from([2, 64]),
)  # fmt: skip
def test_solutions_of_random_graphs(seed, count, neighbours, flat, part):
    """Also of graphs in several parts, of edges between distant points."""
    rng = np.random.default_rng(seed)
    points = rng.random((count, 3)) * ([1.0, 0.0, 0.0] if flat else 1.0)
    first, second = rng.integers(0, count, (2, count * neighbours))
    near = np.linalg.norm(points[first] - points[second], axis=1) < rng.choice([0.2, 2.0])
    matrix = _of_edges(first[near], second[near], count, rng)
    right = rng.standard_normal((3 * count, 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cholesky, "LARGEST_PART", part)
        found = Cholesky(matrix, points).solve(right)
    assert found == pytest.approx(np.linalg.solve(matrix.toarray(), right), rel=1e-9, abs=1e-9)


def _of_edges(first, second, count, rng):
    """Return a diagonally dominant matrix with blocks of three rows."""
    blocks = rng.uniform(-1, 1, (len(first), 3, 3))
    rows = 3 * first[:, None, None] + np.arange(3)[:, None] + np.zeros(3, dtype=int)
    columns = 3 * second[:, None, None] + np.arange(3) + np.zeros((3, 1), dtype=int)
    half = csc_array(coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * count,) * 2))
    both = half + half.T
    return csc_array(both + coo_array((1.0 + abs(both).sum(axis=0), (np.arange(3 * count),) * 2)))


def test_every_node_is_eliminated_once_and_separators_separate(tmp_path):
    model = bar(tmp_path, "tetra10", along=20, across=3)
    parts = dissection(csc_array(model.stiffness), model.nodes)
    assert np.array_equal(np.sort(np.concatenate(parts)), np.arange(len(model.nodes)))
    factors = Cholesky(csc_array(model.stiffness + 1e3 * model.mass * (E / DENSITY)), model.nodes)
    largest = max(len(front.later) for front in factors._fronts)
    assert largest <= 3 * 4 * 7 * 7  # four layers of nodes across the bar


@pytest.mark.parametrize("shift", [-1.0, -1e6])
def test_a_matrix_that_is_not_positive_definite_is_refused(tmp_path, shift):
    model = bar(tmp_path, "tetra", along=12, across=2)
    with pytest.raises(np.linalg.LinAlgError):
        Cholesky(csc_array(model.stiffness + shift * model.mass), model.nodes)


ELEMENTS_OF_SCIKIT_FEM = {
    "tetra": (skfem.ElementTetP1, 2), "tetra10": (skfem.ElementTetP2, 4), "hexahedron": (skfem.ElementHex1, 3),
    "hexahedron20": (skfem.ElementHexS2, 5), "hexahedron27": (skfem.ElementHex2, 5),
}  # fmt: skip


@pytest.mark.parametrize("kind", ELEMENTS_OF_SCIKIT_FEM)
def test_assembled_matrices_are_those_of_scikit_fem(tmp_path, kind):
    """On distorted elements; scikit-fem's of 20 nodes have straight edges."""
    mesh = mesh_of_bar(kind, along=2, across=2)
    (cells,) = (block.data for block in mesh.cells)
    x, y, z = (mesh.points / 1000).T
    linear = mesh.points + 1000 * np.column_stack([2 * x * y + 5 * y * z, x * z + 3 * x * y, 2 * x * y])
    if kind == "hexahedron20":
        for k, (a, b) in enumerate(ELEMENTS[kind].middles):
            linear[cells[:, 8 + k]] = (linear[cells[:, a]] + linear[cells[:, b]]) / 2
    mesh.points = linear
    mesh.write(tmp_path / "bar.vtu")
    model = from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
    element, order = ELEMENTS_OF_SCIKIT_FEM[kind]
    corners = cells if kind in ("tetra10", "hexahedron27") else cells[:, : 4 if kind == "tetra" else 8]
    used, inverse = np.unique(corners, return_inverse=True)
    geometry = kind.replace("20", "")
    of_skfem = from_meshio(meshio.Mesh(model.nodes[used], [(geometry, inverse.reshape(corners.shape))]))
    basis = skfem.Basis(of_skfem, skfem.ElementVector(element()), intorder=order)
    place = 3 * cKDTree(model.nodes).query(basis.doflocs.T)[1]
    for component in (1, 2):
        place[np.unique(basis.element_dofs[component::3])] += component

    @skfem.BilinearForm
    def inertia(u, v, _):
        return DENSITY * dot(u, v)

    for form, own in ((linear_elasticity(*lame_parameters(E, NU)), model.stiffness), (inertia, model.mass)):
        other = form.assemble(basis).toarray()
        assert own.toarray()[np.ix_(place, place)] == pytest.approx(other, abs=1e-12 * np.abs(other).max())


@pytest.mark.long
@pytest.mark.parametrize("kinds", [("average", "average"), ("rigid", "average"), ("rigid", "rigid")])
def test_static_modes_minimise_the_strain_energy(tmp_path, kinds):
    """Forces on free nodes are combinations of the functionals of average interfaces."""
    from stiffmbs.flexible_bodies.static_solver import StaticSolver

    model = bar(tmp_path, "tetra10", along=16, across=3)
    interfaces = [face(model, 0.0, "a", kinds[0]), face(model, 0.4, "b", kinds[1])]
    solver = StaticSolver(model, interfaces, np.empty((3 * len(model.nodes), 0)))
    modes = solver.static_modes()
    coordinates = np.vstack([each.mean(model) @ modes[each.entries(model)] for each in interfaces])
    assert coordinates == pytest.approx(np.eye(12), abs=1e-9)
    force = (model.stiffness @ modes)[solver.free]
    rows = solver._held_functionals(np.empty((3 * len(model.nodes), 0)))
    if len(rows):
        force -= rows.T @ np.linalg.lstsq(rows.T, force, rcond=None)[0]
    assert np.abs(force).max() < 1e-9 * np.abs(model.stiffness @ modes).max()


def test_the_stages_of_a_reduction_are_logged(tmp_path, caplog):
    from stiffmbs.flexible_bodies.reduction import reduce

    with caplog.at_level("INFO", logger="stiffmbs.flexible_bodies"):
        model = bar(tmp_path, "tetra10")
        reduce(model, [face(model, 0.0, "a"), face(model, 0.4, "b")], 3)
    assert [record.getMessage() for record in caplog.records] == [
        "reading and assembling the mesh bar.vtu",
        f"factoring the stiffness matrix of {len(model.nodes)} nodes",
        "computing 3 normal modes",
        "computing the geometric stiffening of 9 modes",
    ]


@pytest.mark.parametrize("count", [1, 20, 40])
def test_modes_are_those_of_arpack(tmp_path, count):
    """Eight right-hand sides are solved at once; a square bar has pairs of equal frequencies."""
    from stiffmbs.flexible_bodies.static_solver import StaticSolver

    mesh = mesh_of_bar("tetra10", along=10, across=2)
    mesh.points[:, 1] *= HEIGHT / WIDTH
    mesh.write(tmp_path / "bar.vtu")
    model = from_mesh(tmp_path / "bar.vtu", 1e-3, STEEL)
    solver = StaticSolver(model, [face(model, 0.0, "a")], np.empty((3 * len(model.nodes), 0)))
    widths, solve = set(), solver._factors.solve
    solver._factors.solve = lambda right: widths.add(right.shape[1]) or solve(right)
    squares, shapes = solver.normal_modes(count)
    assert widths == {8}
    free = solver.free
    stiffness, mass = (csc_array(matrix[free][:, free]) for matrix in (model.stiffness, model.mass))
    expected = eigsh(stiffness, count, mass, sigma=0.0, return_eigenvectors=False)
    assert squares == pytest.approx(np.sort(expected), rel=1e-9)
    assert shapes.T @ (model.mass @ shapes) == pytest.approx(np.eye(count), abs=1e-10)
    force = (model.stiffness @ shapes - model.mass @ shapes * squares)[free]
    assert np.abs(force).max() < 1e-7 * np.abs(model.stiffness @ shapes).max()


@pytest.mark.parametrize(("equal", "others"), [(24, np.linspace(2, 1000, 576)), (600, [])])
def test_equal_frequencies_are_all_found(equal, others):
    """As of a hub with many blades: ARPACK with single vectors finds 8 of 24 equal ones and higher ones in their place."""
    from stiffmbs.flexible_bodies.static_solver import _lanczos_modes

    expected = np.append(np.ones(equal), others)
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((600, 600)))[0]
    squares, shapes = _lanczos_modes(
        lambda force: turn @ ((turn.T @ force).T / expected).T, eye_array(600, format="csr"), 30
    )
    assert squares == pytest.approx(expected[:30], rel=1e-11)
    assert shapes.T @ shapes == pytest.approx(np.eye(30), abs=1e-10)


def test_a_body_of_interface_nodes_alone(tmp_path):
    """An element between two rigid faces, whose axial displacement is linear."""
    from stiffmbs.flexible_bodies.reduction import reduce

    model = bar(tmp_path, "hexahedron", along=1, across=1)
    ends = [face(model, 0.0, "a"), face(model, 0.4, "b")]
    body = reduce(model, ends, 0)
    assert len(body.frequencies) == 6
    confined = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))  # the faces keep their size
    axial = np.sqrt(12 * confined / DENSITY) / LENGTH / (2 * np.pi)
    assert np.abs(body.frequencies / axial - 1).min() < 1e-9
    with pytest.raises(InputError, match="modes: found 2, expected 0 or fewer"):
        reduce(model, ends, 2)


@pytest.mark.parametrize(("count", "parts"), [(64, 1), (65, 3)])
def test_nodes_that_are_eliminated_together(count, parts):
    """A chain of one node more has two halves and a separator."""
    line = np.arange(count)
    matrix = _of_edges(line[1:], line[:-1], count, np.random.default_rng(0))
    assert len(dissection(matrix, line[:, None] * [1.0, 0.0, 0.0])) == parts


def test_columns_that_are_added_together():
    """Above the diagonal, the first row changes within the first columns only."""
    target = np.zeros((600, 600), order="F")
    cholesky._add_lower(target, np.arange(600), np.ones((600, 600)))
    assert np.array_equal(np.tril(target), np.tril(np.ones((600, 600))))
    assert np.count_nonzero(target[0]) == 256


def test_elements_whose_matrices_are_computed_together():
    """Ten functions of three components: 900 numbers for each element, 80 MB in all."""
    pairs = NodePairs([np.tile(np.arange(10)[:, None], 20_000)], 10)
    assert [part.stop for part in pairs.parts(0)] == [11_111, 22_222]
