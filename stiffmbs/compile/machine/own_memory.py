"""Tables with memory allocated by compiled code and freed with the table."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Mapping
from typing import Any

import numpy as np

from .layout import OWN, Layout, packed

RELEASE = ctypes.pythonapi.PyMem_RawFree
"""Frees the memory of `stiffmbs.compile.machine.native.memory`."""


def packed_with_memory(layout: Layout, values: Mapping[str, Any]) -> np.ndarray:
    """Return a table as `stiffmbs.compile.machine.layout.packed`; compiled code's own arrays are freed with it.

    Users of the table's address must keep the returned array.
    """
    words = packed(layout, values)
    own = [column for column, kind in enumerate(layout.values()) if kind in OWN]
    table = words.view()
    weakref.finalize(table, _free, words, own).atexit = False
    return table


def _free(words: np.ndarray, columns: list[int]) -> None:
    for column in columns:
        RELEASE(ctypes.c_void_p(int(words[column])))
        words[column] = 0
