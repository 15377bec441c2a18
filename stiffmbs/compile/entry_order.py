"""In which order the entries of a matrix are added up: few memory accesses, and the same sums as in the order given."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FEW = 0.5
"""Part of all slots below which those that entries begin do not matter: a dense matrix is cleared as a whole."""


class EntryOrder(NamedTuple):
    """An order of entries, and what slots begin with.

    Attributes
    ----------
    order : ndarray of int, shape (entries,)
        The entries: those that slots begin with, slot after slot, others of slots that do not depend on cj, and those of slots
        that do.
    n_first, n_constant : int
        Ends of the first two parts.
    n_cleared : int
        Number of slots that begin with zero, from the first one on: all or none.
    bare : ndarray of int
        Other slots that begin with zero.
    """

    order: np.ndarray
    n_first: int
    n_constant: int
    n_cleared: int
    bare: np.ndarray


def ordered_entries(slot: np.ndarray, cj: np.ndarray, n_slots: int) -> EntryOrder:
    """The order of entries that stand in these slots, with these parts in cj."""
    changing = np.zeros(n_slots, dtype=bool)
    changing[slot[cj != 0]] = True
    late = changing[slot]
    begins = np.full(n_slots, -1)
    begins[slot[::-1]] = np.arange(len(slot))[::-1]  # of equal indices the last assignment counts: the first entry
    begun = (begins >= 0) & ~changing
    first = begins[begun] if np.count_nonzero(begun) >= FEW * n_slots else begins[:0]
    others = np.ones(len(slot), dtype=bool)
    others[first] = False
    parts = (first, np.flatnonzero(others & ~late), np.flatnonzero(late))
    bare = np.flatnonzero(~begun) if len(first) else begins[:0]
    n_first, n_constant, _ = np.cumsum([len(part) for part in parts])
    return EntryOrder(np.concatenate(parts), int(n_first), int(n_constant), 0 if len(first) else n_slots, bare)
