"""Functions of Radau methods with the interface of IDA, so that one loop drives both."""

from math import sqrt
from typing import Final

from stiffmbs.compile.machine.native.access import compiled, floats, ints
from stiffmbs.compile.machine.native.calls import call_address, int32
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.statuses import OK, RECOVERABLE, STOP_RETURN
from stiffmbs.solve.error_control.native.parameters import EXCLUDED, NEWTON
from stiffmbs.solve.radau.native.between_steps import dense_output
from stiffmbs.solve.radau.native.memory import collocation_view, polynomial_rates, radau_view
from stiffmbs.solve.radau.native.steps import SMALLEST, first_step, set_weights, step

BAD_ORDER: Final = -25
BAD_TIME: Final = -26
"""IDA_BAD_K and IDA_BAD_T."""


@compiled
def _data(x, vector):
    return floats(call_address(x.array_of, vector))


def solve(memory, toward, returned, y, yp, task):
    """Take one step (IDASolve in the mode IDA_ONE_STEP)."""
    x = radau_view(ints(memory))
    if x.stops and x.stop - x.t <= SMALLEST * abs(x.t):
        x.t = x.stop
        returned[0] = x.t
        copied(_data(x, y), x.y, x.n)
        copied(_data(x, yp), x.yp, x.n)
        x.stops = 0
        return int32(STOP_RETURN)
    flag = step(x)
    if flag < 0:
        return int32(flag)
    returned[0] = x.t
    copied(_data(x, y), x.y, x.n)
    copied(_data(x, yp), x.yp, x.n)
    if x.stops and x.t >= x.stop:
        x.stops = 0
        return int32(STOP_RETURN)
    return int32(OK)


def repeat(memory, begin, h):
    """Return to the beginning of the last step, which is repeated with another length."""
    x = radau_view(ints(memory))
    if begin < x.stop <= x.t:
        x.stops = 1
    copied(x.y, x.y_past, x.n_all)
    x.t = begin
    x.h = h
    x.h_past = 0.0
    x.h_accepted = 0.0
    x.steps -= 1
    return int32(OK)


def resolves(memory):
    """Return 1 if the error estimate of the last step holds over jumps and kinks.

    The tolerance of the estimate, of order s, is that of smooth solutions. A step over a jump or kink has to stay within
    the part of the requested tolerance that the iteration may leave. Its estimate does not bound its error. Nor does one without
    the motions that the step damps, such as an impact on a stiff pad.
    """
    x = radau_view(ints(memory))
    relaxed = collocation_view(ints(x.methods[x.method_past])).relaxed
    return int32(1 if x.damped == 0 and x.error_size * relaxed <= x.newton else 0)


def interpolate(memory, t, order, target):
    """Evaluate the polynomial of the last step, or its derivative (IDAGetDky); RECOVERABLE for a state that stays open."""
    x = radau_view(ints(memory))
    if order > 1:
        return int32(BAD_ORDER)
    if x.h_past == 0.0:
        copied(_data(x, target), x.yp if order == 1 else x.y, x.n)
        return int32(OK)
    place = 1.0 + (t - x.t) / x.h_past
    if not -1e-6 <= place <= 1.0 + 1e-6:
        return int32(BAD_TIME)
    if order == 1:
        polynomial_rates(x, place, _data(x, target))
    elif not dense_output(x, t, place, _data(x, target)):
        return int32(RECOVERABLE)
    return int32(OK)


def reinitialise(memory, t, y, yp):
    """Start or restart (IDAReInit)."""
    x = radau_view(ints(memory))
    x.t = t
    copied(x.y, _data(x, y), x.n)
    copied(x.yp, _data(x, yp), x.n)
    x.h_past = 0.0
    x.h = 0.0
    x.rate_kept = 0
    x.current = 0
    x.h_accepted = 0.0
    x.since_change = 0
    x.stops = 0
    x.steps = 0
    x.residuals = 0
    x.jacobians = 0
    x.factorizations = 0
    x.error_failures = 0
    x.step_failures = 0
    x.iterations = 0
    x.newton_failures = 0
    return int32(OK)


def set_stop_time(memory, t):
    """Set the time beyond which no step goes (IDASetStopTime)."""
    x = radau_view(ints(memory))
    x.stop = t
    x.stops = 1
    return int32(OK)


