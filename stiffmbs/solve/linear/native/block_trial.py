"""Trials of the factors of a block LU: what they leave of a state of the system's own size.

References
----------
Oettli and Prager, Compatibility of approximate solution of linear equations, Numer. Math. 6 (1964) 405-409: the residual's measure.
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, factors_view
from stiffmbs.solve.linear.native.block_solution import solved

LARGEST_RESIDUAL, REFINABLE = 1e-9, 1e-5
"""Part of the sizes of a row's terms that a trial may leave, and from which on one refinement of each solution is not tried: it leaves about
the square.  Fixed orders leave 1e-13 to 1e-15, in long steps of a car on bushings of 1e9 N/m up to 1e-9."""
CHANGED = 8.0
"""Factor by which the size of a pivot differs from that of the last trial when the next is made; by 2 they differ where rows of a block change places."""
SERVES = 50
"""Factorisations after which it is made in any case."""
COORDINATE, VELOCITY = 1, 2
"""Kinds of unknowns; multipliers are 0."""


@compiled
def _near_tried(s):
    """Whether no pivot has changed much since the last trial."""
    if s.serves == 0:
        return False
    s.serves -= 1
    far = 0
    for k in range(s.n):
        ratio = abs(s.pivot[k] * s.tried[k])  # of rows that are as large another may be taken, with another sign
        far += 0 if 1.0 / CHANGED < ratio < CHANGED else 1
    return far == 0


@compiled
def _sized(s, f):
    """A state of the system's own size in `trial`: coordinates of 1, velocities of the rate, multipliers that matter beside them."""
    rate = 0.0
    for k in range(s.n_diagonal):
        rate = max(rate, abs(f.a[s.diagonal[k]]))
    for i in range(f.n):
        s.terms[i] = 0.0
    for j in range(f.n):
        s.trial[j] = s.state[j] * (1.0 if s.kind[j] == COORDINATE else rate)
        if s.kind[j] > 0:
            for p in range(f.a_start[j], f.a_start[j + 1]):
                s.terms[f.a_row[p]] += abs(f.a[p] * s.trial[j])
    for j in range(f.n):
        if s.kind[j] == 0:
            part = 0.0
            for p in range(f.a_start[j], f.a_start[j + 1]):
                if s.kind[f.a_row[p]] > 0:
                    part = max(part, abs(f.a[p]) / s.terms[f.a_row[p]])
            s.trial[j] = s.state[j] / part if 0.0 < part < float("inf") else s.state[j]


@compiled
def _multiply(s, f, by):
    """A times a vector, in `product`, and the sizes of the terms of each row in `terms`."""
    for i in range(f.n):
        s.product[i] = 0.0
        s.terms[i] = 0.0
    for j in range(f.n):
        for p in range(f.a_start[j], f.a_start[j + 1]):
            part = f.a[p] * by[j]
            s.product[f.a_row[p]] += part
            s.terms[f.a_row[p]] += abs(part)


@compiled
def trusted(s, f):
    """Whether the factors leave a small residual; by a trial where pivots have changed."""
    if _near_tried(s):
        return True
    _sized(s, f)
    _multiply(s, f, s.trial)
    for i in range(f.n):
        s.allowed[i] = LARGEST_RESIDUAL * s.terms[i]
    left = _left_after_solution(s, f)
    s.refined = 1 if 1.0 < left <= REFINABLE / LARGEST_RESIDUAL else 0
    if s.refined:
        left = _left_after_solution(s, f)
    for k in range(f.n):
        s.tried[k] = 1.0 / s.pivot[k]
    s.serves = SERVES if left <= 1.0 else 0
    return left <= 1.0


@compiled
def _left_after_solution(s, f):
    """Take what the factors make of `product` from the trial; the largest residual that stays, in units of what is allowed."""
    solved(s, s.product)
    for j in range(f.n):
        s.trial[j] -= s.x[s.place[j]]
    _multiply(s, f, s.trial)
    largest = 0.0
    for i in range(f.n):
        left = 0.0 if s.product[i] == 0.0 else abs(s.product[i]) / s.allowed[i]
        if not left <= largest:
            largest = left if left < float("inf") else float("inf")  # also where it is no number
    return largest


@compiled
def refine(s, x, b):
    """Add to a solution what the factors make of its residual."""
    _multiply(s, factors_view(s.factors), x)
    for i in range(s.n):
        s.product[i] = b[i] - s.product[i]
    solved(s, s.product)
    for j in range(s.n):
        x[j] += s.x[s.place[j]]
