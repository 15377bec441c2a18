"""Numbers with units: what they mean, and that nothing but arithmetic can stand in them."""

import contextlib
import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.reading.formula.text import FormulaError
from stiffmbs.reading.units.quantity import in_si, quantity
from stiffmbs.reading.units.units import Quantity


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("125 mm", "length", 0.125),
        ("0.6/2", "length", 0.3),
        ("20 deg", "angle", math.radians(20)),
        ("-20deg", "angle", -math.radians(20)),
        ("10 N/5 mm", "stiffness", 2000.0),
        ("270 N/m", "stiffness", 270.0),
        ("3 N m/rad", "torque", 3.0),
        ("2 mm^2*1000 kg/m^2*1 m/s^2", "force", 2e-3),
        ("sqrt(4 m^2)", "length", 2.0),
        ("3000 rpm", "angular velocity", 100 * math.pi),
        ("2*sin(30 deg)", "number", 1.0),
        ("max(1 mm, 2 mm)", "length", 2e-3),
        ("(1 + 2) m", "length", 3.0),
        ("1e-3", "time", 1e-3),
        ("2 pi", "angle", 2 * math.pi),
        ("1 tonne", "mass", 1000.0),
        ("-2^2", "number", -4.0),
    ],
)
def test_value_in_si(text, dimension, value):
    assert in_si(text, dimension) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "().__class__",
        "[1 for x in (1,)]",
        "lambda: 1",
        "'a'*3",
        "1 if 1 else 2",
        "open('x')",
        "x := 3",
        "f'{1}'",
        "sin.__call__(1)",
        "(1).real",
        "True",
        "1j",
        "1, 2",
        "abs(1, 2)",
        "",
        "   ",
        "1 +",
        "9**9**9**9",
        "1e999",
        "1/0",
        "sqrt(-1)",
        "(-8)^(1/3)",
        "log(0)",
        "sin(1, 2)",
        "sin(3 mm)",
        "1 mm + 1 s",
        "2^(1 m)",
        "1 parsec",
        "-" * 500 + "1",
        "1+" * 1500 + "1",
        "1\n2",
        "\x00",
        "import os",
        "a\\\nb",
    ],
)
def test_what_is_no_arithmetic_is_refused_in_words(text):
    with pytest.raises(FormulaError) as error:
        in_si(text, "number")
    assert "found" in str(error.value)


@pytest.mark.parametrize("found", [True, None, [1], {"a": 1}, float("nan"), float("inf")])
def test_what_is_no_number_is_refused(found):
    with pytest.raises(FormulaError):
        in_si(found, "length")


@pytest.mark.parametrize("found", ["sqrt 4 m", "abs 2 m", "length 2 m", "2*length 3 m", "other 2 m"])
def test_a_name_before_a_number_with_a_unit_is_no_call(found):
    with pytest.raises(FormulaError, match="expected a number or a formula"):
        in_si(found, "length", {"length": Quantity(1.0, (0, 1, 0))})


def test_wrong_dimension_is_refused():
    with pytest.raises(FormulaError, match=r"'3 kg', which is in kg, expected a length in m"):
        in_si("3 kg", "length")


def test_a_parameter_may_bear_a_units_name_where_it_is_clear():
    parameters = {"N": Quantity(5.0), "m": Quantity(2.0)}
    assert quantity("3*N", parameters).value == 15
    assert quantity("3 N", parameters) == Quantity(3.0, (1, 1, -2))
    assert quantity("3 N/m", parameters) == Quantity(3.0, (1, 0, -2))
    with pytest.raises(FormulaError, match="a unit and a parameter"):
        quantity("3 N/m + N", parameters)


@pytest.mark.long
@given(st.text(max_size=30))
def test_any_text_is_a_number_or_refused(text):
    with contextlib.suppress(FormulaError):
        assert math.isfinite(quantity(text).value)


@given(
    st.recursive(st.integers(1, 9).map(str), lambda s: st.builds("({} {} {})".format, s, st.sampled_from("+-*/"), s))
)
def test_arithmetic_is_pythons(text):
    try:
        expected = eval(text)
    except ZeroDivisionError:
        return
    assert quantity(text).value == pytest.approx(expected)


@pytest.mark.parametrize("found", [1e300, -1e101, "1e99*1e99"])
def test_numbers_whose_products_overflow_are_refused(found):
    with pytest.raises(FormulaError, match=r"expected a length below 1e\+100 m"):
        in_si(found, "length")


