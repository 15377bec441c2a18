"""What SUNDIALS makes and has to be told to free: kept together, freed once, in the reverse order."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import numpy as np

from .libraries import Libraries
from .when_needed import WhenNeeded


class Session:
    """A SUNContext and all objects made in it.

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
        libraries.SUNContext_ClearErrHandlers(self.context)  # they print; failures are told by their flags

    def keep(self, handle: int | None, free: Callable[[Any], Any], what: str) -> int:
        """Take charge of a new object.

        Raises
        ------
        MemoryError
            When SUNDIALS could not make it.
        """
        if not handle:
            raise MemoryError(f"SUNDIALS could not make {what}")
        self._frees.callback(free, handle)
        return handle

    def before_freed(self, undo: Callable[[], Any]) -> None:
        """Have something undone before the objects made so far are freed."""
        self._frees.callback(undo)

    def may_need(self, routines: WhenNeeded) -> None:
        """Note routines that a linear solver may ask for."""
        self._needed.append(routines)

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call compiled code, libraries on one thread; raises afterwards what kept a routine from being compiled."""
        if self.libraries.may_start_threads:
            with self.libraries.on_one_thread():
                found = function(*arguments)
        else:
            found = function(*arguments)
        for routines in self._needed:
            routines.raise_fault()
        return found

    def vector(self, values: np.ndarray) -> int:
        """An N_Vector whose values are those of an array, which must live as long."""
        handle = self.libraries.N_VMake_Serial(len(values), values.ctypes.data, self.context)
        return self.keep(handle, self.libraries.N_VDestroy, "a vector")

    def ida(self) -> int:
        """A new integrator."""
        libraries = self.libraries

        def free(memory: int) -> None:
            libraries.IDAFree(ctypes.byref(ctypes.c_void_p(memory)))

        return self.keep(libraries.IDACreate(self.context), free, "an integrator")

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        self._frees.close()
