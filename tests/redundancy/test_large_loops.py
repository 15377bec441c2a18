"""Loops of hundreds of bodies: their rank by sparse factors is that of singular values."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Marker, Model, Revolute
from stiffmbs.redundancy import loop_rank
from stiffmbs.redundancy import sparse_matrix as entries_module
from stiffmbs.redundancy.sparse_matrix import SparseMatrix
from stiffmbs.tuning import parameters_of


def dense_up_to(monkeypatch, rows):
    """Set the largest number of rows for dense factors."""
    changed = replace(parameters_of(entries_module.MATRICES), dense_up_to=rows)
    monkeypatch.setattr(entries_module, "MATRICES", changed)


@pytest.fixture(params=["dense", "sparse"])
def way(request, monkeypatch):
    dense_up_to(monkeypatch, {"dense": 10**9, "sparse": 0}[request.param])


def matrix(n, m, seed, least=None):
    """A random sparse matrix of more columns than rows, and its entries; with a given least singular value."""
    rng = np.random.default_rng(seed)
    A = np.where(rng.random((n, m)) < 0.3, rng.uniform(-1, 1, (n, m)), 0.0) + np.eye(n, m)
    if least is not None:
        left, values, right = np.linalg.svd(A, full_matrices=False)
        A = left @ np.diag([*values[:-1], least]) @ right
    row, column = np.nonzero(A)
    return A, SparseMatrix(row, column, A[row, column], A.shape)


@pytest.mark.parametrize("seed", range(5))
def test_entries_are_a_matrix(way, seed):
    A, entries = matrix(12, 17, seed)
    rng = np.random.default_rng(seed)
    x, y, kept = rng.random(17), rng.random(12), rng.random(12) < 0.5
    np.testing.assert_array_equal(entries.dense(), A)
    np.testing.assert_allclose(entries.times(x), A @ x)
    np.testing.assert_allclose(entries.transposed_times(y), A.T @ y)
    np.testing.assert_allclose(entries.norms(), np.linalg.norm(A, axis=1))
    np.testing.assert_array_equal(entries.of_rows(kept).dense(), A[kept])
    np.testing.assert_allclose(entries.scaled(y, x).dense(), y[:, None] * A * x)
    np.testing.assert_allclose(entries.solved_gram(0.1, y), np.linalg.solve(A @ A.T + 0.1 * np.eye(12), y))


@pytest.mark.parametrize("least", [0.0, 1e-9, 0.9e-5, 1.1e-5, 1e-3])
@pytest.mark.parametrize("seed", range(5))
def test_singular_values_below_a_bound_are_seen(way, least, seed):
    _, entries = matrix(20, 25, seed, least)
    assert entries.singular_values_above(1e-5) == (least > 1e-5)


def test_more_rows_than_columns_depend_on_each_other(way):
    A, _ = matrix(10, 14, 0)
    row, column = np.nonzero(A.T)
    assert not SparseMatrix(row, column, A.T[row, column], A.T.shape).singular_values_above(1e-5)


def ladder(cells):
    """Two rails of rods with rungs between their hinges."""
    model = Model(gravity=(0, -9.81))
    ends = [Marker(body="ground", point=(0, side)) for side in (0, 1)]
    for k in range(cells):
        rails = [model.add(f"rail{side}_{k}", Body(mass=1, inertia=0.1, position=(k + 0.5, side))) for side in (0, 1)]
        rung = model.add(f"rung{k}", Body(mass=1, inertia=0.1, position=(k + 1, 0.5)))
        for side, rail in enumerate(rails):
            model.add(f"hinge{side}_{k}", Revolute(i=rail.at(-0.5, 0), j=ends[side]))
            model.add(f"pin{side}_{k}", Revolute(i=rung.at(0, side - 0.5), j=rail.at(0.5, 0)))
            ends[side] = rail.at(0.5, 0)
    return model


def test_every_cell_of_a_ladder_leaves_one_freedom():
    """Of 3 cells bodies with 8 cells equations one freedom for each cell is left: two rails and a rung are a four-bar."""
    report = stiffmbs.check(ladder(120))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (960, 960, 120)
    assert report.sound


def test_a_large_ladder_is_examined_as_a_small_one(monkeypatch):
    by_sparse = stiffmbs.check(ladder(50))
    dense_up_to(monkeypatch, 10**9)
    assert stiffmbs.check(ladder(50)) == by_sparse


@pytest.mark.parametrize("redundant", [0, 1, 5])
def test_small_singular_values_alone_are_those_of_the_whole(monkeypatch, redundant):
    """The same null vectors, and the same least value above zero, with the others not computed."""
    rng = np.random.default_rng(redundant)
    A = np.vstack([np.eye(80, 100) + np.where(rng.random((80, 100)) < 0.03, 0.3, 0.0), np.zeros((redundant, 100))])
    for k in range(redundant):
        A[80 + k] = A[2 * k] - A[2 * k + 1]
    A[79] = A[78] + 1e-6 * A[79]
    row, column = np.nonzero(A)
    entries = SparseMatrix(row, column, A[row, column], A.shape)
    whole, whole_vectors = loop_rank.small_singular(entries)
    dense_up_to(monkeypatch, 0)
    values, vectors = loop_rank.small_singular(entries)
    assert (len(values), vectors.shape[1]) == (len(whole), redundant + 1 + loop_rank.REDUNDANCY.more)
    np.testing.assert_allclose(values[-redundant - 1 :], whole[-redundant - 1 :], rtol=1e-6, atol=1e-13)
    null, whole_null = (v[:, v.shape[1] - redundant :] for v in (vectors, whole_vectors))
    np.testing.assert_allclose(null @ null.T, whole_null @ whole_null.T, atol=1e-9)
