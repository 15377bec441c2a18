"""What a solution offers besides its channels: the rules of mappings, tables, files, words, figures."""

import csv
from dataclasses import fields, replace

import numpy as np
import pandas
import pytest
import xarray
from matplotlib import pyplot

import stiffmbs
from stiffmbs import Body, InputError, Model, Solution
from stiffmbs.results.energy_balance import Balance

ENDINGS = (".csv", ".npz", ".nc")


@pytest.fixture(scope="module")
def solution(examples):
    return stiffmbs.verify(examples / "bar_pendulum.yaml", duration=0.2)


@pytest.fixture(scope="module")
def in_space(examples):
    text = (examples / "heavy_top.yaml").read_text()
    scene = stiffmbs.read_scene(f"{text}\nrequests: {{probe: {{x: fx(tip), y: top.x}}, top_x: 2*top.x}}\n")
    return stiffmbs.run(scene, duration=0.05)


def test_a_solution_keeps_the_rules_of_mappings(solution):
    assert solution.get("nothing") is None and solution.get("nothing", 3) == 3
    assert solution.get("bar.x") is solution["bar.x"]
    with pytest.raises(KeyError):
        solution["nothing"]
    with pytest.raises(InputError, match=r"^found no channel 'bar\.z', expected one such as bar\.x, "):
        solution["bar.z"]
    with pytest.raises(KeyError):
        solution[3]
    assert dict(solution).keys() == solution.channels.keys()


def test_success_is_that_the_whole_time_was_solved(solution):
    assert solution.success
    assert not replace(solution, outcome=type(solution.outcome).STOPPED).success


def test_channels_have_units(solution, in_space):
    units = solution.units
    assert units.keys() == solution.channels.keys()
    expected = {
        "bar.x": "m",
        "bar.omega": "rad/s",
        "hinge.torque": "N m",
        "energy.total": "J",
        "constraint.position": "",
    }
    assert {name: units[name] for name in expected} == expected
    assert in_space.units["top.q0"] == "" and in_space.units["tip.fx"] == "N"
    assert in_space.units["probe.x"] == "N", "a request has the unit of what it reads, whatever it is called"


def test_a_solution_becomes_a_table_of_pandas(solution):
    frame = solution.to_pandas()
    assert list(frame.columns) == list(solution) and frame.index.name == "time"
    np.testing.assert_array_equal(frame.index, solution.time)
    np.testing.assert_array_equal(frame["hinge.fy"], solution["hinge.fy"])
    assert frame.attrs["units"]["hinge.fy"] == "N"


@pytest.mark.parametrize("made", [pandas.DataFrame, np.asarray, np.mean])
def test_a_solution_is_not_taken_for_its_names(solution, made):
    with pytest.raises(InputError, match=r"found a solution .*to_pandas\(\)"):
        made(solution)


def test_a_solution_becomes_a_data_set_of_xarray(in_space):
    found = in_space.to_xarray()
    assert list(found.data_vars) == list(in_space)
    np.testing.assert_array_equal(found["tip.fx"], in_space["tip.fx"])
    assert found["tip.fx"].attrs == {"channel": "tip.fx", "unique": 1, "units": "N"}
    assert found["time"].attrs["units"] == "s"


def test_a_missing_package_is_told(solution, monkeypatch):
    monkeypatch.setattr("stiffmbs.errors.find_spec", lambda name: None)
    for use, package in ((solution.to_pandas, "pandas"), (solution.to_xarray, "xarray")):
        with pytest.raises(InputError, match=f"this needs {package}, which is not installed: pip install"):
            use()


def test_what_is_saved_is_loaded(solution, tmp_path):
    solution.save(tmp_path / "run.npz")
    found = Solution.load(str(tmp_path / "run.npz"))
    assert found.success and list(found) == list(solution)
    for name in solution:
        np.testing.assert_array_equal(found[name], solution[name])
    np.testing.assert_array_equal(found.time, solution.time)
    for part in fields(Solution):
        if part.name not in ("time", "channels", "history", "balance"):
            assert getattr(found, part.name) == getattr(solution, part.name), part.name
    for part in fields(Balance):
        np.testing.assert_array_equal(getattr(found.balance, part.name), getattr(solution.balance, part.name))
    np.testing.assert_array_equal(found.step_times, solution.step_times)
    assert found.errors and found.figure is not None
    assert found.summary() == solution.summary()


