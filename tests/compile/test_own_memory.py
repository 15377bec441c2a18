"""Memory that compiled code asks for: it grows with the factors, is given back, and its lack is told in a sentence."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from stiffmbs.compile.machine import layout
from stiffmbs.compile.machine.layout import packed_with_memory
from stiffmbs.compile.machine.native.tables import FACTORS
from stiffmbs.solve.linear_solvers.sparse_lu import SparseLU
from stiffmbs.sparse.elimination_order import EliminationOrder, factors_of

from ..solve.linear_solvers.test_linear_solvers import Solver, scattered

CAPACITY, L = (list(FACTORS).index(name) for name in ("capacity", "l"))


def without_fill(order, *_):
    """Expects no fill at all."""
    return EliminationOrder(order, 0, 0)


def test_factors_grow_beyond_what_is_expected(monkeypatch):
    monkeypatch.setattr("tests.solve.linear_solvers.test_linear_solvers.EliminationOrder", without_fill)
    rng = np.random.default_rng(0)
    pattern = scattered(rng, 120)
    solver = Solver(SparseLU, pattern)
    dense = np.where(pattern, rng.uniform(-1, 1, pattern.shape), 0.0) + 3 * np.eye(len(pattern))
    b = rng.uniform(-1, 1, len(pattern))
    np.testing.assert_allclose(solver.solved(dense, b), np.linalg.solve(dense, b), atol=1e-10)
    capacity = solver.arrays["factors"][CAPACITY]
    assert max(solver.factors["l_start"][-1], solver.factors["u_start"][-1]) <= capacity
    assert capacity > 2 * len(pattern), "the factors have grown"


def test_memory_is_given_back_with_the_table(monkeypatch):
    freed = []
    monkeypatch.setattr(layout, "RELEASE", lambda at: freed.append(at.value))
    order = EliminationOrder(np.arange(2), 4, 8)
    table = packed_with_memory(FACTORS, factors_of(2, np.array([0, 1]), np.array([0, 1]), order))
    table[L] = 4711
    del table
    assert 4711 in freed


FAILING = """
    import ctypes, sys
    import llvmlite.binding as llvm
    from stiffmbs.compile.machine.native.memory import REALLOCATE

    LIMIT = int(sys.argv[1])
    libc = ctypes.pythonapi.PyMem_RawRealloc
    libc.restype, libc.argtypes = ctypes.c_void_p, (ctypes.c_void_p, ctypes.c_size_t)
    KIND = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
    limited = KIND(lambda at, size: libc(at, size) if size <= LIMIT else None)
    llvm.add_symbol(REALLOCATE, ctypes.cast(limited, ctypes.c_void_p).value)

    import stiffmbs
    from tests.stress.framework import in_plane
    from tests.stress.families.structure.lattices import lattice

    try:
        solution = stiffmbs.run(in_plane(lattice(4, 4)), duration=0.1, points=3)
        print(solution.outcome.name, solution.message)
    except stiffmbs.StiffmbsError as error:
        print(type(error).__name__, error)
"""


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(("limit", "expected"), [(1000, "AssemblyError"), (60_000, "STOPPED"), (10**9, "DONE")])
def test_too_little_memory_is_one_sentence(limit, expected):
    """Too little for the block systems, enough for these but not for the iteration matrix, and enough."""
    command = [sys.executable, "-c", textwrap.dedent(FAILING), str(limit)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(expected)
    assert ("too little memory" in done.stdout) == (expected != "DONE")
    assert "Traceback" not in done.stderr
