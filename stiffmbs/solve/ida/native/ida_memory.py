"""Memory of the loop over IDA's steps, and event functions for its root search, each positive at first."""

from stiffmbs.compile.machine.native.access import compiled, floats, view_of
from stiffmbs.compile.machine.native.calls import call_address
from stiffmbs.solve.ida.native.layouts import NATIVE_IDA

native_ida_view = view_of("NativeIda", NATIVE_IDA)


@compiled
def array_of(c, vector):
    """Return the data of a SUNDIALS vector."""
    return floats(call_address(c.array_of, vector))


@compiled
def watched(values, signs, band, g, count):
    """Fill g; an event function is ignored while it is zero, and one with a band until it leaves it.

    `signs` holds the first nonzero sign of each event function, 0 before.
    """
    for k in range(count):
        value = band[k] - abs(values[k]) if band[k] > 0.0 else values[k]
        if signs[k] == 0.0 and value != 0.0:
            signs[k] = 1.0 if value > 0.0 else -1.0
        g[k] = signs[k] * value if signs[k] != 0.0 else 1.0
