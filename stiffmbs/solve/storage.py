"""Memory for results: in memory, and in a temporary file where they are large."""

from __future__ import annotations

import errno
import math
import mmap
import os
import tempfile
from collections.abc import Iterator, Mapping

import numpy as np

from ..errors import InputError

LARGEST_IN_MEMORY = 2**26
"""Bytes of an array that is still held in memory."""

BLOCK = 100_000
"""Rows that are written or read before memory is let go of."""


def allocated(*shape: int) -> np.ndarray:
    """An array of floats of any content.

    Where it is large it lies in a file that vanishes with it: the system keeps in memory what it has space for.

    Raises
    ------
    InputError
        When there is no space for the file.
    """
    size = 8 * math.prod(shape)
    if size <= LARGEST_IN_MEMORY:
        return np.empty(shape)
    with tempfile.TemporaryFile(prefix="stiffmbs-") as file:
        _reserve(file.fileno(), size)
        return np.frombuffer(mmap.mmap(file.fileno(), size), dtype=float).reshape(shape)


def _reserve(file: int, size: int) -> None:
    """Give a file its size and, where the system can, its space: on a full disk a write through memory ends the process."""
    try:
        os.truncate(file, size)
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(file, 0, size)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise InputError(
                f"found too little space in {tempfile.gettempdir()}, expected {size / 1e9:.2g} GB for a part of the results: "
                "ask for fewer output points, or let the variable TMPDIR name a larger folder"
            ) from None
        if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):  # of file systems that cannot reserve
            raise


def release(*arrays: np.ndarray) -> None:
    """Let go of the memory of arrays that lie in files; what they hold stays."""
    for array in arrays:
        memory = _mapped(array)
        if memory is not None and hasattr(memory, "madvise"):
            memory.madvise(mmap.MADV_DONTNEED)


def blocks(count: int) -> Iterator[slice]:
    """The rows of a table in blocks."""
    for first in range(0, count, BLOCK):
        yield slice(first, min(first + BLOCK, count))


def all_finite(*arrays: np.ndarray) -> bool:
    """Whether all numbers of some arrays are finite."""
    return all(map(_finite, arrays))


def with_gaps(channels: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The channels of which not all values are finite, by blocks of rows: one of a large run lies in a file."""
    return {name: values for name, values in channels.items() if not _finite(values)}


def _finite(values: np.ndarray) -> bool:
    for block in blocks(len(values)):
        # a sum of large values overflows
        finite = math.isfinite(values[block].sum()) or np.isfinite(values[block]).all()
        release(values)
        if not finite:
            return False
    return True


def _mapped(array: np.ndarray) -> mmap.mmap | None:
    """The mapping that an array, or what it is a view of, lies in."""
    owner: object = array
    while isinstance(owner, np.ndarray):
        owner = owner.base
    found = owner.obj if isinstance(owner, memoryview) else owner
    return found if isinstance(found, mmap.mmap) else None
