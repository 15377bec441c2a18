"""The command ``stiffmbs study``."""

import csv
import json

import pytest
import xarray
from click.testing import CliRunner

from stiffmbs.commands.main import main


def study(*arguments):
    return CliRunner().invoke(main, ["study", *map(str, arguments)])


def test_a_grid_is_written_and_its_rows_are_let_go_of(examples, tmp_path):
    path = tmp_path / "table.nc"
    given = ("--vary", "L=0.4 m:0.8 m:3", "--vary", "run.rtol=1e-5,1e-7", "--of", "peak(rail.fy)/9.81", "--of", "bar.x")
    result = study(examples / "cart_pendulum.yaml", *given, "--duration", "0.5", "-o", path)
    assert result.exit_code == 0, result.output
    assert "6 of 6 cases done" in result.output
    with xarray.open_dataset(path, engine="scipy") as found:
        assert found["peak(rail.fy)_per_9.81"].shape == (3, 2)
        assert found["L"].values.tolist() == pytest.approx([0.4, 0.6, 0.8])
        assert found["bar.x"].dims == ("L", "run.rtol", "time")
    assert [file.name for file in tmp_path.iterdir()] == ["table.nc"]


def test_a_sample_as_json_and_as_a_table_of_text(examples, tmp_path):
    given = ("--vary", "L=0.4:0.8", "--sample", "sobol:4", "--of", "final(cart.x)", "--duration", "0.2")
    found = json.loads(study(examples / "cart_pendulum.yaml", *given, "--json").output)
    assert found["status"] == "done" and len(found["cases"]) == 4
    assert set(found["cases"][0]) == {"case", "L", "final(cart.x)", "status", "message"}
    study(examples / "cart_pendulum.yaml", *given, "-o", tmp_path / "table.csv")
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["final(cart.x)"]) for row in rows] == [case["final(cart.x)"] for case in found["cases"]]


def test_a_case_that_fails_is_told_and_makes_the_exit_status_1(examples):
    result = study(examples / "cart_pendulum.yaml", "--vary", "bodies.bar.mass=1,-1", "--duration", "0.1")
    assert result.exit_code == 1
    assert "1 of 2 cases done" in result.output and "not solved: bodies.bar.mass = -1: " in result.output


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ((), "found nothing to vary"),
        (("--vary", "L"), "--vary L: found no values"),
        (("--vary", "L=1:2:x"), "found the count 'x'"),
        (("--vary", "L=1:1:3"), "found 1 to 1, expected two numbers"),
        (("--vary", "L=1 kg:2 kg:3"), "in kg^3, expected a moment of inertia"),
        (("--vary", "L=0:1:3:log"), "expected positive ends"),
        (("--vary", "L=1,2", "--vary", "L=3"), "found two variations"),
        (("--vary", "L=1", "-o", "table.txt"), "found the ending '.txt'"),
    ],
)
def test_wrong_input_is_told_in_one_sentence(examples, given, sentence):
    result = study(examples / "cart_pendulum.yaml", *given)
    assert result.exit_code == 2
    assert sentence in result.output and "Traceback" not in result.output
