"""Sums and products of the derivation are those of SymPy, of which records and their kernels follow; and its cache is larger."""

import os
import subprocess
import sys
from itertools import product as combinations

import pytest
import sympy as sp

from stiffmbs.compile.symbolic.canonical import positive, product, total

VARIABLE = "SYMPY_CACHE_SIZE"
x, y, z = sp.symbols("x y z", real=True)
PARTS = (
    x, -x, 2 * x, x * y, -3 * x * y, x + y, x - y, 2 * (x + y), sp.Mul(2, x + y, evaluate=False), x + y + 1, x**2, 1 / x, sp.sqrt(x**2 + y**2),
    1 / sp.sqrt(x**2 + y**2), sp.sin(x), sp.exp(x), sp.exp(-y), sp.Abs(x), sp.sqrt(2), sp.sqrt(2) * x, sp.pi, sp.S.Zero, sp.S.One, -sp.S.One,
    sp.Rational(1, 2), sp.Float("0.1"), sp.Float("0.3"), sp.oo, y**z, x**z,
)  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    "ours, sympys", [(lambda parts: total(parts), sp.Add), (lambda parts: product(*parts), sp.Mul)]
)
def test_sums_and_products_are_those_of_sympy(ours, sympys):
    for parts in (*combinations(PARTS, repeat=2), *((*pair, z * x) for pair in combinations(PARTS, repeat=2))):
        assert sp.srepr(ours(list(parts))) == sp.srepr(sympys(*parts)), parts


def test_signs_are_those_of_sympy():
    for one in (*PARTS, *(a - b for a, b in combinations(PARTS[:-3], repeat=2)), x - y - z, z - x - y, 1 - x, x - 1):
        has_minus = one.could_extract_minus_sign()
        assert positive(one) == (-one if has_minus else None), one


class Endless(sp.Function):
    """Function that does not tell whether it is finite."""

    def _eval_is_finite(self):
        pytest.fail("asked whether a factor is finite, which takes SymPy long for functions of long sums")


def test_products_with_zero_do_not_ask_whether_functions_are_finite():
    assert product(sp.S.Zero, Endless(x), y) is sp.S.Zero
    assert product(sp.S.Zero, sp.oo, x) is sp.S.NaN


@pytest.mark.long
@pytest.mark.parametrize(("given", "expected"), [(None, "20000 False"), ("5000", "5000 True")])
def test_derivations_have_a_larger_cache_of_sympy_and_leave_the_environment_as_it_is(given, expected):
    script = (
        "import os, stiffmbs.compile.symbolic\nfrom sympy.core import cache\n"
        f"print(cache.{VARIABLE}, {VARIABLE!r} in os.environ)"
    )
    environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
    environment |= {} if given is None else {VARIABLE: given}
    shown = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == expected
