"""Degrees of freedom, redundant equations, and reactions without a unique value.

The degrees of freedom are n_u minus the rank of the velocity Jacobian J.  Rows of a tree are always independent, so
only loops are looked at, each by itself: `loops` finds them, `loop_rank` their rank, `give_way` the equations to
leave out, `uniqueness` the reactions that stay undetermined, `contradictions` equations that cannot hold together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.state import State
from ..compile.system import System
from .contradictions import Contradiction, contradictions, time_dependent
from .give_way import Redundant, redundant_rows
from .loop_equations import LoopEquations
from .loop_rank import SOUND, LoopRank, loop_rank
from .loops import loops
from .uniqueness import Undetermined, forces_change, undetermined


@dataclass(frozen=True)
class LoopFinding:
    """A loop whose equations are not independent at the start, and what follows.

    Attributes
    ----------
    rank : LoopRank
    redundant : list of Redundant
        The equations that give way.
    undetermined : list of Undetermined
    contradictions : list of Contradiction
    driven : ndarray of bool
        Which of the loop's rows depend on time.
    motion_unique : bool
        False where friction hangs on reactions that are not unique.
    """

    rank: LoopRank
    redundant: list[Redundant]
    undetermined: list[Undetermined]
    contradictions: list[Contradiction]
    driven: np.ndarray
    motion_unique: bool

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general: more than 0 at a singular pose."""
        return self.rank.rank - self.rank.start_rank

    @property
    def nearly_dependent(self) -> bool:
        """Whether equations differ by so little that the motion hangs on rounding."""
        return not self.extra_freedoms and self.rank.least < SOUND


@dataclass(frozen=True)
class Redundancy:
    """What the examination of a system found.

    Attributes
    ----------
    system : System
        As examined.
    findings : tuple of LoopFinding
        Of the loops whose equations are not independent at the start.
    active : ndarray of bool, shape (n_c,)
        Which equations stay.
    """

    system: System
    findings: tuple[LoopFinding, ...]
    active: np.ndarray

    @property
    def rank(self) -> int:
        """Of J, in general."""
        return int(self.active.sum())

    @property
    def degrees_of_freedom(self) -> int:
        """n_u - rank."""
        return self.system.n_u - self.rank

    @property
    def redundant(self) -> tuple[tuple[str, str], ...]:
        """Joint and name of the equations that give way."""
        return tuple(self.system.equations[row] for row in np.flatnonzero(~self.active))

    @property
    def undetermined(self) -> tuple[Undetermined, ...]:
        """The reactions without a unique value."""
        return tuple(part for finding in self.findings for part in finding.undetermined)

    @property
    def not_unique(self) -> tuple[str, ...]:
        """Their channels."""
        return tuple(dict.fromkeys(name for part in self.undetermined for name in part.channels))

    @property
    def extra_freedoms(self) -> int:
        """Degrees of freedom at the start beyond those in general."""
        return sum(finding.extra_freedoms for finding in self.findings)


def examine(system: System, start: float, duration: float, order: Sequence[str]) -> Redundancy:
    """Examine a system's loops.

    Parameters
    ----------
    system : System
    start, duration : float
        Of the run, s.
    order : sequence of str
        Names of all joints; the last gives way first.
    """
    state = State(system)
    active = np.ones(system.n_c, dtype=bool)
    findings = []
    for loop in loops(system, state, start):
        equations = LoopEquations(loop, state, start)
        pose = equations.pose(system.q[loop.columns], start)
        if not (np.all(np.isfinite(pose.J)) and np.all(np.isfinite(pose.C))):
            continue  # the search for initial values names the element
        rank = loop_rank(equations, pose.q, start)
        if not rank.null_spaces:
            continue
        redundant = redundant_rows(rank, order, system.holonomic[loop.rows])
        active[loop.rows[[part.row for part in redundant]]] = False
        findings.append(_finding(rank, redundant, duration))
    return Redundancy(system, tuple(findings), active)


def _finding(rank: LoopRank, redundant: list[Redundant], duration: float) -> LoopFinding:
    spaces = rank.null_spaces if redundant else []
    return LoopFinding(
        rank, redundant, undetermined(rank, spaces) if redundant else [], contradictions(rank, redundant, duration),
        time_dependent(rank.equations, rank.start, duration), not forces_change(rank, spaces),
    )  # fmt: skip
