"""Residual and iteration matrix of a formulation, compiled, with arguments by address."""

from stiffmbs.compile.machine.native.access import equations_view, state_view
from stiffmbs.compile.machine.native.evaluate import add_entries, add_products, evaluate, load


def residual(t, y, yp, r, state, equations):
    """Compute the residual r(t, y, y')."""
    s = state_view(state)
    e = equations_view(equations)
    load(s, e, y, yp)
    add_products(e, evaluate(s, e.residual_set, t), y, yp, r)


def jacobian(t, y, yp, cj, a, state, equations):
    """Compute the entries of the iteration matrix dr/dy + cj dr/dy'."""
    s = state_view(state)
    e = equations_view(equations)
    load(s, e, y, yp)
    add_entries(e, evaluate(s, e.matrix_set, t), cj, a)
