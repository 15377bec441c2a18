"""Degrees of freedom, redundant equations, and reactions without a unique value.

The degrees of freedom are n_u minus the rank of the velocity Jacobian J. Rows of a tree are always independent, so only
loops (`loops`) are examined, each separately (`rank_result`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..compile.state import State
from ..compile.system import System
from .loops import loops

if TYPE_CHECKING:
    from .inconsistent_constraints import LoopRankResult
    from .uniqueness import Indeterminate


class Redundancy(NamedTuple):
    """Result of the examination of a system.

    `system`: as examined. `rank_results`: of the loops with dependent equations at the start. `active` of shape
    (n_c,): mask of the equations that are kept.
    """

    system: System
    rank_results: tuple[LoopRankResult, ...]
    active: np.ndarray

    @property
    def rank(self) -> int:
        """General rank of J."""
        return int(self.active.sum())

    @property
    def degrees_of_freedom(self) -> int:
        """Number of degrees of freedom, n_u - rank."""
        return self.system.n_u - self.rank

    @property
    def redundant(self) -> tuple[tuple[str, str], ...]:
        """Joint and name of the dropped equations."""
        return tuple(self.system.equations[row] for row in np.flatnonzero(~self.active))

    @property
    def indeterminate(self) -> tuple[Indeterminate, ...]:
        """Reactions without a unique value."""
        return tuple(part for rank_result in self.rank_results for part in rank_result.indeterminate)

    @property
    def not_unique(self) -> tuple[str, ...]:
        """Channels of the reactions without a unique value."""
        return tuple(dict.fromkeys(name for part in self.indeterminate for name in part.channels))

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general."""
        return sum(rank_result.extra_freedoms for rank_result in self.rank_results)


def examine(system: System, start: float, duration: float, order: Sequence[str]) -> Redundancy:
    """Examine the loops of a system.

    `start`, `duration`: of the run, s. `order`: names of all joints; the last is dropped first.
    """
    state = State(system)
    state.evaluate("motion", start)
    active = np.ones(system.n_c, dtype=bool)
    rank_results = []
    for loop in loops(system, state):
        from .inconsistent_constraints import rank_result_of

        rank_result = rank_result_of(loop, state, start, duration, order)
        if rank_result is None:
            continue
        active[loop.rows[[part.row for part in rank_result.redundant]]] = False
        rank_results.append(rank_result)
    return Redundancy(system, tuple(rank_results), active)
