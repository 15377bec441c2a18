"""Spelling of formulas: owners with dots, parentheses and spaces; names that occur often."""

import ast

import pytest

import stiffmbs
from stiffmbs.reading.formula.nodes import measured_markers
from stiffmbs.reading.formula.text import FormulaError, parse


@pytest.mark.parametrize("text", ["a.b.c", "a . b . c", "(a.b).c", "((a.b) ) .c", "a.b\n.c"])
def test_the_owner_of_a_name_with_dots_is_one_name(text):
    tree = parse(f"{text} + 1").left
    assert (tree.value.id, tree.attr) == ("a.b", "c")


@pytest.mark.parametrize(
    "text", ["a..b", "a.5b", "1 .5", "a^^b", "a* *b", "2(x)", "(2)x(1)", "a if b", "a.5or(b)", "01"]
)
def test_other_spellings_are_refused(text):
    with pytest.raises(FormulaError, match="found"):
        parse(text)


def test_a_formula_without_units_is_kept():
    assert ast.unparse(parse("-k*(x - 2.5e-3)^2 + sin(cart.x)")) == "-k * (x - 0.0025) ** 2 + sin(cart.x)"


def test_a_marker_that_is_named_often_is_made_once():
    first, again = (measured_markers(parse("dx(wheel, hub.axis)")) for _ in range(2))
    assert all(a is b for a, b in zip(first, again, strict=True))


@pytest.mark.parametrize("section", ["requests: {far: dm(b, ground)}", "variables: {v: max(b.x, 0)}"])
def test_a_request_or_variable_whose_commas_split_a_mapping_gets_a_hint(section):
    with pytest.raises(stiffmbs.InputError, match="a formula with commas needs quotes between braces"):
        stiffmbs.read_scene(f"bodies: {{b: {{mass: 1, inertia: 1}}}}\n{section}\n")


@pytest.mark.parametrize("law", ["step(t, 0, 0, 3, 1.5)", "step(t, 0, 1, 3, 1.5)"])
def test_a_formula_whose_commas_split_a_mapping_gets_a_hint(law):
    scene = f"bodies: {{b: {{mass: 1, inertia: 1}}}}\njoints:\n  m: {{type: drive, coordinate: b.x, position: {law}}}\n"
    with pytest.raises(stiffmbs.InputError, match="a formula with commas needs quotes between braces"):
        stiffmbs.read_scene(scene)
