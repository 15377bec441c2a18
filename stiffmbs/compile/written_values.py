"""Elements that wrote given values of a term set."""

from __future__ import annotations

import numpy as np

from .group import Group
from .system import System
from .terms import TERM_SETS


def writer(system: System, term_set: str, at: int) -> str:
    """Return the name of the element that writes the value with a given index."""
    group, element = _writer(system, term_set, at)
    return group.names[element]


def beyond(system: System, limit: int) -> str:
    """Return the message for a violated limit, given its index among the values of the set ``event_function``."""
    group, element = _writer(system, "event_function", limit)
    return f"'{group.names[element]}': {group.kind.element.beyond}"  # type: ignore[attr-defined]


def _writer(system: System, term_set: str, at: int) -> tuple[Group, int]:
    for g, group in enumerate(system.groups):
        for k, term in enumerate(TERM_SETS[term_set]):
            width = group.entries[term]
            first = int(system.places[term_set][g, 1 + k])
            if first <= at < first + group.count * width:
                return group, (at - first) // width
    raise IndexError(f"the set {term_set} has no value {at}")


def values_of(system: System, values: np.ndarray, term_set: str, element: str) -> dict[str, np.ndarray]:
    """Return the values that one element wrote for each term of a set."""
    found = {}
    for g, group in enumerate(system.groups):
        if element in group.names:
            e = group.names.index(element)
            for k, term in enumerate(TERM_SETS[term_set]):
                width = group.entries[term]
                first = system.places[term_set][g, 1 + k] + e * width
                found[term] = values[first : first + width]
    return found
