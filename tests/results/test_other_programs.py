"""Results in files of MATLAB, Excel and Parquet, as other readers see them."""

from __future__ import annotations

import json

import numpy as np
import openpyxl
import pytest
from pyarrow import parquet
from scipy.io import loadmat

import stiffmbs
from stiffmbs import InputError
from stiffmbs.results import other_programs
from stiffmbs.results.other_programs import variable_names

SCENE = """
name: Räder
dimensions: 3
bodies:
  Rad: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}
joints:
  first: {type: revolute, i: {body: Rad, point: [-1, 0, 0]}, j: {body: ground}}
  second: {type: revolute, i: {body: Rad, point: [-1, 0, 0]}, j: {body: ground}}
run: {duration: 0.1, points: 4}
"""


@pytest.fixture(scope="module")
def solution():
    found = stiffmbs.run(stiffmbs.read_scene(SCENE))
    assert found.not_unique
    return found


def test_matlab(solution, tmp_path):
    solution.save(tmp_path / "a.mat")
    found = loadmat(tmp_path / "a.mat", squeeze_me=True)
    listed = found["channels"]
    assert listed["channel"].tolist() == list(solution)
    for variable, channel, unit, unique in listed.tolist():
        np.testing.assert_array_equal(found[variable], solution[channel])
        assert (str(unit) if np.size(unit) else "") == (solution.unit(channel) or "")
        assert unique == (channel not in solution.not_unique)
    assert "Rad_x" in listed["variable"]
    assert found["time"].tolist() == solution.time.tolist()
    assert found["about"]["version"].item() == stiffmbs.__version__
    assert json.loads(found["about"]["scene"].item())["name"] == "Räder"
    assert found["about"]["outcome"].item() == "DONE"


def test_variables_of_matlab_are_valid_and_different():
    names = ["a.b", "a_b", "time", "1st.x", "_x", "ö.x", "oe.x", *(f"{'long' * 20}.{k}" for k in range(3))]
    found = variable_names(names)
    assert found[:5] == ["a_b", "a_b_2", "time_2", "x1st_x", "x_x"]
    assert len(set(found)) == len(names)
    assert all(name.isascii() and name.isidentifier() and name[0] != "_" and len(name) <= 63 for name in found)


def test_excel(solution, tmp_path):
    stiffmbs.run(stiffmbs.read_scene(SCENE)).save(tmp_path / "a.xlsx")
    book = openpyxl.load_workbook(tmp_path / "a.xlsx", read_only=True)
    names, units, *rows = book["results"].iter_rows(values_only=True)
    assert names == ("time", *solution)
    assert [unit or "" for unit in units[1:]] == [solution.unit(name) or "" for name in solution]
    np.testing.assert_array_equal(rows, np.column_stack([solution.time, *solution.channels.values()]))
    about = {name: "".join(filter(None, texts)) for name, *texts in book["about"].iter_rows(values_only=True)}
    assert about["version"] == stiffmbs.__version__ and about["title"] == "Räder"
    assert about["not unique"].splitlines() == list(solution.not_unique)


def test_numbers_that_are_not_finite_are_empty_cells_and_long_texts_take_several(solution, tmp_path):
    from dataclasses import replace

    channels = {"a": np.array([1.0, np.nan, np.inf, -np.inf])}
    replace(solution, channels=channels, message="x" * 70_000, not_unique=()).save(tmp_path / "a.xlsx")
    book = openpyxl.load_workbook(tmp_path / "a.xlsx", read_only=True)
    assert next(book["results"].iter_rows(min_row=3, values_only=True))[1] == 1.0
    assert all(row[1:2] in ((), (None,)) for row in book["results"].iter_rows(min_row=4, values_only=True))
    message = next(row for row in book["about"].iter_rows(values_only=True) if row[0] == "message")
    assert "".join(filter(None, message[1:])) == "x" * 70_000


def test_a_sheet_that_is_too_large_is_refused_and_nothing_is_written(solution, tmp_path, monkeypatch):
    monkeypatch.setattr(other_programs, "LIMITS", other_programs.Limits(rows=5))
    with pytest.raises(InputError, match=r"found 6 rows and \d+ columns, expected at most 5 and 16384; use .parquet"):
        solution.save(tmp_path / "a.xlsx")
    assert not list(tmp_path.iterdir())


def test_parquet(solution, tmp_path):
    solution.save(tmp_path / "a.parquet")
    table = parquet.read_table(tmp_path / "a.parquet")
    assert table.column_names == ["time", *solution]
    for name in solution:
        np.testing.assert_array_equal(table[name], solution[name])
        known = table.schema.field(name).metadata
        assert known[b"unit"].decode() == (solution.unit(name) or "")
        assert known[b"unique"].decode() == str(name not in solution.not_unique)
    assert table.schema.metadata[b"version"].decode() == stiffmbs.__version__
    assert table.schema.metadata[b"title"].decode() == "Räder"


@pytest.mark.parametrize("ending", ["mat", "xlsx", "parquet"])
def test_they_hold_their_origin_themselves(solution, tmp_path, ending):
    solution.save(tmp_path / f"a.{ending}")
    assert [path.name for path in tmp_path.iterdir()] == [f"a.{ending}"]
