"""How a call of the native IDA ended, and IDA's failures as sentences."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """What `NativeIda.advance` and `NativeIda.steps` came back for."""

    GOING = "more work is left; call again"
    STOP = "the stop time is reached"
    ROOT = "a switch changed its sign"
    FAILED = "IDA cannot go on"


FAILURES = {
    -1: "too many steps in one call",
    -2: "the tolerance asked for is finer than the numbers' own precision",
    -3: "the error test failed too often, or with the smallest step",
    -4: "Newton's iteration failed to converge too often, or with the smallest step",
    -5: "the linear solver could not be started",
    -6: "the linear solver failed to factor the iteration matrix",
    -7: "the linear solver failed",
    -8: "the residual failed",
    -9: "the residual has no finite value however small the step",
    -10: "the switches could not be evaluated",
    -12: "the residual has no finite value at the start",
    -14: "neither the residual nor the linear solver recovered, however small the step",
    -22: "IDA was given an invalid argument",
    -24: "an error weight became zero: the absolute tolerances must be greater than zero",
    -25: "the derivative asked for is of higher order than the last step",
    -26: "the time asked for is outside the last step",
    -101: "the steps have shrunk to the precision of time: no solution was found beyond this instant",
}
"""IDA's flags below zero (ida.h) in words, and that of the loop (`stiffmbs.solve.native.ida_loop.STALLED`)."""


def failure_sentence(flag: int) -> str:
    """Why IDA failed."""
    return FAILURES.get(flag, f"IDA failed with flag {flag}")
