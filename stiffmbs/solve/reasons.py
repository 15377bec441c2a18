"""Why runs end early: an enumeration with remedies, which the message of a run carries."""

from __future__ import annotations

from enum import Enum

from ..compile.machine.native.statuses import (
    NO_BALANCE,
    NO_CONVERGENCE,
    NO_MEMORY,
    NO_STATE,
    NOT_FINITE,
    NOT_FINITE_WITHIN,
    SINGULAR,
    STEP_TOO_SMALL,
    STIFF,
)
from ..notes import Note, Severity


class Reason(Enum):
    """Why a run ended early, and what to do."""

    SINGULAR_POSE = "the constraint equations are dependent", "use bdf or radau, or start in another pose"
    NOT_ASSEMBLED = (
        "no positions satisfy the constraints",
        "check whether the joints can close there, or use a smaller step",
    )
    NOT_FINITE = "a formula or a force has no finite value", "check sqrt, log and divisions, and signs of stiffnesses"
    NO_BALANCE = "friction and reactions have no unique solution", "use less friction, or another joint"
    NO_STATE = "algebraic states have no solution near their last values", "check their formulas"
    NO_MEMORY = "there is too little memory", "use fewer bodies, or close other programs"
    NO_STEP = (
        "no step satisfies the equations and the tolerance",
        "write jumps as step(), use a larger rtol or another solver",
    )
    STIFF = "stability limits explicit steps", "use bdf or radau"
    LOCKED = "the mechanism locks, or its joints contradict each other", "check drives, dimensions and redundant joints"
    CHATTERING = "events accumulate", "smooth the force that switches, or give it damping"
    DIVERGED = "the motion grows beyond all bounds", "look for a wrong sign of a stiffness, damping or force"
    OUT_OF_RANGE = (
        "a force has left the range in which it is defined",
        "check the motion before, and the data of the element",
    )
    LEFT_TABLE = "a table with beyond: error was left", "give more points, or another 'beyond'"
    DRIFTED = "relaxed constraints have drifted apart", "use formulation: SI2_exact"
    FUNCTION = "a Python function raised an exception", "mend the function, or catch the exception in it"
    OTHER = "another reason, which the message gives", ""

    def __init__(self, what: str, remedy: str) -> None:
        self.what, self.remedy = what, remedy

    @property
    def kind(self) -> str:
        """Kind of the notes of this reason."""
        return self.name.lower().replace("_", "-")

    def of(self, message: str, element: str = "") -> Note:
        """Return the message of a run that ended for this reason."""
        return Note(message, self.kind, element, self.remedy, Severity.STOP)

    def ended(self, message: str) -> bool:
        """Return True if a run with this message ended for this reason."""
        return isinstance(message, Note) and message.kind == self.kind


OF_STATUS = {
    SINGULAR: Reason.SINGULAR_POSE,
    NO_CONVERGENCE: Reason.NOT_ASSEMBLED,
    NOT_FINITE: Reason.NOT_FINITE,
    NOT_FINITE_WITHIN: Reason.NOT_FINITE,
    NO_BALANCE: Reason.NO_BALANCE,
    NO_STATE: Reason.NO_STATE,
    NO_MEMORY: Reason.NO_MEMORY,
    STEP_TOO_SMALL: Reason.NO_STEP,
    STIFF: Reason.STIFF,
}
"""Reasons by the statuses of compiled routines."""
