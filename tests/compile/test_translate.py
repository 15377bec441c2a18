"""The translator: what it compiles computes what Python computes, bit for bit; what it does not know it refuses."""

import math
import random
import re

import numpy as np
import pytest

import stiffmbs
from stiffmbs.compile.machine.compiler import compiled_source
from stiffmbs.compile.machine.translate.unit import Entry, assembly
from stiffmbs.compile.machine.translate.values import Untranslatable
from stiffmbs.compile.record import source_of
from stiffmbs.compile.state import State
from stiffmbs.compile.terms import TERM_SETS

HEADER = "from math import acos, asin, atan, atan2, copysign, cos, cosh, exp, floor, isfinite, log, sin, sinh, sqrt, tan, tanh\n"


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("STIFFMBS_CACHE", str(tmp_path))


def in_python(source):
    namespace = {}
    exec(source, namespace)
    return namespace["f"]


def both(body, *arguments, signature="float64(float64, float64, int64, int64)", names="x, y, i, j"):
    """What a function gives compiled, and what it gives in Python."""
    source = f"{HEADER}def f({names}):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    return compiled_source(source, "f", signature).call(*arguments), float(in_python(source)(*arguments))


@pytest.mark.parametrize(
    "expression",
    [
        "x + 2*y - i/j", "i // j + 10*(i % j)", "x**2 + y**-3", "i**3", "x**y", "abs(i) - abs(y)", "max(x, y, 0)", "min(i, j)",
        "x if x > y else i", "1 if x < y < 3.0 else y", "float(i)/7", "int(x*10)", "floor(x*10) + 1", "-x - -i",
        "1 if x > 0 and y > 0 or i == j else 2", "1 if not isfinite(x/(y - y)) else 2",
        "sqrt(x) + sin(x)*cos(y) + exp(-x) + log(x) + tan(x) + asin(x/9) + acos(x/9) + atan(y)",
        "atan2(x, y) + copysign(x, y) + sinh(x) + cosh(y) + tanh(x)",
    ],
)  # fmt: skip
@pytest.mark.parametrize("i, j", [(7, 3), (-7, 3), (7, -3), (-6, -3)])
def test_expressions_have_pythons_values(expression, i, j):
    if "y - y" in expression:  # where Python raises
        expression = "1"
    for x, y in ((0.3, 1.7), (2.25, -0.5)):
        compiled, expected = both(f"return {expression}", x, y, i, j)
        assert compiled == expected


@pytest.mark.parametrize("operation", ["<", "<=", ">", ">=", "==", "!="])
@pytest.mark.parametrize("x, y", [(1.0, 2.0), (2.0, 1.0), (2.0, 2.0), (math.nan, 1.0)])
def test_comparisons_hold_where_pythons_do(operation, x, y):
    i, j = (0, 1) if math.isnan(x) else (int(x), int(y))
    for names in ("x, y", "i, j", "x, j"):
        a, b = names.split(", ")
        compiled, expected = both(f"return 1 if {a} {operation} {b} else 0", x, y, i, j)
        assert compiled == expected


def test_a_division_by_zero_gives_infinity():
    source = "def f(x, y):\n    return x/y\n"
    divided = compiled_source(source, "f", "float64(float64, float64)").call
    assert divided(1.0, 0.0) == math.inf
    assert math.isnan(divided(0.0, 0.0))


@pytest.mark.parametrize(
    "body",
    [
        "total = 0\nfor k in range(i):\n    if k == 3:\n        continue\n    if k > 7:\n        break\n    total += k*x\nreturn total",
        "k = 0\nwhile k < i:\n    k += 2\nreturn k",
        "while True:\n    x *= 0.5\n    if x < 1e-3:\n        return x",
        "s = 0.0\nfor a in range(i, -1, -1):\n    for b in range(a, i):\n        s = s/3.0 + a - b\nreturn s",
        "a, b = x, y\na, b = b, a\nreturn a - 2.0*b",
        "i = i*2\nfor i in range(3):\n    y += i\nreturn y*i",
        "if x > y:\n    return 1\nelif i > 3:\n    return x\nreturn y",
    ],
)
def test_statements_do_what_they_do_in_python(body):
    for arguments in ((0.7, 0.4, 11, 3), (0.1, 0.4, 5, 3), (0.1, 0.4, 1, 3)):
        compiled, expected = both(body, *arguments)
        assert compiled == expected


