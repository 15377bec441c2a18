"""Query of IDA's counters."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.compile.machine.native.calls import call_int


@compiled
def add_counters(count, functions, memory, value, sums):
    """Add the results of some counter functions of IDA to sums; `value` has space for one number."""
    for k in range(count):
        value[0] = 0  # C's long may be shorter
        call_int(functions[k], (memory, value))
        sums[k] += value[0]


def count(n, functions, memory, value, sums):
    """Call `add_counters` from Python."""
    add_counters(n, functions, memory, value, sums)
