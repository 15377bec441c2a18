"""Rows of a study in an SQLite file; completed rows survive an abnormal end of the process."""

from __future__ import annotations

import hashlib
import logging
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import numpy as np

from ..errors import InputError, SolverError
from ..reading.files.files_read import check_regular, digest_of_file
from ..reading.files.own_sources import CODE
from ..reading.files.quoted import quoted
from .case_solver import ChangedFileError, Row

OF_DISK = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR)
"""Primary error codes of a full or failing disk."""
FORMAT: Final = 2
"""Version of the tables, stored as SQLite's user version."""
_TABLES = """
create table if not exists parts (name text primary key, digest text not null);
create table if not exists files (name text primary key, digest text not null);
create table if not exists rows (
    number integer primary key, status text not null, message text not null, lengths blob not null, outputs blob not null,
    code blob not null
);
"""
LOGGER = logging.getLogger(__name__)


class Store:
    """Store of completed rows.

    Rows that cannot be written, for example on a full disk, are kept in memory and written later.

    `path`: file, which is created if it does not exist; None for a store in memory. `study`: everything that the rows
    depend on, by its name in messages; a store in which a part differs is refused. Raises InputError if the file
    belongs to another study, or is not a store; the message names the changed parts.
    """

    def __init__(self, path: Path | None, study: Mapping[str, str]) -> None:
        self._named = quoted(str(path)) if path else "the study"
        self._unwritten: dict[int, Row] = {}
        self._connection: sqlite3.Connection | None = None
        with self._readable():
            if path and path.exists():
                check_regular(path)
            self._connection = sqlite3.connect(path or ":memory:", isolation_level=None)
            self._connection.execute("pragma journal_mode = wal")
            self._connection.execute("pragma synchronous = normal")
            self._claim(
                {name: hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest() for name, text in study.items()}
            )
            self._drop_damaged()

    @property
    def _file(self) -> sqlite3.Connection:
        assert self._connection is not None
        return self._connection

    @contextmanager
    def _readable(self) -> Iterator[None]:
        """Raise an error if a file cannot be read as a store."""
        try:
            yield
        except (InputError, SolverError):
            self.close()
            raise
        except (sqlite3.Error, OSError, ValueError, TypeError, OverflowError) as error:
            self.close()
            reason = getattr(error, "strerror", None) or error
            if getattr(error, "sqlite_errorcode", 0) & 0xFF in OF_DISK:
                raise SolverError(f"{self._named}: the store cannot be written ({reason})") from None
            raise InputError(
                f"{self._named}: the store cannot be used ({reason}), expected the store of a study: remove the file to start again"
            ) from None

    def _claim(self, parts: Mapping[str, str]) -> None:
        """Assign a new file to a study, or check that it belongs to the study. Raises InputError if it does not."""
        tables = self._file.execute("select count(*) from sqlite_master").fetchone()[0]
        if tables and self._file.execute("pragma user_version").fetchone()[0] != FORMAT:
            raise self._of_another("stiffmbs")
        self._file.execute("begin immediate")
        for statement in filter(str.strip, _TABLES.split(";")):
            self._file.execute(statement)
        self._file.execute(f"pragma user_version = {FORMAT}")
        if not tables:
            self._file.executemany("insert into parts values (?, ?)", parts.items())
        self._file.execute("commit")
        found = dict(self._file.execute("select name, digest from parts"))
        changed = [name for name in {**parts, **found} if parts.get(name) != found.get(name)]
        files = [name for name in changed if name.startswith("'")]
        named = files or changed
        for name, digest in self._file.execute("select name, digest from files"):
            if not name.startswith(CODE) and digest_of_file(name) != digest:
                named = [*named, f"'{quoted(name)}'"]
        if named:
            raise self._of_another(" and ".join(named))

    def _of_another(self, changed: str) -> InputError:
        return InputError(
            f"{self._named}: found the rows of another study, in which {changed} had different content; expected rows of this study: "
            "remove the file to start again"
        )

    def _drop_damaged(self) -> None:
        """Remove rows whose content does not match its checksum, so that their cases are solved again."""
        damaged = [row[0] for row in self._file.execute("select * from rows") if _code(row[:-1]) != row[-1]]
        if damaged:
            self._file.executemany("delete from rows where number = ?", ((number,) for number in damaged))
            LOGGER.warning(
                "stiffmbs: note: %s: %d rows were damaged; their cases are solved again", self._named, len(damaged)
            )

    def done(self) -> set[int]:
        """Return the numbers of the stored cases."""
        with self._readable():
            return {number for (number,) in self._file.execute("select number from rows")}

    def add(self, rows: Iterable[Row]) -> None:
        """Write rows, all or none of them.

        Raises ChangedFileError if a file that the case of a row names had different content in another case.
        """
        self._unwritten |= {row.case: row for row in rows}
        if failed := self._write_rest():
            LOGGER.debug("%s: not written yet: %s", self._named, failed)

    def _write_rest(self) -> str:
        """Write the pending rows; return the reason if this is not possible, else an empty string."""
        rows = self._unwritten.values()
        try:
            self._file.execute("begin")
            for row in rows:
                self._add_files(row.files)
            self._file.executemany("insert or ignore into rows values (?, ?, ?, ?, ?, ?)", map(_packed, rows))
            self._file.execute("commit")
        except (sqlite3.Error, ChangedFileError) as error:
            with suppress(sqlite3.Error):
                self._file.execute("rollback")
            if isinstance(error, ChangedFileError):
                raise
            return str(error)
        self._unwritten = {}
        return ""

    def _add_files(self, files: Mapping[str, str]) -> None:
        for name, digest in files.items():
            self._file.execute("insert or ignore into files values (?, ?)", (_text(name), digest))
            (known,) = self._file.execute("select digest from files where name = ?", (_text(name),)).fetchone()
            if known != digest:
                raise ChangedFileError(f"'{quoted(name)}' has changed; expected the same content in all cases")

    def rows(self) -> Iterator[Row]:
        """Yield all rows in the order of the cases; log a note if some could not be written."""
        if self._unwritten and (failed := self._write_rest()):
            LOGGER.warning(
                "stiffmbs: note: %s: %d rows could not be stored (%s); another session solves their cases again",
                self._named, len(self._unwritten), failed,
            )  # fmt: skip
        with self._readable():
            kept = self._file.execute("select number, status, message, lengths, outputs from rows order by number")
            rest = sorted(self._unwritten)
            for number, status, message, lengths, outputs in kept:
                while rest and rest[0] < number:
                    yield self._unwritten[rest.pop(0)]
                yield Row(number, status, message, tuple(_unpacked(lengths, outputs)))
            yield from (self._unwritten[number] for number in rest)

    def close(self) -> None:
        """Try to write the pending rows, and close the file."""
        if self._connection is None:
            return
        if self._unwritten:
            with suppress(InputError):
                self._write_rest()
        with suppress(sqlite3.Error):
            self._connection.close()
        self._connection = None


