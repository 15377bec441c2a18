"""Own functions in place of those of a linear solver of SUNDIALS."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import takewhile

import numpy as np

from ..native.statuses import CONTENT, NORM_TABLE, OPERATIONS
from .libraries import Libraries, Unavailable
from .session import Session

MOST_WORDS = 16
"""Words of a solver, or of its table of operations, that are looked through."""


def take_place(session: Session, solver: int, size: int, functions: Mapping[str, int], content: np.ndarray) -> None:
    """Put functions, and the content that they work on, in place of a solver's own; undone before it is freed.

    A solver holds its content, its operations and, last, its context.  The table of operations is found by the addresses that it holds, as the layout of SUNDIALS' structures moves between versions.

    Parameters
    ----------
    session : Session
    solver : int
        The SUNLinearSolver.
    size : int
        Its number of unknowns, by which its content is known.
    functions : dict of str to int
        The name of a function to replace, and the address of the one that takes its place.
    content : ndarray of int
        What takes the place of the content; the first three words are as in that.

    Raises
    ------
    Unavailable
        When the solver does not look as expected.
    """
    replaced = {session.libraries.address(name): address for name, address in functions.items()}
    own = list(takewhile(lambda word: word != session.context.value, _words(solver, MOST_WORDS)))
    table = next((t for t in own[1:] if t and set(replaced) <= set(_words(t, MOST_WORDS))), None)
    if table is None or session.libraries.index.from_address(own[CONTENT]).value != size:
        raise Unavailable("the SUNDIALS libraries lay out linear solvers in another way")
    for k, address in enumerate(_words(table, MOST_WORDS)):
        if address in replaced:
            _write(table, k, replaced[address])
    _write(solver, CONTENT, content.ctypes.data)
    session.before_freed(lambda: _write(solver, CONTENT, own[CONTENT]))


def take_norm(session: Session, vector: int, norm: int, table: np.ndarray) -> None:
    """Put a norm in place of N_VWrmsNorm in a vector's operations, and so in those of its later copies.

    The operation has no argument for a table of its own: its address takes the place of N_VBufPack, which IDA does not use.

    Parameters
    ----------
    session : Session
    vector : int
        The N_Vector.
    norm : int
        The address of the function.
    table : ndarray of int
        What the function works on.

    Raises
    ------
    Unavailable
        When the vector does not look as expected.
    """
    operations = list(_words(vector, OPERATIONS + 1))[OPERATIONS]
    words = list(_words(operations, NORM_TABLE + 1))
    own = session.libraries.address("N_VWrmsNorm_Serial")
    if words.count(own) != 1 or words[NORM_TABLE] != session.libraries.address("N_VBufPack_Serial"):
        raise Unavailable("the SUNDIALS libraries lay out vectors in another way")
    _write(operations, words.index(own), norm)
    _write(operations, NORM_TABLE, table.ctypes.data)


@cache
def replaceable(libraries: Libraries) -> bool:
    """Whether `take_place` works with these libraries: tried on a solver of two unknowns."""
    session = Session(libraries)
    values = np.zeros(2)
    try:
        matrix = session.keep(libraries.SUNBandMatrix(2, 0, 0, session.context), libraries.SUNMatDestroy, "a matrix")
        made = libraries.SUNLinSol_Band(session.vector(values), matrix, session.context)
        solver = session.keep(made, libraries.SUNLinSolFree, "a linear solver")
        unchanged = {name: libraries.address(name) for name in ("SUNLinSolSetup_Band", "SUNLinSolSolve_Band")}
        take_place(session, solver, 2, unchanged, np.zeros(3, dtype=np.int64))
    except Unavailable:
        return False
    finally:
        session.close()
    return True


def _words(address: int, count: int) -> Iterator[int]:
    return (ctypes.c_int64.from_address(address + 8 * k).value for k in range(count))


def _write(address: int, word: int, value: int) -> None:
    ctypes.c_int64.from_address(address + 8 * word).value = value
