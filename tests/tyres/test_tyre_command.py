"""``stiffmbs tyre``: curves, single states, and property files that are written."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs import InputError
from stiffmbs.commands.main import main
from stiffmbs.tyres import TyreProperties

from .test_magic_formula import PLAIN
from .test_magic_formula_6 import NUMBERS, TURNING

LATER = TyreProperties(
    coefficients={**NUMBERS, **TURNING, "FZMAX": 9e3, "INFLPRES": 2.6e5, "Q_CAM1": 70.0, "Q_CAM2": 230.0, "Q_FYS1": -1.7e4},
    version="6.2", use_mode=15, side="right", ranges={"load": (50.0, 9e3), "slip_angle": (-1.5, 1.5), "pressure": (1e5, 5e5)},
    bottoming={"radius": 0.22, "load": {"table": [[0, 0], [0.1, 2e5]]}},
)  # fmt: skip
EARLIER = TyreProperties(
    coefficients={**PLAIN, "PTX1": 1.0, "PTY1": 1.0, "FZMAX": 9e3}, use_mode=-14, side="left", is_pac2002=True, belt=0.9,
    deflection_load={"table": [[0, 0], [0.01, 1900], [0.03, 6500]]}, ranges={"camber": (-0.2, 0.2)},
    bottoming={"radius": 0.2, "width": 0.19, "load": {"table": [[0, 0], [0.01, 5e3]]}},
)  # fmt: skip
ENGINEERS = {"LENGTH": "mm", "FORCE": "kN", "ANGLE": "deg", "MASS": "gram", "TIME": "millisecond"}


def called(*arguments):
    return CliRunner().invoke(main, ["tyre", *map(str, arguments)])


@pytest.mark.parametrize("tyre", [LATER, EARLIER], ids=["6.2", "5.2"])
@pytest.mark.parametrize("units", [None, ENGINEERS])
def test_a_written_file_is_read_as_the_same_tyre(tmp_path, tyre, units):
    tyre.to_file(tmp_path / "copy.tir", units)
    copy = TyreProperties.from_file(tmp_path / "copy.tir")
    assert copy.remarks == ()
    for name in ("version", "use_mode", "side", "is_pac2002"):
        assert getattr(copy, name) == getattr(tyre, name), name
    assert copy.belt == pytest.approx(tyre.belt, rel=1e-14)
    assert copy.coefficients == pytest.approx(tyre.coefficients, rel=1e-14)
    for channel, ends in tyre.ranges.items():
        assert copy.ranges[channel] == pytest.approx(ends, rel=1e-14), channel
    assert copy.bottoming.radius == pytest.approx(tyre.bottoming.radius, rel=1e-14)
    if tyre.deflection_load:
        assert np.array(copy.deflection_load.table) == pytest.approx(np.array(tyre.deflection_load.table), rel=1e-14)
    state = {"Fz": np.linspace(500, 8000, 7), "kappa": 0.03, "alpha": 0.05, "gamma": 0.04, "Vx": 15.0}
    expected, found = tyre.steady_state(**state), copy.steady_state(**state)
    for column, x in expected.items():
        assert found[column] == pytest.approx(x, rel=1e-11, abs=1e-12), column


def test_units_that_do_not_exist_are_refused(tmp_path):
    with pytest.raises(InputError, match="LENGTH: found the unit 'furlong', expected one of m"):
        EARLIER.to_file(tmp_path / "copy.tir", {"LENGTH": "furlong"})
    with pytest.raises(InputError, match="found the dimension 'SPEED'"):
        EARLIER.to_file(tmp_path / "copy.tir", {"SPEED": "m"})


@pytest.mark.long
def test_curves_states_and_files_of_the_command(tmp_path):
    LATER.to_file(tmp_path / "tyre.tir")
    given = (
        "--load",
        "3000",
        "--load",
        "5 kN",
        "--pressure",
        "220 kPa",
        "--points",
        31,
        "--at",
        "4000,0.02,0.05,0,240000,20",
    )
    result = called(
        tmp_path / "tyre.tir",
        *given,
        "--json",
        "-o",
        tmp_path / "curves.svg",
        "--write",
        tmp_path / "new.tir",
        "--unit",
        "LENGTH=mm",
    )
    assert result.exit_code == 0, result.output
    told = json.loads(result.output)
    assert (told["version"], [curve["load"] for curve in told["curves"]]) == ("6.2", [3000, 5000])
    curve = told["curves"][1]
    expected = LATER.steady_state(5000, np.array(curve["kappa"]), p=2.2e5)
    assert curve["Fx"] == pytest.approx(expected["Fx"], rel=1e-12)
    along, across = np.array(curve["ellipse"]["Fx"]), np.array(curve["ellipse"]["Fy"])
    assert max(along) == pytest.approx(curve["mux"] * 5000, rel=0.02)
    assert max(abs(across)) == pytest.approx(curve["muy"] * 5000, rel=0.02)
    state = LATER.steady_state(4000, 0.02, 0.05, 0.0, 2.4e5, 20.0)
    assert {name: told["states"][0][name] for name in state} == pytest.approx(
        {name: float(x) for name, x in state.items()}
    )
    assert (tmp_path / "curves.svg").read_text().startswith("<?xml")
    assert TyreProperties.from_file(tmp_path / "new.tir").coefficients == pytest.approx(LATER.coefficients)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--load", "-3"), "found -3, expected a force greater than 0 N"),
        (("--load", "3 m"), "found '3 m', which is in m"),
        (("--at", "1,x"), "--at 1,x: found no numbers, expected up to 7"),
        (("--at", "4000,0,0,0,0"), "found a pressure of 0 Pa"),
        (("--write", "other.txt"), ".tir"),
        (("--unit", "mm", "--write", "other.tir"), "--unit: found 'mm', expected DIMENSION=UNIT"),
    ],
)
def test_options_that_do_not_fit_are_refused(tmp_path, options, sentence):
    LATER.to_file(tmp_path / "tyre.tir")
    result = called(tmp_path / "tyre.tir", *options)
    assert result.exit_code == 2
    assert sentence in result.output + (result.stderr if result.stderr_bytes else "")


def test_a_pressure_of_an_older_tyre_and_its_own_file_are_refused(tmp_path):
    EARLIER.to_file(tmp_path / "tyre.tir")
    assert called(tmp_path / "tyre.tir", "--pressure", "2e5").exit_code == 2
    assert called(tmp_path / "tyre.tir", "--write", tmp_path / "tyre.tir").exit_code == 2
    assert called(tmp_path / "tyre.tir").exit_code == 0


def test_a_state_leaves_out_the_pressure_of_a_tyre_of_5_2(tmp_path):
    EARLIER.to_file(tmp_path / "own.tir")
    states = []
    for state in ("4000,0.02,0.05,0,,30", "4000,0.02,0.05"):
        found = CliRunner().invoke(main, ["tyre", str(tmp_path / "own.tir"), "--json", "--at", state])
        assert found.exit_code == 0, found.output
        states.append(json.loads(found.stdout)["states"][0])
    assert states[0]["Fy"] == states[1]["Fy"]
    assert states[0]["omega"] == pytest.approx(30 * 1.02 / states[0]["Re"])
    found = CliRunner().invoke(main, ["tyre", str(tmp_path / "own.tir"), "--at", ",0.02"])
    assert found.exit_code == 2
    assert "expected up to 7" in found.stderr
