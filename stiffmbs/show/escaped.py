"""Escaping of control and formatting characters in text for terminals and pages.

Names and files may hold characters that control a terminal or change the writing direction.  The following are written
as escapes that JSON reads as the same character, such as ``\\u202e``: control characters (C0 and C1), formatting
characters (such as bidirectional overrides and zero-width characters), line separators other than a line feed, and code
points without a character. Unicode Standard Annex 9, section 3.1; Unicode Technical Report 36, section 2.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from rich.console import Console

_UNUSUAL = re.compile("[^ -~\n\t]")
ESCAPED = ("Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp")
"""Unicode categories that are escaped."""


def escaped(text: str) -> str:
    """Return a text with escapes for all characters except visible ones, blanks, tabs and line feeds.

    Examples
    --------
    >>> escaped("a\\x9b31mb")
    'a\\\\u009b31mb'
    """
    return _UNUSUAL.sub(_escape, text)


def _escape(found: re.Match[str]) -> str:
    sign = found[0]
    if unicodedata.category(sign) not in ESCAPED:
        return sign
    return f"\\u{ord(sign):04x}" if ord(sign) <= 0xFFFF else f"\\U{ord(sign):08x}"


class EscapingStream:
    """Text stream that escapes its text and gives no access to its bytes. `stream`: text stream."""

    def __init__(self, stream: TextIO) -> None:
        self.rich_proxied_file = stream
        """Underlying stream for consoles of rich, which write terminal codes themselves: see `console`."""

    def write(self, text: str | bytes) -> int:
        """Write text, or bytes in UTF-8, and return the length.

        Raises TypeError for empty bytes, with which click tests for a text stream.
        """
        if not text and not isinstance(text, str):
            raise TypeError("found bytes, expected text")
        shown = text if isinstance(text, str) else text.decode(errors="backslashreplace")
        self.rich_proxied_file.write(escaped(shown))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        if name == "buffer":
            raise AttributeError(name)
        return getattr(self.rich_proxied_file, name)


def console(**options: Any) -> Console:
    """Return a console of rich that escapes text and does not format it; parameters as for `rich.console.Console`."""
    from rich.console import Console
    from rich.segment import Segment

    class EscapingConsole(Console):
        """Console that escapes text as it prints; control codes are unchanged."""

        def render(self, *arguments: Any, **keywords: Any) -> Iterator[Segment]:
            for segment in super().render(*arguments, **keywords):
                yield segment if segment.control else segment._replace(text=escaped(segment.text))

    return EscapingConsole(markup=False, emoji=False, **options)


def page_text(found: object) -> Any:
    """Return a value for a page: text is escaped, scripts and other values are unchanged."""
    return escaped(found) if isinstance(found, str) and not hasattr(found, "__html__") else found
