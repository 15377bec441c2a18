"""Reading IDA's counters."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.solve.native.calls import call_int


@compiled
def add_counters(count, functions, memory, value, sums):
    """Add what each of some functions of IDA's gives to a sum; `value` has room for one number."""
    for k in range(count):
        value[0] = 0  # C's long may be shorter
        call_int(functions[k], (memory, value))
        sums[k] += value[0]


def count(n, functions, memory, value, sums):
    """The same, for calls from Python."""
    add_counters(n, functions, memory, value, sums)