def _text(found: str) -> str:
    """Return a text without lone surrogates, which SQLite does not accept."""
    return found.encode(errors="backslashreplace").decode()


def _code(columns: tuple[object, ...]) -> bytes:
    """Return the checksum of a row."""
    return hashlib.sha256(repr(columns).encode(errors="surrogatepass")).digest()


def _packed(row: Row) -> tuple[int, str, str, bytes, bytes, bytes]:
    """Return a row of the table; the length of a number is -1."""
    lengths = [len(value) if isinstance(value, np.ndarray) else -1 for value in row.values]
    numbers = np.concatenate([np.empty(0), *(np.atleast_1d(np.asarray(value, dtype="<f8")) for value in row.values)])
    columns = (
        row.case,
        row.status,
        _text(row.message),
        np.array(lengths, dtype="<i8").tobytes(),
        numbers.astype("<f8").tobytes(),
    )
    return *columns, _code(columns)


def _unpacked(lengths: bytes, outputs: bytes) -> Iterator[float | np.ndarray]:
    numbers, first = np.frombuffer(outputs, dtype="<f8"), 0
    for length in np.frombuffer(lengths, dtype="<i8"):
        count = max(int(length), 1) if length < 0 else int(length)
        yield float(numbers[first]) if length < 0 else numbers[first : first + count]
        first += count
