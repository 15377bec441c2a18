"""Callbacks from kernels to Python functions: values, derivatives and exceptions."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from ..elements.element import Element
from ..notes import Note, NoteKind, Severity
from ..reading.python_function import PythonFunction

if TYPE_CHECKING:
    from .system import System

_PROTOTYPE = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p)
DIFFERENCE, LEAST_ARGUMENT = np.cbrt(np.finfo(float).eps), 1e-3
"""Relative step of central differences, and least magnitude of an argument for it."""
COMPLEX_STEP = np.sqrt(np.finfo(float).tiny)


class Callback:
    """Python function called from kernels.

    `address`: address of two words: that of a C function, and a flag for a call without an answer. The function takes
    the number of values, the value's index, the argument to differentiate by (-1 for none), the number of arguments,
    and their address; it stores its answer after them, in place of a NaN.
    """

    def __init__(self, function: PythonFunction) -> None:
        self.name, self._function, self._method = function.name, function.function, function.derivatives
        self._raised: BaseException | None = None
        self.calls = 0
        self._given = b""
        self._values: np.ndarray | None = None
        self._slopes: np.ndarray | None = None
        self._c_function = _PROTOTYPE(self._called)
        self._words = np.array([ctypes.cast(self._c_function, ctypes.c_void_p).value or 0, 0], dtype=np.int64)
        self.address = self._words.ctypes.data

    @property
    def fault(self) -> BaseException | None:
        """Exception of the function. After it, the function is not called and all values are NaN.

        Ctrl-C before the first line of `_called` is dropped by ctypes: that call then has no answer.
        """
        return self._raised or (KeyboardInterrupt() if self._words[1] else None)

    def restart(self) -> None:
        """Call the function again after a fault."""
        self._raised, self._values, self._words[1] = None, None, 0

    def _called(self, count: int, output: int, by: int, n: int, at: int) -> None:
        ctypes.c_double.from_address(at + 8 * n).value = self._answer(count, output, by, n, at)

    def _answer(self, count: int, output: int, by: int, n: int, at: int) -> float:
        if self.fault is not None:
            return np.nan
        try:  # an exception cannot pass through compiled code
            given = ctypes.string_at(at, 8 * n)
            if given != self._given or self._values is None:
                self._given, self._slopes = given, None
                self._values = self._value(np.frombuffer(given).copy(), count)
            if by < 0:
                return float(self._values[output])
            if self._slopes is None:
                x = np.frombuffer(given)
                self._slopes = np.array([self._by(x, k, count) for k in range(n)]).T
            return float(self._slopes[output, by])
        except BaseException as fault:
            self._raised = fault
            return np.nan

    def _value(self, x: np.ndarray, count: int) -> np.ndarray:
        self.calls += 1
        values = np.atleast_1d(np.asarray(self._function(x), dtype=x.dtype)).ravel()
        if len(values) != count:
            raise ValueError(f"found {len(values)} numbers, expected {count}")
        if not np.isfinite(values).all():
            raise ValueError(f"found {values[~np.isfinite(values)][0]}, expected finite numbers")
        return values

    def _by(self, x: np.ndarray, k: int, count: int) -> np.ndarray:
        if self._method == "complex_step":
            moved = x.astype(complex)
            moved[k] += 1j * COMPLEX_STEP
            return self._value(moved, count).imag / COMPLEX_STEP
        above, below = x.copy(), x.copy()
        step = DIFFERENCE * max(abs(x[k]), LEAST_ARGUMENT)
        above[k], below[k] = x[k] + step, x[k] - step
        return (self._value(above, count) - self._value(below, count)) / (above[k] - below[k])


_KEPT: WeakKeyDictionary[PythonFunction, Callback] = WeakKeyDictionary()
"""Callback of each function, kept because compiled models hold its address."""


def callback_of(function: PythonFunction) -> Callback:
    """Return the callback of a function, created once."""
    if function not in _KEPT:
        _KEPT[function] = Callback(function)
    return _KEPT[function]


def callbacks(system: System) -> Iterator[tuple[str, Element, PythonFunction, Callback]]:
    """Yield the Python functions of a system's elements, with element name, element and callback."""
    for group in system.groups:
        if group.has_functions:
            for name, element in zip(group.names, group.elements, strict=True):
                for _, function in element.parts(PythonFunction):
                    yield name, element, function, callback_of(function)


def has_fault(system: System) -> bool:
    """Return True if a function of the system has raised an exception."""
    return any(callback.fault is not None for *_, callback in callbacks(system))


class Fault(NamedTuple):
    """Exception of a Python function, and a clause that names the element."""

    raised: BaseException
    clause: str


def fault_of(system: System) -> Fault | None:
    """Return the first fault of a system's functions, or None; afterwards the functions are called again."""
    found = None
    for name, element, _, callback in callbacks(system):
        if callback.fault is not None:
            clause = (
                f"the Python function {callback.name} of '{name}' ({element.kind}) raised {_raised(callback.fault)}"
            )
            found = found or Fault(callback.fault, clause)
            callback.restart()
    return found


FUNCTION = NoteKind(
    "python-function",
    "the law of '{element}' is the Python function {function} ({calls} calls): its derivatives are by {way}, and breakpoints "
    "in it are not located",
    severity=Severity.REMARK,
)


def notes_on_functions(system: System) -> Iterator[Note]:
    """Yield a note for each element with a Python function as its law."""
    for name, _, function, callback in callbacks(system):
        way = "a complex step" if function.derivatives == "complex_step" else "central differences"
        yield FUNCTION(name, function=callback.name, calls=callback.calls, way=way)


def _raised(fault: BaseException) -> str:
    return f"{type(fault).__name__}: {fault}" if str(fault) else type(fault).__name__
