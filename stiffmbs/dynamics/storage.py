"""Storage of results in memory, or in a temporary file if they are large."""

from __future__ import annotations

import errno
import math
import mmap
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..compile.machine.native.statuses import (
    NO_BALANCE,
    NO_CONVERGENCE,
    NO_MEMORY,
    NO_STATE,
    NOT_FINITE,
    NOT_FINITE_WITHIN,
    SINGULAR,
)
from ..errors import InputError
from ..tuning import tuned


@dataclass(frozen=True)
class StorageParameters:
    """Parameters of the memory of results; results do not depend on them. Source: tests/dynamics/test_storage.py."""

    largest_in_memory: int = 2**24
    """Size of the largest array held in memory, bytes."""
    block: int = 100_000
    """Number of rows that are written or read before memory is released."""


STORAGE = tuned("storage", StorageParameters())


def allocated(*shape: int) -> np.ndarray:
    """Return an uninitialized array of floats.

    A large array is mapped to a temporary file, which is deleted with it. Raises InputError when there is no space for
    the file.
    """
    size = 8 * math.prod(shape)
    if size <= STORAGE.largest_in_memory:
        return np.empty(shape)
    import tempfile

    with tempfile.TemporaryFile(prefix="stiffmbs-") as file:
        _reserve(file.fileno(), size)
        return np.frombuffer(mmap.mmap(file.fileno(), size), dtype=float).reshape(shape)


def _reserve(file: int, size: int) -> None:
    """Set the size of a file and reserve its space, as writing to a mapping on a full disk ends the process."""
    try:
        os.truncate(file, size)
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(file, 0, size)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            from tempfile import gettempdir

            raise InputError(
                f"found too little space in {gettempdir()}, expected {size / 1e9:.2g} GB for a part of the results: "
                "ask for fewer output points, or let the variable TMPDIR name a larger folder"
            ) from None
        if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):  # file systems that cannot reserve
            raise


def release(*arrays: np.ndarray) -> None:
    """Release the memory of arrays that are mapped to files; their contents stay."""
    for array in arrays:
        memory = _mapped(array)
        if memory is not None and hasattr(memory, "madvise"):
            memory.madvise(mmap.MADV_DONTNEED)


def blocks(count: int) -> Iterator[slice]:
    """Yield the rows of a table in blocks."""
    block = STORAGE.block
    for first in range(0, count, block):
        yield slice(first, min(first + block, count))


def all_finite(*arrays: np.ndarray) -> bool:
    """Return True if all numbers of some arrays are finite."""
    return all(map(_finite, arrays))


def with_gaps(channels: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the channels with values that are not finite."""
    return {name: values for name, values in channels.items() if not _finite(values)}


def _finite(values: np.ndarray) -> bool:
    for block in blocks(len(values)):
        # a sum of large values may overflow
        finite = math.isfinite(values[block].sum()) or np.isfinite(values[block]).all()
        release(values)
        if not finite:
            return False
    return True


def _mapped(array: np.ndarray) -> mmap.mmap | None:
    """Return the mapping that holds an array or the base of a view, or None."""
    owner: object = array
    while isinstance(owner, np.ndarray):
        owner = owner.base
    found = owner.obj if isinstance(owner, memoryview) else owner
    return found if isinstance(found, mmap.mmap) else None


FAILURES = {
    SINGULAR: "the constraint equations are dependent",
    NO_CONVERGENCE: "the positions could not be projected onto the constraints",
    NOT_FINITE: "an equation or an acceleration has no finite value",
    NOT_FINITE_WITHIN: "an equation or an acceleration has no finite value near the motion, within the last step",
    NO_BALANCE: "friction and reactions have no unique solution (a joint jams, or there is too much friction)",
    NO_STATE: "the equations of algebraic states have no solution near their last values",
    NO_MEMORY: "there is too little memory for the factors of the block system; use fewer bodies, or close other programs",
}
"""Clause for each failure of the compiled routines (`stiffmbs.compile.machine.native.statuses`)."""
