"""Check of forces that the rounding of coordinates changes."""

from __future__ import annotations

from collections.abc import Iterator

from ..compile.rounding import lost_digits
from ..dynamics.dynamics import Dynamics, OutputRows
from .parameters import RUN_CHECKS


def lost_digits_sentence(dynamics: Dynamics, rows: OutputRows) -> Iterator[str]:
    """Yield a sentence on the force that rounding changes most at the end of a run, if that is much; the state is changed."""
    if not len(rows.t):
        return
    state, t = dynamics.state, float(rows.t[-1])
    state.q[:], state.u[:] = rows.q[-1], rows.u[-1]
    name, lost, largest = lost_digits(state, t)
    if lost > RUN_CHECKS.lost * largest > 0.0:
        yield (
            f"the force of '{name}' is known to about {lost:.1g} N only, as are reactions: coordinates have 16 digits, "
            f"and it is so stiff; the largest force at t = {t:.6g} s is {largest:.3g} N; use a joint, or less stiffness"
        )
