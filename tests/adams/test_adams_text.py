"""The text of Adams datasets: statements, arguments, expressions, and what is said where one of them is wrong."""

import ast
import math

import numpy as np
import pytest

from stiffmbs.adams.functions.expression import ExpressionError, parse
from stiffmbs.adams.statements.arguments import Arguments, number
from stiffmbs.adams.statements.dataset import read_dataset
from stiffmbs.adams.statements.text import statements
from stiffmbs.errors import InputError

SMALLEST = """a title, whatever it says /1,
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
PART/2, MASS=2, CM=21, IP=1,1,1
MARKER/21, PART=2
{}
END
"""


def dataset(text: str):
    return read_dataset(SMALLEST.format(text))


def test_lines_are_joined_and_comments_left_out():
    text = "\r\n".join([
        "Title / with, signs",
        "! comment",
        "MARKER/0102, PART = 01   ! trailing",
        "!, QP = 9, 9, 9",
        "",
        ", QP = 1,",
        ", 2, 3",
        "marker/7, pa=1, &",
        "  qp=4,5,6; MARKER/8, PART=1",
        "end",
        "MARKER/9, PART = 1",
    ])  # fmt: skip
    title, found, ended = statements(text)
    assert title == "Title / with, signs" and ended
    assert [(s.word, s.ident, s.line) for s in found] == [("MARKER", "0102", 3), ("MARKER", "7", 8), ("MARKER", "8", 9)]
    assert [piece.text for piece in found[0].pieces] == ["PART = 01", "QP = 1", "2", "3"]
    assert [piece.line for piece in found[0].pieces] == [3, 6, 7, 7]
    assert [piece.text for piece in found[1].pieces] == ["pa=1", "qp=4", "5", "6"]


def test_a_view_name_belongs_to_the_statement_after_it():
    text = "t\n!  adams_view_name='crank'\nPART/2\n, MASS=1\n!\nPART/3\nEND"
    assert [s.alias for s in statements(text)[1]] == ["crank", ""]


def test_functions_keep_their_commas_and_lose_those_of_new_lines():
    text = r"""t
REQUEST/4, F2=DX(1,2)\F3=STEP(TIME,
, 0, 0
, 1, 5)\
, F4 = DM(1,2)
, - 2.0*
, TIME\, COMMENT=some words
"""
    (statement,) = statements(text)[1]
    found = Arguments(statement, "REQUEST", ("F2", "F3", "F4", "COMMENT"), ("F2", "F3", "F4"))
    assert found.text("F2") == "DX(1,2)"
    assert found.text("F3").replace(" ", "") == "STEP(TIME,0,0,1,5)"
    assert found.text("F4") == "DM(1,2) - 2.0* TIME"
    assert found.text("COMMENT") == "some words"


def test_abbreviations_stand_for_the_first_name_that_they_begin():
    (statement,) = statements("t\nREQUEST/1, D, I=3, C=a b\n")[1]
    found = Arguments(statement, "REQUEST", ("DISPLACEMENT", "I", "COMMENT", "CNAMES"))
    assert found.one_of("DISPLACEMENT") and found.required("I") == 3 and found.text("COMMENT") == "a b"


@pytest.mark.parametrize(
    "text, value",
    [("90D", math.pi / 2), ("-45.0d", -math.pi / 4), ("1.5D2", 150.0), ("2e-3", 2e-3), (".5", 0.5), ("x", None)],
)
def test_numbers_may_be_degrees_or_have_fortrans_exponents(text, value):
    assert number(text) == pytest.approx(value) if value is not None else number(text) is None


@pytest.mark.parametrize(
    "text, value",
    [
        ("-2**2", -4),
        ("2*3**2/6", 3),
        ("1.0D1 + 1E1", 20),
        ("SIN(90D)", 1),
        ("cos(180d)*2.5", -2.5),
        ("IF(-1: 3, 4, 5)", 3),
        ("If(0:3,4,5) + 0201", 205),
        ("  - 1.0*(5 - 2.0) - .5 + 0.0", -3.5),
    ],
)
def test_expressions_mean_what_they_mean_in_fortran(text, value):
    names = {"SIN": math.sin, "COS": math.cos, "IF_": lambda x, a, b, c: a if x < 0 else b if x == 0 else c}
    assert eval(compile(ast.Expression(ast.fix_missing_locations(parse(text))), "", "eval"), names) == pytest.approx(
        value
    )


@pytest.mark.parametrize("text", ["", "2*", "DX(1,2", "a = 3", "1..2", "DM[1]", "'x'", "1 if 2 else 3", "3$"])
def test_what_is_no_expression_is_refused(text):
    with pytest.raises(ExpressionError, match="expected a function expression"):
        parse(text)


UNITS = "t\nUNITS/{}\nPART/1, GROUND\nPART/2, MASS=1, CM=3, IP=1,1,1\nMARKER/3, PART=2, QP=1,0,0\nACCGRAV/JGRAV=-1\n"


