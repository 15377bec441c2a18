"""Results beside listings of other programs."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.results.listings import read_columns

ADAMS = Path(__file__).parents[1] / "data" / "adams" / "Revolute_Case01"
T = np.linspace(0, 1, 11)
RESULTS = """<?xml version="1.0" encoding="UTF-8"?>
<Results xmlns="http://www.mscsoftware.com/:xrf10"><Bibliography/><Analysis name="a">
<StepMap name="map_001"><Entity name="time"><Component name="TIME" unitsValue="second" id="1"/></Entity>
<Entity name="ball" entity="PART_2"><Component name="X" unitsValue="mm" id="2"/><Component name="Y" unitsValue="mm" id="3"/></Entity></StepMap>
<Data name="dynamic" id="2"><Step type="initialConditions">0 9 9</Step>
{}</Data></Analysis></Results>"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.nc"
    solution = stiffmbs.run(ADAMS / "dataset.adm", rtol=1e-9)
    solution.save(path)
    solution.save(path.with_suffix(".tab"))
    solution.save(path.with_suffix(".res"))
    return path


def test_a_run_is_compared_with_adams_listing(results):
    pairs = ["--map", "REQUEST_1.x=2", "--map", "REQUEST_1.z=Z_Pos", "--map", "REQUEST_1.y=3"]
    told = CliRunner().invoke(main, ["diff", str(results), str(ADAMS / "Pos.txt"), *pairs, "--json"])
    assert told.exit_code == 0, told.output
    report = json.loads(told.output)
    assert report["within"] and all(one["relative"] < 2e-5 for one in report["differences"])
    off = CliRunner().invoke(main, ["diff", str(results), str(ADAMS / "Pos.txt"), "--map", "REQUEST_1.x=2*1.01"])
    assert off.exit_code == 1 and "relative 9.9" in off.output and "0 of 1 channels" in off.output


def test_a_run_is_what_its_own_table_says(results):
    told = CliRunner().invoke(main, ["diff", str(results), str(results.with_suffix(".tab")), "--tolerance", "1e-12"])
    assert told.exit_code == 0 and "PART_2.x - PART_2.x: 0 at" in told.output
    assert "constraint" not in told.output


def test_a_run_is_what_its_own_adams_results_say(results):
    ours, theirs = read_columns(results.with_suffix(".tab")), read_columns(results.with_suffix(".res"))
    assert {name for name in ours if not name.isdecimal()} <= set(theirs) and len(ours["time"]) > 10
    for name, values in theirs.items():
        np.testing.assert_array_equal(values, ours["time" if name == "time.TIME" else name])


def test_adams_xml_results_are_read(tmp_path):
    steps = "\n".join(f'<Step type="dynamic">{t} {1000 * np.sin(t)}\n{t**2}</Step>' for t in T)
    (tmp_path / "model.res").write_text(RESULTS.format(steps))
    found = read_columns(tmp_path / "model.res")
    assert list(found) == ["time.TIME", "ball.X", "ball.Y", "time"]
    fine = np.linspace(0, 2, 401)
    (one,) = stiffmbs.differences(
        {"time": fine, "b.x": np.sin(fine) + 0.01 * (fine > 0.45)}, tmp_path / "model.res", {"b.x": "ball.X*0.001"}
    )
    assert one.largest == pytest.approx(0.01, rel=1e-6) and one.t >= 0.5
    assert one.relative == pytest.approx(0.01 / np.sin(1), rel=1e-6)


def test_times_between_those_of_a_run_are_interpolated():
    (one,) = stiffmbs.differences(
        {"time": T, "x": np.sin(T)}, {"time": T[:-1] + 0.05, "y": np.sin(T[:-1] + 0.05)}, {"x": "y"}
    )
    assert 0 < one.largest < 1e-5


@pytest.mark.parametrize(
    "name, text, words",
    [
        ("a.tab", "time x\n", "found no table of numbers over time"),
        ("a.tab", "1 2\n0.5 3\n", "found no times that increase"),
        ("a.res", "<Results><a></Results>", "found no table of numbers over time"),
        ("a.tab", "5 1\n6 1\n", "found times from 5 to 6 s next to 0 to 1 s"),
        ("a.tab", "0 1\n1 1\n", "found no column '7', expected one of 1, 2"),
    ],
)
def test_what_is_no_listing_is_refused(tmp_path, name, text, words):
    (tmp_path / name).write_text(text)
    with pytest.raises(stiffmbs.InputError, match=words):
        stiffmbs.differences({"time": T, "x": T}, tmp_path / name, {"x": "7" if "no column" in words else "2"})


def test_what_is_asked_for_wrongly_is_refused(tmp_path):
    (tmp_path / "a.tab").write_text("0 1\n1 1\n")
    for pairs, words in (({"y": "2"}, "found no channel 'y'"), (None, "found no channel that is called like a column")):
        with pytest.raises(stiffmbs.InputError, match=words):
            stiffmbs.differences({"time": T, "x": T}, tmp_path / "a.tab", pairs)
    told = CliRunner().invoke(main, ["diff", "a.nc", "b.tab", "--map", "x"])
    assert told.exit_code == 2 and "--map x: found no such file" in told.output
