"""Error estimate of Radau steps, and the motions that it leaves out.

References
----------
Hairer and Wanner, Solving Ordinary Differential Equations II (2nd ed. 1996), ch. IV.8: error estimation.
"""

from math import sqrt

from stiffmbs.compile.machine.native.access import compiled, equations_view, floats, shifted, state_view
from stiffmbs.compile.machine.native.evaluate import add_rate_terms
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.solve.events.native.parameters import SEARCH
from stiffmbs.solve.ida.native.error_norm import error_norm_view
from stiffmbs.solve.radau.native.between_steps import most_moved_within
from stiffmbs.solve.radau.native.memory import basis
from stiffmbs.solve.radau.native.newton import add_efforts, residual, size_in_tolerances, solved_real

LEAST_ESTIMATE = 1e-10
"""Least estimated error."""


@compiled
def _size(x, values):
    """Return the RMS of a vector in tolerances, which the periods of a law share."""
    return error_norm_view(x.error_norm).repeats * size_in_tolerances(x, values)


@compiled
def _solved_defect(x, t, y):
    """Compute (gamma/h M - f_y)^-1 (f(t, y) - M y') for y' in `x.yp_stage`; return its size in tolerances."""
    residual(x, t, y, x.yp_stage, x.b, x.misfit)
    for k in range(x.n):
        x.b[k] = -x.b[k]
    solved_real(x)
    return _size(x, x.x)


@compiled
def _estimate(x, c, t, h, y):
    """Compute the error (gamma/h M - f_y)^-1 (f(t, y) + M sum d_i Z_i / h); return its size in tolerances."""
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    for i in range(c.stages):
        factor = -c.error[i] / h
        z = shifted(x.z, i * x.n_all)
        for k in range(x.n):
            x.yp_stage[k] += factor * z[k]
    size = _solved_defect(x, t, y)
    copied(x.error, x.x, x.n)
    return max(LEAST_ESTIMATE, _size_of_estimate(x, c, size))


@compiled
def _size_of_estimate(x, c, size):
    """Return the size of the estimate in `x.x` in its tolerances; `size` is that in the requested ones."""
    return max(size / c.relaxed, _unresolved(x, c) if size > 1.0 else 0.0)


@compiled
def _filter(x, c, h, values):
    """Compute (gamma/h M - f_y)^-1 gamma/h M times a vector."""
    e = equations_view(x.equations)
    for k in range(x.n):
        x.yp_stage[k] = c.gamma / h * values[k]
        x.b[k] = 0.0
    add_rate_terms(e, floats(state_view(x.state).values[e.residual_set]), x.yp_stage, x.b)
    solved_real(x)


@compiled
def _filtered(x, c, h):
    """Return the size of the filtered estimate, in its tolerances.

    The estimate of a vibration has a phase, at which the tested velocities may be zero by chance.  The filter turns the
    phase by arctan(h omega/gamma), and reduces a decaying motion.
    """
    _filter(x, c, h, x.error)
    return _size_of_estimate(x, c, _size(x, x.x))


@compiled
def _vibrating(x, c, h):
    """Return the size of the estimate in unknowns that vibrate fast for the step, in its tolerances.

    Two filters turn the phase of a fast vibration by nearly half a turn, (1 - h lambda/gamma)^-2, so that its unknowns change
    their signs. They only reduce a decaying motion. The error of a slow motion, which may exceed what is left of a fast one,
    also passes a third filter.
    """
    _filter(x, c, h, x.error)
    _filter(x, c, h, x.x)
    copied(x.d, x.x, x.n)
    _filter(x, c, h, x.d)
    for k in range(x.n):
        fast = x.d[k] - x.x[k]
        x.d[k] = x.error[k] if x.error[k] * x.d[k] < 0.0 and abs(x.x[k]) < abs(fast) else 0.0
    return _size(x, x.d) / c.relaxed


@compiled
def _unresolved_degree(x, c, k):
    """Return the coefficient of degree s of the polynomial of an unknown, in powers, if it does not converge; else 0.

    Of its coefficients of degrees s, s - 1 and s - 2 in Chebyshev polynomials, the first is then not small.
    """
    highest = 0.0
    second = 0.0
    third = 0.0
    for j in range(c.stages):
        difference = c.weights[j + 1] * x.z[j * x.n_all + k]
        highest += difference
        second += c.nodes[j] * difference
        third += c.nodes[j] * (c.nodes[j] - 1.0) * difference
    return highest if abs(highest) > x.converging * max(4.0 * abs(second), 16.0 * abs(third)) else 0.0


