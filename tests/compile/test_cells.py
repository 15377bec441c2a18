"""Cells: numbers that Python and compiled code read and set under the same names."""

import numpy as np
import pytest

from stiffmbs.compile.machine.compiler import compiled_source
from stiffmbs.compile.machine.layout import FLOAT_CELL, FLOATS, INT, INT_CELL, Layout, fill, packed
from stiffmbs.compile.machine.translate.values import Untranslatable

LAYOUT = Layout({"n": INT, "t": FLOAT_CELL, "row": FLOATS, "steps": INT_CELL})
HEADER = f"""
from stiffmbs.compile.machine.native.access import address_of, floats, view_of

view = view_of("Table", {LAYOUT})
"""


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("STIFFMBS_CACHE", str(tmp_path))


def run(body, table):
    lines = "\n".join(f"    {line}" for line in ("x = view(table)", *body.splitlines()))
    compiled_source(f"{HEADER}def f(table):\n{lines}", "f", "void(int64*)").call(table.ctypes.data)


def test_both_sides_read_and_set_cells():
    row = np.array([3.0, 4.0])
    table = packed(LAYOUT, {"n": 2, "t": 0.5, "row": row})
    own = table.view(LAYOUT.cells)[0]
    run("for k in range(x.n):\n    x.t += x.row[k]\n    x.steps = x.steps + 1", table)
    assert (own["t"], own["steps"]) == (7.5, 2)
    own["t"] = -1.0
    run("x.t *= 2.0\nx.row[x.steps - 1] = x.t", table)
    assert row.tolist() == [3.0, -2.0]


def test_the_address_of_a_cell_points_to_it():
    table = packed(LAYOUT, {"n": 0, "t": 1.0, "row": np.zeros(1)})
    run("p = address_of(x.t)\np[0] = 4.0\ncount = address_of(x.steps)\ncount[0] = 9", table)
    assert table.view(LAYOUT.cells)[0].item() == (4.0, 9)


def test_a_table_filled_anew_keeps_cells_that_are_not_given():
    table = packed(LAYOUT, {"n": 1, "t": 1.0, "steps": 5, "row": np.zeros(1)})
    fill(table, {"n": 3, "t": 2.0, "row": np.zeros(1)})
    assert table[0] == 3 and table.view(LAYOUT.cells)[0].item() == (2.0, 5)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("x.n = 3", "'n' is no cell"),
        ("x.row += 1.0", "'row' is no cell"),
        ("x.tempo = 1.0", "no record with a field 'tempo'"),
        ("y = address_of(x.n)", "'n' is no cell"),
    ],
)
def test_what_is_no_cell_cannot_be_set(body, reason):
    with pytest.raises(Untranslatable, match=reason):
        run(body, packed(LAYOUT, {"n": 0, "row": np.zeros(1)}))


def test_python_is_told_of_an_unknown_cell():
    with pytest.raises(ValueError, match="tempo"):
        packed(LAYOUT, {"n": 0, "row": np.zeros(1)}).view(LAYOUT.cells)[0]["tempo"] = 1.0
