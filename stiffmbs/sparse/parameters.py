"""Choice between dense and sparse matrices."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class MatrixParameters:
    """Choice between dense and sparse matrices in searches for equilibria, their stability, and analyses of redundancy.

    Source: tests/equilibria and tests/redundancy.
    """

    dense_up_to: int = 400
    """Largest number of unknowns, velocities or rows for dense matrices, up to which loading SciPy takes longer."""


MATRICES = tuned("matrices", MatrixParameters())