@compiled
def _unresolved(x, c):
    """Return the size of the estimate in `x.x` in unknowns whose polynomial does not converge, in tolerances.

    The step is long for a vibration, which the method damps.
    """
    total = 0.0
    for k in range(x.n):
        if _unresolved_degree(x, c, k) != 0.0:
            part = x.x[k] * x.weight[k]
            total += part * part
    return sqrt(total / x.n_tested)


@compiled
def _wandering(x, c):
    """Return the size of the last Chebyshev terms of polynomials that do not converge, in tolerances of the estimate.

    Where drives prescribe the motion, the end of a step has no error, but its stages may lie on another branch of the joints.
    """
    total = 0.0
    for k in range(x.n):
        part = _unresolved_degree(x, c, k) * x.weight[k]
        total += part * part
    return sqrt(total / x.n_tested) / (2.0 ** (2 * c.stages - 1) * max(1.0, c.relaxed))


@compiled
def _between_nodes(x, c, h):
    """Return the size of the errors of prescribed positions between the nodes, where events are searched, in tolerances.

    Drives and joints prescribe positions at the nodes, so that the estimate in them is only rounding.
    """
    total = 0.0
    for i in range(x.n_positions):
        k = x.position[i]
        defect = h * x.yp[k]
        for j in range(c.stages):
            defect += c.error[j] * x.z[j * x.n_all + k]
        x.prescribed[i] = abs(x.error[k]) <= x.rtol * abs(defect)
        if x.prescribed[i]:
            part = c.most_between * defect * x.weight[k]
            total += part * part
    return sqrt(total / x.n_tested)


@compiled
def _turned_apart(x, c, h):
    """Return the largest difference of the rate of an angle's polynomial from its angular velocity at a stage, times the step.

    Both agree but for the error of the polynomial. Stages of an angle that joints and drives prescribe may differ by full
    turns, or lie on another branch of the joints.
    """
    largest = 0.0
    for i in range(c.stages):
        for k in range(x.n_angles):
            rate = 0.0
            for j in range(c.stages):
                rate += c.derivative[i * c.stages + j] * x.z[j * x.n_all + x.angle[k]]
            turned = h * (x.y[x.spin[k]] + x.z[i * x.n_all + x.spin[k]])
            largest = max(largest, abs(rate - turned))
    return largest


@compiled
def estimate_below(x, c, lower, t, h):
    """Return the size that the estimate of a method of fewer stages would have, in tolerances.

    Its stages are taken from the polynomial of the accepted step. In (gamma/h M - f_y)^-1, gamma is that of the step.
    """
    for k in range(x.n):
        x.yp_stage[k] = 0.0
    for i in range(lower.stages):
        for j in range(c.stages):
            factor = -lower.error[i] / h * basis(c, j, lower.nodes[i])
            z = shifted(x.past, j * x.n_all)
            for k in range(x.n):
                x.yp_stage[k] += factor * z[k]
    return _solved_defect(x, t, x.y_past) * c.gamma / lower.gamma


@compiled
def error_of_step(x, c, h, untested):
    """Return the error of the step in tolerances.

    After starts and rejected steps, a failed estimate is repeated with f at the corrected state, without the motions that the
    step damps; not if these vibrate, as on a stiff pad after an impact, since they do not decay. The estimate of an untested step,
    which may be long for a vibration that earlier ones have not tested, is filtered too.
    """
    error = _estimate(x, c, x.t, h, x.y)
    x.damped = 0
    if error >= 1.0 and (untested or x.rejected) and _vibrating(x, c, h) < 1.0:
        copied(x.y_stage, x.error, x.n)
        add_efforts(x, x.y_stage, x.misfit)
        for k in range(x.n_all):
            x.y_stage[k] += x.y[k]
        error = _estimate(x, c, x.t, h, x.y_stage)
        x.damped = 1
    if untested and error < 1.0:
        error = max(error, _filtered(x, c, h))
    wandering = _wandering(x, c) if x.acting == 0 else 0.0  # efforts of decaying motions are removed or closed
    x.apart = _between_nodes(x, c, h) if x.has_kinks and x.n_closing > 0 else 0.0
    wandering = max(wandering, x.apart / most_moved_within(c))
    wandering = max(wandering, _turned_apart(x, c, h) / SEARCH.turned)
    return max(error, wandering) if wandering > 1.0 else error
