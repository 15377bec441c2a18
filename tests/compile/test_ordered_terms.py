"""Sums are printed in SymPy's own order, and long expressions are read once for each of their parts."""

import itertools

import pytest
import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from stiffmbs.compile.symbolic.generate import _Printer, ordered_terms
from stiffmbs.compile.symbolic.read import read

x, y, a10, a9 = sp.symbols("x y a10 a9", real=True)
PARTS = [
    x, -y, 3 * x, -2 * x * y, x**2, 1 / x, sp.sqrt(x), y / sp.sqrt(x), sp.Rational(1, 3) * a10, -a9 * x, sp.sin(x) * y, sp.cos(x * y) ** 2,
    sp.Integer(2), -sp.Rational(1, 2), sp.pi, sp.sqrt(2) * y, sp.Float("0.25") * x * a9, (x + y) * a10, sp.exp(-x), sp.Integer(-1),
]  # fmt: skip
LENGTHS = (2, 3, 5)


@pytest.mark.parametrize("length", LENGTHS)
def test_terms_of_sums_stand_in_sympys_own_order(length):
    parts = PARTS if length < 5 else PARTS[::2]
    sums = [sp.Add(*found) for found in itertools.combinations(parts, length)]
    found = [x for x in sums if x.is_Add and ordered_terms(x) is not None]
    assert len(found) > len(sums) / 2
    for x in found:
        assert ordered_terms(x) == x.as_ordered_terms()


def test_terms_of_one_monomial_are_left_to_sympy():
    equal = sp.Add(sp.sqrt(2) * x, sp.sqrt(3) * x, evaluate=False)
    assert ordered_terms(equal) is None
    assert _Printer().doprint(1 - x) == PythonCodePrinter().doprint(1 - x)


def test_kernels_look_at_no_coefficient_to_order_a_sum(monkeypatch):
    monkeypatch.setattr(sp.Expr, "as_terms", None)
    assert _Printer().doprint(3 * x * y - y / 2 + x**2 + 1) == "(x*x) + 3*x*y - 1/2*y + 1"


def test_what_occurs_many_times_is_read_once():
    long = x
    for _ in range(60):
        long = sp.sin(long) * sp.cos(long)
    assert read(long, None) is long
