"""Page of handling tests: axes in words with units, cones and path of lane changes, answers in words, phones."""

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

from stiffmbs.model.paths.lanes import STANDARDS
from stiffmbs.show.handling import _steered, write_handling
from stiffmbs.show.handling_figure import handling_figure
from stiffmbs.studies.handling import study  # not its class Tested alone, which pytest would collect
from stiffmbs.studies.handling.known import SEEN
from stiffmbs.studies.handling.lane_changes import BEFORE, PART_1
from stiffmbs.studies.handling.standards import TESTS

CHANNELS = ("time", "vehicle.x", "vehicle.y", "vehicle.ay", "vehicle.az", "vehicle.yaw_rate", "vehicle.speed", SEEN)
RUN = {name: np.linspace(0.0, 200.0, 5) for name in CHANNELS}
METRICS = {"passed (1 yes, 0 no)": (1.0, ""), "largest yaw rate": (0.5, "rad/s"), "speed": (np.nan, "m/s")}


def _found(angular: bool = True) -> Any:
    car: Any = SimpleNamespace(
        wheelbase=2.5,
        track=1.5,
        steering="guide",
        angular=angular,
        stated=False,
        measured=(0.0, 0.0, 0.5),
        behind=lambda place: 1.2,
    )
    return study.Handling("car", car, 0.1, {name: study.Tested(METRICS, [RUN]) for name in TESTS}, 1.8)


@pytest.mark.parametrize("test", TESTS)
def test_axes_have_words_and_units(test):
    (axes,) = handling_figure(_found(), test, study.Tested(METRICS, [RUN, RUN])).axes
    for label in (axes.get_xlabel(), axes.get_ylabel()):
        assert re.fullmatch(r"[a-z ]+ \((s|m|m/s|m/s²|rad|rad/s)\)", label), label
    assert len(axes.figure.legends) == 1


def test_steering_by_a_rack_is_in_metres():
    (axes,) = handling_figure(_found(angular=False), "constant_speed", study.Tested(METRICS, [RUN])).axes
    assert axes.get_ylabel() == "steering (m)" and not axes.figure.legends


def test_lane_changes_have_cones_and_the_path():
    (axes,) = handling_figure(_found(), "lane_change", study.Tested(METRICS, [RUN])).axes
    lines = {line.get_label(): line.get_xydata() for line in axes.lines}
    lanes = STANDARDS[PART_1](1.8)
    assert {tuple(cone) for cone in lines["cones"]} == {
        (x + BEFORE, y) for lane in lanes for x in (lane.start, lane.end) for y in (lane.left, lane.right)
    }
    for lane in lanes:
        inside = (lines["path"][:, 0] >= lane.start + BEFORE) & (lines["path"][:, 0] <= lane.end + BEFORE)
        assert inside.any() and np.all(
            np.abs(lines["path"][inside, 1] - lane.centre) <= (lane.left - lane.right - 1.8) / 2
        )


@pytest.mark.long
def test_the_page_answers_in_words_and_fits_a_phone(tmp_path):
    write_handling(tmp_path / "page.html", _found())
    page = (tmp_path / "page.html").read_text()
    assert "<td>passed</td><td>yes</td>" in page and "1 yes" not in page and "not reached" in page
    assert 'name="viewport"' in page and "max-width: 100%" in page


@pytest.mark.parametrize(
    ("angular", "words"),
    [
        (False, "the front wheels steer by 0.0573 deg for 10 mm of guide"),
        (True, "the front wheels steer by 1 deg for 10 deg of guide"),
    ],
)
def test_the_steer_angle_is_told_for_a_travel_or_a_turn(angular, words):
    assert _steered(_found(angular)) == words
