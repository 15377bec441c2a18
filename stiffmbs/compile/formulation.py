"""Residuals and matrices as tables of blocks, as in textbooks.

Each line of a residual is a block of the system (M, J, f, ...) times a vector of unknowns or of their derivatives; each
line of a matrix is a block with its rows and columns. A solver needs nothing else (`stiffmbs.compile.equations`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Product(NamedTuple):
    """One line of a residual: in `rows`, factor * block @ operand.

    `rows` and `operand` are names of unknowns (``q u mu lam``, ``x`` for algebraic states, ``s`` for all coordinates after those of bodies). An operand with a prime is
    a derivative; a vector block (``f``, ``C``, ``V``, ``gamma``) has no operand. ``I`` is the identity, ``E`` the
    identity without the rows of algebraic states; ``Z`` maps u to q', ``Z_q`` is d(Z u)/dq; ``E_mu`` and ``E_lam`` are
    the relaxations of the rows. ``.T`` transposes, ``:rates`` keeps nonholonomic rows, ``:turning`` those of
    quaternions.
    """

    rows: str
    factor: float
    block: str
    operand: str | None = None


class Block(NamedTuple):
    """One line of a matrix: in `rows` and `columns`, (constant + cj * cj-part) * block.

    A block of columns q in the columns u is condensed: positions of bodies change by Z u / cj.
    """

    rows: str
    columns: str
    block: str
    constant: float = 1.0
    cj: float = 0.0


class Formulation(NamedTuple):
    """Equations of motion in the form that a solver integrates or solves.

    - `name`: as in the settings of a run.
    - `unknowns`: some of ``q u mu lam x s``.
    - `residual_set`, `matrix_set`: term sets of residual and matrix.
    - `tested`: unknowns under error control.
    - `integrated`: true if the unknowns mu and lam are integrals of the multipliers.
    """

    name: str
    unknowns: tuple[str, ...]
    residual_set: str
    matrix_set: str
    residual: Sequence[Product]
    matrix: Sequence[Block]
    tested: tuple[str, ...] = ("q", "u")
    integrated: bool = False
