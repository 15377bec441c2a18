"""Ownership of SUNDIALS objects, freed once in reverse order of creation."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import numpy as np

from ..linear_solvers.when_needed import WhenNeeded
from .libraries import Libraries


class Session:
    """SUNContext with all objects created in it.

    Parameters
    ----------
    libraries : Libraries
    """

    def __init__(self, libraries: Libraries) -> None:
        self.libraries = libraries
        self._frees = ExitStack()
        self._needed: list[WhenNeeded] = []
        self.context = ctypes.c_void_p()
        libraries.SUNContext_Create(0, ctypes.byref(self.context))
        self._frees.callback(libraries.SUNContext_Free, ctypes.byref(self.context))
        libraries.SUNContext_ClearErrHandlers(self.context)  # they print; flags report failures

    def keep(self, handle: int | None, free: Callable[[Any], Any], what: str) -> int:
        """Take ownership of a new object.

        Raises
        ------
        MemoryError
            If SUNDIALS could not create it.
        """
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
        """Call compiled code with libraries on one thread; afterwards raise errors from the compilation of routines."""
        if self.libraries.may_start_threads:
            with self.libraries.on_one_thread():
                found = function(*arguments)
        else:
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
