"""The command ``stiffmbs bench``: run time against error of the shipped examples."""

import json

import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.comparison import sweep
from stiffmbs.comparison.compare import compare
from stiffmbs.errors import SolverError

from ..conftest import EXAMPLES


def bench(*arguments):
    return CliRunner().invoke(main, ["bench", *arguments])


@pytest.mark.long
def test_rows_are_those_of_compare():
    result = bench("simple_pendulum", "--json")
    assert result.exit_code == 0
    found = json.loads(result.output)
    expected = compare(EXAMPLES / "simple_pendulum.yaml")
    assert found["problem"] == "simple_pendulum" and found["machine"]["cores"]
    for row, other in zip(found["rows"], expected.rows, strict=True):
        assert (row["solver"], row["setting"], row["steps"]) == (other.solver, other.setting, other.steps)
        assert row["error"] == pytest.approx(other.errors["positions"], rel=1e-6, abs=1e-12)
        assert row["seconds"] > 0


@pytest.mark.long
def test_the_table_names_the_machine_and_the_fastest():
    result = bench("simple_pendulum")
    machine, conclusion, *rows = result.output.splitlines()
    assert "cores" in machine and conclusion.startswith("simple_pendulum: at an error of")
    assert any("bdf" in row and row.endswith(" ms") for row in rows)


def test_an_unknown_example_is_refused():
    result = bench("cart_pendulums")
    assert result.exit_code == 2
    assert result.stderr.startswith(
        "stiffmbs: found no example 'cart_pendulums' (did you mean 'cart_pendulum'?), expected one of andrews"
    )


def test_an_example_that_cannot_be_measured_leaves_the_others(monkeypatch):
    def refused(path):
        if path.stem == "door":
            raise SolverError("there is no reference")
        return compare(path, solvers=("dop853",), tolerances=(1e-4, 1e-5))

    monkeypatch.setattr("stiffmbs.comparison.compare.compare", refused)
    result = bench("door", "simple_pendulum")
    assert result.exit_code == 1
    assert result.stderr == "stiffmbs: door: there is no reference\n"
    assert "dop853" in result.stdout


def test_what_the_first_solution_compiles_is_not_in_its_time(monkeypatch):
    """The first solution of a solver may compile code: 0.3 s of a solution of a millisecond on an empty cache."""
    compiling, known = [0.3], sweep.seconds_of

    def seconds_of(solve):
        seconds, found = known(solve)
        return (compiling.pop() if compiling else seconds), found

    monkeypatch.setattr(sweep, "seconds_of", seconds_of)
    found = compare(EXAMPLES / "simple_pendulum.yaml", solvers=("dop853",), tolerances=(1e-3, 1e-4))
    assert not compiling and found.rows[0].seconds < 0.2
