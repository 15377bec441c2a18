"""Accuracy test of the pivots of J M^-1 J^T, which makes pivoting unnecessary."""

from stiffmbs.compile.machine.native.access import compiled

LOST = 1e-6
"""Least pivot relative to its diagonal entry; smaller ones require the LU with pivoting."""
SMALL, TOGETHER, RELATIVE = 1e-2, 1e-9, 1e-5
"""Relative size below which a pivot counts as small, bound for all small pivots together, and the same relative to the
best earlier value.  Along closed loops, losses of digits multiply; in trees, the smallest pivot counts."""


@compiled
def keeps_digits(r, pivot, diagonal):
    """Return True if a pivot is accurate relative to its diagonal entry; update the total loss."""
    if pivot > SMALL * diagonal:
        return True
    part = pivot / diagonal
    r.kept = min(r.kept, part) if r.trees else r.kept * part
    return part > LOST and r.kept > max(TOGETHER, RELATIVE * r.most_kept)
