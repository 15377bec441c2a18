"""Whether the pivots of J M^-1 J^T keep enough digits, so that no pivoting is needed."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled

LOST = 1e-6
"""A pivot that keeps less than this part of its diagonal entry is left to the LU with pivoting."""
SMALL, TOGETHER, BESIDE = 1e-2, 1e-9, 1e-5
"""Pivots that keep less than the first part, and what they may keep together: where joints close loops, the loss of digits of one
is passed on to the next.  In trees the smallest counts.  Beside what they have kept elsewhere on the way they may keep the last part."""


@compiled
def keeps_digits(r, pivot, diagonal):
    """Whether a pivot keeps enough of its diagonal entry; notes what all keep together so far."""
    if pivot > SMALL * diagonal:
        return True
    part = pivot / diagonal
    r.kept = min(r.kept, part) if r.trees else r.kept * part
    return part > LOST and r.kept > max(TOGETHER, BESIDE * r.most_kept)
