"""Check that exactly one of two fields is given."""

from __future__ import annotations


def exactly_one(first: tuple[str, object], second: tuple[str, object]) -> None:
    """Refuse a pair of fields, each with name and value, if both or neither are given.

    Raises
    ------
    ValueError
        With the message of an input error.
    """
    names = f"'{first[0]}' and '{second[0]}'"
    given = sum(value is not None for _, value in (first, second))
    if given != 1:
        raise ValueError(f"found {'both' if given else 'neither'} of {names}, expected exactly one of them")
