"""Where in a dataset something is wrong."""

from __future__ import annotations

from ...errors import InputError


class DatasetFault(InputError):
    """What is wrong with a statement, and its line; the file's name is put before it by the reader of the file."""

    def __init__(self, line: int, label: str, reason: str) -> None:
        super().__init__(f"line {line}, {label}: {reason}")
        self.line = line
