"""Arrays whose memory ends at a page that nobody may touch: compiled code that writes or reads behind one is stopped.

Every array of numpy, and the memory that compiled code asks for, is a mapping of its own.  What is in front of an array,
and the few bytes behind one that is no multiple of 8 bytes long, hold a pattern that is looked at when it is freed.
New memory holds not-a-numbers, so that a value that was never written shows.  Memory that is freed is no longer there.

References
----------
NEP 49, Data allocation strategies (numpy.org/neps); Perens, Electric Fence (1987), for the method.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import sys
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.compile.machine import layout
from stiffmbs.compile.machine.native.memory import REALLOCATE

SET_HANDLER = 304
"""Place of PyDataMem_SetHandler in numpy's C interface."""
PATTERN, NEVER_WRITTEN = 0xA5, 0xFF
"""Bytes around arrays, and in new ones: eight of the latter are a not-a-number, or -1."""
BROKEN = 70
"""Exit status of a process in which a pattern was overwritten."""
_WORD = 8

_P, _N = ctypes.c_void_p, ctypes.c_size_t
_MALLOC = ctypes.CFUNCTYPE(_P, _P, _N)
_CALLOC = ctypes.CFUNCTYPE(_P, _P, _N, _N)
_REALLOC = ctypes.CFUNCTYPE(_P, _P, _P, _N)
_FREE = ctypes.CFUNCTYPE(None, _P, _P, _N)
_RAW_REALLOC = ctypes.CFUNCTYPE(_P, _P, _N)


class _Allocator(ctypes.Structure):
    _fields_ = [("context", _P), ("malloc", _MALLOC), ("calloc", _CALLOC), ("realloc", _REALLOC), ("free", _FREE)]


class _Handler(ctypes.Structure):
    """PyDataMem_Handler of numpy/ndarraytypes.h."""

    _fields_ = [("name", ctypes.c_char * 127), ("version", ctypes.c_uint8), ("allocator", _Allocator)]


@dataclass(frozen=True)
class _Block:
    """A mapping of so many bytes from `base`, whose last page is the guard, and the size of the array in front of that."""

    base: int
    length: int
    size: int


class GuardPages:
    """Memory between guards, for all arrays that are made after `install`."""

    def __init__(self) -> None:
        self._blocks: dict[int, _Block] = {}
        self._c = ctypes.CDLL(None, use_errno=True)
        self._c.mmap.restype, self._c.mmap.argtypes = (
            _P,
            (_P, _N, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long),
        )
        self._c.mprotect.argtypes, self._c.munmap.argtypes = (_P, _N, ctypes.c_int), (_P, _N)

    @property
    def count(self) -> int:
        """Blocks in use."""
        return len(self._blocks)

    def install(self) -> None:
        """Take the place of the allocators of numpy and of compiled code; before any routine is loaded, and for good."""
        import llvmlite.binding as llvm

        own = _Allocator(
            None,
            _MALLOC(lambda _, size: self.new(size)),
            _CALLOC(lambda _, count, size: self.new(count * size, content=0)),
            _REALLOC(lambda _, at, size: self.resized(at, size)),
            _FREE(lambda _, at, size: self.free(at)),
        )
        self._kept: list[Any] = [_Handler(b"guard_pages", 1, own), _RAW_REALLOC(self.resized)]
        new_capsule = ctypes.pythonapi.PyCapsule_New
        new_capsule.restype, new_capsule.argtypes = ctypes.py_object, (_P, ctypes.c_char_p, _P)
        self._name = b"mem_handler"
        capsule = new_capsule(ctypes.addressof(self._kept[0]), self._name, None)
        pointer = ctypes.pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = _P, (ctypes.py_object, ctypes.c_char_p)
        table = ctypes.cast(pointer(np._core._multiarray_umath._ARRAY_API, None), ctypes.POINTER(_P))  # type: ignore[attr-defined]
        self._kept.append(ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(table[SET_HANDLER] or 0)(capsule))
        llvm.add_symbol(REALLOCATE, ctypes.cast(self._kept[1], _P).value)
        layout.RELEASE = lambda at: self.free(at.value)  # type: ignore[assignment]

    def new(self, size: int, content: int = NEVER_WRITTEN) -> int | None:
        """The address of so many bytes; None where there is no memory."""
        rounded = -(-max(size, 1) // _WORD) * _WORD
        pages = -(-rounded // mmap.PAGESIZE) * mmap.PAGESIZE
        flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
        base = self._c.mmap(None, pages + mmap.PAGESIZE, mmap.PROT_READ | mmap.PROT_WRITE, flags, -1, 0)
        if base in (None, ctypes.c_void_p(-1).value):
            return None
        self._c.mprotect(base + pages, mmap.PAGESIZE, 0)
        at = base + pages - rounded
        ctypes.memset(base, PATTERN, pages - rounded)
        ctypes.memset(at + size, PATTERN, rounded - size)
        if content:
            ctypes.memset(at, content, size)
        self._blocks[at] = _Block(base, pages + mmap.PAGESIZE, size)
        return int(at)

    def free(self, at: int | None) -> None:
        """Give memory back, after a look at what surrounds it."""
        if not at:
            return
        block = self._blocks.pop(at)
        end = block.base + block.length - mmap.PAGESIZE
        for first, count in ((block.base, at - block.base), (at + block.size, end - at - block.size)):
            if ctypes.string_at(first, count).strip(bytes([PATTERN])):
                sys.stderr.write(f"found a write outside of an array of {block.size} bytes\n")
                sys.stderr.flush()
                os._exit(BROKEN)
        self._c.munmap(block.base, block.length)

    def resized(self, at: int | None, size: int) -> int | None:
        """As realloc of the C library."""
        new = self.new(size)
        if new and at:
            ctypes.memmove(new, at, min(size, self._blocks[at].size))
            self.free(at)
        return new
