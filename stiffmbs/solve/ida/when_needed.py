"""Routines that few runs need, compiled when compiled code first asks for them."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping

import numpy as np

from ...compile.machine.routines import Routine
from ..native.statuses import FAILED, NOT_COMPILED, OK

_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int32)


class WhenNeeded:
    """A C function that puts the addresses of routines into a table.

    Parameters
    ----------
    cells : numpy.void
        The table's; "last_flag" is NOT_COMPILED where compiled code has asked in vain.
    routines : dict of str to Routine
        By the cells that receive their addresses, which are zero before.

    Attributes
    ----------
    address : int
        Of the C function, which has no arguments.
    """

    def __init__(self, cells: np.void, routines: Mapping[str, Routine]) -> None:
        self._cells = cells
        self._faults: list[BaseException] = []
        self._c_function = _PROTOTYPE(_filling(cells, routines, self._faults))
        self.address = ctypes.cast(self._c_function, ctypes.c_void_p).value or 0

    def raise_fault(self) -> None:
        """Raise what kept the routines from being compiled, such as Ctrl-C; to be called when compiled code has returned."""
        if self._cells["last_flag"] == NOT_COMPILED:
            self._cells["last_flag"] = OK
            raise (
                self._faults.pop() if self._faults else KeyboardInterrupt
            )  # which may come before the function's first line


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
