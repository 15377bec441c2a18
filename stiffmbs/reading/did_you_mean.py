"""Suggestion of the valid name nearest to a misspelt one."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from .files.quoted import quoted

LEAST = 0.65
"""Smallest similarity of a suggested name, as a part of 1."""


def did_you_mean(found: object, known: Iterable[object]) -> str:
    """Return a question for a message, after the name that was found; empty if no valid name is similar.

    Names of the same owner, as in ``bar.x`` and ``bar.y``, are compared without the owner.

    Examples
    --------
    >>> did_you_mean("stifness", ["mass", "stiffness"])
    " (did you mean 'stiffness'?)"
    >>> did_you_mean("colour", ["mass", "stiffness"])
    ''
    """
    from difflib import get_close_matches

    text = quoted(found).casefold()
    names = {quoted(name).casefold(): quoted(name) for name in known}
    owner = text[: text.rfind(".") + 1]
    owned = {name.removeprefix(owner): full for name, full in names.items() if name.startswith(owner)}
    near = get_close_matches(text.removeprefix(owner) if owned else text, owned or names, 1, LEAST)
    return f" (did you mean '{(owned or names)[near[0]]}'?)" if near else ""


def instead_of(found: object, known: Collection[str]) -> str:
    """Return the end of a message, after the name that was found: the nearest valid name and a list of all."""
    return f"{did_you_mean(found, known)}, expected one of {', '.join(known) or 'none'}"
