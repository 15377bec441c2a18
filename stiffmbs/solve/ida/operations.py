"""Replacement of operations in SUNDIALS objects by the package's own functions."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from itertools import takewhile
from typing import Final

import numpy as np

from ...compile.machine.native.statuses import CONTENT, NORM_TABLE, OPERATIONS
from .libraries import Unavailable
from .session import Session

MOST_WORDS: Final = 16
"""Number of words searched in a solver or in its table of operations, both of which are shorter in SUNDIALS."""


def take_place(session: Session, solver: int, size: int, functions: Mapping[str, int], content: np.ndarray) -> None:
    """Replace functions and content of a linear solver; the content is restored before the solver is freed.

    A solver holds its content, its operations and, last, its context.  The table of operations is found by its
    addresses, because the layout of SUNDIALS structures depends on the version. `solver`: SUNLinearSolver. `size`:
    number of unknowns, which identifies the content. `functions`: names of the functions to replace, and addresses of
    their replacements. `content`: replacement of the content; its first three words are as in the original. Raises
    Unavailable if the layout of the solver is unknown.
    """
    replaced = {session.libraries.address(name): address for name, address in functions.items()}
    own = list(takewhile(lambda word: word != session.context.value, _words(solver, MOST_WORDS)))
    table = next((t for t in own[1:] if t and set(replaced) <= set(_words(t, MOST_WORDS))), None)
    if table is None or ctypes.c_int32.from_address(own[CONTENT]).value != size:
        raise Unavailable("the SUNDIALS libraries lay out linear solvers in another way")
    for k, address in enumerate(_words(table, MOST_WORDS)):
        if address in replaced:
            _write(table, k, replaced[address])
    _write(solver, CONTENT, content.ctypes.data)
    session.before_freed(lambda: _write(solver, CONTENT, own[CONTENT]))


def take_norm(session: Session, vector: int, norm: int, table: np.ndarray) -> None:
    """Replace N_VWrmsNorm in the operations of a vector, and thereby in those of its later clones.

    The operation has no argument for a table: the table's address replaces N_VBufPack, which IDA does not use.
    `vector`: N_Vector. `norm`: address of the function. `table`: table of the function's data. Raises Unavailable if
    the layout of the vector is unknown.
    """
    operations = list(_words(vector, OPERATIONS + 1))[OPERATIONS]
    words = list(_words(operations, NORM_TABLE + 1))
    own = session.libraries.address("N_VWrmsNorm_Serial")
    if words.count(own) != 1 or words[NORM_TABLE] != session.libraries.address("N_VBufPack_Serial"):
        raise Unavailable("the SUNDIALS libraries lay out vectors in another way")
    _write(operations, words.index(own), norm)
    _write(operations, NORM_TABLE, table.ctypes.data)


def _words(address: int, count: int) -> Iterator[int]:
    return (ctypes.c_int64.from_address(address + 8 * k).value for k in range(count))


def _write(address: int, word: int, value: int) -> None:
    ctypes.c_int64.from_address(address + 8 * word).value = value
