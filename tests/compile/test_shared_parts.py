"""Common parts of generated code are computed once, and the code has the values of the expressions."""

import math
import random

import pytest
import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from stiffmbs.compile.symbolic.differentiate import Derivatives
from stiffmbs.compile.symbolic.read import read
from stiffmbs.compile.symbolic.shared_parts import written

SYMBOLS = x, y, z, w = sp.symbols("x y z w", real=True)
PRINTER = PythonCodePrinter({"fully_qualified_modules": False, "precision": 17})


def code(*outputs, meanings=None, given=None):
    derivatives = Derivatives()
    derivatives.meanings.update(meanings or {})
    return written(outputs, derivatives, given or {}, PRINTER)


def values(found, **at):
    names = {**vars(math), **at}
    for name, text in found.assignments:
        names[name] = eval(text, names)
    return [eval(text, names) for text in found.results]


def grown(rng, size):
    """A random expression of sums, products, powers and functions."""
    if size <= 1:
        return rng.choice(
            [*SYMBOLS, sp.Integer(rng.randint(-3, 3)), sp.Rational(rng.randint(1, 5), 3), sp.Float(0.37), sp.pi]
        )
    parts = [grown(rng, size // 2) for _ in range(rng.randint(2, 4))]
    match rng.randrange(6):
        case 0 | 1:
            return sp.Add(*parts)
        case 2 | 3:
            return sp.Mul(*parts)
        case 4:
            return (parts[0] ** 2 + 1) ** sp.Rational(rng.choice([-5, -3, -2, -1, 1, 3, 4, 7, 14]), 2)
        case _:
            return rng.choice([sp.sin, sp.cos, sp.atan])(parts[0]) - sp.Abs(parts[1]) ** sp.Float(1.3)


@pytest.mark.long
@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(6))
def test_code_has_the_values_of_the_expressions(seed):
    rng = random.Random(seed)
    named = sp.symbols("named0:3", real=True)
    meanings = {}
    for symbol in named:
        meanings[symbol] = grown(rng, 4).subs(x, rng.choice([x, *meanings]))
    outputs = [grown(rng, 8).subs({y: rng.choice(named), z: -named[0] / 2}) for _ in range(4)]
    at = {symbol: rng.uniform(0.3, 1.7) for symbol in SYMBOLS}
    expected = outputs
    for symbol in reversed(named):
        expected = [each.subs(symbol, meanings[symbol]) for each in expected]
    for found, each in zip(
        values(code(*outputs, meanings=meanings), **{s.name: v for s, v in at.items()}), expected, strict=True
    ):
        assert found == pytest.approx(float(each.subs(at)), rel=1e-6, abs=1e-6), seed


def test_parts_are_computed_once_also_with_the_other_sign_or_within_more_factors():
    found = code((x - y) * z, (y - x) * w, x * y * z, x * y * w + 1)
    assert [text for _, text in found.assignments] == ["x - y", "x*y"]


def test_pairs_of_terms_are_shared_up_to_their_sign():
    found = code(x - 2 * y + z, w - x + 2 * y)
    assert [text for _, text in found.assignments] == ["x - 2.0*y"]
    assert values(found, x=1.0, y=2.0, z=4.0, w=8.0) == [1.0, 11.0]


def test_reciprocals_are_shared_and_a_single_one_is_a_division():
    assert code(x / (y * z)).results == ["x/y/z"]
    assert code(x / y, z / y).assignments == [(code(x / y, z / y).assignments[0][0], "1.0/y")]


def test_given_symbols_replace_expressions_and_unused_symbols_are_not_read():
    found = code(sp.sin(x) * y, given={sp.sin(x): z})
    assert found.results == ["y*z"] and found.symbols == {y, z}


def test_constants_are_folded():
    found = code(named := sp.Symbol("n", real=True), x * named, x / named, meanings={named: sp.Rational(1, 2)})
    assert found.results == ["0.5", "0.5*x", "2.0*x"]


def test_infinity_is_a_number_of_the_language():
    assert code(sp.oo, x - sp.oo).results == ["float('inf')", "float('-inf')"]


def test_what_occurs_many_times_is_read_once():
    long = x
    for _ in range(60):
        long = sp.sin(long) * sp.cos(long)
    assert read(long, None) is long
    assert len(code(long).assignments) <= 180
