"""The check that one of two fields is given, and not both."""

from __future__ import annotations


def exactly_one(first: tuple[str, object], second: tuple[str, object]) -> None:
    """Refuse two fields, each with its name and value, of which both or neither are given.

    Raises
    ------
    ValueError
        In the words of all errors of input.
    """
    names = f"'{first[0]}' and '{second[0]}'"
    given = sum(value is not None for _, value in (first, second))
    if given != 1:
        raise ValueError(f"found {'both' if given else 'neither'} of {names}, expected exactly one of them")
