"""Page of handling tests: axes in words with units, cones of lane changes, answers in words, variants with their changes."""

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("jinja2")

from stiffmbs.model.paths.lanes import STANDARDS
from stiffmbs.reading.units.display import SI_UNITS, DisplayUnits
from stiffmbs.show import handling_charts as handling_charts_module
from stiffmbs.show.curves import curve_chart
from stiffmbs.show.handling import _cell, _steered, write_handling
from stiffmbs.show.handling_charts import handling_charts
from stiffmbs.show.page.page_of_tests import change
from stiffmbs.studies.handling import study  # not its class Tested alone, which pytest would collect
from stiffmbs.studies.handling.known import SEEN
from stiffmbs.studies.handling.lane_changes import PART_1
from stiffmbs.studies.handling.standards import TESTS

CHANNELS = (
    "time",
    "vehicle.x",
    *(f"vehicle.{name}" for name in ("y", "ax", "ay", "az", "yaw_rate", "speed", "sideslip", "roll")),
    SEEN,
)
RUN = {name: np.linspace(0.0, 40.0, 401) for name in CHANNELS}
METRICS = {
    "passed (1 yes, 0 no)": (1.0, ""), "largest yaw rate": (0.5, "rad/s"), "speed": (np.nan, "m/s"), "gain": (2.0, "m/s^2/rad"),
    "gain, error bar": (0.01, "m/s^2/rad"),
}  # fmt: skip
DEGREES = DisplayUnits({"angle": "deg", "velocity": "km/h"})


def found(angular: bool = True, tests: Any = ("lane_change", "ride"), **metrics: tuple[float, str]) -> Any:
    car: Any = SimpleNamespace(
        wheelbase=2.5,
        track=1.5,
        steering="guide",
        angular=angular,
        point_given=False,
        measured=(0.0, 0.0, 0.5),
        behind=lambda place: 1.2,
    )
    parameters = {"first": 0.2, "last": 3.0}
    done = {name: study.Tested(METRICS | metrics, [RUN, RUN], parameters=parameters) for name in tests}
    return study.Handling("car", car, 0.1, done, 1.8, 4.3)


@pytest.mark.parametrize("test", TESTS)
def test_axes_have_words_and_units(test):
    charts = handling_charts({"": found(tests=(test,))}, test, DEGREES)
    assert charts
    for chart in charts:
        labels = re.findall(r'class="(?:strong|soft)" text-anchor="(?:start|end)">([^<]*[a-z][^<]*)<', chart)
        assert len(labels) == 2
        for label in labels:
            assert re.match(r"[a-z ]+, (s|m|km/h|m/s²|deg|deg/s|Hz|deg/s/deg|m/s²/deg)(;.*)?$", label), label


def test_steering_is_the_angle_of_the_wheels():
    (chart, *_) = handling_charts({"": found(tests=("step_steer",))}, "step_steer", SI_UNITS)
    assert "steer angle of the wheels, rad" in chart and ">4<" in chart and ">40<" in chart  # a tenth of the steering


def test_lane_changes_have_cones_and_the_path():
    chart = handling_charts({"": found()}, "lane_change", DEGREES)[0]
    assert chart.count('class="mark"') == 4 * len(STANDARDS[PART_1](1.8))
    assert chart.count('class="curve path"') == 1 and "triangles: cones" in chart


def test_the_path_is_that_of_a_vehicle_of_this_length(monkeypatch):
    """It was that of a vehicle of 4.3 m, up to 0.1 m away."""
    asked = []
    monkeypatch.setattr(handling_charts_module, "path_through", lambda *given: asked.append(given) or np.zeros((2, 2)))
    handling_charts({"": replace(found(), length=6.0)}, "lane_change", SI_UNITS)
    assert [each[-1] for each in asked] == [6.0]