@pytest.mark.parametrize(
    ("written", "meant"),
    [("t", "tonne"), ("Nm", "N m"), ("Nmm", "N mm"), ("Ns", "N s"), ("kgm", "kg m"), ("mm2", "mm^2"), ("m3", "m^3"), ("degrees", "deg"),
     ("Newton", "N"), ("kph", "km/h"), ("sec", "s"), ("lbs", "lb"), ("Meters", "m"), ("hz", "Hz")],
)  # fmt: skip
def test_units_in_other_spellings_are_suggested(written, meant):
    with pytest.raises(stiffmbs.InputError, match=re.escape(f"'{written}' (did you mean '{meant}'?)")):
        stiffmbs.read_scene(f"{{bodies: {{a: {{mass: 2 {written}, inertia: 1}}}}, run: {{duration: 1}}}}")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e8 N/m", 1e8), ("-1e8 N/m", -1e8), ("3 N*s/m", 3), ("2 kN/mm^2", 2e9), ("5 m", 5), ("4 m/s^2", 4), ("2 N m/rad", 2), ("7 kg/(m*s)", 7),
        ("m", 2), ("s/m", 0.15), ("2*m*s", 1.2),
    ],
)  # fmt: skip
def test_units_may_have_the_names_of_parameters(text, value):
    """A textbook calls a mass m, and its stiffness is in N/m."""
    parameters = {"m": Quantity(2.0), "s": Quantity(0.3)}
    assert quantity(text, parameters).value == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["3 N/m*x", "2*m*3 N", "1 N/m + m", "5 N/(x*m)", "2 mm*sin(m)"])
def test_a_parameter_next_to_units_in_a_formula_is_ambiguous(text):
    parameters = {"m": Quantity(2.0), "x": Quantity(1.0)}
    with pytest.raises(FormulaError, match=r"rename the parameter, or write \(1 m\) for the unit"):
        quantity(text, parameters)
    quantity(text.replace("m", "y").replace("yy", "mm"), {"y": Quantity(2.0), "x": Quantity(1.0)})


def test_the_unit_can_be_written_in_parentheses():
    parameters = {"m": Quantity(2.0), "x": Quantity(1.0)}
    assert quantity("3 N/(1 m)*x", parameters).value == 3


@pytest.mark.parametrize(
    ("entry", "example"),
    [
        (
            "gravity: -9.81",
            r"gravity: found -9\.81, expected a list in brackets: \[0, -9\.81\], or \[0, 0, -9\.81\] in space",
        ),
        ("figure: {y: b.x}", r"figure\.y: found 'b\.x', expected a list in brackets: \[b\.x\]"),
        ("markers: {a: {point: 0.1}}", r"found 0\.1, expected a list in brackets: \[0\.1, \.\.\.\]"),
        (
            "forces: {f: {type: force, i: b, force: -2*b.x}}",
            r"force: found '-2\*b\.x', expected a list in brackets: \[-2\*b\.x, \.\.\.\]",
        ),
    ],
)
def test_a_list_without_brackets_is_answered_with_an_example(entry, example):
    with pytest.raises(InputError, match=example):
        stiffmbs.read_scene(f"bodies: {{b: {{mass: 1, inertia: 1}}}}\n{entry}")


@pytest.mark.parametrize(("text", "kind"), [("hello world", "text without keys"), ("[1, 2]", "a list")])
def test_text_that_is_no_scene_is_answered_with_what_a_scene_is(text, kind):
    with pytest.raises(
        InputError, match=f"found {kind}, expected a scene: YAML with 'bodies', as stiffmbs init writes it"
    ):
        stiffmbs.read_scene(text)


FAULTY = """
parameters: {L: 1 m, m: 2 kg}
bodies: {bar: {mass: m, inertia: m*L^2/12, position: [L/2, 0]}}
forces: {push: {type: force, i: bar, force: [0, 1 N]}}
"""


def test_all_places_of_faults_are_named_and_the_parameter_that_a_change_gives_another_unit():
    with pytest.raises(stiffmbs.InputError) as refused:
        stiffmbs.read_scene(FAULTY, [("L", "3 kg"), ("m", "4")])
    assert str(refused.value).endswith("(and 1 more: bodies.bar.position.0); L is changed from m to kg")


def test_a_formula_that_yaml_divides_at_its_comma():
    with pytest.raises(stiffmbs.InputError, match="found 3 values, expected 2; a formula with a comma needs quotes"):
        stiffmbs.read_scene(FAULTY.replace("1 N]", "max(0 N, 1 N)]"))
    with pytest.raises(stiffmbs.InputError, match=r"found 3 values, expected 2$"):
        stiffmbs.read_scene(FAULTY.replace("1 N]", "0, 1 N]"))
