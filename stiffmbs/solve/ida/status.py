"""Outcomes of calls of the native IDA, and messages for IDA's failures."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """Reason for the return of `NativeIda.advance` and `NativeIda.steps`."""

    GOING = "more work is left; call again"
    STOP = "the stop time is reached"
    ROOT = "an event function changed its sign"
    FAILED = "IDA cannot go on"


_UNDEFINED = (
    "a formula leaves its domain or a force grows without bound there: see sqrt, log and divisions in the scene"
)
_JUMP = "an equation jumps or bends where no breakpoint is declared, or the tolerance is finer than the equations' own digits"
_INSIDE = "this is a fault of the program or of its libraries: please report it with the scene"

FAILURES = {
    -1: "too many steps in one call; give a shorter duration, or a looser rtol",
    -2: "the tolerance asked for is finer than the numbers' own precision; give a larger rtol or atol",
    -3: f"the error test failed too often, or with the smallest step: {_JUMP}; write jumps as step(), or give a looser rtol",
    -4: f"Newton's iteration failed to converge too often, or with the smallest step: {_JUMP}, or the pose is singular; "
    "give a looser rtol, or take solver projected",
    -5: f"the linear solver could not be started: {_INSIDE}",
    -6: "the linear solver failed to factor the iteration matrix, as there is too little memory for the factors; give fewer "
    "bodies, or close other programs",
    -7: f"the linear solver failed: {_INSIDE}",
    -8: f"the residual failed: {_INSIDE}",
    -9: f"the residual has no finite value however small the step: {_UNDEFINED}",
    -10: f"the event functions could not be evaluated: {_UNDEFINED}, or the gap of a contact has no value",
    -11: f"a bound on an unknown could not be kept: {_INSIDE}",
    -12: f"the residual has no finite value at the start: {_UNDEFINED}",
    -13: f"the line search for initial values failed: {_INSIDE}",
    -14: f"neither the residual nor the linear solver recovered, however small the step: {_UNDEFINED}",
    -16: f"the nonlinear solver could not be set up: {_INSIDE}",
    -17: f"the nonlinear solver failed: {_INSIDE}",
    -20: f"IDA was given no memory of its own: {_INSIDE}",
    -21: "IDA found too little memory; give fewer bodies, or close other programs",
    -22: f"IDA was given an invalid argument: {_INSIDE}",
    -23: f"IDA was called before it was started: {_INSIDE}",
    -24: "an error weight became zero: the absolute tolerances must be greater than zero; give an atol",
    -25: "the derivative asked for is of higher order than the last step; ask for a lower one",
    -26: "the time asked for is outside the last step; ask for one within it",
    -27: f"IDA was given no vector for its answer: {_INSIDE}",
    -101: "the steps have shrunk to the precision of time: no solution was found beyond this instant, as where the "
    f"motion has a pole or a mechanism locks, or {_UNDEFINED}; look at the last rows, or end the run before",
}
"""Messages for IDA's negative flags (ida.h) and for `stiffmbs.solve.ida.native.ida_loop.STALLED`, with cause and remedy."""


def failure_sentence(flag: int) -> str:
    """Return the reason of a failure of IDA."""
    return FAILURES.get(flag, f"IDA failed with flag {flag}: {_INSIDE}")
