"""Tables with memory that compiled code asks for, which is given back with the table."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Mapping
from typing import Any

import numpy as np

from .layout import OWN, Layout, packed

RELEASE = ctypes.pythonapi.PyMem_RawFree
"""Frees what `stiffmbs.compile.machine.native.memory` has asked for."""


def packed_with_memory(layout: Layout, values: Mapping[str, Any]) -> np.ndarray:
    """As `stiffmbs.compile.machine.layout.packed`; the arrays of compiled code's own are freed when nothing refers to the table.

    Whoever uses the address of the table must keep the array that is returned.
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
