"""Residual and Jacobian callbacks of scikit-sundae, with a history of IDA's steps inferred from the calls."""

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, ints, state_view, view_of
from stiffmbs.compile.machine.native.evaluate import SWITCH, add_entries, add_products, evaluate, load
from stiffmbs.solve.ida.native.ida_memory import watched
from stiffmbs.solve.ida.native.layouts import IDA

ida_view = view_of("Ida", IDA)


@compiled
def _note(c, t):
    """Count steps: IDA tries a later time after a success and an earlier one after a failure."""
    if t == c.last_time:
        return
    if t > c.last_time:
        c.steps += 1
    else:
        c.rejected += 1
    if 0 < c.steps <= c.n_ends:
        c.ends[c.steps - 1] = t
    c.last_time = t


@compiled
def _data(array, header):
    """Return the data of a NumPy array given by its id: the pointer after the object's header (PyArrayObject.data)."""
    return floats(ints(array + header)[0])


def residual(t, y, yp, r, ida):
    """Compute the residual r(t, y, y') in a NumPy array; note the time."""
    c = ida_view(ida)
    _note(c, t)
    s = state_view(c.state)
    e = equations_view(c.equations)
    unknowns, rates = _data(y, c.array_header), _data(yp, c.array_header)
    load(s, e, unknowns, rates)
    add_products(e, evaluate(s, e.residual_set, t), unknowns, rates, _data(r, c.array_header))


def jacobian(t, y, yp, cj, a, ida):
    """Compute the iteration matrix dr/dy + cj dr/dy' in a NumPy array."""
    c = ida_view(ida)
    s = state_view(c.state)
    e = equations_view(c.equations)
    load(s, e, _data(y, c.array_header), _data(yp, c.array_header))
    add_entries(e, evaluate(s, e.matrix_set, t), cj, _data(a, c.array_header))


def event_functions(t, y, yp, values, ida):
    """Compute the event functions of breakpoints in the state in a NumPy array."""
    c = ida_view(ida)
    s = state_view(c.state)
    load(s, equations_view(c.equations), _data(y, c.array_header), _data(yp, c.array_header))
    found = evaluate(s, SWITCH, t)
    watched(found, c.signs, c.masked, _data(values, c.array_header), c.n_event_functions)
