"""Text for terminals and pages: names and files may hold characters that steer a terminal or turn the direction of writing.

Control characters (C0 and C1), formatting characters (such as bidirectional overrides and characters without width), separators of
lines other than a line feed, and what is no character are written as escapes, ``\\u202e``, which JSON reads as the same character.
Unicode Standard Annex 9, section 3.1; Unicode Technical Report 36, section 2.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

_UNUSUAL = re.compile("[^ -~\n\t]")
ESCAPED = ("Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp")
"""Categories of characters that are written as escapes."""
BASIC = 0xFFFF


def escaped(text: str) -> str:
    """Return a text in which what is no visible character, blank, tab or line feed stands as an escape.

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
    return f"\\u{ord(sign):04x}" if ord(sign) <= BASIC else f"\\U{ord(sign):08x}"


class EscapingStream:
    """A stream of text whose text is escaped; its bytes are out of reach.

    Parameters
    ----------
    stream : file object
        Of text.
    """

    def __init__(self, stream: Any) -> None:
        self.rich_proxied_file = stream
        """What consoles of rich write to, whose codes for a terminal are their own: see `console`."""

    def write(self, text: str | bytes) -> int:
        """Write text, or what bytes say in UTF-8, and return its length.

        Raises
        ------
        TypeError
            For no bytes, by which click finds out that this is a stream of text.
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
    """Return a console of rich that escapes text, and leaves it otherwise as it is; parameters as for `rich.console.Console`."""
    from rich.console import Console
    from rich.segment import Segment

    class EscapingConsole(Console):
        def render(self, *arguments: Any, **keywords: Any) -> Iterator[Segment]:
            for segment in super().render(*arguments, **keywords):
                yield segment if segment.control else segment._replace(text=escaped(segment.text))

    return EscapingConsole(markup=False, emoji=False, **options)


def page_text(found: Any) -> Any:
    """Return what a page shows of a value: text escaped, scripts and other values as they are."""
    return escaped(found) if type(found) is str else found
