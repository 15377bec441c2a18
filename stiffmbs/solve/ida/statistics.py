"""IDA's counters, added up over its restarts."""

from __future__ import annotations

import ctypes

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
        self._before = dict.fromkeys(COUNTERS, 0)
        self._order = ctypes.c_int()
        self._value = ctypes.c_long()
        self._at = ctypes.byref(self._value)
        self._read = {name: getattr(libraries, function) for name, function in COUNTERS.items()}

    def of(self, name: str) -> int:
        """One of the counters."""
        self._read[name](self._memory, self._at)
        return self._before[name] + int(self._value.value)

    def _total(self) -> dict[str, int]:
        return {name: self.of(name) for name in COUNTERS}

    def keep(self) -> None:
        """Add what has been counted to the sum, before a restart sets IDA's counters to zero."""
        self._before = self._total()

    def forget(self) -> None:
        """Begin with nothing counted, before IDA starts anew."""
        self._before = dict.fromkeys(COUNTERS, 0)

    def counted(self) -> dict[str, int]:
        """All counters; `rejected` counts the steps tried in vain, `order` is the last step's."""
        total = self._total()
        self._libraries.IDAGetLastOrder(self._memory, ctypes.byref(self._order))
        rejected = total["error_test_failures"] + total["convergence_failures"]
        return {**total, "rejected": rejected, "order": self._order.value}
