"""Tyres whose force adds energy within their own range are reported, and others are not."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.model.scene import notes_of
from stiffmbs.tyres import TyreProperties

ROOT = Path(stiffmbs.__file__).parents[1]
OF_5 = TyreProperties.from_file(ROOT / "examples" / "car.tir")
OF_6 = {
    **{name: value for name, value in OF_5.coefficients.items() if name[:2] in ("PC", "PD", "PE", "PK")},
    "UNLOADED_RADIUS": 0.316, "VERTICAL_STIFFNESS": 2.2e5, "FNOMIN": 4000.0, "FZMAX": 12000.0, "PKY4": 2.0, "NOMPRES": 2e5,
    "LONGITUDINAL_STIFFNESS": 3e5, "LATERAL_STIFFNESS": 1e5, "WIDTH": 0.2,
}  # fmt: skip


def tyre(version, ranges=None, **changes):
    coefficients = OF_5.coefficients if version == "5.2" else OF_6
    return TyreProperties(coefficients={**coefficients, **changes}, version=version, ranges=ranges or {})


def said(properties):
    return [note for note in properties.notes() if "within its own range" in note]


@pytest.mark.parametrize("version", ["5.2", "6.1", "6.2"])
def test_a_passive_tyre_has_no_note(version):
    assert said(tyre(version)) == []


@pytest.mark.parametrize("version", ["5.2", "6.2"])
def test_a_negative_slip_stiffness_is_reported_with_its_range(version):
    """PKX1 + PKX2 dfz is zero at 1.5 nominal loads; the energy of a car rose from 10 kJ to 4.45 MJ without a note."""
    (note,) = said(tyre(version, PKX1=22.0, PKX2=-44.0))
    assert "Kxk is negative between 60" in note
    assert "and 12000 N" in note
    assert "set FZMAX to 59" in note
    assert said(tyre(version, PKX1=22.0, PKX2=-44.0, FZMAX=5900.0)) == [], "outside of its range"
    (note,) = said(tyre(version, PKX1=22.0, PKX2=44.0))
    assert "Kxk is negative between 29." in note, "from the lowest loads to half the nominal load"
    assert "and 19" in note


@pytest.mark.sampled(12)
@pytest.mark.parametrize("seed", range(30))
def test_notes_agree_with_the_stiffnesses_of_the_equations(seed):
    """Both stiffnesses at random, over load and camber."""
    rng, version = np.random.default_rng(seed), ("5.2", "6.1", "6.2")[seed % 3]
    changes = {"PKX2": rng.uniform(-40, 30), "PKY3": rng.uniform(0, 6), "FZMAX": rng.uniform(4e3, 12e3)}
    changes |= {} if version == "5.2" else {"PKY4": rng.uniform(1.5, 5)}
    properties = tyre(version, {"camber": (-0.25, 0.25)}, **changes)
    loads = np.linspace(changes["FZMAX"] / 400, changes["FZMAX"], 500)[:, None]
    exact = properties.steady_state(loads, gamma=np.array([-0.25, 0.0, 0.25]))
    notes = said(properties)
    for name, sign in (("Kxk", 1), ("Kya", -1)):
        assert any(note.startswith(name) for note in notes) == bool(np.any(sign * exact[name] < 0)), name


def test_a_relaxation_length_keeps_the_sign_of_its_stiffness():
    """Its absolute value hid a negative stiffness."""
    properties = tyre("6.2", PKX1=22.0, PKX2=-44.0)
    found = properties.steady_state([3000.0, 9000.0])
    assert found["sigma_x"] * 3e5 == pytest.approx(found["Kxk"])
    assert found["sigma_x"][1] < 0
    assert found["sigma_y"] * 1e5 == pytest.approx(-found["Kya"])
    (note,) = said(tyre("5.2", PTX1=2.0, PTX2=-2.0))
    assert note.startswith("the relaxation length sigma_x is negative between 80")


def test_check_run_and_the_tyre_command_report_it(tmp_path):
    text = (ROOT / "examples" / "car.tir").read_text()
    file = tmp_path / "bad.tir"
    file.write_text(text.replace("PKX2 = 0.5", "PKX2 = -40"))
    found = CliRunner().invoke(main, ["tyre", str(file)])
    assert found.exit_code == 0
    assert "note: Kxk is negative between 6" in found.output
    wheel = {"mass": 20, "inertia": [1, 2, 1], "position": [0, 0, 0.3]}
    scene = {
        "dimensions": 3, "bodies": {"wheel": wheel}, "roads": {"flat": {"type": "flat"}}, "run": {"duration": 0.01},
        "forces": {"tyre": {"type": "magic_formula_tyre", "i": "wheel", "properties": str(file), "road": "flat"}},
    }  # fmt: skip
    loaded = stiffmbs.read_scene(json.dumps(scene))
    assert any(note.startswith("tyre: Kxk is negative") for note in notes_of(loaded))
