"""Statistics of IDA, the log of its steps, and sentences on its return values."""

from __future__ import annotations

import ctypes
from enum import Enum

import numpy as np

from ...compile.machine.layout import addresses
from ...compile.machine.routines import Routine
from .libraries import Libraries
from .native.layouts import STEP_WIDTH
from .native.parameters import LOOP

_ADD = Routine("stiffmbs.solve.ida.native.start", "add_counters", "void(int64, int64*, int64*, int64*, int64*)")

COUNTERS = {
    "steps": "IDAGetNumSteps",
    "residuals": "IDAGetNumResEvals",
    "jacobians": "IDAGetNumJacEvals",
    "factorizations": "IDAGetNumLinSolvSetups",
    "error_test_failures": "IDAGetNumErrTestFails",
    "convergence_failures": "IDAGetNumStepSolveFails",
    "newton_iterations": "IDAGetNumNonlinSolvIters",
    "newton_failures": "IDAGetNumNonlinSolvConvFails",
}
"""Names of the counters and of the functions that return them."""


class Statistics:
    """Counters of one integrator.

    `memory`: IDA memory. `counters` of shape (2, counters): their functions and the arguments of these. `arrays`: arrays
    for compiled code (`stiffmbs.solve.ida.native.layouts.START`), with space for one number, and the counts before the
    last start.
    """

    def __init__(self, libraries: Libraries, memory: int, counters: np.ndarray) -> None:
        self._libraries, self._memory = libraries, memory
        self._before = np.zeros(len(COUNTERS), dtype=np.int64)
        self._order = ctypes.c_int()
        self._functions, self._counted = counters
        self._value = np.zeros(1, dtype=np.int64)
        self.arrays = {
            "n_counters": len(COUNTERS), "counter": self._functions, "counted": self._counted, "count": self._value, "counts": self._before,
        }  # fmt: skip

    def total(self) -> dict[str, int]:
        """Return all counters."""
        sums = self._before.copy()
        _ADD.short_call(len(sums), *addresses(self._functions, self._counted, self._value, sums))
        return dict(zip(COUNTERS, sums.tolist(), strict=True))

    def forget(self) -> None:
        """Reset the sums before IDA is reset."""
        self._before[:] = 0

    def counted(self) -> dict[str, int]:
        """Return all counters, with `rejected` steps and the `order` of the last step."""
        total = self.total()
        self._libraries.IDAGetLastOrder(self._memory, ctypes.byref(self._order))
        rejected = total["error_test_failures"] + total["convergence_failures"]
        return {**total, "rejected": rejected, "order": self._order.value}


class Status(Enum):
    """Reason for the return of `NativeIda.advance` and `NativeIda.steps`."""

    GOING = "more work is left; call again"
    STOP = "the stop time is reached"
    ROOT = "an event function changed its sign"
    FAILED = "IDA cannot go on"


_UNDEFINED = "a formula leaves its domain or a force is unbounded there; check sqrt, log and divisions in the scene"
_JUMP = "an equation has a jump or kink without a declared breakpoint, or the tolerance is below the rounding of the equations"
_INSIDE = "this is an error of the program or its libraries; please report it with the scene"

FAILURES = {
    -1: "too many steps in one call; use a shorter duration or a larger rtol",
    -2: "the tolerance is below machine precision; use a larger rtol or atol",
    -3: f"the error test failed too often, or with the smallest step: {_JUMP}; write jumps as step(), or use a larger rtol",
    -4: f"Newton's iteration failed to converge too often, or with the smallest step: {_JUMP}, or the pose is singular; "
    "use a larger rtol or solver projected",
    -5: f"the linear solver could not be started: {_INSIDE}",
    -6: "the linear solver has too little memory for the factors of the iteration matrix; use fewer bodies, or close other programs",
    -7: f"the linear solver failed: {_INSIDE}",
    -8: f"the residual failed: {_INSIDE}",
    -9: f"the residual has no finite value however small the step: {_UNDEFINED}",
    -10: f"the event functions could not be evaluated: {_UNDEFINED}, or the gap of a contact has no value",
    -11: f"a bound on an unknown could not be kept: {_INSIDE}",
    -12: f"the residual has no finite value at the start: {_UNDEFINED}",
    -13: f"the line search for initial values failed: {_INSIDE}",
    -14: f"the residual or the linear solver failed, however small the step: {_UNDEFINED}",
    -16: f"the nonlinear solver could not be set up: {_INSIDE}",
    -17: f"the nonlinear solver failed: {_INSIDE}",
    -20: f"IDA was given no memory of its own: {_INSIDE}",
    -21: "IDA has too little memory; use fewer bodies, or close other programs",
    -22: f"IDA was given an invalid argument: {_INSIDE}",
    -23: f"IDA was called before it was started: {_INSIDE}",
    -24: "an error weight became zero: absolute tolerances must be greater than zero; set atol",
    -25: "the requested derivative is of higher order than the last step; request a lower one",
    -26: "the requested time is outside the last step; request one within it",
    -27: f"IDA was given no vector for its answer: {_INSIDE}",
    -101: "the steps have become as small as the rounding of time, so no solution was found beyond: the "
    f"motion has a pole, the mechanism locks, {_UNDEFINED}, or a late time is rounded too coarsely for rtol; see the last output "
    "rows, use a shorter duration, or start nearer to t = 0",
}
"""Messages for IDA's negative flags (ida.h) and for `stiffmbs.solve.ida.native.ida_loop.STALLED`, with cause and remedy."""


def failure_sentence(flag: int) -> str:
    """Return the reason of a failure of IDA."""
    return FAILURES.get(flag, f"IDA failed with flag {flag}: {_INSIDE}")


END, ORDER, SIZE = range(STEP_WIDTH)


class StepLog:
    """Log of steps, filled by compiled code in each call and read as arrays. `count`: number of steps."""

    def __init__(self) -> None:
        self._rows = np.empty((0, STEP_WIDTH))
        self.forget()

    def rows(self, steps: int) -> np.ndarray:
        """Return memory for the steps of one call, numbers in the order of `STEP`."""
        self._rows = np.empty((steps, STEP_WIDTH))
        return self._rows

    def forget(self) -> None:
        """Drop all steps."""
        self._chunks: list[np.ndarray] = []
        self.count = self._kept = 0

    def begin(self, t: float) -> None:
        """Note a start at `t`; a last step beyond it, within which an event was found, is shortened."""
        if self._chunks:
            last = self._chunks[-1][-1]
            if last[END] > t:
                last[SIZE] -= last[END] - t
                last[END] = t

    def add(self, steps: int) -> None:
        """Store the first rows."""
        self.count += steps
        kept = min(steps, LOOP.most_items - self._kept)
        if kept > 0:
            self._chunks.append(self._rows[:kept].copy())
            self._kept += kept

    @property
    def last(self) -> tuple[float, int] | None:
        """Return the size, s, and order of the last stored step."""
        if not self._chunks:
            return None
        last = self._chunks[-1][-1]
        return float(last[SIZE]), int(last[ORDER])

    def stored(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the ends of the stored steps, s, their orders and sizes, s."""
        rows = np.concatenate([self._rows[:0], *self._chunks])
        return rows[:, END].copy(), rows[:, ORDER].astype(int), rows[:, SIZE].copy()