def test_variants_have_colours_of_their_own():
    chart = handling_charts({"base": found(), "other": found()}, "ride", DEGREES)[0]
    assert [chart.count(f'class="curve c{k}"') for k in range(3)] == [2, 2, 0]


def test_a_mark_lies_within_the_axes():
    chart = curve_chart([], "y, m", "x, m", marks=np.array([[1.0, 5.0], [3.0, -5.0]]))
    heights = [float(value) for value in re.findall(r'class="mark" d="M[\d.-]+,([\d.]+)', chart)]
    assert len(heights) == 2 and all(34 <= value - 4 <= 212 for value in heights)


def test_the_page_answers_in_words(tmp_path):
    write_handling(tmp_path / "page.html", {"": found()}, {"": None}, {})
    page = (tmp_path / "page.html").read_text()
    assert "<td>passed</td><td>yes</td>" in page and "1 yes" not in page and "not reached" in page
    assert "28.65</td><td>deg/s" in page and 'name="viewport"' in page and "Completed" in page
    assert '0.03491 <span class="pm">± 0.00018</span></td><td>m/s²/deg' in page and "error bar" not in page


def test_an_answer_in_the_negative_is_first(tmp_path):
    given = found(**{"passed (1 yes, 0 no)": (0.0, "")})
    write_handling(tmp_path / "page.html", {"": given}, {"": None}, {})
    page = (tmp_path / "page.html").read_text()
    assert "! Not passed" in page and "Double lane change: not passed" in page


def test_a_test_that_failed_is_told_with_its_reason(tmp_path):
    given = found()
    given.tests["ride"] = study.Tested(message="no road")
    write_handling(tmp_path / "page.html", {"": given}, {"": None}, {})
    page = (tmp_path / "page.html").read_text()
    assert "1 of 2 tests could not be done." in page and "Not done: no road" in page


def test_variants_are_compared(tmp_path):
    other = found(**{"largest yaw rate": (0.4, "rad/s")})
    write_handling(tmp_path / "page.html", {"base": found(), "softer": other}, {"base": None, "softer": None}, {})
    page = (tmp_path / "page.html").read_text()
    assert "<th>base</th><th>softer</th><th>change</th>" in page
    assert "<td>28.65</td><td>22.92</td><td>−20.0\N{NO-BREAK SPACE}%</td>" in page


def test_a_scene_chooses_the_units_of_its_page(tmp_path):
    write_handling(tmp_path / "page.html", {"": found()}, {"": None}, {"angle": "rad"})
    assert "<td>0.5</td><td>rad/s</td>" in (tmp_path / "page.html").read_text()


def test_cells():
    assert _cell({}, "gain", 1.0) == "\N{EN DASH}"
    assert _cell({"a": (-0.25, "")}, "a", 2.0) == "−0.5"
    assert [list(change(pair)) for pair in ([1.0, 1.0001], [0.0, 1.0], [1.0], [-2.0, -3.0])] == [
        ["0\N{NO-BREAK SPACE}%"], ["+1"], [], ["−50.0\N{NO-BREAK SPACE}%"],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("angular", "words"),
    [
        (False, "the front wheels steer by 0.0573 deg for 10 mm of guide"),
        (True, "the front wheels steer by 1 deg for 10 deg of guide"),
    ],
)
def test_the_steer_angle_is_told_for_a_travel_or_a_turn(angular, words):
    assert _steered(replace(found(angular))) == words


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [(2.0, 2.5, "+25.0\N{NO-BREAK SPACE}%"), (-2.0, -1.0, "+50.0\N{NO-BREAK SPACE}%"), (1e-9, -0.25, "\N{MINUS SIGN}0.25"), (0.0, 3.0, "+3"),
     (0.0, 0.0, "0"), (2.0, 2.0, "0\N{NO-BREAK SPACE}%"), (np.nan, 1.0, "\N{EN DASH}")],
)  # fmt: skip
def test_changes_of_values_that_cross_zero_are_differences(before, after, words):
    assert list(change([before, after])) == [words]
