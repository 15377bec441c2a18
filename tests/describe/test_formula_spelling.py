"""Formulas without units, of which nothing is spelt anew: the same trees as by way of their tokens."""

import ast
import warnings

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stiffmbs.describe.formula import text as formula_text
from stiffmbs.describe.formula.nodes import measured_markers
from stiffmbs.describe.formula.text import FormulaError, parse

PIECES = (
    "x", "front.left.x", "w_fl.vx", "sin(", "max(a, b)", "(", ")", "+", "-", "*", "/", "^", "**", ",", " ", "1", "0.5", ".5", "5.", "1e3", "5e-3", "1_000", "01", "0x1F",
    "N", "mm", "in", "if", "or", "not", "2x", "3 kg", ".", "..", "\n", "\xe9", "\xb2", "#", "'", "[", "=", "<",
)  # fmt: skip
TEXTS = st.lists(st.sampled_from(PIECES), min_size=1, max_size=9).map("".join)


def tree(text):
    try:
        return ast.dump(parse(text))
    except FormulaError as error:
        return str(error)


class _Never:
    def fullmatch(self, text):
        return None


class _Always:
    def search(self, text):
        return True


@pytest.fixture(scope="module")
def by_tokens():
    """The tree of a text that is read by its tokens, with all its names looked at for owners."""

    def found(text):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(formula_text, "_NAMES_AND_NUMBERS", _Never())
            patch.setattr(formula_text, "_OWNER_OF_OWNER", _Always())
            return tree(text)

    return found


@pytest.mark.long
@settings(max_examples=1000, deadline=None)
@given(TEXTS)
def test_every_formula_has_the_tree_of_its_tokens(by_tokens, text):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of Python, about numbers that run into words
        expected = by_tokens(text)
    assert tree(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "a.b.c", "a . b . c", "(a.b).c", "((a.b) ) .c + 1", "a.b.c.d*2 mm", "1_000", "1e", "5.x", "a.5b", "1 .5", "a^^b", "a* *b", "2(x)", "(2)x", "sin(x)N", "5 N m/rad", "x\ny",
        "01", "1__0", "0.50.5x", "1and x", "a..b", "a.5or(b)", "x.1", "x1.5", "a if b", "0.6/2 m", "a.b\n.c",
    ],
)  # fmt: skip
def test_formulas_with_units_dots_and_faults_have_the_trees_of_their_tokens(by_tokens, text):
    assert tree(text) == by_tokens(text)


def test_a_formula_without_units_is_not_taken_apart(monkeypatch):
    monkeypatch.setattr(formula_text.tokenize, "generate_tokens", None)
    assert ast.unparse(parse("-k*(x - 2.5e-3)^2 + sin(cart.x)")) == "-k * (x - 0.0025) ** 2 + sin(cart.x)"


def test_a_marker_that_is_named_often_is_made_once():
    first, again = (measured_markers(parse("dx(wheel, hub.axis)")) for _ in range(2))
    assert all(a is b for a, b in zip(first, again, strict=True))
