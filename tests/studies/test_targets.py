"""Targets of metrics: ranges in any unit, misspelt names, values of both sides, and what a page and a command tell of them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.show.page.page_of_tests import Judgement
from stiffmbs.show.page.targets import target_lines, target_sections, targets_as_dict, with_targets
from stiffmbs.studies import targets
from stiffmbs.studies.targets import Metric, checked_targets, judged

METRICS = {
    "step_steer.yaw rate, overshoot": Metric({"": 6.8}, "%"),
    "step_steer.yaw rate, response time": Metric({"": 0.17}, "s"),
    "constant_speed.understeer gradient": Metric({"": 2.7}, "mrad/(m/s^2)"),
    "constant_speed.rollover threshold": Metric({"": np.nan}, "m/s^2"),
    "lane_change.passed (1 yes, 0 no)": Metric({"": 1.0}, ""),
    "toe": Metric({"left": 0.02, "right": 0.5}, "deg"),
    "bump.wheel_rate": Metric({"left": -0.1}, "N/mm/mm"),
}
DONE = Judgement("done", "x", "9 load cases.")


@pytest.mark.parametrize(
    ("name", "text", "met"),
    [
        ("step_steer.yaw_rate_overshoot", ":15", True),
        ("step_steer.yaw rate, overshoot", "7: %", False),
        ("step_steer.yaw_rate_response_time", "100:180 ms", True),
        ("step_steer.yaw_rate_response_time", "200 ms:0.3 ms", None),
        ("constant_speed.understeer_gradient", "0.1:0.2 deg/(m/s^2)", True),  # 1.7 to 3.5 mrad/(m/s^2)
        ("constant_speed.rollover_threshold", "8:", False),
        ("lane_change.passed", "yes", True),
        ("lane_change.passed", "no", False),
        ("toe", "-0.1:0.1", False),  # the right side
        ("toe", "0:10 mrad", True),  # 0.57 deg
        ("bump.wheel_rate", "-200:0 N/m/mm", True),
    ],
)
def test_a_target_is_met_if_all_values_lie_in_its_range(name, text, met):
    if met is None:
        with pytest.raises(InputError, match="lower bound first"):
            judged({name: text}, METRICS)
        return
    (found,) = judged({name: text}, METRICS)
    assert found.met is met


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("step_steer.yaw_rate_overshot", ":15", "did you mean 'step_steer.yaw_rate_overshoot'?"),
        ("toee", ":15", "did you mean 'toe'?"),
        ("toe", "15", "expected a range such as"),
        ("toe", ":", "expected a range such as"),
        ("toe", "wide", "expected a range such as"),
        ("toe", "0:1 mm", "found the unit 'mm', expected deg"),
        ("toe", "0:1 %", "found the unit '%', expected deg"),
        ("lane_change.passed", "0:1 deg", "expected no unit"),
        ("toe", "0 deg:1 rad", "expected one unit for both bounds"),
    ],
)
def test_a_target_that_cannot_be_judged_is_refused(name, text, message):
    with pytest.raises(InputError, match="target") as refused:
        judged({name: text}, METRICS)
    assert message in str(refused.value)


def test_targets_of_tests_that_do_not_run_are_refused_before_them():
    with pytest.raises(InputError, match=r"found the test .step_stear. .did you mean .step_steer"):
        checked_targets({"step_stear.yaw_rate_overshoot": ":15"}, ["step_steer", "ride"])


UNITS = {"deg": np.pi / 180, "mrad": 1e-3, "rad": 1.0, "rev": 2 * np.pi}


@given(
    value=st.floats(-10, 10), low=st.floats(-10, 10), width=st.floats(0, 10), own=st.sampled_from(list(UNITS)),
    other=st.sampled_from(list(UNITS)),
)  # fmt: skip
def test_the_unit_of_a_range_does_not_matter(value, low, width, own, other):
    bounds = [bound * UNITS[own] / UNITS[other] for bound in (low, low + width)]
    (found,) = judged({"x": f"{bounds[0]!r}:{bounds[1]!r} {other}"}, {"x": Metric({"": value}, own)})
    margin = 1e-9 * (1 + abs(low) + width)
    if min(abs(value - low), abs(value - low - width)) > margin:
        assert found.met is (low <= value <= low + width)


def test_pages_and_texts_name_the_targets_that_are_missed():
    given = judged({"toe": "-0.1:0.1", "step_steer.yaw_rate_overshoot": ":15"}, METRICS)
    (section,) = target_sections({"": given})
    assert section.tables[0].rows == (
        ("toe", "left 0.02, right 0.5 ✗", "−0.1 to 0.1", "deg"),
        ("step steer: yaw rate overshoot", "6.8 ✓", "≤ 15", "%"),
    )
    finding = with_targets(DONE, {"": given})
    assert (finding.status, finding.sentence, finding.further) == (
        "doubt",
        "1 of 2 targets is missed: toe.",
        ("9 load cases.",),
    )
    assert with_targets(DONE, {"": given[1:]}).further == ("The target is met.",)
    assert with_targets(DONE, {}) is DONE and not list(target_sections({}))
    lines = list(target_lines(given))
    assert lines[0] == "target toe -0.1 to 0.1 deg: missed, found left 0.02, right 0.5"
    assert targets_as_dict(given)["step_steer.yaw_rate_overshoot"]["low"] is None


def test_variants_have_their_own_values():
    base = judged({"toe": ":1"}, METRICS)
    other = (replace(base[0], metric=Metric({"left": 2.0, "right": 2.0}, "deg")),)
    (section,) = target_sections({"base": base, "stiff": other})
    assert section.tables[0].heads == ("metric", "base", "stiff", "range", "unit")
    assert section.tables[0].rows[0][2] == "2 ✗"
    assert with_targets(DONE, {"base": base, "stiff": other}).sentence == "1 of 2 targets is missed: toe (stiff)."


def test_kc_judges_measures_and_slopes(tmp_path):
    page = tmp_path / "kc.html"
    command = ["kc", "examples/car.yaml", "--points", "5", "-o", str(page), "--json"]
    cases = [word for case in ("roll", "steer", "lateral", "lateral_parallel", "brake", "traction", "aligning", "aligning_parallel") for word in ("--case", f"{case}=0")]  # fmt: skip
    wanted = ["--target", "camber=-1:0 deg", "--target", "bump.toe=-5:0 deg/m", "--target", "track=:1500 mm"]
    found = CliRunner().invoke(main, command + cases + wanted)
    assert found.exit_code == 1  # the track is 1520 mm
    result = json.loads(found.stdout)
    slope = result["cases"]["bump"]["slopes"]["left.toe"]
    assert result["targets"]["bump.toe"]["values"]["left"] == slope
    assert {name: each["met"] for name, each in result["targets"].items()} == {
        "camber": True,
        "bump.toe": True,
        "track": False,
    }
    content = page.read_text()
    assert "1 of 3 targets is missed: track." in content
    assert content.count('class="curve path"') == 2  # the slopes of the range of bump.toe
    wrong = CliRunner().invoke(main, [*command, *cases, "--target", "cambre=:1"])
    assert wrong.exit_code == 2 and "did you mean 'camber'" in wrong.stderr
    assert json.loads(wrong.stdout)["measures"], "results remain"


def test_names_of_metrics_in_words_are_targets():
    assert (
        targets.key_of("yaw rate, gain per steer angle of the wheels") == "yaw_rate_gain_per_steer_angle_of_the_wheels"
    )
    assert targets.key_of("passed (1 yes, 0 no)") == "passed"
