"""Decisions of presolve."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.presolve import presolve
from stiffmbs.presolve.relations import Relations
from stiffmbs.presolve.spinning_bodies import _alike
from tests.decisions.common import Record, nothing
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def relations(n=2):
    return Relations(np.arange(n), np.ones(n), np.zeros(2, dtype=bool))


def solved_apart(count):
    replaced = {
        "mechanisms": lambda _: [None] * count,
        "merge": lambda *_: Record(members={}, axes={}),
        "_part": nothing,
    }
    with patch.multiple(presolve, **replaced):
        return bool(presolve.parts_of(None, Record(equations=(), active=()), None, apart=True))


def used(independence):
    """Return whether two rows of three coordinates are used together."""
    rows = {0: [(0, 1.0), (1, 1.0), (2, 1.0)], 1: [(0, 1.0), (1, 1.0), (2, 1.0 + independence)]}
    return relations(3).extended(rows)


DECISIONS = {
    "presolve.negligible": lambda: count_while(
        lambda part: len(relations()._by_independent([(0, 1.0), (1, part)])) == 2, HALVES
    ),
    "presolve.independent": lambda: count_while(used, HALVES),
    "presolve.alike": lambda: count_while(lambda off: _alike(1.0, 1.0 + 1e-14 * off), DOUBLES),
    "presolve.most_apart": lambda: count_while(solved_apart, range(2, 100)),
}
EXPECTED = {
    "presolve.negligible": 173, "presolve.independent": 72, "presolve.alike": 27,
    "presolve.most_apart": 7,
}  # fmt: skip
