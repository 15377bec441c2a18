"""Accuracy test of the pivots of J M^-1 J^T, which makes pivoting unnecessary."""

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.dynamics.native.parameters import ELIMINATION


@compiled
def keeps_digits(r, pivot, diagonal):
    """Return True if a pivot is accurate relative to its diagonal entry; update the total loss."""
    if pivot > ELIMINATION.small * diagonal:
        return True
    part = pivot / diagonal
    r.kept = min(r.kept, part) if r.trees else r.kept * part
    return part > ELIMINATION.lost and r.kept > max(ELIMINATION.together, ELIMINATION.relative * r.most_kept)
