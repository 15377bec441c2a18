"""Lazy compilation of rarely used routines, at the request of compiled code."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping

import numpy as np

from ...compile.machine.native.statuses import FAILED, NOT_COMPILED, OK
from ...compile.machine.routines import Routine

_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int32)


class WhenNeeded:
    """C function that stores the addresses of routines in a table.

    Parameters
    ----------
    cells : numpy.void
        Cells of the table; "last_flag" is NOT_COMPILED after a failed request.
    routines : dict of str to Routine
        Routines by the cells for their addresses, which are zero before.

    Attributes
    ----------
    address : int
        Address of the C function, which has no arguments.
    """

    def __init__(self, cells: np.void, routines: Mapping[str, Routine]) -> None:
        self._cells = cells
        self._faults: list[BaseException] = []
        self._c_function = _PROTOTYPE(_filling(cells, routines, self._faults))
        self.address = ctypes.cast(self._c_function, ctypes.c_void_p).value or 0

    def raise_fault(self) -> None:
        """Raise the error from a failed compilation, such as Ctrl-C; to be called after compiled code has returned."""
        if self._cells["last_flag"] == NOT_COMPILED:
            self._cells["last_flag"] = OK
            raise (
                self._faults.pop() if self._faults else KeyboardInterrupt
            )  # which may precede the function's first line


def _filling(cells: np.void, routines: Mapping[str, Routine], faults: list[BaseException]) -> Callable[[], int]:
    def fill() -> int:
        try:  # an exception cannot pass through compiled code
            addresses = {name: routine.address for name, routine in routines.items()}
        except BaseException as fault:
            faults.append(fault)
            return FAILED
        for name, address in addresses.items():
            cells[name] = address
        return OK

    return fill
