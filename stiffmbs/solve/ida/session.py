"""Ownership of SUNDIALS objects, freed once in reverse order of creation."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from typing import Any

import numpy as np

from ...compile.machine.native.statuses import FAILED, NOT_COMPILED, OK
from ...compile.machine.routines import Routine
from .libraries import Libraries


class Session:
    """SUNContext with all objects created in it."""

    def __init__(self, libraries: Libraries) -> None:
        self.libraries = libraries
        self._frees = ExitStack()
        self._needed: list[WhenNeeded] = []
        self.context = ctypes.c_void_p()
        libraries.SUNContext_Create(0, ctypes.byref(self.context))
        self._frees.callback(libraries.SUNContext_Free, ctypes.byref(self.context))
        libraries.SUNContext_ClearErrHandlers(self.context)  # they print; flags report failures

    def keep(self, handle: int | None, free: Callable[[Any], Any], what: str) -> int:
        """Take ownership of a new object. Raises MemoryError if SUNDIALS could not create it."""
        if not handle:
            raise MemoryError(f"SUNDIALS could not make {what}")
        self._frees.callback(free, handle)
        return handle

    def before_freed(self, undo: Callable[[], Any]) -> None:
        """Undo a change before the objects created so far are freed."""
        self._frees.callback(undo)

    def may_need(self, routines: WhenNeeded) -> None:
        """Note routines that a linear solver may request."""
        self._needed.append(routines)

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call compiled code; afterwards raise errors from the compilation of routines."""
        found = function(*arguments)
        for routines in self._needed:
            routines.raise_fault()
        return found

    def vector(self, values: np.ndarray) -> int:
        """Create an N_Vector with the values of an array, which must outlive it."""
        handle = self.libraries.N_VMake_Serial(len(values), values.ctypes.data, self.context)
        return self.keep(handle, self.libraries.N_VDestroy, "a vector")

    def ida(self) -> int:
        """Create IDA memory."""
        libraries = self.libraries

        def free(memory: int) -> None:
            libraries.IDAFree(ctypes.byref(ctypes.c_void_p(memory)))

        return self.keep(libraries.IDACreate(self.context), free, "an integrator")

    def close(self) -> None:
        """Free all objects; a second call has no effect."""
        self._frees.close()


_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int32)


class WhenNeeded:
    """C function that stores the addresses of routines in a table.

    `cells`: cells of the table; "last_flag" is NOT_COMPILED after a failed request. `routines`: routines by the cells
    for their addresses, which are zero before. `address`: address of the C function, which has no arguments.
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
        """Write the addresses of the compiled routines; return OK or FAILED."""
        try:  # an exception cannot pass through compiled code
            addresses = {name: routine.address for name, routine in routines.items()}
        except BaseException as fault:
            faults.append(fault)
            return FAILED
        for name, address in addresses.items():
            cells[name] = address
        return OK

    return fill
