"""Variables: formulas by name, which other formulas use; and how long formulas may be."""

import ast
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import InputError
from stiffmbs.reading.formula.nodes import reading_order
from stiffmbs.reading.formula.size import DEEPEST, MOST_PARTS, balanced, check_size, depth, parts
from stiffmbs.reading.formula.text import FormulaError, parse
from stiffmbs.reading.formula.variables import resolved, with_variables
from stiffmbs.spatial import in_space

BODIES = {"a": {"mass": 1, "inertia": 1}, "b": {"mass": 1, "inertia": 1, "position": [1, 0]}}
SCENE = {
    "parameters": {"k": "5 N/m", "v": 3, "n": 2},
    "tables": {"push": {"table": [[0, 0], [1, 1], [2, 0]], "lines": True}},
    "variables": {"pull": "-k*stretch - c*a.vx", "stretch": "a.x - 0.3 m", "c": "2 N s/m", "turn": "sin(a.angle)", "more": "push(t)*1 N"},
    "bodies": BODIES,
    "run": {"duration": 1.5, "points": 16, "rtol": 1e-9},
}  # fmt: skip


def read(family=SCENE, changes=(), **sections):
    return stiffmbs.read_scene(json.dumps(family | sections), changes)


def pushed(*formulas, **sections):
    return read(forces={"f": {"type": "force", "i": "a", "force": list(formulas)}}, **sections)


def test_a_variable_is_its_formula_wherever_it_stands():
    named = pushed("pull + more", "turn*pull", requests={"r": "pull", "stretch": "2*stretch"})
    written = pushed(
        "(-k*(a.x - 0.3 m) - 2 N s/m*a.vx) + push(t)*1 N", "sin(a.angle)*(-k*(a.x - 0.3 m) - 2 N s/m*a.vx)",
        requests={"r": "-k*(a.x - 0.3 m) - 2 N s/m*a.vx", "stretch": "2*(a.x - 0.3 m)"},
    )  # fmt: skip
    found, expected = stiffmbs.run(named), stiffmbs.run(written)
    for channel in expected:
        np.testing.assert_array_equal(found[channel], expected[channel], err_msg=channel)
    assert np.ptp(found["r"]) > 0.1


def test_in_space_variables_hold_all_that_requests_may():
    scene = read(
        {"dimensions": 3, "bodies": {"a": {"mass": 2, "inertia": [1, 1, 1]}}, "run": {"duration": 1, "points": 11}},
        variables={"gain": "2 kg*accx(a) - force", "force": "fx(pull)"},
        forces={"pull": {"type": "force", "i": "a", "force": ["3 N*sin(2*t)", 0, 0]}},
        requests={"left": "gain", "both": {"f": "force", "g": "2*force"}},
    )
    solution = stiffmbs.run(scene)
    np.testing.assert_allclose(solution["both.f"], 3 * np.sin(2 * solution.t), atol=1e-9)
    np.testing.assert_allclose(solution["both.g"], 6 * np.sin(2 * solution.t), atol=1e-9)
    np.testing.assert_allclose(solution["left"], 0, atol=1e-6)


@pytest.mark.long
def test_a_planar_scene_takes_its_variables_and_tables_into_space():
    plane = pushed("pull + more", "turn*pull", requests={"r": "pull"})
    np.testing.assert_allclose(stiffmbs.run(in_space(plane))["r"], stiffmbs.run(plane)["r"], atol=1e-6)


def test_a_variable_can_be_set_and_repeated_entries_use_it():
    scene = read(
        changes=[("variables.stretch", "a.x - {n}*0.1 m"), ("k", "7")],
        forces={"f{j}": {"for": "j in 1..2", "type": "force", "i": "a", "force": ["j*pull", 0]}},
    )
    formula = scene.forces["f2"].force[0]
    assert formula.text == "(2)*pull" and formula.values["k"] == 7.0
    assert "a.x - 2 * (0.1 * unit.m)" in ast.unparse(formula.tree)


@pytest.mark.parametrize(
    "variables, words",
    [
        ({"p": "q", "q": "2*p"}, "variables.p: found a variable that depends on itself .p -> q -> p"),
        ({"p": "p + 1"}, "variables.p: found a variable that depends on itself"),
        ({"p": "2*strech"}, "variables.p: found the unknown name 'strech', expected t, .*a parameter or a variable"),
        ({"p": "c.x"}, "variables.p.*found the unknown body 'c'"),
        ({"p": "a.x2"}, "variables.p.*found 'a.x2'"),
        ({"p": "a.x + 3 kg"}, "variables.p: found m and kg in 'a.x . 3 kg'"),
        ({"p": "1 +"}, "variables.p: found '1 .', expected a number or a formula"),
        ({"p": [1]}, r"variables.p: found \[1\], expected a formula"),
        ({"N": "1"}, "variables.N: found the name of a unit, .*rename the variable"),
        ({"k": "1"}, "variables.k: found a name with a meaning already"),
        ({"t": "1"}, "variables.t: found a name with a meaning already"),
        ({"push": "1"}, "variables.push: found a name with a meaning already"),
        ({"2p": "1"}, "variables: found the name '2p'"),
        ([1], "variables: found .1., expected a mapping of names to formulas"),
        ({"p1": "a.x + t"} | {f"p{k + 1}": f"p{k}*p{k}" for k in range(1, 60)}, f"numbers, names and operations .*at most {MOST_PARTS}"),
        ({"p1": "a.x + t"} | {f"p{k + 1}": f"sin(p{k})" for k in range(1, 99)}, f"nested deeper than {DEEPEST}"),
    ],
)  # fmt: skip
def test_variables_that_cannot_be_are_told(variables, words):
    with pytest.raises(InputError, match=words):
        read(variables=variables)


