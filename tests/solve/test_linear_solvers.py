"""Elimination along a fixed order, by entries and by pairs of columns, against numpy's dense solution."""

import ctypes

import numpy as np
import pytest

from stiffmbs.compile.machine.layout import PAIRED_COLUMNS, cells
from stiffmbs.solve.ida.fixed_order import FixedOrder
from stiffmbs.solve.ida.paired_columns import PairedColumns
from stiffmbs.solve.linear.elimination_order import EliminationOrder

SAME_ADDRESS = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(lambda vector: vector)
"""In place of N_VGetArrayPointer: the vectors here are arrays."""


class Solver:
    """The routines on one pattern, with the memory that IDA would keep for them."""

    def __init__(self, kind, pattern):
        self.columns, self.rows = np.nonzero(pattern.T)
        n = len(pattern)
        self.matrix = kind(n, self.rows, self.columns, EliminationOrder(np.arange(n), n * n, n**3))
        self.memory = self.matrix.memory(ctypes.cast(SAME_ADDRESS, ctypes.c_void_p).value)
        self.factors, self.arrays = self.memory.factors, self.memory.arrays
        self.solver = np.array([self.memory.content.ctypes.data])

    def solved(self, dense, b):
        self.factors["a"][:] = dense[self.rows, self.columns]
        assert self.matrix.setup.load()(self.solver.ctypes.data, 0) == 0
        x = np.full(len(b), np.nan)
        assert self.matrix.solve.load()(self.solver.ctypes.data, 0, x.ctypes.data, b.ctypes.data, 0.0) == 0
        return x


def in_blocks(rng, n_blocks, size):
    """A chain of full blocks, some of their entries left out, so that neighbouring columns have most rows in common."""
    n = n_blocks * size
    block = np.arange(n) // size
    near = np.abs(block[:, None] - block) <= 1
    return (near & (rng.uniform(size=(n, n)) < 0.8)) | np.eye(n, dtype=bool)


def scattered(rng, n):
    """Few entries anywhere: hardly any columns that are worth a pair, and much fill."""
    return (rng.uniform(size=(n, n)) < 0.08) | np.eye(n, dtype=bool)


@pytest.mark.parametrize("kind", [FixedOrder, PairedColumns])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("pattern", ["one", "blocks", "odd", "scattered", "full"])
def test_solutions_are_those_of_numpy(kind, pattern, seed):
    rng = np.random.default_rng(seed)
    present = {
        "one": np.ones((1, 1), dtype=bool),
        "blocks": in_blocks(rng, 6, 5),
        "odd": in_blocks(rng, 5, 3),
        "scattered": scattered(rng, 40),
        "full": np.ones((9, 9), dtype=bool),
    }[pattern]
    n = len(present)
    solver = Solver(kind, present)
    for round_ in range(4):  # the first seeks pivots, others take them; the last ones need new ones
        dense = np.where(present, rng.uniform(-1, 1, (n, n)), 0.0) + (3.0 if round_ < 2 else 1e-9) * np.eye(n)
        b = rng.uniform(-1, 1, n)
        expected = np.linalg.solve(dense, b)
        limit = 1e-14 * np.linalg.cond(dense) * 1e3
        np.testing.assert_allclose(solver.solved(dense, b), expected, atol=limit * np.max(np.abs(expected)))


def test_most_columns_of_blocks_are_paired():
    pattern = np.kron(np.eye(4, dtype=bool) | np.eye(4, k=1, dtype=bool) | np.eye(4, k=-1, dtype=bool), np.ones((6, 6)))
    solver = Solver(PairedColumns, pattern > 0)
    n = len(pattern)
    solver.solved(np.where(pattern > 0, 0.1, 0.0) + np.eye(n), np.ones(n))
    entries = solver.factors["l_start"][n] + solver.factors["u_start"][n] - 2 * n
    assert cells(solver.memory.content, PAIRED_COLUMNS)["n_items"] < 0.6 * entries
