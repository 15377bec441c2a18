"""Effective inertia of unknowns coupled by equations in a block system [D J^T; J 0]."""

from __future__ import annotations

from .access import compiled

LIGHT, SPREAD_OVER = 1e-6, 4
"""Part of the coupled inertia below which a body's own inertia is replaced; number of joints it spreads over."""
COUPLES = 0.1
"""Part of an equation's largest entry above which an entry couples; smaller ones would act as huge gear ratios."""


@compiled
def spread_inertia(f):
    """Replace small inertias in `work` by the coupled ones: D_k becomes the largest D_j (J_k/J_j)^2.

    A body without inertia on a hinge moves with the hinge. Scaled by its own inertia, its acceleration would be a
    difference of large numbers.
    """
    for _ in range(SPREAD_OVER):
        for row in range(f.n):
            if f.work[row] == 0.0:
                _spread(f, row)


@compiled
def _spread(f, row):
    """Spread inertia along one equation, whose row of J is its column in the symmetric matrix."""
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