@pytest.mark.parametrize(
    "section, entry, words",
    [
        ("forces", {"type": "force", "i": "a", "force": ["pull + 3 kg", 0]}, "found N and kg in"),
        ("forces", {"type": "torque", "i": "a", "torque": "pull"}, "found 'pull', which is in N, expected a torque in N m"),
        ("joints", {"type": "drive", "coordinate": "a.y", "position": "stretch"}, "found a.x in 'stretch', expected a formula without coord"),
        ("joints", {"type": "equation", "zero": "a.y + pull*1 m/1 N"}, "expected one of a.x, a.y, a.angle"),
        ("forces", {"type": "spring_damper", "i": "a", "j": "b", "damper_law": "lift*v"}, "the variable 'lift', which uses a parameter 'v'"),
    ],
)  # fmt: skip
def test_a_field_takes_of_a_variable_what_it_takes(section, entry, words):
    with pytest.raises(InputError, match=words):
        read(variables=SCENE["variables"] | {"lift": "2*v"}, **{section: {"e": entry}})


def test_a_unit_in_a_variable_is_none_of_a_laws_variables():
    """In the law of a spring s is its deflection, in a variable N/s is a newton in a second."""
    scene = read(
        variables={"rate": "50 N/s*(1 s)/(1 m)"},
        forces={"f": {"type": "spring_damper", "i": "a", "j": "b", "free_length": 1, "spring_law": "rate*s"}},
    )
    stretched = scene.model_copy(
        update={"bodies": scene.bodies | {"b": scene.bodies["b"].model_copy(update={"position": (1.5, 0)})}}
    )
    assert stiffmbs.run(stretched, duration=1e-3, points=2)["f.fx"][0] == pytest.approx(25.0)


def test_a_long_sum_is_computed():
    """A Fourier series of 5000 characters."""
    terms = [(k, 1 / k**2) for k in range(1, 240)]
    text = " + ".join(f"{size:.9f}*sin({k}*a.x)" for k, size in terms)
    assert len(text) > 4000
    body = {"mass": 1, "inertia": 1, "velocity": [2, 0]}
    solution = stiffmbs.run(read(bodies={"a": body}, variables={}, requests={"r": text}))
    expected = sum(float(f"{size:.9f}") * np.sin(k * solution["a.x"]) for k, size in terms)
    np.testing.assert_allclose(solution["r"], expected, atol=1e-12)


@pytest.mark.parametrize(
    "text, words",
    [
        ("1+" * 1500 + "1", f"found 3001 numbers, names and operations in .*, expected at most {MOST_PARTS}"),
        ("-" * 70 + "t", f"nested deeper than {DEEPEST}"),
        ("sin(" * 70 + "t" + ")" * 70, f"nested deeper than {DEEPEST}"),
        ("t*" * 60_000 + "t", "found a formula of 120001 characters"),
    ],
)
def test_formulas_beyond_the_bounds_are_told(text, words):
    with pytest.raises(FormulaError, match=words):
        parse(text)


def test_a_formula_within_the_bounds_is_left_as_it_is():
    text = "t + " * 50 + "sin(t)*2"
    assert ast.unparse(parse(text)) == text.replace("*", " * ")


@pytest.mark.long
@settings(max_examples=25)
@given(st.lists(st.tuples(st.sampled_from("+-*/"), st.integers(1, 9)), min_size=100, max_size=300))
def test_a_balanced_chain_has_the_same_value(chain):
    tree = ast.parse("5" + "".join(f"{op}{n}" for op, n in chain), mode="eval").body
    found = balanced(tree)
    assert parts(found) == parts(tree)
    if depth(tree) > DEEPEST:
        check_size(found, lambda: "the chain")
    values = [eval(compile(ast.fix_missing_locations(ast.Expression(each)), "", "eval")) for each in (found, tree)]
    size = sum(n for _, n in chain)
    assert values[0] == pytest.approx(values[1], rel=1e-10, abs=1e-10 * size)


def test_a_variable_that_stands_in_two_places_is_two_trees():
    """What changes a formula's nodes in their place, as a mirrored part does, must not meet one of them twice."""
    trees = resolved({"v": "2*dm(bar) + sin(bar.x)", "w": "v - v"}, {"t"})
    found = with_variables(parse("w*v/w"), trees)
    nodes = [node for tree in (found, *trees.values()) for node in reading_order(tree)]
    assert len(set(map(id, nodes))) == len(nodes)
