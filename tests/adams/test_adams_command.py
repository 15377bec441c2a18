"""Adams datasets at the command line: run, check, convert, and one sentence for every mistake."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

PENDULUM = """ADAMS/View model name: pendulum \u00e9
UNITS/FORCE = NEWTON, MASS = KILOGRAM, LENGTH = MILLIMETER, TIME = SECOND
!                            adams_view_name='ground'
PART/1
, GROUND
MARKER/10
, PART = 1
, REULER = 0, 90D, 0
!                            adams_view_name='crank'
PART/2
, MASS = 2
, CM = 21
, IP = 1E4, 2E4, 2E4
MARKER/21
, PART = 2
, QP = 300, 0, 0
MARKER/20
, PART = 2
, REULER = 0, 90D, 0
GRAPHICS/1
, CYLINDER
, CM = 20
, LENGTH = 600
, RADIUS = 10
JOINT/1
, REVOLUTE
, I = 20
, J = 10
ACCGRAV/
, KGRAV = -9806.65
REQUEST/1
, DISPLACEMENT
, I = 21
, J = 10
REQUEST/2
, F2 = DX(21,10)\\
, F3 = JOINT(1,0,4,0)\\
, F4 = KELVIN(3)
END
"""


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.adm").write_bytes(PENDULUM.encode("latin-1"))
    return tmp_path


def command(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_a_dataset_is_run(in_folder):
    result = command("run", "model.adm", "--json", "--rtol", "1e-8", "--duration", "1", "--set", "run.output=0.1")
    assert result.exit_code == 0, result.output
    report = json.loads(result.output)
    assert report["time"] == {"start": 0, "end": 1}
    channels = report["channels"]
    assert channels["PART_2.x"]["first"] == pytest.approx(0.3)
    # a pin at one end of a bar: the part of the weight that it carries at the start is I/(I + m a^2) of it
    share = 0.02 / (0.02 + 2 * 0.3**2)
    assert channels["JOINT_1.fz"]["first"] == pytest.approx(2 * 9.80665 * share, rel=1e-9)
    assert channels["REQUEST_1.x"]["first"] == pytest.approx(0.3)
    assert channels["REQUEST_2.f2"]["first"] == pytest.approx(300)
    assert channels["REQUEST_2.f3"]["first"] == pytest.approx(2 * 9.80665 * share, rel=1e-9)
    notes = " ".join(report["notes"])
    assert "GRAPHICS (line 20) is left out: graphics" in notes
    assert "REQUEST/2: found the function KELVIN" in notes and "REQUEST/2, F4 is left out" in notes


def test_the_summary_shows_joints_and_notes_but_no_requests_as_forces(in_folder):
    result = command("run", "model.adm", "--duration", "0.1")
    assert result.exit_code == 0
    assert "pendulum é" in result.output and "JOINT_1" in result.output and "GRAPHICS" in result.output
    assert "REQUEST_2 " not in result.output


def test_a_dataset_is_checked(in_folder):
    result = command("check", "model.adm", "--json")
    assert result.exit_code == 0
    report = json.loads(result.output)
    assert report["degrees_of_freedom"] == 1 and report["rank"] == 5
    assert any("GRAPHICS" in message for message in report["messages"])


def test_a_dataset_is_converted_to_the_scene_that_it_is_run_as(in_folder):
    assert command("convert", "model.adm", "-o", "scene.yaml").exit_code == 0
    converted, read = stiffmbs.load_scene("scene.yaml"), stiffmbs.load_scene("model.adm")
    for name in type(read).model_fields:
        assert getattr(converted, name) == getattr(read, name), name
    first, second = (stiffmbs.run(scene, duration=0.5) for scene in (converted, read))
    np.testing.assert_array_equal(first["REQUEST_2.f2"], second["REQUEST_2.f2"])
    assert "  PART_2:  # crank\n" in (in_folder / "scene.yaml").read_text()
    printed = command("convert", "model.adm")
    assert printed.output == (in_folder / "scene.yaml").read_text()


def test_a_scene_that_cannot_be_written_is_told(in_folder):
    result = command("convert", "model.adm", "-o", "nowhere/scene.yaml")
    assert result.exit_code == 1 and "not written: nowhere/scene.yaml" in result.output


@pytest.mark.parametrize(
    "change, words",
    [
        (("REVOLUTE", "HINGE"), "model.adm, line 26, JOINT/1: found 'HINGE', expected one of REVOLUTE"),
        (
            ("PART = 2\n, QP", "PART = 3\n, QP"),
            "model.adm, line 14, MARKER/21: found PART = 3, expected the number of a PART of the dataset",
        ),
        (("GRAPHICS/1", "FLEX_BODY/1"), "model.adm: found unsupported statements: FLEX_BODY/1 (line 20)"),
        (("IP = 1E4, 2E4, 2E4", "IP = 1E4, 2E4, -9E4"), "model.adm, line 10, PART/2: found principal moments"),
        (
            (", REULER = 0, 90D, 0\nGRAPHICS", ", REULER = 0, 0, 0\nGRAPHICS"),
            "model.adm, line 25, joints.JOINT_1: found the z axes of its markers drawn 90 degrees apart",
        ),
    ],
)
def test_mistakes_are_told_with_the_file_and_the_line(in_folder, change, words):
    text = PENDULUM.replace(*change)
    assert text != PENDULUM
    (in_folder / "model.adm").write_text(text)
    for name in ("run", "check", "convert"):
        result = command(name, "model.adm")
        assert result.exit_code == 2
        assert words in " ".join(result.output.split()), result.output


@pytest.mark.parametrize(
    "commands, settings, note",
    [
        ("model\nsimulate/dynamics, end=0.3, dtout=0.1\nstop\n", {"duration": 0.3, "output": 0.1}, None),
        ("spring\nbeam_results\nsimulate/dynamics, end=0.3, dtout=0.1\nstop\n", {"duration": 0.3, "output": 0.1}, None),
        ("model.adm\nmodel_res\nsimulate/dynamics, end=0.3, dtout=0.1\nstop\n", {"duration": 0.3, "output": 0.1}, None),
        ("file/model=model\nSIM/TRAN\n, DURATION=0.5\n, STEPS=10\n", {"duration": 0.5, "points": 11}, None),
        ("simulate/kinematics, end=1, steps=4", {"duration": 1, "points": 5, "solver": "kinematic"}, None),
        (
            "model\nsim/stat\nsim/dyn, end=1, steps=4 ! run\nINTEG/SI2\nsim/dyn, end=2, dtout=0.25\nstop\nsim/dyn, end=9",
            {"duration": 2, "points": 9, "start": "equilibrium"},
            "INTEGRATOR (line 4) except HMAX, and ERROR below 1e-06 of the command file: left out, analysis settings",
        ),
    ],
)
def test_a_command_file_beside_it_says_how_to_run(in_folder, commands, settings, note):
    (in_folder / "model.acf").write_text(commands)
    scene = stiffmbs.load_scene("model.adm")
    for name, value in settings.items():
        assert getattr(scene if name == "start" else scene.run, name) == pytest.approx(value)
    assert "duration and output are those of model.acf" in scene.notes
    assert note is None or note in scene.notes
    (in_folder / "model.acf").write_text("simulate/dynamics, finish=3")
    with pytest.raises(stiffmbs.InputError, match=r"model.acf, line 1, SIMULATE: found 'finish=3'"):
        stiffmbs.load_scene("model.adm")


def test_a_dataset_that_is_not_there(in_folder):
    result = command("run", "other.adm")
    assert result.exit_code == 2 and "other.adm: found no such file" in result.output


@pytest.mark.parametrize("name", ["", ".", "/"])
def test_a_folder_or_an_empty_name_is_no_dataset(in_folder, name):
    """The name of the command file was made from it first: a traceback."""
    result = command("convert", name)
    assert result.exit_code == 2
    assert result.output.startswith(f"stiffmbs: {name}: ") and result.output.count("\n") == 1
