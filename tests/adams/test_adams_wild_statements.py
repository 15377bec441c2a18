"""Statements and commands of datasets in use: read, or left out with a note, or refused with one sentence."""

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import InputError, load_scene
from stiffmbs.adams.commands.commands import read_commands
from stiffmbs.adams.load import read_adams
from stiffmbs.commands.main import main

from .test_adams_command import PENDULUM

BODY = PENDULUM.replace("END\n", "").replace(", F4 = KELVIN(3)\n", "").replace("(1,0,4,0)\\", "(1,0,4,0)")


def notes(text):
    return "; ".join(read_adams(f"{BODY}{text}\nEND\n").notes)


def written(tmp_path, commands, text=""):
    (tmp_path / "model.adm").write_bytes(f"{BODY}{text}\nEND\n".encode("latin-1"))
    (tmp_path / "model.acf").write_text(commands)
    return tmp_path / "model.adm"


@pytest.mark.parametrize(
    ("statement", "said"),
    [
        ("JOINT/2, SPHERICAL, I=20, J=10, PITCH=3, PD=4", "JOINT PITCH of JOINT/2, JOINT PD of JOINT/2"),
        ("JOINT/2, FIXED, I=20, J=10, FRICTION=OFF, HEIGHT=3", ""),
        ("PART/3, MASS=1, CM=31, IP=1,1,1, MATERIAL=STEEL\nMARKER/31, PART=3", "(masses are given): PART MATERIAL of PART/3"),
        ("JPRIM/1, INLINE, I=20, J=10", ""),
        ("JOINT/2, TRANSLATIONAL, I=20, J=10, PITCH=3", "JOINT PITCH of JOINT/2"),
        ("JOINT/2, CYLINDRICAL, I=20, J=10, PD=3", "JOINT PD of JOINT/2"),
        ("JOINT/2, CYLINDRICAL, I=20, J=10, DELTA_V=3, MU_DYN_ROT=0", ""),
        ("FRICTION/1, JOINT=1, MU_STATIC=0.2, MU_DYNAMIC=0.1, MAX_STICTION_DEFORMATION=0.3", "FRICTION MAX_STICTION_DEFORMATION"),
        ("FRICTION/1, JOINT=1, MU_STATIC=0.2, MU_DYNAMIC=0.1, INACTIVE_DURING=STATIC", ""),
        ("FRICTION/1, JOINT=1, MU_STATIC=0.2, MU_DYNAMIC=0.1, INACTIVE=STATIC", ""),
        ("REQUEST/3, DISPLACEMENT, I=21, J=10, COMMENT=a crank", ""),
        ("ARRAY/1, IC, SIZE=2, NUMBERS=1,2\nARRAY/2, X, SIZE=2\nARRAY/3, U, SIZE=1, VARIABLES=4\nVARIABLE/4, FUNCTION=0", ""),
        ("SENSOR/1, FUNCTION=DX(21,10)\\, VALUE=9E9, EQ, ERROR=1, HALT", ""),
    ],
)  # fmt: skip
def test_arguments_that_nothing_requests_are_noted(statement, said):
    found = notes(statement)
    assert (said in found and "not used" in found) if said else "not used" not in found


def test_an_array_of_another_size_is_refused():
    with pytest.raises(InputError, match="ARRAY/1: found SIZE = 3 and 2 entries"):
        read_adams(f"{BODY}ARRAY/1, IC, SIZE=3, NUMBERS=1,2\nEND\n")


def test_friction_that_rests_in_motion_is_refused():
    with pytest.raises(InputError, match=r"FRICTION/1: found INACTIVE_DURING = DYNAMICS, expected STATICS"):
        notes("FRICTION/1, JOINT=1, MU_STATIC=0.2, MU_DYNAMIC=0.1, INACTIVE_DURING=DYNAMICS")


@pytest.mark.parametrize(
    "statement", ["STRING/7, STRING=a\0b", "STRING/7\n, STRING = \0\0", "GRAPHICS/9, CIRCLE, CM=\0", "! \0"]
)
def test_zero_bytes_count_only_where_something_is_read(tmp_path, statement):
    assert read_adams(f"{BODY}{statement}\nEND\n").bodies
    path = written(tmp_path, "SIMULATE/DYNAMICS, END=0.1, STEPS=2", statement)
    assert stiffmbs.run(load_scene(path)).time[-1] == pytest.approx(0.1)


@pytest.mark.parametrize(
    "statement", ["SFORCE/1, TRANSLATION, I=21, J=10, FUNCTION=3\0", "PART/3, MASS=1\0", "JOINT/9, \0FIXED, I=20, J=10"]
)
def test_zero_bytes_of_statements_that_count_are_refused(statement):
    with pytest.raises(InputError, match=r"line \d+, (SFORCE|PART|JOINT)/\d: found a zero byte, expected text"):
        notes(statement)


