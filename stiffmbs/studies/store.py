"""Rows of a study in an SQLite file: whole rows survive however the process ends."""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType

import numpy as np

from ..errors import InputError
from .case_solver import Row

_TABLES = """
create table if not exists study (fingerprint text not null);
create table if not exists rows (
    number integer primary key, status text not null, message text not null, lengths blob not null, outputs blob not null
);
"""


class Store:
    """The rows that are done.

    Parameters
    ----------
    path : Path or None
        The file, made where there is none; in memory without it.
    study : bytes
        All that the rows follow from: a file of another study is refused.

    Raises
    ------
    InputError
        When the file is that of another study, or none at all.
    """

    def __init__(self, path: Path | None, study: bytes) -> None:
        self._named = str(path) if path else "the study"
        try:
            self._connection = sqlite3.connect(path or ":memory:", isolation_level=None)
            self._connection.execute("pragma journal_mode = wal")
            self._connection.execute("pragma synchronous = normal")
            self._connection.executescript(_TABLES)
            self._claim(hashlib.sha256(study).hexdigest())
        except sqlite3.Error as error:
            raise InputError(f"{self._named}: {error}, expected a file of a study, or none") from None

    def _claim(self, fingerprint: str) -> None:
        self._connection.execute("begin immediate")
        found = self._connection.execute("select fingerprint from study").fetchone()
        if found is None:
            self._connection.execute("insert into study values (?)", (fingerprint,))
        self._connection.execute("commit")
        if found is not None and found[0] != fingerprint:
            self._connection.close()
            raise InputError(
                f"{self._named}: found the rows of another study, or of another version of the scene or of stiffmbs; "
                "expected those of this one: remove the file to begin anew"
            )

    def done(self) -> set[int]:
        """The numbers of the cases that are there."""
        return {number for (number,) in self._connection.execute("select number from rows")}

    def add(self, rows: Iterable[Row]) -> None:
        """Write rows, all or none of them."""
        self._connection.execute("begin")
        self._connection.executemany("insert or ignore into rows values (?, ?, ?, ?, ?)", map(_packed, rows))
        self._connection.execute("commit")

    def rows(self) -> Iterator[Row]:
        """All rows, in the order of the cases."""
        for number, status, message, lengths, outputs in self._connection.execute("select * from rows order by number"):
            yield Row(number, status, message, tuple(_unpacked(lengths, outputs)))

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.close()


def _packed(row: Row) -> tuple[int, str, str, bytes, bytes]:
    """A row of the table; the length of a number is -1."""
    lengths = [len(value) if isinstance(value, np.ndarray) else -1 for value in row.values]
    numbers = np.concatenate([np.empty(0), *(np.atleast_1d(np.asarray(value, dtype="<f8")) for value in row.values)])
    return row.case, row.status, row.message, np.array(lengths, dtype="<i8").tobytes(), numbers.astype("<f8").tobytes()


def _unpacked(lengths: bytes, outputs: bytes) -> Iterator[float | np.ndarray]:
    numbers, first = np.frombuffer(outputs, dtype="<f8"), 0
    for length in np.frombuffer(lengths, dtype="<i8"):
        count = max(int(length), 1) if length < 0 else int(length)
        yield float(numbers[first]) if length < 0 else numbers[first : first + count]
        first += count
