"""Units chosen by a scene: in tables, plots and pages; channels, files and JSON stay in SI units."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.reading.formula.text import FormulaError
from stiffmbs.reading.units.display import DisplayUnits, checked_units
from stiffmbs.results.displayed import displayed
from stiffmbs.results.error_bars import ErrorBar
from stiffmbs.results.solution import Solution
from stiffmbs.show.loads import Column
from stiffmbs.show.sections import differences_section

from ..conftest import EXAMPLES

CHOSEN = {"angle": "deg", "length": "mm", "force": "kN", "angular velocity": "rpm"}


@pytest.fixture(scope="module")
def solution():
    changes = [("run.points", "21"), *((f"units.{name.replace(' ', '_')}", unit) for name, unit in CHOSEN.items())]
    return stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml", changes))


@pytest.mark.parametrize(
    ("unit", "shown", "factor"),
    [
        ("rad", "deg", 180 / np.pi), ("rad/s", "rpm", 30 / np.pi), ("rad/s^2", "deg/s^2", 180 / np.pi), ("m/s^2", "mm/s^2", 1e3),
        ("N", "kN", 1e-3), ("N m", "kN mm", 1.0), ("N/m", "kN/mm", 1e-6), ("N m/rad", "kN mm/deg", np.pi / 180), ("J", "J", 1.0),
        ("kg m^2", "kg mm^2", 1e6), ("", "", 1.0), ("s", "s", 1.0),
    ],
)  # fmt: skip
def test_units_of_products_follow(unit, shown, factor):
    assert DisplayUnits(CHOSEN).of(unit) == (shown, pytest.approx(factor))


def test_a_composite_unit_is_not_put_into_another_one():
    assert DisplayUnits({"velocity": "km/h"}).of("m/s") == ("km/h", pytest.approx(3.6))
    assert DisplayUnits({"torque": "kN m", "force": "N"}).of("N m") == ("kN m", pytest.approx(1e-3))


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ({"forse": "kN"}, "did you mean 'force'"), ({"force": "mm"}, "expected a force in N"), ({"angle": "2*deg"}, "expected a unit"),
        ({"angular velocity": "Hz"}, "expected rad/s, rpm"), ({"energy": "kN"}, "expected a unit of energy"), ({"force": "xx"}, "unknown name 'xx'"),
    ],
)  # fmt: skip
def test_other_units_are_refused(units, message):
    with pytest.raises(FormulaError, match=message):
        checked_units(units)


def test_channels_stay_in_si_units_and_are_shown_in_others(solution):
    shown = displayed(solution)
    assert solution.unit("bar.angle") == "rad" and shown.unit("bar.angle") == "deg"
    assert shown["bar.angle"] == pytest.approx(np.degrees(solution["bar.angle"]))
    assert shown["hinge.fy"] == pytest.approx(1e-3 * solution["hinge.fy"]) and shown.unit("hinge.fy") == "kN"
    assert shown.unit("energy.total") == "J" and shown["energy.total"] is solution["energy.total"]
    assert displayed(shown) is shown


def test_error_bars_are_shown_in_the_same_units(solution):
    bar = ErrorBar(1.0, 2.0, 3.0, 0.5, 0.25)
    shown = displayed(replace(solution, errors={"hinge.fy": bar}))
    assert shown.errors["hinge.fy"] == ErrorBar(1e-3, 2e-3, 3e-3, 0.5e-3, 0.25e-3)


def test_a_file_of_results_keeps_them(solution, tmp_path):
    solution.save(tmp_path / "run.npz")
    loaded = Solution.load(tmp_path / "run.npz")
    assert loaded.display == solution.display and np.array_equal(loaded["hinge.fy"], solution["hinge.fy"])


def test_summary_and_json():
    arguments = ["run", str(EXAMPLES / "bar_pendulum.yaml"), "--set", "units.force=kN", "--duration", "0.1"]
    text, found = (CliRunner().invoke(main, [*arguments, *more]).output for more in ([], ["--json"]))
    assert "(kN, kN m)" in text
    assert json.loads(found.splitlines()[-1])["channels"]["hinge.fy"]["max"] > 1


def test_a_plot_names_them(solution):
    pytest.importorskip("matplotlib")
    from stiffmbs.model.scene import Figure
    from stiffmbs.show.figure import drawn

    (axes,) = drawn(solution, Figure(x="bar.angle", y=("hinge.fy",))).axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("bar.angle (deg)", "hinge.fy (kN)")
    assert axes.lines[0].get_ydata() == pytest.approx(1e-3 * solution["hinge.fy"])


def test_a_chosen_unit_replaces_the_prefix_that_fits():
    assert Column.of("N", 5e6, DisplayUnits()).unit == "MN"
    column = Column.of("N", 5e6, DisplayUnits({"force": "kN"}))
    assert column.unit == "kN" and column.words(5e6, 10.0) == "5000.00 ± 0.05"


def test_differences_are_in_the_units_of_the_run(solution):
    other = replace(
        solution,
        channels={**solution.channels, "bar.angle": solution["bar.angle"] + np.radians(2)},
        display=DisplayUnits(),
    )
    (table,) = (one for one in differences_section(solution, "other", other).tables if one.heads[0] == "channel")
    ((_, largest, _, unit, *_),) = table.rows
    assert (float(largest), unit) == (pytest.approx(2, rel=1e-3), "deg")
