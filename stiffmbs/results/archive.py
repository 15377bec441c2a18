"""Writing of arrays to an uncompressed NumPy archive (.npz).

`zipfile` seeks back to the head of each member, which takes five times as long as the arrays of a short run.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Final
from zlib import crc32

import numpy as np

from ..dynamics.storage import blocks, release

VERSION: Final = 45
"""Version of the ZIP format with sizes of 64 bits."""
NAMES_IN_UTF8: Final = 0x800
FIRST_OF_1980: Final = 33
"""Earliest date of the format; a constant one makes the same results the same file."""
IN_64_BITS: Final = 2**32 - 1
MEMBERS_IN_64_BITS: Final = 2**16 - 1
"""Entries of 32 and 16 bits whose values follow in fields of 64 bits."""


def write_archive(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Write an archive that `numpy.load` reads, one array after the other to save memory.

    PKWARE, .ZIP File Format Specification (APPNOTE 6.3.10), sec. 4.3; ZIP64 throughout, as `numpy.savez` writes it.

    `path`: file to write; it may be a pipe. `arrays`: arrays of numbers or of text by name.
    """
    directory: list[bytes] = []
    place = 0
    with path.open("wb", buffering=2**20) as file:
        for name, values in arrays.items():
            code = 0
            for piece in _pieces(values):
                code = crc32(piece, code)
            member = f"{name}.npy".encode()
            size = len(_head(values.dtype, values.shape)) + values.nbytes
            common = struct.pack(
                "<5H3LH", VERSION, NAMES_IN_UTF8, 0, 0, FIRST_OF_1980, code, *[IN_64_BITS] * 2, len(member)
            )
            local = b"PK\3\4" + common + struct.pack("<H", 20) + member + struct.pack("<2H2Q", 1, 16, size, size)
            directory.append(
                struct.pack("<4sH", b"PK\1\2", VERSION)
                + common
                + struct.pack("<4H2L", 28, 0, 0, 0, 0, IN_64_BITS)
                + member
                + struct.pack("<2H3Q", 1, 24, size, size, place)
            )
            file.write(local)
            for piece in _pieces(values):
                file.write(piece)
            place += len(local) + size
        entries = b"".join(directory)
        file.write(entries)
        counts = [len(directory)] * 2
        file.write(struct.pack("<4sQ2H2L4Q", b"PK\6\6", 44, VERSION, VERSION, 0, 0, *counts, len(entries), place))
        file.write(struct.pack("<4sLQL", b"PK\6\7", 0, place + len(entries), 1))
        file.write(struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, *[MEMBERS_IN_64_BITS] * 2, *[IN_64_BITS] * 2, 0))


def _pieces(values: np.ndarray) -> Iterator[bytes | memoryview]:
    """Yield the head of an array and its values in blocks."""
    yield _head(values.dtype, values.shape)
    flat = values.reshape(-1)
    for block in blocks(len(flat)):
        yield np.ascontiguousarray(flat[block]).data
        release(values)


@lru_cache
def _head(dtype: np.dtype, shape: tuple[int, ...]) -> bytes:
    """Return the head of a .npy file."""
    head = io.BytesIO()
    form = {"descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(head, form)
    return head.getvalue()
