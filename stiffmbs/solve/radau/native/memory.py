"""Views of the memory of a Radau integration, and its polynomial."""

from stiffmbs.compile.machine.native.access import compiled, ints, shifted, view_of
from stiffmbs.solve.radau.native.layouts import COLLOCATION, RADAU

collocation_view = view_of("Collocation", COLLOCATION)
radau_view = view_of("Radau", RADAU)


@compiled
def basis(c, node, place):
    """Return the Lagrange polynomial of a node at a place; the nodes are 0, c_1 to c_s."""
    value = c.weights[node + 1] * place  # the first weight and the factor `place` are of the node 0
    for k in range(c.stages):
        if k != node:
            value *= place - c.nodes[k]
    return value


@compiled
def slope(c, node, place):
    """Return the derivative of `basis`."""
    value = c.weights[node + 1] * place  # value and rate of the product of the first factors (product rule)
    rate = c.weights[node + 1]
    for k in range(c.stages):
        if k != node:
            rate = rate * (place - c.nodes[k]) + value
            value *= place - c.nodes[k]
    return rate


@compiled
def polynomial(x, place, count, target):
    """Compute the first numbers of the state at a place of the last step: 0 is its beginning, 1 its end."""
    c = collocation_view(ints(x.methods[x.method_past]))
    for k in range(count):
        target[k] = x.y_past[k]
    for j in range(c.stages):
        factor = basis(c, j, place)
        z = shifted(x.past, j * x.n_all)
        for k in range(count):
            target[k] += factor * z[k]
    # The error estimate at the end, as a polynomial that is zero at both ends (`Collocation.bubble`), by Horner's rule.
    # Unknowns outside the error test have no estimate.
    correction = 0.0
    for j in range(c.stages + 2):
        correction = correction * place + c.bubble[c.stages + 1 - j]
    for k in range(x.n):
        if x.weight[k] > 0.0:
            target[k] += correction * x.error[k]


@compiled
def polynomial_rates(x, place, target):
    """Compute the derivative of `polynomial` with respect to time."""
    c = collocation_view(ints(x.methods[x.method_past]))
    for k in range(x.n):
        target[k] = 0.0
    for j in range(c.stages):
        factor = slope(c, j, place) / x.h_past
        z = shifted(x.past, j * x.n_all)
        for k in range(x.n):
            target[k] += factor * z[k]
    correction = 0.0
    for j in range(c.stages + 1):
        correction = correction * place + (c.stages + 1 - j) * c.bubble[c.stages + 1 - j]
    correction /= x.h_past
    for k in range(x.n):
        if x.weight[k] > 0.0:
            target[k] += correction * x.error[k]
