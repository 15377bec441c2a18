"""Accuracy test of the pivots of J M^-1 J^T, which makes pivoting unnecessary."""

from sys import float_info

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.dynamics.native.parameters import ELIMINATION

EPSILON = float_info.epsilon


@compiled
def keeps_digits(r, pivot, diagonal):
    """Return True if a pivot is accurate relative to its diagonal entry; update the total loss."""
    if pivot > ELIMINATION.small * diagonal:
        return True
    part = pivot / diagonal
    r.kept = min(r.kept, part) if r.trees else r.kept * part
    if (
        r.trees and not r.by_pins
    ):  # of a light body: accelerations are corrected once, which squares their error EPSILON / part
        return part * part > EPSILON * ELIMINATION.lost
    return part > ELIMINATION.lost and r.kept > max(ELIMINATION.together, ELIMINATION.relative * r.most_kept)
