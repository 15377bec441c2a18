"""Degrees of freedom, redundant equations, and reactions without a unique value.

The degrees of freedom are n_u minus the rank of the velocity Jacobian J.  Rows of a tree are always independent, so
only loops are looked at, each by itself: `loops` finds them, and `finding` puts together what there is to say of one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..compile.state import State
from ..compile.system import System
from .loops import loops

if TYPE_CHECKING:
    from .rank_result import LoopFinding
    from .uniqueness import Undetermined


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
        from .rank_result import finding_of  # trees do not pay for it

        finding = finding_of(loop, state, start, duration, order)
        if finding is None:
            continue
        active[loop.rows[[part.row for part in finding.redundant]]] = False
        findings.append(finding)
    return Redundancy(system, tuple(findings), active)
