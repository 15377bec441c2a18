"""All that is found about one loop.

`loop_rank` finds the rank of its equations, `drop_first` those to leave out, `uniqueness` the reactions that stay
undetermined, `inconsistencies` equations that cannot hold together.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..compile.state import State
from .drop_first import Redundant, redundant_rows
from .inconsistent_constraints import Inconsistency, inconsistencies, time_dependent
from .loop_equations import LoopEquations
from .loop_rank import SOUND, LoopRank, loop_rank
from .loops import Loop
from .uniqueness import Indeterminate, forces_change, indeterminate


class LoopRankResult(NamedTuple):
    """A loop whose equations are not independent at the start, and what follows.

    Attributes
    ----------
    rank : LoopRank
    redundant : list of Redundant
        The equations that are dropped.
    indeterminate : list of Indeterminate
    inconsistencies : list of Inconsistency
    driven : ndarray of bool
        Which of the loop's rows depend on time.
    motion_unique : bool
        False where friction depends on reactions that are not unique.
    """

    rank: LoopRank
    redundant: list[Redundant]
    indeterminate: list[Indeterminate]
    inconsistencies: list[Inconsistency]
    driven: np.ndarray
    motion_unique: bool

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general: more than 0 at a singular pose."""
        return self.rank.rank - self.rank.start_rank

    @property
    def nearly_dependent(self) -> bool:
        """Whether equations differ by so little that the motion depends on rounding."""
        return not self.extra_freedoms and self.rank.least < SOUND


def rank_result_of(
    loop: Loop, state: State, start: float, duration: float, order: Sequence[str]
) -> LoopRankResult | None:
    """Examine one loop near the pose described.

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
        None where all equations are independent, or not defined (the search for initial values names the element).
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
