"""Memory of the loop over IDA's steps."""

from stiffmbs.compile.machine.native.access import compiled, floats, view_of
from stiffmbs.compile.machine.native.calls import call_address
from stiffmbs.solve.ida.native.layouts import NATIVE_IDA

native_ida_view = view_of("NativeIda", NATIVE_IDA)


@compiled
def array_of(c, vector):
    """Return the data of a SUNDIALS vector."""
    return floats(call_address(c.array_of, vector))
