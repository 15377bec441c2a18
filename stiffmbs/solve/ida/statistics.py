"""IDA's counters, added up over its restarts."""

from __future__ import annotations

import ctypes

import numpy as np

from ...compile.machine.layout import address, addresses
from ...compile.machine.routines import Routine
from .libraries import Libraries

_COUNT = Routine("stiffmbs.solve.ida.native.counters", "count", "void(int64, int64*, int64, int64*, int64*)")

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
"""Each counter and the function that reads it."""


class Statistics:
    """The counters of one integrator.

    Parameters
    ----------
    libraries : Libraries
    memory : int
        The integrator.

    Attributes
    ----------
    arrays : dict
        For compiled code (`stiffmbs.solve.native.tables.steps.START`): functions that read the counters, room for one number, and what
        was counted before the last start.
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
        """Each of the counters."""
        sums = self._before.copy()
        self._add_to(sums)
        return dict(zip(COUNTERS, sums.tolist(), strict=True))

    def keep(self) -> None:
        """Add what has been counted to the sum, before a restart sets IDA's counters to zero."""
        self._add_to(self._before)

    def forget(self) -> None:
        """Begin with nothing counted, before IDA starts anew."""
        self._before[:] = 0

    def counted(self) -> dict[str, int]:
        """All counters; `rejected` counts the steps tried in vain, `order` is the last step's."""
        total = self.total()
        self._libraries.IDAGetLastOrder(self._memory, ctypes.byref(self._order))
        rejected = total["error_test_failures"] + total["convergence_failures"]
        return {**total, "rejected": rejected, "order": self._order.value}
