"""Residuals and matrices written as tables of blocks, as in the textbook, and compiled to flat lists.

A formulation is a table: each line of the residual is a block of the system (M, J, f, ...) times a vector of
unknowns or of their derivatives, each line of the matrix a block in its rows and columns.  Nothing else is needed
for a solver: the lists made of it here are run by `stiffmbs.compile.native.evaluate`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .layout import EQUATIONS, packed
from .system import System, Term
from .terms import TERM_SETS

ABSENT = -1


@dataclass(frozen=True)
class Product:
    """One line of a residual: in `rows`, factor * block @ operand.

    `rows` and `operand` are names of unknowns (``q u mu lam``); an operand with a prime is a derivative; a vector
    block (``f``, ``C``, ``V``, ``gamma``) has none.  ``I`` is a unit matrix, ``Z`` takes u to q', ``E_mu`` and
    ``E_lam`` are the relaxations of the rows, ``.T`` transposes, ``:rates`` keeps rows without a position form.
    """

    rows: str
    factor: float
    block: str
    operand: str | None = None


@dataclass(frozen=True)
class Block:
    """One line of a matrix: in `rows` and `columns`, (constant + cj * cj-part) * block."""

    rows: str
    columns: str
    block: str
    constant: float = 1.0
    cj: float = 0.0


@dataclass(frozen=True)
class Formulation:
    """Equations of motion in the form that a solver integrates or solves.

    Attributes
    ----------
    unknowns : tuple of str
        Of ``q u mu lam``.
    residual_set, matrix_set : str
        The term sets that residual and matrix are made of.
    residual : sequence of Product
    matrix : sequence of Block
    tested : tuple of str
        Unknowns whose error the integrator controls.
    integrated : bool
        Whether the unknowns mu and lam are integrals of the multipliers, which then are their derivatives.
    """

    name: str
    unknowns: tuple[str, ...]
    residual_set: str
    matrix_set: str
    residual: Sequence[Product]
    matrix: Sequence[Block]
    tested: tuple[str, ...] = ("q", "u")
    integrated: bool = False


class Equations:
    """A formulation of one system, compiled: where each unknown stands, and the lists for residual and matrix.

    Parameters
    ----------
    formulation : Formulation
    system : System
    place : ndarray of int, shape (n,), optional
        Where each unknown of the natural order (kind after kind) stands instead.

    Attributes
    ----------
    n : int
        Number of unknowns.
    at : dict of str to ndarray
        Where each kind of unknown stands in the vector of unknowns, `ABSENT` where it does not: multipliers of
        redundant equations, and mu of equations that have no position form.
    pattern : tuple of ndarrays
        Row and column of each slot of the matrix, by columns.
    """

    def __init__(self, formulation: Formulation, system: System, place: np.ndarray | None = None) -> None:
        self.formulation, self.system = formulation, system
        everything = np.ones
        present = {
            "q": everything(system.n_q, dtype=bool), "u": everything(system.n_u, dtype=bool),
            "mu": system.holonomic & system.active, "lam": system.active,
        }  # fmt: skip
        self.at: dict[str, np.ndarray] = {}
        self.n = 0
        for name in formulation.unknowns:
            self.at[name] = np.where(present[name], self.n + np.cumsum(present[name]) - 1, ABSENT)
            self.n += int(present[name].sum())
        if place is not None:
            self.at = {name: np.where(at == ABSENT, ABSENT, place[at]) for name, at in self.at.items()}
        self._compile_residual()
        self._compile_matrix()

    def _block(self, term_set: str, name: str, rows: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Source, row and column of a block's entries."""
        system = self.system
        base = name.removesuffix(".T")
        constants = system.constants(term_set)
        if base in ("I", "Z"):  # planar: q' = u
            diagonal = np.arange(len(self.at[rows]))
            return np.full(len(diagonal), constants["I"]), diagonal, diagonal
        if base in constants:
            diagonal = np.arange(system.n_u if base == "M" else system.n_c)
            return constants[base] + diagonal, diagonal, diagonal
        base, _, rates_only = base.partition(":")
        term = system.term(term_set, base)
        if rates_only:
            kept = ~system.holonomic[term.row]
            term = Term(term.source[kept], term.row[kept], term.column[kept])
        return (term.source, term.column, term.row) if name.endswith(".T") else (term.source, term.row, term.column)

    def _compile_residual(self) -> None:
        parts: dict[str, list[tuple[np.ndarray, ...]]] = {"plain": [], "y": [], "yp": []}
        for line in self.formulation.residual:
            source, row, column = self._block(self.formulation.residual_set, line.block, line.rows)
            factor = np.full(len(source), line.factor)
            if line.operand is None:
                part, operand = "plain", np.zeros_like(source)
            else:
                part = "yp" if line.operand.endswith("'") else "y"
                operand = self.at[line.operand.rstrip("'")][column]
            line_row = self.at[line.rows][row]
            kept = (line_row != ABSENT) & (operand != ABSENT)
            parts[part].append(tuple(column[kept] for column in (line_row, source, operand, factor)))
        ends = np.cumsum([sum(len(lines[0]) for lines in part) for part in parts.values()])
        self._n_plain, self._n_with_y, self._n_with_yp = (int(end) for end in ends)
        columns = [
            np.concatenate([lines[k] for part in parts.values() for lines in part] or [np.empty(0)]) for k in range(4)
        ]
        self._r_row, self._r_source, self._r_operand = (np.ascontiguousarray(c, dtype=np.int64) for c in columns[:3])
        self._r_factor = np.ascontiguousarray(columns[3], dtype=float)

    def _compile_matrix(self) -> None:
        lines = []
        for line in self.formulation.matrix:
            source, row, column = self._block(self.formulation.matrix_set, line.block, line.rows)
            ones = np.ones(len(source))
            place = (self.at[line.rows][row], self.at[line.columns][column])
            kept = (place[0] != ABSENT) & (place[1] != ABSENT)
            lines.append(tuple(part[kept] for part in (*place, source, line.constant * ones, line.cj * ones)))
        row, column, source, constant, cj = (np.concatenate([line[k] for line in lines]) for k in range(5))
        places, slot = np.unique(column * self.n + row, return_inverse=True)
        self.pattern = (places % self.n, places // self.n)
        self._slot, self._source = slot.astype(np.int64), source.astype(np.int64)
        self._constant, self._cj = constant.astype(float), cj.astype(float)

    @cached_property
    def _index(self) -> dict[str, np.ndarray]:
        empty = np.zeros(1, dtype=np.int64)
        return {f"at_{name}": np.ascontiguousarray(self.at.get(name, empty)) for name in ("q", "u", "mu", "lam")}

    def table(self, slots: np.ndarray | None = None) -> tuple[np.ndarray, list[np.ndarray]]:
        """The table for compiled code, and the arrays that must live as long as it.

        Parameters
        ----------
        slots : ndarray of int, optional
            Where each slot of the pattern stands in the solver's matrix; its own order by default.
        """
        slot = self._slot if slots is None else np.ascontiguousarray(slots[self._slot], dtype=np.int64)
        n_slots = len(self.pattern[0]) if slots is None else int(slots.max()) + 1
        sets = list(TERM_SETS)
        values = {
            "n": self.n, "residual_set": sets.index(self.formulation.residual_set),
            "matrix_set": sets.index(self.formulation.matrix_set),
            "n_plain": self._n_plain, "n_with_y": self._n_with_y, "n_with_yp": self._n_with_yp,
            "r_row": self._r_row, "r_source": self._r_source, "r_operand": self._r_operand, "r_factor": self._r_factor,
            "n_slots": n_slots, "integrated": self.formulation.integrated, "n_entries": len(slot), "m_slot": slot, "m_source": self._source,
            "m_constant": self._constant, "m_cj": self._cj,
            "has_q": "q" in self.at, "has_u": "u" in self.at, "has_mu": "mu" in self.at, "has_lam": "lam" in self.at,
            **self._index,
        }  # fmt: skip
        return packed(EQUATIONS, values), [slot]
