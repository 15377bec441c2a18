"""Forward mode of the translator: derivatives of compiled functions against differences of the functions themselves."""

import random

import numpy as np
import pytest

from stiffmbs.compile.machine.compiler import compiled_source
from stiffmbs.compile.machine.translate.derivatives import PARTIAL_DERIVATIVES
from stiffmbs.compile.machine.translate.expressions import INTRINSICS, OF_THE_LIBRARY
from stiffmbs.errors import InputError

HEADER = """
from math import acos, asin, asinh, atan, atan2, copysign, cos, cosh, exp, floor, log, sin, sinh, sqrt, tan, tanh
from stiffmbs.compile.machine.native.access import has_derivative, room, shifted, with_derivative
from stiffmbs.compile.machine.native.simd import add_products, plus_product, quad, spread, sum_of


"""
ENTRIES = """

def plain(x, to):
    f(x, to)


def directed(x, x_d, to, to_d):
    f(with_derivative(x, x_d), with_derivative(to, to_d))
"""
OFFSETS = {-2: 1, -1: -8, 1: 8, 2: -1}
"""Weights of the difference of fourth order, times 12."""


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("STIFFMBS_CACHE", str(tmp_path))


def functions(body, others=""):
    """A function f of the numbers x, whose results are in `to`: compiled as it is, and differentiated."""
    lines = "\n".join(f"    {line}" for line in body.strip().splitlines())
    source = f"{HEADER}{others}\n\ndef f(x, to):\n{lines}\n{ENTRIES}"
    plain = compiled_source(source, "plain", "void(float64*, float64*)")
    directed = compiled_source(source, "directed", "void(float64*, float64*, float64*, float64*)")
    return plain, directed


def check(body, x, n=1, others="", rtol=1e-7):
    """Compare values bit for bit and derivatives along a random direction with differences."""
    plain, directed = functions(body, others)
    x = np.array(x, dtype=float)
    x_d = np.random.default_rng(len(body)).normal(size=len(x))

    def values(at):
        to = np.zeros(n)
        plain.call(at.ctypes.data, to.ctypes.data)
        return to

    to, to_d = np.zeros(n), np.full(n, np.nan)
    directed.call(x.ctypes.data, x_d.ctypes.data, to.ctypes.data, to_d.ctypes.data)
    assert to.tobytes() == values(x).tobytes()
    h = 1e-3
    wanted = sum(weight * values(x + k * h * x_d) for k, weight in OFFSETS.items()) / (12 * h)
    assert to_d == pytest.approx(wanted, rel=rtol, abs=rtol)


@pytest.mark.parametrize(
    "expression",
    [
        "a + 2*b - 3/c", "a*b*c - a/b", "2.0/a - b/3", "a**2 + b**-3 + c**0", "a**b", "2.0**a", "-a - -b", "abs(-a) + abs(b)",
        "max(a, b, 0) + min(a, c)", "a if a > b else c", "sqrt(a) + sin(a)*cos(b) + exp(-a) + log(c) + tan(b)",
        "asin(a/9) + acos(b/9) + atan(c) + asinh(a)", "atan2(a, b) + sinh(a) + cosh(b) + tanh(c)", "floor(a*10) + a",
        "copysign(a, -b)", "float(int(a*10))*b", "a if b else c", "3.0",
    ],
)  # fmt: skip
def test_derivatives_of_expressions(expression):
    check(f"a, b, c = x[0], x[1], x[2]\nto[0] = {expression}", [0.731, 1.213, 2.417])


def test_loops_branches_arrays_and_calls():
    """Rooms become dual, pointers are returned, and a variable that begins as a number becomes dual."""
    others = """
def row(x, k):
    return shifted(x, 2*k)


def length(v, n):
    total = 0.0
    for i in range(n):
        total += v[i]*v[i]
    return sqrt(total)


def store(v, to):
    to[0] = length(row(v, 1), 2)
"""
    body = """
v, s = room(6), 1.0
for i in range(3):
    v[2*i] = x[i]*s
    v[2*i + 1] = x[i] + i
    s = s*x[i] if x[i] > 1.0 else s + 0.5
k = 0
while k < 3:
    k += 1
    if k == 2:
        continue
    to[k] = length(row(v, 1), 2)*s + k
store(v, to)
to[2] = s
"""
    check(body, [0.7, 1.4, 2.1], 4, others)