@pytest.mark.parametrize(
    "body",
    [
        "for k in range(i + 3):\n    last = k*x\nreturn last + k", "if x > y:\n    a = x\nelse:\n    b = y\n    a = b\nreturn a",
        "for k in range(3):\n    a = x*k\n    for m in range(2):\n        b = a + m\n    c = b*a\nreturn c - b + m",
        "for k in range(9):\n    if k > j:\n        at = k\n        break\nreturn at + x",
        "k = 0\nwhile k < 4:\n    k = k + 1\n    a = k*y\nreturn a", "x = x + 1\na, b = x, y\nreturn a - b",
    ],
)  # fmt: skip
def test_a_value_given_in_one_place_is_that_of_the_last_time(body):
    """Read in its block, after it, and where its statement is passed over at times."""
    compiled, expected = both(body, 0.3, 1.7, 4, 2)
    assert compiled == expected


def test_straight_code_needs_no_memory():
    source = "def f(x, y):\n    a = x*x\n    for k in range(3):\n        b = a + k\n        y[k] = b*b\n"
    namespace = {}
    exec(source, namespace)
    text = assembly([Entry(namespace["f"], "f", ["float64", "float64*"], "void")], source)
    assert text.count("alloca") == 1  # of the range


def test_fields_of_a_frozen_dataclass_are_constants():
    source = """from dataclasses import dataclass

@dataclass(frozen=True)
class Parameters:
    gain: float = 0.3
    most: int = 7

PARAMETERS = Parameters()

def f(x, i):
    return PARAMETERS.gain*x if i < PARAMETERS.most else x
"""
    compiled = compiled_source(source, "f", "float64(float64, int64)").call
    assert [compiled(2.0, i) for i in (6, 7)] == [0.6, 2.0]
    with pytest.raises(Untranslatable, match="no record with a field 'most_of_all'"):
        compiled_source(
            source.replace("x if i < PARAMETERS.most", "x if i < PARAMETERS.most_of_all"),
            "f",
            "float64(float64, int64)",
        )


def test_pointers_are_read_and_written():
    body = "for k in range(n):\n    p[k] += q[n - 1 - k]*p[k]\n    r[k] = k*2 - r[k]"
    source = "def f(n, p, q, r):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    p, q, r = np.arange(5.0), np.linspace(1, 2, 5), np.arange(5) ** 2
    expected = [a.tolist() for a in (p, q, r)]
    in_python(source)(5, *expected)
    signature = "void(int64, float64*, float64*, int64*)"
    compiled_source(source, "f", signature).call(5, *(a.ctypes.data for a in (p, q, r)))
    assert [p.tolist(), q.tolist(), r.tolist()] == expected


def test_memory_of_floats_and_of_integers_is_told_apart():
    """What is stored as one of them leaves the others as they are: each access says of which kind it is."""
    function = in_python(source := "def f(n, p, r):\n    for k in range(n):\n        p[r[k]] += 0.5*r[0]")
    text = assembly([Entry(function, "f", ["int64", "float64*", "int64*"], "void")], source)
    accesses = re.findall(r"(?:= load|store) (double|i64)\b.*?(!tbaa !\d)?\n", text)
    assert len(accesses) > 6
    assert len(set(accesses)) == len({tag for _, tag in accesses}) == 2


