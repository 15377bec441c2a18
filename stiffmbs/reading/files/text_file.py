"""Text files: encoding and lines."""

from __future__ import annotations

import codecs
import math
import re
import sys
from pathlib import Path

from ...errors import InputError
from .files_read import LARGEST, content_of
from .quoted import quoted

STANDARD_INPUT = "-"
"""File name that denotes standard input."""
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
"""Byte order marks; UTF-32 comes before UTF-16, as its mark begins with that of UTF-16."""
_PADDING = "\0\x1a"
"""Padding at the end of files of older systems."""


def source_name(path: str | Path) -> str:
    """Return the name of a file in messages."""
    return "standard input" if str(path) == STANDARD_INPUT else str(path)


def file_text(path: str | Path, otherwise: str = "", zero: str = "", expected: str = "a scene") -> str:
    """Read a text file, or standard input for the name ``-``.

    `otherwise`: encoding of a file that is neither UTF-8 nor UTF-16; such a file is refused if it is empty. `zero`:
    replacement of zero bytes; files with zero bytes are refused if it is empty. `expected`: kind of file, for messages.
    Raises InputError if the file cannot be read, is not a regular file, is larger than `LARGEST`, or is not text.
    """
    content = _standard_input() if str(path) == STANDARD_INPUT else file_content(path, expected)
    return decoded(content, source_name(path), otherwise, zero)


def file_content(path: str | Path, expected: str) -> bytes:
    """Read a regular file; errors as for `file_text`."""
    try:
        return content_of(path)
    except FileNotFoundError:
        raise InputError(f"{path}: found no such file, expected {expected}") from None
    except (OSError, ValueError) as error:  # a name may contain characters that no file system accepts
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{quoted(str(path))}: the file cannot be read ({reason})") from None


def _standard_input() -> bytes:
    if sys.stdin is None:
        raise InputError(f"{source_name(STANDARD_INPUT)}: found it closed, expected a scene")
    content = sys.stdin.buffer.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise InputError(f"{source_name(STANDARD_INPUT)}: found more than {LARGEST} bytes, expected a scene")
    return content


def decoded(content: bytes, source: str, otherwise: str = "", zero: str = "") -> str:
    """Decode bytes as UTF-8, UTF-16 or UTF-32 by their mark, or as UTF-16 by zero bytes; errors as `file_text`."""
    encoding = next((name for mark, name in _MARKS if content.startswith(mark)), None) or _unmarked(content)
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        if not otherwise or encoding != "utf-8":
            name = encoding.upper().removesuffix("-SIG")
            raise InputError(f"{source}: the file cannot be read (it is not {name} text)") from None
        text = content.decode(otherwise)
    return checked(text, source, zero)


def checked(text: str, source: str, zero: str = "") -> str:
    """Return a text without byte order mark and padding; refuse zero bytes unless `zero` replaces them."""
    text = text.removeprefix("\ufeff").rstrip(_PADDING)
    if "\0" in text and zero:
        return text.replace("\0", zero)
    if "\0" in text:
        line = len(lines(text[: text.index("\0")] + "x"))
        raise InputError(f"{source}, line {line}: found a zero byte, expected text")
    return text


def _unmarked(content: bytes) -> str:
    """Return UTF-16 if one of the first two bytes is zero, as for ASCII characters, otherwise UTF-8."""
    first = content[:4]
    if first[1:2] == b"\0" and first[:1] != b"\0":
        return "utf-16-le"
    return "utf-16-be" if first[:1] == b"\0" and first[1:2] not in (b"\0", b"") else "utf-8"


def lines(text: str) -> list[str]:
    """Split a text at CR and LF only; `str.splitlines` also splits at form feeds, U+0085 and U+2028."""
    found = re.split(r"\r\n|\r|\n", text)
    return found[:-1] if not found[-1] else found


def finite_number(text: str, where: str) -> float:
    """Return a finite number in a file of another program, whose exponent may be D as in Fortran.

    Raises InputError for any other text; the message begins with `where`.
    """
    try:
        value = float(re.sub("[dD]", "e", text))
    except ValueError:
        raise InputError(f"{where}: found '{quoted(text)}', expected a number") from None
    if not math.isfinite(value):
        raise InputError(f"{where}: found '{quoted(text)}', expected a finite number")
    return value
