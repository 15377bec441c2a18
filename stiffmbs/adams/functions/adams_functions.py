"""Adams/Solver functions expressed by functions of scene formulas.  MSC Adams/Solver, "Functions"."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable

from .trees import call, difference, number, power, product, quotient, times, total

ZERO, ONE = number(0.0), number(1.0)


def _shf(x: ast.expr, x0: ast.expr, a: ast.expr, w: ast.expr, *rest: ast.expr) -> ast.expr:
    """Simple harmonic function: a sin(w (x - x0) - phi) + b."""
    phi, b = (*rest, ZERO, ZERO)[:2]
    return total([product(a, call("sin", difference(product(w, difference(x, x0)), phi))), b])


def _poly(x: ast.expr, x0: ast.expr, a0: ast.expr, *a: ast.expr) -> ast.expr:
    """Polynomial a0 + a1 (x - x0) + ... by Horner's scheme."""
    value, *others = reversed((a0, *a))
    for coefficient in others:
        value = total([coefficient, product(difference(x, x0), value)])
    return value


def _cheby(x: ast.expr, x0: ast.expr, a0: ast.expr, *a: ast.expr) -> ast.expr:
    """Chebyshev series: the sum of a_k T_k(x - x0)."""
    terms = [a0]
    before, now = [1], [0, 1]  # coefficients of T_0 and T_1, lowest first
    for coefficient in a:
        powers = [times(power(difference(x, x0), k), c) for k, c in enumerate(now) if c]
        terms.append(product(coefficient, total(powers)))
        doubled = [0, *(2 * c for c in now)]
        before, now = now, [c - (before[k] if k < len(before) else 0) for k, c in enumerate(doubled)]
    return total(terms)


def _fourier(wave: str) -> Callable[..., ast.expr]:
    def series(x: ast.expr, x0: ast.expr, w: ast.expr, a0: ast.expr, *a: ast.expr) -> ast.expr:
        """Fourier series: a0 + the sum of a_k wave(k w (x - x0))."""
        phase = product(w, difference(x, x0))
        return total([a0, *(product(c, call(wave, times(phase, k))) for k, c in enumerate(a, start=1))])

    return series


def _havsin(x: ast.expr, x0: ast.expr, h0: ast.expr, x1: ast.expr, h1: ast.expr) -> ast.expr:
    """Haversine step from h0 at x0 to h1 at x1: (h0 + h1)/2 - (h1 - h0)/2 cos(pi z), z from 0 to 1."""
    z = call("min", call("max", quotient(difference(x, x0), difference(x1, x0)), ZERO), ONE)
    middle, half = quotient(total([h0, h1]), number(2)), quotient(difference(h1, h0), number(2))
    return difference(middle, product(half, call("cos", times(z, math.pi))))


def _sweep(x: ast.expr, a: ast.expr, x0: ast.expr, f0: ast.expr, x1: ast.expr, f1: ast.expr, dx: ast.expr) -> ast.expr:
    """Sine of amplitude a whose frequency changes linearly from f0 at x0 to f1 at x1, switched on from x0 to x0 + dx."""
    z = difference(call("min", call("max", x, x0), x1), x0)
    rise, after = difference(f1, f0), call("max", difference(x, x1), ZERO)
    growth = quotient(product(rise, power(z, 2)), product(number(2), difference(x1, x0)))
    turns = total([product(f0, x), growth, product(rise, after)])
    on = call("step5", x, x0, ZERO, total([x0, dx]), ONE)
    return product(product(a, on), call("sin", times(turns, 2 * math.pi)))


def _impact(x: ast.expr, rate: ast.expr, x1: ast.expr, k: ast.expr, e: ast.expr, c: ast.expr, d: ast.expr) -> ast.expr:
    """One-sided impact: k (x1 - x)^e - c x' step(x, x1 - d, 1, x1, 0) for x < x1, never negative."""
    depth = call("max", difference(x1, x), ZERO)
    spring = product(k, ast.BinOp(depth, ast.Pow(), e))
    damper = product(product(c, rate), call("step", x, difference(x1, d), ONE, x1, ZERO))
    return call("max", difference(spring, damper), ZERO)


def _bistop(
    x: ast.expr, rate: ast.expr, x1: ast.expr, x2: ast.expr, k: ast.expr, e: ast.expr, c: ast.expr, d: ast.expr
) -> ast.expr:
    """Two-sided impact: `_impact` below x1 and its mirror image above x2."""
    minus = ast.UnaryOp(ast.USub(), x), ast.UnaryOp(ast.USub(), rate), ast.UnaryOp(ast.USub(), x2)
    return difference(_impact(x, rate, x1, k, e, c, d), _impact(*minus, k, e, c, d))


def _sign(a: ast.expr, b: ast.expr) -> ast.expr:
    """Fortran SIGN: the magnitude of a with the sign of b."""
    return product(call("abs", a), call("sign", b))


ADAMS_FUNCTIONS: dict[str, Callable[..., ast.expr]] = {
    "SHF": _shf,
    "POLY": _poly,
    "CHEBY": _cheby,
    "FORCOS": _fourier("cos"),
    "FORSIN": _fourier("sin"),
    "HAVSIN": _havsin,
    "SWEEP": _sweep,
    "IMPACT": _impact,
    "BISTOP": _bistop,
    "SIGN": _sign,
    "DIM": lambda a, b: call("max", difference(a, b), ZERO),
    "LOG10": lambda x: quotient(call("log", x), number(math.log(10))),
}
