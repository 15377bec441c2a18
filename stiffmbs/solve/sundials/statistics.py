"""IDA's counters, added up over its restarts."""

from __future__ import annotations

import ctypes
from collections import Counter

from .libraries import Libraries

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
    """

    def __init__(self, libraries: Libraries, memory: int) -> None:
        self._libraries, self._memory = libraries, memory
        self._before: Counter[str] = Counter()

    def _now(self) -> Counter[str]:
        found = Counter[str]()
        for name, function in COUNTERS.items():
            value = ctypes.c_long()
            getattr(self._libraries, function)(self._memory, ctypes.byref(value))
            found[name] = value.value
        return found

    def keep(self) -> None:
        """Add what has been counted to the sum, before a restart sets IDA's counters to zero."""
        self._before.update(self._now())

    def counted(self) -> dict[str, int]:
        """All counters; `rejected` counts the steps tried in vain, `order` is the last step's."""
        total = self._before + self._now()
        order = ctypes.c_int()
        self._libraries.IDAGetLastOrder(self._memory, ctypes.byref(order))
        counted = {name: total[name] for name in COUNTERS}
        rejected = counted["error_test_failures"] + counted["convergence_failures"]
        return {**counted, "rejected": rejected, "order": order.value}