GSE = "ARRAY/1, X, SIZE=2\nARRAY/2, Y, SIZE=1\nARRAY/3, U, SIZE=1, VARIABLES=5\nVARIABLE/5, FUNCTION=TIME\nGSE/4, NS=2, NO=1, X=1, Y=2, U=3, FUNCTION=USER(1)\\"
READS = (
    "SFORCE/1, TRANSLATION, I=21, J=10, FUNCTION=ARYVAL(2,1)",
    "VARIABLE/6, FUNCTION=3*ARYVAL( 1 , 2)",
    "REQUEST/3, F2=ARYVAL(2,1)",
)


def test_general_state_equations_that_nothing_reads_are_left_out():
    assert "GSE (line" in notes(GSE.replace(", FUNCTION=USER(1)\\", ""))


@pytest.mark.parametrize("reads", READS)
def test_general_state_equations_that_are_read_are_refused(reads):
    with pytest.raises(InputError, match=r"found unsupported statements: GSE/4"):
        notes(f"{GSE}\n{reads}".replace(", FUNCTION=USER(1)\\", ""))


SOLIDS = """PART/3, MASS=1, CM=31, IP=1E3,1E3,1E3, QG=0,0,995
MARKER/31, PART=3
MARKER/32, PART=3, QP=700,0,0
MARKER/11, PART=1
GRAPHICS/11, PLANE, RM=11, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1
GRAPHICS/31, ELLIPSOID, CM=31, XSCALE=2000, YSCALE=2000, ZSCALE=2000
GRAPHICS/32, ELLIPSOID, CM=32, XSCALE=2000, YSCALE=2000, ZSCALE=2000
"""
LAW = "STIFFNESS=1E3, DAMPING=0, EXPONENT=1, DMAX=0.1"


@pytest.mark.parametrize("kind", ["", "TYPE=SOLID_TO_SOLID, ", "TYPE=SOLID, "])
@pytest.mark.parametrize("sides", ["IGEOM=31, 32, JGEOM=11", "IGEOM=11, JGEOM=31, 32"])
def test_a_contact_of_several_geometries_is_one_of_each_pair(kind, sides):
    """Two spheres 5 mm within a plane: 5 kN each at 1 kN/mm."""
    listed = read_adams(f"{BODY}{SOLIDS}CONTACT/1, {kind}{sides}, {LAW}\nEND\n")
    run = stiffmbs.run(listed, duration=1e-6, output=1e-6)
    assert {name for name in listed.forces if name.startswith("CONTACT")} == {"CONTACT_1", "CONTACT_1_2"}
    assert run["PART_3.az"][0] == pytest.approx(1e4 - 9.80665, rel=1e-6)
    apart = stiffmbs.run(
        read_adams(f"{BODY}{SOLIDS}CONTACT/1, IGEOM=31, JGEOM=11, {LAW}\nCONTACT/2, IGEOM=32, JGEOM=11, {LAW}\nEND\n"),
        duration=1e-6, output=1e-6,
    )  # fmt: skip
    np.testing.assert_allclose(run["PART_3.wdy"], apart["PART_3.wdy"], rtol=1e-9)


def test_other_types_of_contact_are_refused():
    with pytest.raises(InputError, match=r"CONTACT/1: found TYPE = CURVE_TO_CURVE, expected SOLID_TO_SOLID"):
        notes(f"{SOLIDS}CONTACT/1, TYPE=CURVE_TO_CURVE, IGEOM=31, JGEOM=11, {LAW}")


JOINTS = "".join(f"SFORCE/{k}, TRANSLATION, I=21, J=10, FUNCTION={k}\n" for k in (3, 5, 8, 12))


@pytest.mark.parametrize(
    ("given", "off"),
    [
        ("RANGE=3,8", {3, 5, 8}), ("RANGE=4, 9", {5, 8}), ("RANGE=12", {12}), ("RANGE=1,99", {3, 5, 8, 12}),
        ("ID=3, RANGE=8,12", {3, 8, 12}), ("ID=5", {5}),
    ],
)  # fmt: skip
def test_a_range_of_statements_is_deactivated(tmp_path, given, off):
    path = written(tmp_path, f"DEACTIVATE/SFORCE, {given}\nSIMULATE/DYNAMICS, END=0.01, STEPS=1\n", JOINTS)
    forces = load_scene(path).forces
    assert {k for k in (3, 5, 8, 12) if f"SFORCE_{k}" not in forces} == off


def test_a_range_is_made_active_again(tmp_path):
    commands = "DEA/SFORCE, RANGE=3,12\nACT/SFORCE, RANGE=5,8\nSIM/DYN, END=0.01, STEPS=1\n"
    assert {"SFORCE_5", "SFORCE_8"} == {
        x for x in load_scene(written(tmp_path, commands, JOINTS)).forces if "SFORCE" in x
    }


