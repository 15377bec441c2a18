"""Counters of IDA, accumulated over restarts."""

from __future__ import annotations

import ctypes

import numpy as np

from ...compile.machine.layout import address, addresses
from ...compile.machine.routines import Routine
from .libraries import Libraries

_COUNT = Routine("stiffmbs.solve.ida.starting.native.counters", "count", "void(int64, int64*, int64, int64*, int64*)")

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

    Parameters
    ----------
    libraries : Libraries
    memory : int
        IDA memory.

    Attributes
    ----------
    arrays : dict
        Arrays for compiled code (`stiffmbs.solve.ida.native.layouts.START`): counter functions, space for one
        number, and the counts before the last start.
    """

    def __init__(self, libraries: Libraries, memory: int) -> None:
        self._libraries, self._memory = libraries, memory
        self._before = np.zeros(len(COUNTERS), dtype=np.int64)
        self._order = ctypes.c_int()
        self._functions = np.array([libraries.address(function) for function in COUNTERS.values()], dtype=np.int64)
        self._value = np.zeros(1, dtype=np.int64)
        self.arrays = {
            "n_counters": len(COUNTERS), "counter": self._functions, "count": self._value, "counts": self._before,
        }  # fmt: skip

    def _add_to(self, sums: np.ndarray) -> None:
        functions, value = addresses(self._functions, self._value)
        _COUNT.short_call(len(sums), functions, self._memory, value, address(sums))

    def total(self) -> dict[str, int]:
        """Return all counters."""
        sums = self._before.copy()
        self._add_to(sums)
        return dict(zip(COUNTERS, sums.tolist(), strict=True))

    def keep(self) -> None:
        """Add IDA's counters to the sums before a restart resets them."""
        self._add_to(self._before)

    def forget(self) -> None:
        """Reset the sums before IDA is reset."""
        self._before[:] = 0

    def counted(self) -> dict[str, int]:
        """Return all counters, with `rejected` steps and the `order` of the last step."""
        total = self.total()
        self._libraries.IDAGetLastOrder(self._memory, ctypes.byref(self._order))
        rejected = total["error_test_failures"] + total["convergence_failures"]
        return {**total, "rejected": rejected, "order": self._order.value}