def set_first_step(memory, h):
    """Set the size of the first step (IDASetInitStep)."""
    x = radau_view(ints(memory))
    x.first = h
    return int32(OK)


def set_longest_step(memory, h):
    """Set the largest step; 0 for none (IDASetMaxStep)."""
    x = radau_view(ints(memory))
    x.longest = h
    return int32(OK)


def set_newton(memory, part):
    """Set the part of the requested tolerance that Newton's iteration may leave (IDASetNonlinConvCoef).

    A larger one than usual was relaxed after many failures. It counts at tolerances whose usual part is near rounding.
    """
    x = radau_view(ints(memory))
    x.part = part if part > NEWTON.loosest <= x.remainder else min(part, x.remainder)
    return int32(OK)


def set_growth(memory, low, high):
    """Ignore the bounds of unchanged steps (IDASetEtaFixedStepBounds)."""
    return int32(OK)


@compiled
def _relax(x, c):
    c.relaxed = x.tolerance * x.rtol ** (0.5 * (1.0 + c.stages) / c.stages - 1.0)


def set_tolerances(memory, rtol, atol):
    """Set the tolerances (IDASVtolerances), which count excluded unknowns in the norm."""
    x = radau_view(ints(memory))
    values = _data(x, atol)
    tested = 0
    x.n_closing = 0
    for k in range(x.n):
        tested += values[k] < EXCLUDED
        x.n_closing += values[k] >= EXCLUDED and x.algebraic[k] > 0.0
    x.n_tested = max(tested, 1)
    factor = sqrt(float(x.n_tested) / float(x.n))
    x.rtol = rtol * factor
    for k in range(x.n):
        x.atol[k] = values[k] * factor if values[k] < EXCLUDED else values[k]
    for number in range(x.n_methods):
        c = collocation_view(ints(x.methods[number]))
        _relax(x, c)
    for number in range(x.n_methods):
        _relax(x, collocation_view(ints(x.below[number])))
    return int32(OK)


def set_order(memory, order):
    """Ignore the highest order (IDASetMaxOrd)."""
    return int32(OK)


def time_of(memory, result):
    """Store the time of the state (IDAGetCurrentTime)."""
    x = radau_view(ints(memory))
    result[0] = x.t
    return int32(OK)


def step_of(memory, result):
    """Store the size of the last step (IDAGetLastStep)."""
    x = radau_view(ints(memory))
    result[0] = x.h_past
    return int32(OK)


def next_step_of(memory, result):
    """Store the size of the next step (IDAGetCurrentStep)."""
    x = radau_view(ints(memory))
    if x.h == 0.0:
        set_weights(x)
        x.h = first_step(x)
    result[0] = x.h
    return int32(OK)


def errors_of(memory, target):
    """Store the estimated error of the last step (IDAGetEstLocalErrors).

    The solution has order 2 s - 1. An estimate e c rtol^((s + 1)/(2 s)) gives it an error of (c e)^(2 s/(s + 1)) rtol.
    The iteration leaves a part of the tolerance.
    """
    x = radau_view(ints(memory))
    errors = _data(x, target)
    c = collocation_view(ints(x.methods[x.method_past]))
    size = (x.tolerance * x.error_size) ** (2.0 * c.stages / (c.stages + 1.0)) + x.left
    factor = size / (x.error_size * c.relaxed)
    for k in range(x.n):
        errors[k] = factor * x.error[k]
    return int32(OK)


def weights_of(memory, target):
    """Store the inverse tolerances (IDAGetErrWeights)."""
    x = radau_view(ints(memory))
    set_weights(x)
    weights = _data(x, target)
    for k in range(x.n):
        weights[k] = x.weight[k]
    return int32(OK)


def counter_of(cell, result):
    """Store the counter in a cell of the memory (IDAGetNumSteps and others)."""
    result[0] = cell[0]
    return int32(OK)


def order_of(memory, result):
    """Store the order of the last step (IDAGetLastOrder)."""
    x = radau_view(ints(memory))
    result[0] = 2 * collocation_view(ints(x.methods[x.method_past])).stages - 1
    return int32(OK)
