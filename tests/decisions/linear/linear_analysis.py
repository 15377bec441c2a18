"""Decisions of linear analysis."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
from scipy.sparse import csc_array

from stiffmbs.errors import SolverError
from stiffmbs.linear_analysis import stability
from stiffmbs.linear_analysis.eigenvalues import _fastest_rate
from stiffmbs.linear_analysis.modes import _mode
from stiffmbs.linear_analysis.state_space import Constraints, _solved
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while

NO_JOINTS = csc_array((0, 2))


def moves(size):
    return _mode((1j, -1j), np.array([size, 0.0, 0.0]), np.eye(3), ("a",), np.ones(3)).participation


def is_regular(condition):
    with patch.object(np.linalg, "cond", lambda _: condition):
        try:
            _solved(np.ones((1, 1)), np.ones((1, 1)))
        except SolverError:
            return False
    return True


def searched(square=-1.5):
    """Return the shifts of a search, the number of w^2 that are asked for at each, and the w^2 that are accepted.

    `square`: the one w^2 that is found at each shift.
    """
    shifts, counts = [], []

    def found(whole, mass, count, start):
        shifts.append(whole[1, 1])
        counts.append(count)
        return np.array([1.0 / (square + shifts[-1])]), np.ones((2, 1))

    with patch.object(stability, "_largest_of_inverse", found):
        squares, _ = stability._near(csc_array(np.diag([1.0, 0.0])), NO_JOINTS, np.ones(2), np.ones(2))
    return shifts, counts, squares


def iteration():
    """Return the settings of Arnoldi's iteration."""
    with patch.object(stability, "eigs", lambda operator, **settings: settings):
        return stability._largest_of_inverse(csc_array(np.eye(2)), np.ones(2), 1, np.ones(2))


def zero_by_imbalance():
    """Return the w^2 of a free body of 1 kg that count as zero, if 1 N is left."""
    none = np.zeros((1, 1))
    return stability.lowest(none, np.zeros((0, 1)), np.ones(1), np.ones(1), np.ones(1)).none[0]


DECISIONS = {
    "linear_analysis.close": lambda: _fastest_rate(np.diag([0.0, 1.0]), 1, 2),
    "linear_analysis.no_motion": lambda: count_while(moves, HALVES),
    "linear_analysis.dependent": lambda: count_while(
        lambda off: Constraints(np.array([[1.0, 0.0], [1.0, off]]))._rank == 2, HALVES
    ),
    "linear_analysis.singular": lambda: count_while(is_regular, DOUBLES),
    "linear_analysis.imbalance": zero_by_imbalance,
    "linear_analysis.least_shift": lambda: min(searched()[0]),
    "linear_analysis.most_free": lambda: max(searched()[1]),
    "linear_analysis.most_restarts": lambda: iteration()["maxiter"],
    "linear_analysis.accuracy": lambda: iteration()["tol"],
    "linear_analysis.own": lambda: count_while(lambda part: len(searched(-2e-15 * part)[2]) == 1, DOUBLES),
}
EXPECTED = {
    "linear_analysis.close": 1e-06, "linear_analysis.no_motion": 160, "linear_analysis.dependent": 120,
    "linear_analysis.singular": 200, "linear_analysis.imbalance": 100, "linear_analysis.least_shift": 1e-14,
    "linear_analysis.most_free": 6, "linear_analysis.most_restarts": 5, "linear_analysis.accuracy": 0.001,
    "linear_analysis.own": 6,
}  # fmt: skip
