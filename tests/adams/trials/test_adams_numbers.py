"""Numbers of datasets are read as Adams reads them, or refused; refusals say how to go on."""

import pytest

import stiffmbs
from stiffmbs.adams.load import read_adams
from stiffmbs.errors import InputError

DATASET = """title
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
PART/2, MASS={mass}, CM=20, IP=1,1,1
MARKER/20, PART=2, REULER={angles}
MARKER/21, PART=2
{more}
END
"""


def _read(mass="1", angles="0,0,0", more=""):
    return read_adams(DATASET.format(mass=mass, angles=angles, more=more))


@pytest.mark.parametrize(
    ("text", "mass"), [("15", 15), (" 1.5E1 ", 15), ("+ 15", 15), ("1D2", 100), ("1.5D+1", 15), (".5", 0.5)]
)
def test_numbers_are_read(text, mass):
    assert _read(mass=text).bodies["PART_2"].mass == mass


@pytest.mark.parametrize("text", ["1 5", "1. 5", "1 .5", "1.5 E1", "1.5E 1", "1.5E+ 1", "0 1"])
def test_blanks_within_numbers_are_refused(text):
    """They were joined: 1 5 was 15 kg."""
    with pytest.raises(InputError, match=r"PART/2: found MASS = .*, expected 1 numbers without blanks"):
        _read(mass=text)


@pytest.mark.parametrize("text", ["1D", "1 D", "1.5E1D"])
def test_degrees_are_refused_where_no_angle_is(text):
    with pytest.raises(InputError, match=r"expected 1 numbers, no angles in degrees \(D\)"):
        _read(mass=text)


@pytest.mark.parametrize("text", ["90D, 0, 0", "90 D, 0, 0", "9E1D, 0D, 0D", "1.5707963267948966, 0, 0"])
def test_angles_are_in_degrees_with_a_d(text):
    assert _read(angles=text).bodies["PART_2"].orientation == pytest.approx((0.5**0.5, 0, 0, 0.5**0.5))


def test_matrices_of_view_are_read():
    """It writes ROWS and COLUMNS for M and N."""
    system = "ARRAY/1, X\nARRAY/2, U, VARIABLES=1\nVARIABLE/1, FUNCTION=TIME\nLSE/1, X=1, U=2, A=1, B=2\nMATRIX/2, FULL=RORDER, {}=1, {}=1, VALUES=3\n"
    for names in (("M", "N"), ("ROWS", "COLUMNS"), ("ROWS", "N")):
        more = (system + "MATRIX/1, FULL=RORDER, {}=1, {}=1, VALUES=-2").format(*names, *names)
        assert (
            _read(more=more).states["LSE_1"].a
            == _read(more=more.replace("ROWS", "M").replace("COLUMNS", "N")).states["LSE_1"].a
        )


CONTACT = """GRAPHICS/1, ELLIPSOID, CM=20, XSCALE=0.2, YSCALE=0.2, ZSCALE=0.2
GRAPHICS/2, PLANE, RM=1, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1
CONTACT/3, IGEOM=1, JGEOM=2, IMPACT, STIFFNESS=1e5, DAMPING=10, DMAX=0.001, EXPONENT=2.2, COULOMB_FRICTION=ON, MU_STATIC=0.3, MU_DYNAMIC=0.2
, STICTION_TRANSITION_VELOCITY=0.01, FRICTION_TRANSITION_VELOCITY=0.1, MAX_STICTION_DEFORMATION=0.01"""


@pytest.mark.parametrize(("word", "noted"), [(", STICTION=OFF", False), (", STICTION=ON", True), ("", True)])
def test_a_contact_without_stiction_is_read(word, noted):
    notes = " ".join(_read(more=CONTACT + word).notes)
    assert ("slides slowly" in notes) is noted and ("STICTION of" in notes) is ("=ON" in word)
    with pytest.raises(InputError, match="found STICTION = MAYBE, expected ON or OFF"):
        _read(more=f"{CONTACT}, STICTION=MAYBE")


@pytest.mark.parametrize(
    ("more", "command"),
    [
        (CONTACT.replace("IMPACT,", "POISSON, PENALTY=1e5,"), "DEACTIVATE/CONTACT, ID=3"),
        (
            CONTACT.replace("PLANE, RM=1, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1", "EXTERNAL, RM=1, FILE=a.shl"),
            "DEACTIVATE/CONTACT, ID=3",
        ),
        ("SFORCE/4, I=21, J=1, TRANSLATIONAL, FUNCTION=USER(1,2)", "DEACTIVATE/SFORCE, ID=4"),
        ("GSE/4, X=1\nARRAY/1, X\nVARIABLE/4, FUNCTION=ARYVAL(1,1)", "DEACTIVATE/GSE, ID=4"),
    ],
)
def test_a_refusal_says_how_to_run_without_the_statement(more, command, tmp_path):
    with pytest.raises(InputError, match=f"{command}"):
        _read(more=more)
    (tmp_path / "m.adm").write_text(DATASET.format(mass="1", angles="0,0,0", more=more.replace("ARYVAL(1,1)", "1")))
    (tmp_path / "m.acf").write_text(f"{command}\nSIMULATE/DYNAMIC, END=1, STEPS=2\n")
    assert stiffmbs.load_scene(tmp_path / "m.adm").run.duration == 1


def test_a_typing_error_is_no_reason_to_leave_a_statement_out():
    with pytest.raises(InputError, match=r"FOO.*expected a supported function$"):
        _read(more="SFORCE/4, I=21, J=1, TRANSLATIONAL, FUNCTION=FOO(1)")


@pytest.mark.parametrize(
    ("ending", "words"),
    [(".cmd", "File > Export > Adams/Solver dataset"), (".CMD", "Adams/Solver dataset"), (".osim", "OpenSim"), (".mbd", "MBDyn"), (".stp", "Simscape")],
)  # fmt: skip
def test_files_of_other_programs_are_recognised(ending, words, tmp_path):
    with pytest.raises(InputError, match=words):
        stiffmbs.load_scene(tmp_path / f"model{ending}")