@pytest.mark.parametrize(
    "units, force, mass, length, time",
    [
        ("FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND", 1, 1, 1, 1),
        ("FORCE = NEWTON, MASS = KILOGRAM, LENGTH = MILLIMETER, TIME = SECOND", 1, 1, 1e-3, 1),
        ("FORCE=POUND_FORCE,MASS=SLUG,LENGTH=FOOT,TIME=MILLI", 4.4482216152605, 14.593902937, 0.3048, 1e-3),
        ("FORCE=KPOUND,MASS=SLINCH,LENGTH=INCH,TIME=MINUTE", 4448.2216152605, 175.126835, 0.0254, 60),
        ("SYSTEM=CGS", 1e-5, 1e-3, 1e-2, 1),
        ("SYSTEM=IPS", 4.4482216152605, 0.45359237, 0.0254, 1),
        ("UCF=32.174", 32.174, 1, 1, 1),
    ],
)
def test_units_are_turned_to_si(units, force, mass, length, time):
    found = read_dataset(UNITS.format(units))
    assert (found.units.force, found.units.mass, found.units.length, found.units.time) == pytest.approx(
        (force, mass, length, time), rel=1e-6
    )
    assert found.gravity == pytest.approx((0, -length / time**2, 0))
    part = next(part for part in found.parts if not part.ground)
    assert part.mass == pytest.approx(mass) and part.moments[0] == pytest.approx(mass * length**2)
    assert found.markers[3].frame.point == pytest.approx([length, 0, 0])


def test_a_slug_is_a_pound_force_at_a_foot_per_square_second():
    units = read_dataset(UNITS.format("FORCE=POUND_FORCE, MASS=SLUG, LENGTH=FOOT, TIME=SECOND")).units
    assert units.of(mass=1, length=1, time=-2) == pytest.approx(units.force, rel=1e-12)


@pytest.mark.parametrize(
    "marker, x, z",
    [
        ("QP=1,2,3", (1, 0, 0), (0, 0, 1)),
        ("REULER=90D,90D,0", (0, 1, 0), (1, 0, 0)),
        ("REULER=180D, 90D, 180D", (1, 0, 0), (0, 1, 0)),
        ("QP=1,1,1, ZP=1,5,1", (1, 0, 0), (0, 1, 0)),
        ("ZP=2,0,0, XP=1,1,0", (0, 1, 0), (1, 0, 0)),
        ("USEXP, XP=0,1,0, ZP=0,1,1", (0, 1, 0), (0, 0, 1)),
        ("XP=0,3,2", (0, 1, 0), (0, 0, 1)),
    ],
)
def test_markers_are_turned_by_angles_or_points(marker, x, z):
    axes = dataset(f"MARKER/5, PART=2, {marker}").markers[5].frame.axes
    np.testing.assert_allclose(axes[:, 0], x, atol=1e-15)
    np.testing.assert_allclose(axes[:, 2], z, atol=1e-15)
    np.testing.assert_allclose(np.cross(axes[:, 2], axes[:, 0]), axes[:, 1], atol=1e-15)


