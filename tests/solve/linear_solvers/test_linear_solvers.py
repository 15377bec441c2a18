"""Sparse LU and block LU against numpy's dense solution."""

import ctypes

import numpy as np
import pytest

import stiffmbs
from stiffmbs.compile.machine.native.tables import FACTORS
from stiffmbs.compile.machine.routines import Routine
from stiffmbs.solve.linear_solvers.block_lu import MOST_STORED, BlockLU
from stiffmbs.solve.linear_solvers.native.layouts import BLOCK_LU, COORDINATE, MULTIPLIER
from stiffmbs.solve.linear_solvers.sparse_lu import SparseLU
from stiffmbs.sparse.blocks import filled
from stiffmbs.sparse.elimination_order import EliminationOrder

SAME_ADDRESS = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(lambda vector: vector)
"""In place of N_VGetArrayPointer: the vectors here are arrays."""


class Solver:
    """The routines on one pattern, with the memory that IDA would keep for them."""

    def __init__(self, kind, pattern, sizes=(3, 1, 4, 7, 2), kinds=None, parts=1):
        self.columns, self.rows = np.nonzero(pattern.T)
        n = len(pattern)
        order = EliminationOrder(np.arange(n), n * n, n**3)
        kinds = np.full(n, COORDINATE) if kinds is None else kinds
        of_blocks = (nodes_of(n // parts, sizes), kinds, parts) if kind is BlockLU else ()
        self.matrix = kind(n, self.rows, self.columns, order, *of_blocks)
        self.memory = self.matrix.memory(ctypes.cast(SAME_ADDRESS, ctypes.c_void_p).value)
        self.factors, self.arrays = self.memory.factors, self.memory.arrays
        self.solver = np.array([self.memory.content.ctypes.data])

    def counted(self, name):
        """A count of the blocks' solver."""
        return self.memory.content.view(BLOCK_LU.cells)[0][name]

    def solved(self, dense, b):
        self.factors["a"][:] = dense[self.rows, self.columns]
        assert self.matrix.factor.call(self.solver.ctypes.data, 0) == 0
        x = np.full(len(b), np.nan)
        assert self.matrix.solve.call(self.solver.ctypes.data, 0, x.ctypes.data, b.ctypes.data, 0.0) == 0
        return x


def nodes_of(n, sizes):
    """Unknowns in nodes whose sizes repeat."""
    ends = np.cumsum(np.tile(sizes, n))
    return [node for node in np.split(np.arange(n), ends[ends < n]) if len(node)]


def in_blocks(rng, n_blocks, size):
    """A chain of full blocks, some of their entries left out, so that neighbouring columns have most rows in common."""
    n = n_blocks * size
    block = np.arange(n) // size
    near = np.abs(block[:, None] - block) <= 1
    return (near & (rng.uniform(size=(n, n)) < 0.8)) | np.eye(n, dtype=bool)


def scattered(rng, n):
    """Few entries anywhere: much fill."""
    return (rng.uniform(size=(n, n)) < 0.08) | np.eye(n, dtype=bool)


PATTERNS = {
    "one": lambda rng: np.ones((1, 1), dtype=bool),
    "blocks": lambda rng: in_blocks(rng, 6, 5),
    "odd": lambda rng: in_blocks(rng, 5, 3),
    "scattered": lambda rng: scattered(rng, 40),
    "full": lambda rng: np.ones((9, 9), dtype=bool),
}


@pytest.mark.parametrize("kind", [SparseLU, BlockLU])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("pattern", PATTERNS)
def test_solutions_are_those_of_numpy(kind, pattern, seed):
    rng = np.random.default_rng(seed)
    present = PATTERNS[pattern](rng)
    n = len(present)
    solver = Solver(kind, present)
    for round_ in range(4):  # the first seeks pivots, others take them; the last ones need new ones
        dense = np.where(present, rng.uniform(-1, 1, (n, n)), 0.0) + (3.0 if round_ < 2 else 1e-9) * np.eye(n)
        b = rng.uniform(-1, 1, n)
        expected = np.linalg.solve(dense, b)
        limit = 1e-14 * np.linalg.cond(dense) * 1e3
        np.testing.assert_allclose(solver.solved(dense, b), expected, atol=limit * np.max(np.abs(expected)))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("pattern", PATTERNS)
def test_solutions_of_complex_blocks_are_those_of_numpy(pattern, seed):
    """In the last rounds, rows are exchanged within the blocks."""
    rng = np.random.default_rng(seed)
    present = PATTERNS[pattern](rng)
    n = len(present)
    solver = Solver(BlockLU, np.kron(present, np.ones((2, 2), dtype=bool)), parts=2)
    for round_ in range(4):
        real, imaginary = (np.where(present, rng.uniform(-1, 1, (n, n)), 0.0) for _ in range(2))
        dense = real + 1j * imaginary + (3.0 if round_ < 2 else 1e-9) * np.eye(n)
        b = rng.uniform(-1, 1, n) + 1j * rng.uniform(-1, 1, n)
        expected = np.linalg.solve(dense, b)
        limit = 1e-14 * np.linalg.cond(dense) * 1e3
        found = solver.solved(as_real(dense), b.view(float)).view(complex)
        np.testing.assert_allclose(found, expected, atol=limit * np.max(np.abs(expected)))
    assert solver.counted("refused") == 0


def test_a_complex_block_without_a_regular_pivot_is_left_to_pivots():
    dense = np.array([[1.0, 1j, 1.0, 0.0], [1j, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
    solver = Solver(BlockLU, np.ones((8, 8), dtype=bool), sizes=(2,), parts=2)
    b = np.array([1.0, 2.0, 3.0, 4.0j])
    found = solver.solved(as_real(dense), b.view(float)).view(complex)
    np.testing.assert_allclose(found, np.linalg.solve(dense, b), rtol=1e-14)
    assert solver.counted("refused") == 1


def as_real(matrix):
    """The complex matrix as a real one, whose unknowns are pairs of real and imaginary part."""
    return np.kron(matrix.real, np.eye(2)) + np.kron(matrix.imag, np.array([[0.0, -1.0], [1.0, 0.0]]))


def test_blocks_serve_where_pivots_are_good():
    rng = np.random.default_rng(1)
    pattern = in_blocks(rng, 6, 5)
    solver = Solver(BlockLU, pattern)
    for _ in range(5):
        dense = np.where(pattern, rng.uniform(-0.1, 0.1, pattern.shape), 0.0) + np.eye(30)
        x = solver.solved(dense, np.ones(30))
        np.testing.assert_allclose(dense @ x, np.ones(30), rtol=1e-13)
    assert solver.counted("refused") == 0 and solver.counted("setup_pivots") == 0  # and nothing is compiled for pivots


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 8])
def test_blocks_store_at_most_a_multiple_of_the_entries_of_a_triangle(size):
    """The bound, which decides about 32-bit indices, is reached by supernodes of one unknown."""
    nodes = 6
    rows, columns = np.nonzero(np.ones((nodes * size, nodes * size)))
    stored = int(filled(np.split(np.arange(nodes * size), nodes), rows, columns).starts[-1])
    triangle = sum(size * size * (nodes - k) for k in range(nodes))
    assert stored <= MOST_STORED * triangle
    if size == 1:
        assert stored == MOST_STORED * triangle


def test_blocks_that_share_nothing():
    solver = Solver(BlockLU, np.eye(5, dtype=bool), sizes=(1,))
    np.testing.assert_allclose(solver.solved(np.diag([1.0, 2, 3, 4, 5]), np.ones(5)), 1 / np.arange(1.0, 6), rtol=1e-15)


def test_a_block_without_a_regular_pivot_is_left_to_pivots():
    """The first node is singular, in sizes and in zeros; the matrix is not."""
    dense = np.array([[1.0, 1.0, 1.0, 0.0], [1.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
    solver = Solver(BlockLU, np.ones((4, 4), dtype=bool), sizes=(2,))
    b = np.array([1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(solver.solved(dense, b), np.linalg.solve(dense, b), rtol=1e-14)
    assert solver.counted("refused") == 1


def interrupted():
    raise KeyboardInterrupt("found while compiling")


def test_what_keeps_pivots_from_being_compiled_is_told_and_they_are_asked_for_again(monkeypatch):
    dense, b = np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([1.0, 2.0])
    solver = Solver(BlockLU, np.ones((2, 2), dtype=bool), sizes=(1,))
    solver.factors["a"][:] = dense[solver.rows, solver.columns]
    with monkeypatch.context() as patch:
        patch.setattr(Routine, "address", property(lambda routine: interrupted()))
        assert solver.matrix.factor.call(solver.solver.ctypes.data, 0) < 0
    with pytest.raises(KeyboardInterrupt, match="found while compiling"):
        solver.memory.needed.raise_fault()
    solver.memory.needed.raise_fault()  # it is raised once
    np.testing.assert_allclose(solver.solved(dense, b), [2.0, 1.0], rtol=1e-14)
    solver.memory.needed.raise_fault()


@pytest.mark.parametrize("factor", [1.9, 30.0, 1e4])
def test_pivots_that_fade_are_noticed(factor):
    """A pivot shrinks with each factorisation: a trial that served before must not be relied on."""
    solver = Solver(BlockLU, np.ones((3, 3), dtype=bool), sizes=(1,))
    b = np.array([1.0, -2.0, 0.5])
    pivot = 1.0
    while pivot > 1e-25:
        dense = np.array([[pivot, 1.0, 0.3], [1.0, 2.0, 0.2], [0.1, 0.5, 1.0]])
        np.testing.assert_allclose(solver.solved(dense, b), np.linalg.solve(dense, b), rtol=5e-9)
        pivot /= factor
    assert solver.counted("refused") > 0


def test_pivots_that_grow_out_of_a_singular_pose_are_taken_again():
    """Factors with pivots serve for a while after a refusal, those of blocks again afterwards."""
    solver = Solver(BlockLU, np.ones((2, 2), dtype=bool), sizes=(1,))
    b = np.array([1.0, 2.0])
    for pivot in [1e-20, *([1.0] * 40)]:
        dense = np.array([[pivot, 2.0], [-1.0, 1.0]])
        np.testing.assert_allclose(solver.solved(dense, b), np.linalg.solve(dense, b), rtol=1e-13)
    assert solver.counted("refused") == 1 and not solver.counted("pivoted")


def test_a_run_knows_no_pivots_of_earlier_ones():
    """The first matrix leaves pivots in the sparse LU, the second one of a new run needs none."""
    solver, b = Solver(BlockLU, np.ones((2, 2), dtype=bool), sizes=(1,)), np.array([1.0, 2.0])
    solver.solved(np.array([[0.0, 1.0], [1.0, 0.0]]), b)
    factors = solver.memory.arrays["factors"].view(FACTORS.cells)[0]
    assert factors["ready"] == 1
    solver.memory.known["ready"] = 0
    solver.solved(np.eye(2), b)
    assert factors["ready"] == 0


@pytest.mark.parametrize("relaxed", [1e-12, 1e-10, 1e-8])
def test_two_equal_constraints_are_solved_for_by_pivots_of_their_own_block(relaxed):
    """The inverse of their block would leave residuals of the size of the coordinates."""
    dense = np.array(
        [[1e3, 0, 1, 1], [0, 1e-3, 1, 1], [1, 1, -relaxed, 0], [1, 1, 0, -relaxed]], dtype=float
    )  # fmt: skip
    kinds = np.array([COORDINATE, COORDINATE, MULTIPLIER, MULTIPLIER])
    solver = Solver(BlockLU, dense != 0, sizes=(1, 1, 2), kinds=kinds)
    b = dense @ np.array([1.0, -1.0, 3.0, 3.0])
    x = solver.solved(dense, b)
    np.testing.assert_allclose(x[:2], [1.0, -1.0], rtol=1e-9)
    np.testing.assert_allclose(x[2] + x[3], 6.0, rtol=1e-9)
    assert solver.counted("refused") == 0


def test_pivots_are_sought_within_a_block():
    """Without exchanges of rows the first pivot would be zero."""
    dense = np.array([[0.0, 2.0, 1.0, 0.0], [3.0, 1.0, 0.0, 1.0], [1.0, 0.0, 4.0, 0.0], [0.0, 1.0, 0.0, 5.0]])
    solver = Solver(BlockLU, dense != 0, sizes=(2,))
    b = np.array([1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(solver.solved(dense, b), np.linalg.solve(dense, b), rtol=1e-14)
    assert solver.counted("refused") == 0


def on_a_stiff_bushing(rng, soft):
    """A body's block: stiff in all directions but for one along no axis."""
    turn = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    return turn @ np.diag([1.0, 1.0, 1.0, 1.0, 1.0, soft]) @ turn.T


@pytest.mark.parametrize("soft", [1e-7, 1e-9])
def test_blocks_that_are_soft_in_one_direction_leave_little(soft):
    """Bodies one after the other on stiff bushings, each far softer in one direction: such residuals asked for refinement or pivots."""
    rng = np.random.default_rng(3)
    dense, n = np.zeros((30, 30)), 30
    for k in range(0, n, 6):
        stiff = on_a_stiff_bushing(rng, soft)
        dense[k : k + 6, k : k + 6] += stiff
        if k + 6 < n:
            dense[k : k + 6, k + 6 : k + 12] -= stiff
            dense[k + 6 : k + 12, k : k + 6] -= stiff
            dense[k + 6 : k + 12, k + 6 : k + 12] += stiff
    solver = Solver(BlockLU, in_blocks(rng, 5, 6) | (dense != 0), sizes=(6,))
    solver.solved(dense, dense @ rng.uniform(0.5, 1.0, n))
    assert solver.counted("refused") == 0 and solver.counted("refined") == 0


@pytest.mark.parametrize(("name", "blocks"), [("cart_pendulum", False), ("governor", True)])
def test_blocks_are_compiled_for_where_they_save_time(examples, name, blocks):
    solution = stiffmbs.run(examples / f"{name}.yaml", solver="bdf", duration=1e-3)
    assert solution.solver["linear_solver"].startswith("blocks") is blocks