def test_the_file_of_the_command_is_loaded(solution, tmp_path, examples):
    from click.testing import CliRunner

    from stiffmbs.commands.main import main

    out = str(tmp_path / "out.npz")
    assert (
        CliRunner().invoke(main, ["run", str(examples / "bar_pendulum.yaml"), "--duration", "0.2", "-o", out]).exit_code
        == 0
    )
    found = Solution.load(out)
    np.testing.assert_array_equal(found["hinge.fy"], solution["hinge.fy"])
    assert found.errors.keys() <= found.keys()  # those of the estimate


def test_what_is_no_saved_run_is_refused(tmp_path):
    np.savez(tmp_path / "other.npz", time=np.zeros(3))
    (tmp_path / "text.npz").write_text("time")
    with pytest.raises(InputError, match=r"other\.npz: found no record of a run"):
        Solution.load(tmp_path / "other.npz")
    with pytest.raises(InputError, match=r"text\.npz: found no archive of arrays"):
        Solution.load(tmp_path / "text.npz")
    with pytest.raises(InputError, match=r"nothing\.npz: No such file"):
        Solution.load(tmp_path / "nothing.npz")
    with pytest.raises(InputError, match=r"found the ending '\.csv', expected \.npz"):
        Solution.load(tmp_path / "run.csv")


def test_files_that_cannot_be_written_are_refused(solution, tmp_path):
    with pytest.raises(
        InputError, match=r"^save .*out\.xls: found the ending '\.xls', expected one of \.csv, \.npz, \.nc"
    ):
        solution.save(tmp_path / "out.xls")
    with pytest.raises(InputError, match="found no folder"):
        solution.save(tmp_path / "nowhere" / "out.csv")


def test_tables_have_units_in_their_heads(solution, tmp_path):
    solution.save(tmp_path / "out.csv")
    with open(tmp_path / "out.csv") as file:
        head, first, *_ = csv.reader(file)
    assert head[:4] == ["time (s)", "bar.x (m)", "bar.y (m)", "bar.angle (rad)"]
    assert "constraint.position" in head
    assert float(first[head.index("hinge.fy (N)")]) == solution["hinge.fy"][0]


def test_netcdf_has_units_and_every_channel(in_space, tmp_path):
    in_space.save(tmp_path / "out.nc")
    with xarray.open_dataset(tmp_path / "out.nc") as found:
        assert found["top_x"].attrs["units"] == "m" and found["time"].attrs["units"] == "s"
        assert found["time"].dtype == float
        by_channel = {variable.attrs["channel"]: variable for variable in found.data_vars.values()}
        assert by_channel.keys() == in_space.channels.keys()
        np.testing.assert_array_equal(by_channel["top_x"], 2 * by_channel["top.x"])


def test_the_summary_is_that_of_the_command(solution):
    text = solution.summary()
    for part in (
        "Bar pendulum: 0 s to 0.2 s, completed",
        "hinge",
        "\nenergy       ",
        "\nsolver       bdf",
        "\nverified     ",
    ):
        assert part in text
    assert "\nresults" not in text


def test_axes_have_units(solution):
    one = solution.plot("bar.angle", title="angle").axes[0]
    assert (one.get_xlabel(), one.get_ylabel(), one.get_title()) == ("time (s)", "bar.angle (rad)", "angle")
    several = solution.plot("hinge.fy", "bar.x", x="bar.y")
    assert [axes.get_ylabel() for axes in several.axes] == ["hinge.fy (N)", "bar.x (m)"]
    assert several.axes[-1].get_xlabel() == "bar.y (m)"
    assert [text.get_text() for text in several.legends[0].get_texts()] == ["hinge.fy", "bar.x"]
    assert solution.plot().axes[0].get_title() == solution.figure.title
    assert replace(solution, figure=None).plot().axes[0].get_title() == "total energy"
    pyplot.close("all")
    with pytest.raises(InputError, match=r"found no channel 'bar\.z'"):
        solution.plot("bar.z")
    assert not pyplot.get_fignums()


def test_an_unknown_channel_is_answered_with_some_that_exist():
    model = Model()
    for name in "abc":
        model.add(name, Body(mass=1, inertia=1))
    found = stiffmbs.run(model, duration=0.1)
    with pytest.raises(InputError, match=r"found no channel 'd\.x'.*, expected one such as") as refused:
        found["d.x"]
    assert str(refused.value).count(", ") == 12  # one behind the name, eleven between twelve channels
    with pytest.raises(InputError, match=r"expected one such as b\.x, .*b\.") as refused:
        found["b.z"]
    assert "a.x" not in str(refused.value)
