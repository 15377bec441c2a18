"""Failures of the dynamics, in words."""

from __future__ import annotations

from ..compile.machine.native.statuses import (
    NO_BALANCE,
    NO_CONVERGENCE,
    NO_MEMORY,
    NO_STATE,
    NOT_FINITE,
    NOT_FINITE_WITHIN,
    SINGULAR,
)

FAILURES = {
    SINGULAR: "the constraint equations depend on each other",
    NO_CONVERGENCE: "the positions could not be brought back to the constraints",
    NOT_FINITE: "an equation or an acceleration has no finite value",
    NOT_FINITE_WITHIN: "an equation or an acceleration has no finite value near the motion, within the last step",
    NO_BALANCE: "friction and the reactions that press it find no unique balance (a joint jams, or there is too much friction)",
    NO_STATE: "the equations of algebraic states have no solution near their last values",
    NO_MEMORY: "there is too little memory for the factors of the block system; give fewer bodies, or close other programs",
}
"""Clause for each failure of the compiled routines (`stiffmbs.compile.machine.native.statuses`)."""
