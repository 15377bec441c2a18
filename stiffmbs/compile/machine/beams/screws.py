"""Tangent maps of the exponential of screws, and their derivatives, by dual numbers.

With x = theta^2, the strain of the curve exp(xi(s)) is T(xi) xi' with T = 1 - b theta~ + c (theta theta^T - x), b = (1 -
cos)/theta^2 and c = (theta - sin)/theta^3. The inverse has b = -1/2 and c = e = (1 - (theta/2) cot(theta/2))/theta^2.
Selig, Geometric Fundamentals of Robotics (2005), ch. 4; Sonneville, Cardona, Bruls (2014).
"""

from stiffmbs.compile.machine.beams.dual import (
    add_cross,
    add_diagonal,
    add_outer,
    add_scaled,
    cross,
    dot,
    product,
    set_number,
)
from stiffmbs.compile.machine.native.access import compiled, room
from stiffmbs.compile.machine.native.vectors import clear

TERMS = 18
"""Largest number of terms of the series in x, for angles up to 3/2 pi; the last is below 1e-16 of the sum."""
NEGLIGIBLE = 1e-22
"""Size of a term below which the rest of a series is omitted; derivatives of the term may be a thousand times larger."""


@compiled
def series(x, kind, orders, to):
    """Compute a function of x and its derivatives up to an order by its series sum (-x)^k/(2k + 2 + kind)! times a factor.

    kind 0: b; kind 1: c; kind 2: (2 b - a)/x of a = sin/theta, with the factor 2(k + 1).
    """
    inverse = 0.5
    if kind == 1:
        inverse = 1.0 / 6.0
    if kind == 2:
        inverse = 1.0 / 24.0
    power = room(4)
    clear(4, to)
    clear(4, power)
    power[0] = 1.0
    for k in range(TERMS):
        factor = inverse
        if kind == 2:
            factor *= 2.0 * (k + 1)
        for order in range(orders + 1):
            to[order] += factor * power[order]
        if k > orders and abs(factor * power[0]) < NEGLIGIBLE:
            break
        for order in range(orders):
            n = orders - order
            power[n] = -x * power[n] - n * power[n - 1]
        power[0] *= -x
        first = 2.0 * k + 3.0 + kind
        inverse /= first * (first + 1.0)


@compiled
def of_inverse(x, orders, to):
    """Compute e and its derivatives by x up to an order of at most 2: e = g/(2 b)."""
    b, g = room(4), room(4)
    series(x, 0, orders, b)
    series(x, 2, orders, g)
    to[0] = 0.5 * g[0] / b[0]
    to[1] = (0.5 * g[1] - b[1] * to[0]) / b[0]
    if orders > 1:
        to[2] = (0.5 * g[2] - b[2] * to[0] - 2.0 * b[1] * to[1]) / b[0]


@compiled
def square(theta):
    """Return x = theta . theta of a rotation vector."""
    return theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2]


@compiled
def number(f, order, factor, rate, to):
    """Compute factor times the derivative of a function f(x), as a dual number for the rate of x."""
    set_number(to, factor * f[order], factor * f[order + 1] * rate)


@compiled
def square_rate(theta):
    """Return the dual part of x = theta . theta."""
    return 2.0 * (theta[0] * theta[3] + theta[1] * theta[4] + theta[2] * theta[5])


@compiled
def tangent(theta, b, factor, c, M):
    """Compute the matrix N = 1 - beta theta~ + gamma (theta theta^T - theta^2) for beta = factor b(x) and gamma = c(x)."""
    clear(18, M)
    beta, gamma, s, one, rate = room(2), room(2), room(2), room(2), square_rate(theta)
    number(b, 0, factor, rate, beta)
    number(c, 0, 1.0, rate, gamma)
    set_number(one, 1.0, 0.0)
    add_diagonal(one, M)
    product(beta, one, -1.0, s)
    add_cross(s, theta, M)
    add_outer(gamma, theta, theta, M)
    dot(theta, theta, s)
    product(gamma, s, -1.0, s)
    add_diagonal(s, M)


@compiled
def tangent_slope(theta, v, b, factor, c, M):
    """Compute the derivative of N v by theta (`tangent`)."""
    clear(18, M)
    beta, gamma, s, x, y, rate = room(2), room(2), room(2), room(2), room(6), square_rate(theta)
    number(b, 0, factor, rate, beta)
    number(c, 0, 1.0, rate, gamma)
    add_cross(beta, v, M)
    cross(theta, v, y)
    number(b, 1, -2.0 * factor, rate, s)
    add_outer(s, y, theta, M)
    add_outer(gamma, theta, v, M)
    dot(theta, v, s)
    clear(6, y)
    add_scaled(s, theta, y)
    product(gamma, s, 1.0, s)
    add_diagonal(s, M)
    set_number(s, -2.0 * gamma[0], -2.0 * gamma[1])
    add_outer(s, v, theta, M)
    dot(theta, theta, x)
    set_number(s, -x[0], -x[1])
    add_scaled(s, v, y)
    number(c, 1, 2.0, rate, s)
    add_outer(s, y, theta, M)


@compiled
def second_slope(theta, w, v, b, c, rate, M):
    """Compute the second derivative of w . T v by theta, for b and c with their derivatives by x."""
    clear(18, M)
    s, t, x, y = room(2), room(2), room(6), room(6)
    number(b, 1, -2.0, rate, s)
    cross(v, w, x)
    add_outer(s, x, theta, M)
    add_outer(s, theta, x, M)
    dot(theta, x, t)
    product(s, t, 1.0, s)
    add_diagonal(s, M)
    number(b, 2, -4.0, rate, s)
    product(s, t, 1.0, s)
    add_outer(s, theta, theta, M)
    # r = (w.theta)(theta.v) - (w.v) theta^2 and its gradient y
    along_w, along_v, between, square, r = room(2), room(2), room(2), room(2), room(2)
    dot(w, theta, along_w)
    dot(theta, v, along_v)
    dot(w, v, between)
    dot(theta, theta, square)
    product(along_w, along_v, 1.0, r)
    product(between, square, -1.0, t)
    r[0] += t[0]
    r[1] += t[1]
    clear(6, y)
    add_scaled(along_v, w, y)
    add_scaled(along_w, v, y)
    set_number(t, -2.0 * between[0], -2.0 * between[1])
    add_scaled(t, theta, y)
    number(c, 0, 1.0, rate, s)
    add_outer(s, v, w, M)
    add_outer(s, w, v, M)
    product(s, t, 1.0, s)
    add_diagonal(s, M)
    number(c, 1, 2.0, rate, s)
    add_outer(s, y, theta, M)
    add_outer(s, theta, y, M)
    product(s, r, 1.0, t)
    add_diagonal(t, M)
    number(c, 2, 4.0, rate, s)
    product(s, r, 1.0, s)
    add_outer(s, theta, theta, M)
