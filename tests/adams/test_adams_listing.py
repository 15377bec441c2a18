"""What `stiffmbs check` tells of each statement of a dataset, and what the reference page tells of them all."""

import json
from pathlib import Path

from click.testing import CliRunner

import stiffmbs
from stiffmbs.adams.functions.adams_functions import ADAMS_FUNCTIONS
from stiffmbs.adams.functions.translate import PLAIN
from stiffmbs.adams.statements.keywords import LEFT_OUT, LEFT_OUT_ARGUMENTS, READERS, REFUSED
from stiffmbs.commands.main import main

MODEL = """listing
PART/1, GROUND
MARKER/10, PART=1
FLEX_BODY/3
GRAPHICS/1, CYL
JOINT/9, HINGE
NONSENSE/4
END
"""
COMMANDS = "model\nSIM/DYN, END=1\nDEBUG/EPRINT\nPART/2, VX=1\nSIM/DYN, END=2\nSTOP\nSIM/STAT\n"


def test_every_statement_has_one_line(tmp_path):
    (tmp_path / "model.adm").write_text(MODEL)
    (tmp_path / "model.acf").write_text(COMMANDS)
    listed = stiffmbs.listed_statements(tmp_path / "model.adm")
    assert [one.line for one in listed] == [2, 3, 4, 5, 6, 7, 1, 2, 3, 4, 5, 6, 7]
    fates = [(one.statement, one.fate) for one in listed]
    assert fates[:6] == [
        ("PART/1", "read"), ("MARKER/10", "read"), ("FLEX_BODY/3", "refused"), ("GRAPHICS/1", "left out"),
        ("JOINT/9", "refused"), ("NONSENSE/4", "refused"),
    ]  # fmt: skip
    assert [fate for _, fate in fates[6:]] == ["left out", "read", "left out", "refused", "read", "read", "left out"]
    told = CliRunner().invoke(main, ["check", str(tmp_path / "model.adm")])
    assert told.exit_code == 2
    assert "line 4, FLEX_BODY/3: refused, flexible bodies" in told.output and "HINGE" in told.output


def test_a_sound_dataset_is_listed_in_json(tmp_path):
    (tmp_path / "model.adm").write_text(
        "ball\nPART/1, GROUND\nPART/2, MASS=1, CM=21, IP=1,1,1\nMARKER/21, PART=2\nEND\n"
    )
    told = CliRunner().invoke(main, ["check", str(tmp_path / "model.adm"), "--json"])
    statements = json.loads(told.output)["statements"]
    assert [(one["line"], one["statement"], one["fate"]) for one in statements] == [
        (2, "PART/1", "read"), (3, "PART/2", "read"), (4, "MARKER/21", "read"),
    ]  # fmt: skip


ARGUMENTS = """arguments
PART/1, GROUND
PART/2, MASS=1, CM=21, IP=1,1,1, MAT=steel
MARKER/10, PART=1
MARKER/21, PART=2
SFORCE/1, ROT, I=21, J=10
, FUNCTION=SIN(TIME) +
, MOD(3, 1)*NFORCE(1)
REQUEST/1, F2=SFORCE(1,0,1,0)\\, F3=MOD(TIME, 1)\\, COM='ab'
END
"""


def test_arguments_and_functions_have_lines_of_their_own(tmp_path):
    (tmp_path / "model.adm").write_text(ARGUMENTS)
    listed = stiffmbs.listed_statements(tmp_path / "model.adm")
    lines = [str(one).partition("model.adm, ")[2] for one in listed]
    assert lines == [
        "line 2, PART/1: read (GROUND)",
        "line 3, PART/2: read (MASS CM IP)",
        "line 3, PART/2, MATERIAL: left out, masses are given",
        "line 4, MARKER/10: read (PART)",
        "line 5, MARKER/21: read (PART)",
        "line 6, SFORCE/1: read (ROTATIONAL I J FUNCTION)",
        "line 7, SFORCE/1, MOD: refused, a function that FUNCTION of this statement cannot use",
        "line 7, SFORCE/1, NFORCE: refused, a function that FUNCTION of this statement cannot use",
        "line 9, REQUEST/1: read (F2 F3)",
        "line 9, REQUEST/1, COMMENT: left out, text",
    ]
    told = CliRunner().invoke(main, ["check", str(tmp_path / "model.adm")])
    assert "SFORCE/1: found the function" in told.output and told.exit_code == 2


def test_the_reference_page_tells_of_arguments_that_are_left_out():
    page = (Path(__file__).parents[2] / "docs" / "reference" / "adams_statements.md").read_text()
    rows = {line.split("|")[1].strip(): line.split("|")[3] for line in page.splitlines() if line.count("|") == 4}
    for name, arguments in LEFT_OUT_ARGUMENTS.items():
        assert set(arguments) <= set(rows[name].replace(",", " ").replace(";", " ").split()), name


def test_the_reference_page_has_all_statements_and_functions():
    page = (Path(__file__).parents[2] / "docs" / "reference" / "adams_statements.md").read_text()
    rows = {line.split("|")[1].strip(): line for line in page.splitlines() if line.startswith("| ")}
    assert {*READERS, *LEFT_OUT, *REFUSED} <= rows.keys()
    for name, reason in (LEFT_OUT | REFUSED).items():
        assert reason in rows[name]
    words = set(page.replace("`", " ").replace(",", " ").split())
    assert {name for name in (*ADAMS_FUNCTIONS, *PLAIN) if name.isupper() and name.isalnum()} <= words
