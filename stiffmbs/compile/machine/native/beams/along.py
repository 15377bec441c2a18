"""States and numbers of a beam section moved in a direction, for its directional derivatives by central differences."""

from math import cos, sin

from stiffmbs.compile.machine.native.access import compiled, shifted
from stiffmbs.compile.machine.native.beams.section import law
from stiffmbs.compile.machine.native.orientation import share_orientation

STEP = 1e-3
"""Largest change of a rotation, or relative change of a number or length, in a difference. Those of fourth order then have a
truncation error of about 1e-12."""


@compiled
def step_size(space, n, n_bodies, n_numbers, numbers, row, moved_numbers, moved_q):
    """Return the step along a direction: `STEP` over the largest relative change, or 0 if nothing changes."""
    largest = 0.0
    for i in range(n_numbers):
        size = abs(numbers[i])
        if size < 1e-9:
            size = 1.0
        largest = max(largest, abs(moved_numbers[i]) / size)
    length = law(space, n, numbers)[2 * n]
    linear = 3 if space == 1 else 2
    for body in range(n_bodies):
        for i in range(7 if space == 1 else 3):
            change = abs(moved_q[row[2 * body] + i])
            if i < linear:
                change /= length
            largest = max(largest, change)
    return STEP / largest if largest > 0.0 else STEP


@compiled
def move(
    space, n_bodies, n_numbers, h, numbers, row, q, u, numbers_d, q_d, u_d, to_numbers, places, to_q, to_turn, to_u
):
    """Compute the numbers, and the state of the section's bodies one after the other, at a step h along a direction."""
    n_q, n_u = 3, 3
    if space == 1:
        n_q, n_u = 7, 6
    for i in range(n_numbers):
        to_numbers[i] = numbers[i] + h * numbers_d[i]
    for body in range(n_bodies):
        places[2 * body], places[2 * body + 1] = float(n_q * body), float(n_u * body)
        of_q, of_u = row[2 * body], row[2 * body + 1]
        for i in range(n_q):
            to_q[n_q * body + i] = q[of_q + i] + h * q_d[of_q + i]
        for i in range(n_u):
            to_u[n_u * body + i] = u[of_u + i] + h * u_d[of_u + i]
        if space == 1:
            share_orientation(shifted(to_q, n_q * body + 3), shifted(to_turn, 2 * n_q * body))
        else:
            to_turn[n_q * body] = cos(to_q[n_q * body + 2])
            to_turn[n_q * body + 1] = sin(to_q[n_q * body + 2])
