"""Datasets as they are written by many programs: lists, labels, routines, and several faults at once."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.load import read_adams
from stiffmbs.errors import InputError

HEAD = """t
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/10, PART=1
PART/2, MASS=2, CM=21, IP=0.1,0.1,0.1
MARKER/21, PART=2, QP=0.1,0,0
{}
END
"""


def solved(text, duration=1.0):
    return stiffmbs.run(read_adams(HEAD.format(text)), duration=duration, rtol=1e-9, output=0.1)


@pytest.mark.long
def test_lists_may_begin_on_the_continuation_line():
    stiffness = "\n".join(", " + ", ".join("8" if row == column else "0" for row in range(6)) for column in range(6))
    found = solved(f"FIELD/1, I=21, J=10\n, KMATRIX =\n{stiffness}\n, LENGTH =\n, 0, 0, 0, 0, 0, 0")
    np.testing.assert_allclose(found["PART_2.x"], 0.1 * np.cos(2 * found.time), atol=1e-7)


def test_requests_report_variables_and_take_labels_and_units():
    found = solved(
        "VARIABLE/4, FUNCTION=3*TIME\nREQUEST/1, VARIABLES=4, CNAMES=a, CUNITS=no_units, CLABELS=b\nREQUEST/2, VARIABLES=4"
    )
    np.testing.assert_allclose(found["REQUEST_1.a"], 3 * found.time)
    np.testing.assert_allclose(found["REQUEST_2.variable_4"], 3 * found.time)


def test_a_variable_by_a_subroutine_that_nothing_uses_is_left_out():
    variable = "VARIABLE/4\n, FUNCTION=USER(1, 2)\n, ROUTINE=lib::var"
    scene = read_adams(HEAD.format(variable))
    assert any("VARIABLE/4" in note and "left out" in note for note in scene.notes)
    force = "\nSFORCE/1, ROTATIONAL, I=21, J=10, FUNCTION=VARVAL(4)"
    with pytest.raises(InputError, match="VARIABLE/4: found the function USER"):
        read_adams(HEAD.format(variable + force))


@pytest.mark.parametrize(
    "text",
    [
        "SFORCE/1, ROTATIONAL, I=21, J=10\n, FUNCTION=USER(1)\\\n, ROUTINE=lib::sfo",
        "MOTION/1, I=21, J=10, X\n, FUNCTION=USER(1)\\\n, ROUTINE=lib::mot",
        "GFORCE/1, I=21, JFLOAT=11, RM=10\n, FUNCTION=USER(1)\\\n, ROUTINE=lib::gfo",
    ],
)
def test_forces_and_motions_by_a_routine_are_refused_as_such(text):
    with pytest.raises(InputError, match=r"found FUNCTION = USER\(1\).*a user subroutine"):
        read_adams(HEAD.format(text))


def test_all_faults_are_told_at_once():
    with pytest.raises(InputError) as told:
        read_adams(HEAD.format("MARKER/22, PART=x\nJOINT/1, I=1\nMOTION/3, JOINT=1, FUNCTION=1+"))
    text = str(told.value)
    for words in ("line 7, MARKER/22: found 'x' PART", "line 8, JOINT/1: found no kind", "line 9, MOTION/3: FUNCTION:"):
        assert words in text
    assert text.count("MARKER/22") == 1


def test_moments_that_no_body_has_are_taken_as_they_stand_with_a_warning():
    text = HEAD.format("").replace("IP=0.1,0.1,0.1", "IP=0.1,0.1,0.3, WX=0.2, WZ=2")
    scene = read_adams(text)
    assert any(note.startswith("warning: PART/2 has a principal moment") for note in scene.notes)
    found = stiffmbs.run(scene, duration=2, rtol=1e-9, output=0.1)
    # a symmetric top: Euler's equations turn the spin about its axis at (I3 - I1) / I1 of wz
    np.testing.assert_allclose(found["PART_2.wx"], 0.2 * np.cos(4 * found.time), atol=1e-6)
    np.testing.assert_allclose(found["PART_2.wz"], 2, atol=1e-6)


def test_moments_that_miss_the_inequality_by_arithmetic_are_not_told():
    scene = read_adams(HEAD.format("").replace("IP=0.1,0.1,0.1", "IP=0.1,0.1,0.200000000001"))
    assert not any("warning" in note for note in scene.notes)
