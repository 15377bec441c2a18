"""Reading of result files whose content may be damaged."""

from __future__ import annotations

import struct
import tokenize
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree.ElementTree import ParseError
from zipfile import BadZipFile

from ..reading.files.files_read import check_regular

RAISED = (
    BadZipFile, zlib.error, struct.error, tokenize.TokenError, ParseError, ArithmeticError, AssertionError, AttributeError,
    EOFError, LookupError, NotImplementedError, RuntimeError, SyntaxError, TypeError,
)  # fmt: skip
"""Exceptions that readers of archives, arrays, tables and XML raise for damaged content."""


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Read a regular file with arbitrary content.

    Raises OSError if it is not a regular file, or cannot be read. Raises ValueError if its content cannot be read.
    """
    check_regular(path)
    try:
        yield
    except ValueError:
        raise
    except RAISED as error:
        raise ValueError(f"damaged content ({type(error).__name__})") from error
