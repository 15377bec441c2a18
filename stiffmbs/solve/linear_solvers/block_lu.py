"""Linear solver of IDA: block LU of bodies and joints without pivoting."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from random import Random  # that of NumPy takes longer to import
from typing import Any, ClassVar, Final

import numpy as np

from ...compile.equations import ABSENT, Equations
from ...compile.machine.layout import QUAD, at_a_line, held_once, packed_with_memory
from ...compile.machine.routines import Routine
from ...sparse.block_updates import updates
from ...sparse.blocks import Blocks, filled
from ...sparse.elimination_order import EliminationOrder, nodes_in_order
from ..ida.session import WhenNeeded
from .linear_solver import COSTS, FACTOR_SIGNATURE, SOLVE_SIGNATURE, LinearSolver, Memory
from .native.layouts import BLOCK_LU, COORDINATE, MULTIPLIER, VELOCITY
from .sparse_lu import SparseLU

_MODULE = "stiffmbs.solve.linear_solvers.native.block_lu"
FACTOR, SOLVE = Routine(_MODULE, "setup", FACTOR_SIGNATURE), Routine(_MODULE, "solve", SOLVE_SIGNATURE, unrolled=True)
SEED: Final = 14
"""Seed of the state for the trial of the factors; its entries between 0.5 and 1 expose rounding errors."""
MOST_STORED = 2 * QUAD
"""Upper bound of the numbers stored in the blocks, relative to the entries of a triangle of full blocks: in both panels,
a line of one unknown takes a whole quad."""


@dataclass(frozen=True)
class BlockLU(LinearSolver):
    """Block LU in a fixed order, checked by its residual; `SparseLU` if the residual is too large.

    `nodes`: unknowns of each supernode, in the order of elimination. `kinds` of shape (n,): kind of each unknown.
    `parts`: 2 for a complex matrix, given as a real one of twice the size. Its unknowns 2 k and 2 k + 1 are the parts of
    unknown k of the supernodes.
    """

    factor: ClassVar[Routine] = FACTOR
    solve: ClassVar[Routine] = SOLVE
    kind: ClassVar[str] = "blocks in a fixed order"

    nodes: list[np.ndarray]
    kinds: np.ndarray
    parts: int = 1

    @classmethod
    def of(cls, equations: Equations, order: EliminationOrder) -> BlockLU:
        """Create the solver of a formulation for an elimination order of its bodies and joints."""
        kinds = np.full(equations.n, MULTIPLIER)
        for name, kind in (("q", COORDINATE), ("u", VELOCITY)):
            at = equations.at.get(name, np.empty(0, dtype=np.int64))
            kinds[at[at != ABSENT]] = kind
        return cls(equations.n, *equations.pattern, order, nodes_in_order(equations, order), kinds)

    @property
    def cost(self) -> float:
        """Estimated time of a factorisation with its solutions, ns; infinite if blocks are too many for 32-bit indices."""
        if MOST_STORED * self.order.fill > np.iinfo(np.int32).max:
            return np.inf
        update, entry, unknown, node = COSTS.blocks
        n_nodes, far = len(self.nodes), COSTS.far_node * max(len(self.nodes) - COSTS.cached_nodes, 0)
        return update * self.order.updates + entry * self.order.fill + unknown * self.n + node * n_nodes + far

    @cached_property
    def blocks(self) -> Blocks:
        """Return the nonzero blocks of the factors."""
        return filled(self.nodes, self.rows // self.parts, self.columns // self.parts, self.parts)

    @cached_property
    def _plan(self) -> dict[str, Any]:
        """Return the constant arrays shared by all memories of the solver."""
        blocks = self.blocks
        diagonal = np.flatnonzero((self.rows == self.columns) & (self.kinds[self.rows] == COORDINATE))
        lists = {
            "size": blocks.sizes, "start": blocks.starts, "down_width": blocks.down_width, "right_width": blocks.right_width,
            "node_start": blocks.node_starts, "place": blocks.places, "kind": self.kinds, "diagonal": diagonal,
            **blocks.quads("down", blocks.below), **blocks.quads("right", blocks.right),
        }  # fmt: skip
        return {
            "n": self.n, "parts": self.parts, "pivots": 0, "last_flag": 0, "n_nodes": len(blocks.nodes), "n_diagonal": len(diagonal), "n_lu": int(blocks.starts[-1]),
            **{name: held_once(np.asarray(part, dtype=np.int64)) for name, part in lists.items()},
            **{name: held_once(part) for name, part in updates(blocks).items()},
            "slot": held_once(blocks.slots(self.rows, self.columns)), "state": _any_direction(self.n, SEED),
        }  # fmt: skip

    def memory(self, array_of: int) -> Memory:
        """Return the memory of the compiled routines, given the address of N_VGetArrayPointer."""
        with_pivots = SparseLU(self.n, self.rows, self.columns, self.order).memory(array_of)
        blocks = self.blocks
        widths = [self.parts * right + own for right, own in zip(blocks.right_width, blocks.widths, strict=True)]
        scratch = max([*widths, *blocks.down_width, *(2 * QUAD * size for size in blocks.sizes)])
        arrays = {
            **self._plan, "array_of": array_of, "factors": with_pivots.arrays["factors"],
            "with_pivots": np.array([with_pivots.content.ctypes.data]), "kept": with_pivots,
            "x": at_a_line(blocks.node_starts[-1]), "scratch": at_a_line(scratch),
            "order": np.zeros(max(blocks.sizes), dtype=np.int64),
            "unit": np.eye(QUAD), "above": np.triu(np.ones((QUAD, QUAD)), 1),
            **{name: np.zeros(self.n) for name in ("pivot", "tried", "trial", "product", "terms", "allowed")},
        }  # fmt: skip
        content = packed_with_memory(BLOCK_LU, arrays)
        cells = content.view(BLOCK_LU.cells)[0]
        needed = WhenNeeded(cells, {"setup_pivots": SparseLU.factor, "solve_pivots": SparseLU.solve})
        cells["compile_pivots"] = needed.address
        return Memory(content, arrays, with_pivots.factors, cells, needed)


def _any_direction(n: int, seed: int) -> np.ndarray:
    """Return n numbers of random signs and of sizes from 0.5 to 1, the same for each seed."""
    random = Random(seed)
    return np.array([random.choice((-1.0, 1.0)) * random.uniform(0.5, 1.0) for _ in range(n)])
