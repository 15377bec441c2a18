"""Quotation of values in messages."""

from __future__ import annotations

from collections.abc import Sequence

MOST_QUOTED = 80
"""Largest length of a quotation; longer text is shortened in the middle."""
MOST_LISTED = 5
"""Largest number of names in a list."""


def quoted(found: object) -> str:
    """Return a text, or the `repr` of another value, shortened for a message.

    Examples
    --------
    >>> quoted("9**9**9")
    '9**9**9'
    >>> len(quoted("9" * 5000))
    80
    """
    return _shortened(found) if isinstance(found, str) else written(found)


def written(found: object) -> str:
    """Return the `repr` of a value, shortened for a message."""
    try:
        return _shortened(repr(found))
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, or too deep nesting
        return f"a large {type(found).__name__}"


def listed(names: Sequence[str]) -> str:
    """Return the first names of a list for a message, and the number of the others."""
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return ", ".join(names[:MOST_LISTED]) + more


def first_line(error: object) -> str:
    """Return the first line of an error's message, or the name of its type if it has none."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__


def _shortened(text: str) -> str:
    if len(text) <= MOST_QUOTED:
        return text
    half = (MOST_QUOTED - 5) // 2
    return f"{text[: MOST_QUOTED - 5 - half]} ... {text[-half:]}"