@pytest.mark.parametrize(
    "text, words",
    [
        ("MARKER/5, PART=2, QP=1,2", r"line 6, MARKER/5: found QP = 1, 2, expected 3 numbers"),
        ("MARKER/5, PART=2, QP=1,2,1e400", r"line 6, MARKER/5: found QP = 1, 2, 1e400, expected 3 numbers"),
        ("MARKER/5, PART=2, EULER=90,0,0", r"line 6, MARKER/5: found 'EULER=90', expected one of .*REULER"),
        ("MARKER/5\n, PART=2\n, QP=1,2,3x", r"line 8, MARKER/5: found QP = 1, 2, 3x, expected 3 numbers"),
        ("MARKER/5, PART=2, COLOR=3", r"line 6, MARKER/5: found 'COLOR=3', expected one of PART, POINT_MASS, QP"),
        ("MARKER/5, PART=2, QP=0,0,0, QP=1,1,1", r"line 6, MARKER/5: found QP twice"),
        ("MARKER/21, PART=2", r"line 6, MARKER/21: found it a second time \(first in line 5\)"),
        ("MARKER/x, PART=2", r"line 6, MARKER/x: found 'x' after the slash, expected the number"),
        ("MARKER/5, PART=2, ZP=0,0,0", r"found ZP at QP"),
        ("MARKER/5, PART=2, ZP=0,0,1, XP=0,0,2", r"on one line with QP"),
        ("MARKER/5, PART=2, ZP=0,0,1, REULER=1,2,3", r"found REULER and ZP"),
        ("JOINT/1, I=21, J=21", r"JOINT/1: found no kind of joint, expected one of REVOLUTE"),
        ("JOINT/1, REVOLUTE, FIXED, I=1, J=2", r"found REVOLUTE and FIXED, expected one of them"),
        ("JOINT/1, REVOLUTE, I=21", r"JOINT/1: found no J, expected J = the number of a statement"),
        ("JOINT/1, SCREW, I=1, J=2", r"found no PITCH"),
        ("JOINT/1, RACKPIN, I=1, J=2", r"found no PD"),
        ("JPRIM/1, I=1, J=2", r"JPRIM/1: found no kind of primitive"),
        ("MOTION/1, I=1, FUNC=TIME", r"MOTION/1: found no JOINT, expected JOINT, or I and J"),
        ("MOTION/1, JOINT=1", r"MOTION/1: found no FUNCTION"),
        ("MOTION/1, JOINT=1, FUNCTION=USER(1,2)", r"a user subroutine"),
        ("GCON/1, FUNCTION=DX(1,2", r"line 6, GCON/1: FUNCTION: found 'DX\(1,2'"),
        ("COUPLER/1, JOINTS=1", r"COUPLER/1: found JOINTS = 1, expected 2 or 3"),
        ("COUPLER/1, JOINTS=1,2, TYPE=T:Q, SCALES=2", r"found TYPE = T:Q, expected T or R"),
        ("GEAR/1, CV=3", r"GEAR/1: found no JOINTS"),
        ("SFORCE/1, I=1, J=2, FUNC=1", r"SFORCE/1: found no kind of force"),
        ("VFORCE/1, I=1, JFLOAT=2, FX=1", r"VFORCE/1: found no FY, no FZ"),
        ("GFORCE/1, I=1, JFLOAT=2, FUNCTION=USER(1)", r"a user subroutine"),
        ("SPRINGDAMPER/1, I=1, J=2, K=3", r"found no kind of spring"),
        ("SPRINGDAMPER/1, ROT, I=1, J=2, K=3", r"found K with ROTATIONAL, expected only KT, CT, ANGLE, TORQUE"),
        ("BEAM/1, I=1, J=2, LENGTH=1", r"BEAM/1: found no AREA"),
        ("FIELD/1, I=1, J=2, KMATRIX=1,2", r"FIELD/1: found KMATRIX = 1, 2, expected 36 numbers"),
        ("REQUEST/1, I=1", r"REQUEST/1: found no quantity"),
        ("REQUEST/1, V, J=1", r"REQUEST/1: found no I"),
        ("SPLINE/1, X=1,2,3,4, Y=1", r"SPLINE/1: found 4 X and 1 Y"),
        ("SPLINE/1, X=1,2,2,4, Y=1,2,3,4", r"do not increase"),
        ("UNITS/FORCE=NEWTON", r"line 6, UNITS: found it a second time \(first in line 2\)"),
        ("ACCGRAV/KGRAV=x", r"ACCGRAV: found KGRAV = x, expected 1 numbers"),
        (", QP = 1", r"MARKER/21"),
    ],
)
def test_wrong_statements_are_told_with_their_line(text, words):
    with pytest.raises(InputError, match=words):
        dataset(text)
        if text.startswith(","):
            raise InputError("MARKER/21")  # it continued the marker, and nothing is wrong


def test_what_is_not_read_is_listed_at_once():
    text = "FLEX_BODY/3, CM=1\nNFORCE/1, JPART=3\nNONSENSE/7\nGRAPHICS/1, CYLINDER, CM=21, LENGTH=1, RADIUS=1"
    with pytest.raises(InputError, match=r"FLEX_BODY/3 \(line 6\), NFORCE/1 \(line 7\), NONSENSE/7 \(line 8\); exp"):
        dataset(text)


def test_graphics_and_settings_are_left_out_with_a_note():
    found = dataset("GRAPHICS/1, CYLINDER, CM=21, LENGTH=1, RADIUS=1\nOUTPUT/REQSAVE\nGRAPHICS/2, BOX, CORNER=21")
    assert found.notes == (
        "GRAPHICS (lines 6, 8) is left out: graphics",
        "OUTPUT (line 7) is left out: output settings",
    )


def test_a_missing_end_is_told():
    assert read_dataset("t\nPART/1, GROUND").notes == ("the dataset has no END, and may have been cut off",)


def test_a_first_line_that_can_only_be_a_statement_is_one_with_a_note():
    """Adams would leave it out; units that are lost without a word would make millimetres metres."""
    body = "\nPART/1, GROUND\nEND"
    for first in ("UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND", "units/\n, SYSTEM=CGS"):
        found = read_dataset(first + body)
        assert found.units.length in (1e-3, 1e-2) and "line 1, the title in Adams" in found.notes[0]
    for title in ("joint / 3 of them", "UNITS of all sorts", "! PART/2", "gear/box", "part/2b"):
        assert read_dataset(title + body).title == title and not read_dataset(title + body).notes


def test_a_marker_that_names_no_part_is_on_the_one_before_it():
    found = dataset(
        "MARKER/5\nPOINT_MASS/7, MASS=1, CM=8\nMARKER/8, QP=1,0,0\nPART/3\nMARKER/9\nMARKER/10, PART=1"
    ).markers
    assert [found[k].owner for k in (5, 8, 9, 10)] == [("PART", 2), ("POINT_MASS", 7), ("PART", 3), ("PART", 1)]
    with pytest.raises(InputError, match="line 2, MARKER/5: found neither PART nor POINT_MASS"):
        read_dataset("t\nMARKER/5\nPART/1, GROUND\nEND")
