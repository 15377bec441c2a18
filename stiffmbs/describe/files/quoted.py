"""Values as sentences quote them."""

from __future__ import annotations

MOST_QUOTED = 80
"""Characters of a quotation; what is longer is cut in its middle."""


def quoted(found: object) -> str:
    """A text, or another value as Python writes it, short enough for a sentence.

    Examples
    --------
    >>> quoted("9**9**9")
    '9**9**9'
    >>> len(quoted("9" * 5000))
    80
    """
    return _shortened(found) if isinstance(found, str) else written(found)


def written(found: object) -> str:
    """A value as Python writes it, text between quotation marks, short enough for a sentence."""
    try:
        return _shortened(repr(found))
    except (ValueError, RecursionError):  # a whole number of more than 4300 digits, or one nested too deep
        return f"a large {type(found).__name__}"


def _shortened(text: str) -> str:
    if len(text) <= MOST_QUOTED:
        return text
    half = (MOST_QUOTED - 5) // 2
    return f"{text[: MOST_QUOTED - 5 - half]} ... {text[-half:]}"