def test_functions_without_a_direction_stay_as_they_are():
    others = """
def g(x):
    return 1.0 if has_derivative(x) else 0.0
"""
    plain, directed = functions("y = room(1)\ny[0] = 2.0\nto[0], to[1] = g(x), g(3.0)", others)
    x, to = np.ones(1), np.zeros(2)
    directed.call(x.ctypes.data, x.ctypes.data, to.ctypes.data, np.zeros(2).ctypes.data)
    assert to.tolist() == [1.0, 0.0]
    plain.call(x.ctypes.data, to.ctypes.data)
    assert to.tolist() == [0.0, 0.0]


def test_products_of_vectors():
    body = """
total = spread(0.0)
for k in range(0, 8, 4):
    total = plus_product(total, quad(x, k), quad(x, 8 - k))
to[0], to[2], to[3] = sum_of(total), 0.0, 0.0
to[1] = plus_product(plus_product(x[0], x[1], 2.0), x[2], x[3])
for k in range(4, 12):
    to[k] = x[k - 4]
add_products(1, 1, shifted(to, 4), 0, x, 1, shifted(x, 4), 4, 2)
"""
    check(body, np.linspace(0.3, 1.9, 12), 12)


def test_a_power_of_zero_has_a_derivative_by_its_exponent():
    """The limit of x^y log x; a constant exponent that is a number of an element has a derivative of zero."""
    _, directed = functions("to[0] = x[0]**x[1]")
    x, x_d, to, to_d = np.array([0.0, 1.5]), np.array([2.0, 0.0]), np.zeros(1), np.full(1, np.nan)
    directed.call(x.ctypes.data, x_d.ctypes.data, to.ctypes.data, to_d.ctypes.data)
    assert to_d[0] == 0.0


def test_every_function_of_the_library_has_partial_derivatives():
    assert {*(f"llvm.{name}.f64" for name in INTRINSICS), *OF_THE_LIBRARY} <= PARTIAL_DERIVATIVES.keys()


def test_a_function_without_partial_derivatives_is_refused(monkeypatch):
    monkeypatch.delitem(PARTIAL_DERIVATIVES, "sinh")
    with pytest.raises(
        InputError, match="found 'sinh' in an equation, expected a function with known partial derivatives"
    ):
        check("to[0] = sinh(x[0])", [1.0])


def expression(draw, depth):
    """A random smooth expression of a, b and c with moderate values."""
    if depth == 0:
        return draw.choice(["a", "b", "c", f"{draw.uniform(0.5, 2):.3f}"])
    first, second = (expression(draw, depth - 1) for _ in range(2))
    return draw.choice([
        f"({first} + {second})", f"({first} - {second})", f"{first}*{second}", f"{first}/(3 + sin({second}))", f"sin({first})",
        f"cos({first})", f"tanh({first})", f"sqrt(2 + cos({first}))", f"atan2({first}, 4 + sin({second}))", f"exp(tanh({first}))",
        f"(sin({first}))**3", f"(2 + cos({first}))**sin({second})",
        f"({first} if a > 5 else {second})",
    ])  # fmt: skip


@pytest.mark.parametrize("seed", range(30))
def test_derivatives_of_random_expressions(seed):
    draw = random.Random(seed)
    body = (
        f"a, b, c = x[0], x[1], x[2]\nd = {expression(draw, 3)}\nto[0] = sin(d)*{expression(draw, 2)}\nto[1] = cos(d)"
    )
    check(body, [draw.uniform(0.5, 2) for _ in range(3)], 2, rtol=2e-6)
