"""Results on one loop.

`loop_rank` finds the rank of its equations, `drop_first` those to leave out, `uniqueness` the indeterminate reactions,
`inconsistencies` contradicting equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from .drop_first import Redundant, redundant_rows
from .inconsistent_constraints import Inconsistency, inconsistencies, time_dependent
from .loop_equations import LoopEquations
from .loop_rank import LoopRank, loop_rank
from .loops import Loop
from .parameters import REDUNDANCY
from .uniqueness import Indeterminate, forces_change, indeterminate


class LoopRankResult(NamedTuple):
    """Results on a loop with dependent equations at the start.

    Attributes
    ----------
    redundant : list of Redundant
        Dropped equations.
    driven : ndarray of bool
        Mask of the loop's rows that depend on time.
    motion_unique : bool
        False if friction depends on reactions that are not unique.
    """

    rank: LoopRank
    redundant: list[Redundant]
    indeterminate: list[Indeterminate]
    inconsistencies: list[Inconsistency]
    driven: np.ndarray
    motion_unique: bool

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general: positive at a singular pose."""
        return self.rank.rank - self.rank.start_rank

    @property
    def nearly_dependent(self) -> bool:
        """True if equations are so nearly dependent that the motion depends on rounding."""
        return not self.extra_freedoms and self.rank.least < REDUNDANCY.sound


def rank_result_of(
    loop: Loop, state: State, start: float, duration: float, order: Sequence[str]
) -> LoopRankResult | None:
    """Examine one loop near the described pose.

    Parameters
    ----------
    state : State
        Working memory.
    start, duration : float
        Of the run, s.
    order : sequence of str
        Names of all joints; the last is dropped first.

    Returns
    -------
    LoopRankResult or None
        None if all equations are independent, or undefined (initial value assembly then names the element).
    """
    equations = LoopEquations(loop, state, start)
    pose = equations.pose(state.system.q[loop.coordinates], start)
    if not (pose.J.finite and np.all(np.isfinite(pose.C))):
        return None
    rank = loop_rank(equations, pose.q, start)
    if not rank.null_spaces:
        return None
    redundant = redundant_rows(rank, order, state.system.holonomic[loop.rows])
    spaces = rank.null_spaces if redundant else []
    return LoopRankResult(
        rank, redundant, indeterminate(rank, spaces) if redundant else [], inconsistencies(rank, redundant, duration),
        time_dependent(rank.equations, rank.start, duration), not forces_change(rank, spaces),
    )  # fmt: skip