@pytest.mark.parametrize("given", ["RANGE=20,30", "RANGE=9,3"])
def test_a_range_of_nothing_is_refused(tmp_path, given):
    with pytest.raises(InputError, match=r"line 1, DEACTIVATE/SFORCE: found no SFORCE from"):
        load_scene(written(tmp_path, f"DEACTIVATE/SFORCE, {given}\n", JOINTS))


@pytest.mark.parametrize(
    ("commands", "said"),
    [
        ("LINEAR/EIGENSOL", "LINEAR/EIGENSOL (line 1 of the command file) is left out: 'stiffmbs modes'"),
        ("LIN/EIG, NODAMPIN, COORDS=1,3", "'stiffmbs modes'"),
        ("LINEAR/STATEMAT, FILE=abc, PINPUT=1, POUTPUT=2", "'stiffmbs response'"),
        ("SIM/STAT\nLINEAR/EIGENSOL", "(with --from, of the state in which a run ends)"),
        ("ENVIRONMENT/NAME=A, VALUE=B", "ENVIRONMENT (line 1)"),
        ("FILE/MODEL=abc, OUTPUT_PREFIX=x", ""),
    ],
)
def test_commands_without_an_effect_on_the_motion_are_noted(commands, said):
    assert said in "; ".join(read_commands(commands).notes)


@pytest.mark.parametrize("command", ["run", "check", "convert"])
def test_a_command_file_is_no_scene(command, tmp_path):
    (tmp_path / "rig.acf").write_text("SIMULATE/STATICS\n")
    result = CliRunner().invoke(main, [command, str(tmp_path / "rig.acf")])
    assert result.exit_code == 2
    assert "found a command file, expected its dataset rig.adm, which is run with" in result.output


FALL = "SIMULATE/DYNAMICS, END=1, STEPS=10\n"


@pytest.mark.parametrize(
    "command",
    ["FILE/COMMAND=other.acf", "FILE/MODEL=a, COMMAND=other.acf", "FIL/COM=other", "file/command = other.acf"],
)
def test_commands_of_another_file_are_executed(tmp_path, command):
    """Those of a file within a file too; STOP there ends all."""
    (tmp_path / "other.acf").write_text("INTEGRATOR/HMAX=0.125\nFILE/COMMAND=third.acf\n")
    (tmp_path / "third.acf").write_text(f"{FALL}STOP\n")
    scene = load_scene(written(tmp_path, f"{command}\nSIMULATE/DYNAMICS, END=3, STEPS=10\n"))
    assert (scene.run.duration, scene.run.points, scene.run.max_step) == (1.0, 11, 0.125)


def test_commands_after_those_of_another_file_are_followed(tmp_path):
    (tmp_path / "other.acf").write_text(FALL)
    scene = load_scene(written(tmp_path, "FILE/COMMAND=other.acf\nSIMULATE/DYNAMICS, END=3, STEPS=20\n"))
    assert scene.run.duration == 3.0


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (None, r"model.acf, line 2, FILE/COMMAND: .*other.acf: found no such file"),
        (
            "model\nFILE/COMMAND=other.acf\n",
            r"line 2, FILE/COMMAND: other.acf, line 2, .* expected no file that executes itself",
        ),
        ("BOX/1\n", r"model.acf, line 2, BOX/1: found an unsupported command"),
        ("SIMULATE/DYNAMICS, END=x\n", r"model.acf, line 2, SIMULATE: found END = x"),
    ],
)
def test_what_another_file_has_wrong_is_named(tmp_path, other, said):
    if other is not None:
        (tmp_path / "other.acf").write_text(other)
    with pytest.raises(InputError, match=said):
        load_scene(written(tmp_path, f"OUTPUT/NOSEPARATOR\nFILE/COMMAND=other.acf\n{FALL}"))


def test_commands_without_files_are_those_of_the_text():
    with pytest.raises(InputError, match=r"line 1, FILE/COMMAND: found COMMAND = other.acf"):
        read_commands("FILE/COMMAND=other.acf\n")


@pytest.mark.parametrize("other", ["F2=TIME", "VARIABLES=1", "FUNCTION=USER(1)"])
def test_a_request_of_markers_and_of_functions_is_refused(other):
    """The functions were left out without a note."""
    with pytest.raises(InputError, match=f"REQUEST/3: found FORCE and {other.split('=')[0]}, expected one of them"):
        read_adams(f"{BODY}VARIABLE/1, FUNCTION=TIME\nREQUEST/3, FORCE, I=20, J=10, {other}\nEND\n")


@pytest.mark.parametrize("function", ["POLY(TIME,0)", "CHEBY(TIME,0)", "FORSIN(TIME,0,1)", "FORCOS(TIME,0,1)"])
def test_a_series_without_a_coefficient_is_refused(function):
    """The error was one of Python, IndexError."""
    name = function.partition("(")[0]
    with pytest.raises(InputError, match=f"SFORCE/1: found \\d arguments of {name} in .* expected another number"):
        read_adams(f"{BODY}SFORCE/1, TRANSLATION, I=21, J=10, FUNCTION={function}\nEND\n")
