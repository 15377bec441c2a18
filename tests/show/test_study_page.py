"""Page of a study: ranges with their places, a curve for each value of the other parameter, and cases that failed."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.show.page.study import MOST_CASES, write_study
from stiffmbs.studies.data_set import MESSAGE, STATUS

from ..conftest import EXAMPLES

xarray = pytest.importorskip("xarray")
pytest.importorskip("jinja2")


def page_of(tmp_path, shape, failed=False, sample=False, words=False):
    """The page of a study whose output is L + 10 k over a grid, or a sample, of L and k."""
    lengths, springs = np.linspace(1.0, 2.0, shape[0]), np.arange(float(shape[1]))
    values = lengths[:, None] + 10 * springs[None]
    status = np.full(shape, "done", dtype=object)
    message = np.full(shape, "", dtype=object)
    if failed:
        values[1, 1], status[1, 1], message[1, 1] = np.nan, "stopped", "the bar <broke>"
    names = np.array([f"way{k}" for k in range(shape[1])]) if words else springs
    coordinates = {"L": ("L", lengths), "k": ("k", names)}
    variables = {"peak": values, STATUS: status.astype(str), MESSAGE: message.astype(str)}
    if sample:
        coordinates = {
            "case": np.arange(values.size), "L": ("case", np.repeat(lengths, shape[1])), "k": ("case", np.tile(springs, shape[0])),
        }  # fmt: skip
        variables = {name: ("case", array.ravel()) for name, array in variables.items()}
    else:
        variables = {name: (("L", "k"), array) for name, array in variables.items()}
    write_study(tmp_path / "page.html", xarray.Dataset(variables, coords=coordinates, attrs={"title": "Bar"}), None)
    return (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_grid_has_a_curve_for_each_value_of_the_other_parameter(tmp_path):
    page = page_of(tmp_path, (5, 3))
    assert [page.count(f'class="curve c{k}" d="M44') for k in range(4)] == [1, 1, 1, 0]
    assert re.findall(r"</svg>(k \d)</span>", page) == ["k 0", "k 1", "k 2"]
    assert "<td>peak</td><td>1</td><td>L 1, k 0</td><td>22</td><td>L 2, k 2</td>" in page
    assert "All 15 cases were solved." in page and page.count("<td>done</td>") == 15


def test_many_values_and_samples_are_points_over_each_parameter(tmp_path):
    for page in (page_of(tmp_path, (5, 5)), page_of(tmp_path, (5, 5), sample=True)):
        assert page.count('class="mark"') == 2 * 25 and page.count("<figure>") == 2


def test_a_parameter_of_words_has_curves(tmp_path):
    page = page_of(tmp_path, (4, 2), words=True)
    assert re.findall(r"</svg>(k way\d)</span>", page) == ["k way0", "k way1"]


def test_a_case_that_failed_is_told_and_leaves_a_gap(tmp_path):
    page = page_of(tmp_path, (4, 2), failed=True)
    assert "1 of 8 cases were not solved." in page and "Case 3: the bar &lt;broke&gt;" in page
    assert re.search(r'class="curve c1" d="M[\d.,]+M[\d.,]+L', page)


def test_a_long_table_says_where_the_others_are(tmp_path):
    page = page_of(tmp_path, (MOST_CASES, 2))
    assert page.count("<td>done</td>") == MOST_CASES and f"The first {MOST_CASES} of {2 * MOST_CASES} cases" in page


def test_the_command_writes_a_page(tmp_path):
    given = [
        "study",
        str(EXAMPLES / "bar_pendulum.yaml"),
        "--vary",
        "L=0.5,0.7",
        "--of",
        "peak(hinge.fy)",
        "--duration",
        "0.2",
    ]
    result = CliRunner().invoke(main, [*given, "-o", str(tmp_path / "study.html")])
    assert result.exit_code == 0, result.output
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    assert "peak(hinge.fy)" in page and "L <b>0.5, 0.7</b>" in page and "stiffmbs study" in page
    assert not list(tmp_path.glob("*.study*"))