def random_expression(draw, depth):
    if depth == 0:
        return draw.choice(["x", "y", "z", "0.5", "3", "1.0e-3"])
    a, b = (random_expression(draw, depth - 1) for _ in range(2))
    forms = "({a} + {b})", "({a} - {b})", "{a}*{b}", "(-{a})", "cos({a})", "({a} if {a} < {b} else {b})", "tanh({a})"
    return draw.choice(forms).format(a=a, b=b)


GIVEN = """
def twice(given, x, i):
    return once(given, once(given, x, i), i)

def once(given, x, i):
    return given(x, i)

def scaled(x, i):
    return x * i

def raised(x, i):
    return x + i
"""


def test_a_function_may_be_given_to_another_one(tmp_path, monkeypatch):
    (tmp_path / "given_functions.py").write_text(GIVEN)
    monkeypatch.syspath_prepend(tmp_path)
    source = "from given_functions import raised, scaled, twice\n"
    source += "def f(x, i):\n    return twice(scaled, x, i) + 100*twice(raised, x, i)\n"
    assert compiled_source(source, "f", "float64(float64, int64)").call(1.5, 3) == in_python(source)(1.5, 3) == 763.5


def test_random_expressions_have_pythons_values_to_the_last_bit():
    draw = random.Random(7)
    expressions = [random_expression(draw, 4) for _ in range(150)]
    lines = [f"    out[{k}] = {expression}" for k, expression in enumerate(expressions)]
    source = HEADER + "def f(x, y, z, out):\n" + "\n".join(lines)
    function = compiled_source(source, "f", "void(float64, float64, float64, float64*)").call
    for x, y, z in np.random.default_rng(1).normal(size=(20, 3)).tolist():
        out, expected = np.zeros(len(expressions)), [0.0] * len(expressions)
        function(x, y, z, out.ctypes.data)
        in_python(source)(x, y, z, expected)
        assert out.tolist() == expected


@pytest.mark.parametrize("scene", ["andrews", "half_car", "cam_follower", "stick_slip", "bouncing_ball", "four_bar"])
def test_kernels_have_pythons_values_to_the_last_bit(examples, scene, monkeypatch):
    monkeypatch.undo()  # kernels of the examples are in the cache that all tests share
    system = stiffmbs.compile_model(stiffmbs.load_scene(examples / f"{scene}.yaml"))
    state, random_ = State(system), np.random.default_rng(3)
    for vector in (state.q, state.u, state.a, state.lam, state.mu):
        vector += 0.01 * random_.normal(size=len(vector))
    turn = [turned for angle in state._q[2::3] for turned in (math.cos(angle), math.sin(angle), 0.0)]
    vectors = [state._q.tolist(), turn, *(v.tolist() for v in (state._u, state._a, state.lam, state.mu))]
    for term_set in TERM_SETS:
        state.evaluate(term_set, 0.013)
        values = [0.0] * len(state.values[term_set])
        for g, group in enumerate(system.groups):
            source = source_of(group.kind, term_set)
            if source:
                numbers, place = group.numbers.tolist(), system.places[term_set][g].tolist()
                kernel = in_python(source + "f = kernel\n")
                kernel(group.count, group.index.ravel().tolist(), numbers, 0.013, *vectors, place, values)
        count = system.n_values(term_set)
        assert state.values[term_set][:count].tolist() == values[:count]


@pytest.mark.parametrize(
    "body, reason",
    [
        ("return [x for _ in range(3)]", "not of the language"),
        ("return unknown(x)", "'unknown' cannot be called"),
        ("return unknown", "'unknown' is no variable"),
        ("if x > 0.0:\n    return x", "some of its ways only"),
        ("return i[x]", "a subscript of what is no pointer"),
        ("with x:\n    pass", "not of the language"),
    ],
)
def test_what_is_not_of_the_language_is_refused(body, reason):
    with pytest.raises(Untranslatable, match=reason):
        both(body, 1.0, 1.0, 1, 1)
