"""The inertia that an unknown of a block system [D J^T; J 0] feels through its equations."""

from __future__ import annotations

from .access import compiled

LIGHT, SPREAD_OVER = 1e-6, 4
"""Part of what joints couple a body to, below which its own inertia is no scale; joints over which that is looked at."""
COUPLES = 0.1
"""Part of an equation's largest entry from which on another one couples: one that a pose leaves near zero would count as a gear."""


@compiled
def spread_inertia(f):
    """Let each unknown that hardly resists feel what its equations couple it to: D_k in `work` becomes the largest D_j (J_k/J_j)^2.

    A body of no inertia on a hinge moves as the hinge and its mass say.  Scaled by its own inertia, its acceleration would be the
    difference of numbers that are larger by the ratio of both.
    """
    for _ in range(SPREAD_OVER):
        for row in range(f.n):
            if f.work[row] == 0.0:
                _spread(f, row)


@compiled
def _spread(f, row):
    """Along one equation, whose row of J is its column in the symmetric matrix."""
    largest = 0.0
    for p in range(f.a_start[row], f.a_start[row + 1]):
        largest = max(largest, abs(f.a[p]))
    heaviest = 0.0
    for p in range(f.a_start[row], f.a_start[row + 1]):
        k = f.a_row[p]
        if abs(f.a[p]) > COUPLES * largest and f.work[k] > 0.0:
            heaviest = max(heaviest, f.work[k] / (f.a[p] * f.a[p]))
    for p in range(f.a_start[row], f.a_start[row + 1]):
        k = f.a_row[p]
        coupled = heaviest * f.a[p] * f.a[p]
        if 0.0 < f.work[k] < LIGHT * coupled:
            f.work[k] = coupled
