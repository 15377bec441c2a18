"""The loop over output times, and what hand-written callbacks need to reach IDA's arrays."""

from __future__ import annotations

from numba import int32, njit, types

from .addresses import call_address, call_int, floats, ints

RESIDUAL = types.int32(types.float64, types.int64, types.int64, types.int64, types.int64)
"""IDAResFn: t, y, y', r, user data."""
JACOBIAN = types.int32(types.float64, *[types.float64], *[types.int64] * 8)
"""IDALsJacFn: t, cj, y, y', r, matrix, user data, three vectors of work."""
NORMAL = 1
"""IDA_NORMAL of ida.h: go on until beyond an output time, and interpolate."""

fast = njit(error_model="numpy", cache=True)
"""Equations written by hand: numpy's divisions, so that nothing raises."""


@fast
def array(user, vector):
    """The doubles of an N_Vector; the table in the user data begins with the address of N_VGetArrayPointer."""
    return floats(call_address(ints(user)[0], vector))


@fast
def matrix(user):
    """The doubles of the iteration matrix."""
    return floats(ints(user)[1])


@fast
def numbers(user):
    """The parameters of the equations."""
    return floats(ints(user)[2])


@fast
def size(user):
    """The number of unknowns."""
    return ints(user)[3]


@njit(error_model="numpy", cache=True, nogil=True)
def loop(functions, y_vector, yp_vector, y, reported, times, breakpoints, rows):
    """Integrate past every output time, from breakpoint to breakpoint; IDA's last flag."""
    solve, stop_at, begin, memory = functions
    reached = times[:1].copy()
    flag, k = int32(0), 1
    for breakpoint in breakpoints:
        call_int(stop_at, (memory, breakpoint))
        while k < len(times) and times[k] <= breakpoint:
            flag = call_int(solve, (memory, times[k], reached.ctypes.data, y_vector, yp_vector, int32(NORMAL)))
            if flag < 0:
                return flag
            for column in range(len(reported)):
                rows[k, column] = y[reported[column]]
            k += 1
        if breakpoint < times[-1]:
            if reached[0] < breakpoint:
                flag = call_int(solve, (memory, breakpoint, reached.ctypes.data, y_vector, yp_vector, int32(NORMAL)))
                if flag < 0:
                    return flag
            call_int(begin, (memory, breakpoint, y_vector, yp_vector))
    return flag
