"""PAC2002 with inflation pressure against independent evaluations, and files with and without a nominal pressure."""

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.elements.tyres.coefficients import WRENCH
from stiffmbs.elements.tyres.names import COEFFICIENTS_6, OF_PAC2002, OF_PRESSURE, SCALES_6
from stiffmbs.spatial import MagicFormulaTyre
from stiffmbs.tyres import TyreProperties

from .plain_magic_formula import plain_wrench
from .plain_magic_formula_6 import plain_wrench_6
from .test_magic_formula_6_coefficients import OF_THE_BODY
from .test_magic_formula_coefficients import random_states, random_tyre
from .test_property_files import FILE
from .wheels import reported, wheel

NOMINAL, PRESSURE, SCALE = 2.2e5, 2.7e5, 1.05
TOLERANCE = 1e-11


def pressed_tyre(seed):
    """All coefficients, none at a value where it has no effect."""
    rng = np.random.default_rng(seed + 1000)
    own = {name: rng.choice([-1, 1]) * rng.uniform(0.1, 0.5) for name in (*OF_PRESSURE, *OF_PAC2002)}
    own |= {"QSX5": 0.8, "QSX6": 1.1, "QSX9": 3.0, "QSX11": 1.2, "QSY7": 0.85}
    return {**random_tyre(seed), **own, "IP": PRESSURE, "IP_NOM": NOMINAL, "LIP": SCALE}


def by_plain(tyre, states, pressures):
    rows = zip(states, pressures, strict=True)
    return np.array([plain_wrench(tyre, *s, dpi=p / (SCALE * NOMINAL) - 1) for s, p in rows])


def by_package(tyre, states, pressures):
    load, kappa, alpha, gamma, ratio = states.T
    found = TyreProperties(coefficients=tyre).wrench(
        load, kappa, alpha, gamma, ratio * tyre["LONGVL"], pressure=pressures
    )
    return np.column_stack([found[name] for name in WRENCH])


def difference(one, other):
    return (np.abs(one - other) / np.abs(other).max(axis=0)).max()


@pytest.mark.parametrize("seed", range(10))
def test_thousands_of_states(seed):
    tyre, states = pressed_tyre(seed), random_states(seed + 100, 300)
    pressures = np.random.default_rng(seed).uniform(1.5e5, 3.2e5, 300)
    assert difference(by_package(tyre, states, pressures), by_plain(tyre, states, pressures)) < TOLERANCE


@pytest.mark.parametrize("name", [name for name in OF_PRESSURE if name != "QPFZ1"])
def test_the_sign_of_each_coefficient_is_seen(name):
    tyre, states = pressed_tyre(0), random_states(100)
    pressures = np.full(len(states), 2.8e5)
    turned = {**tyre, name: -tyre[name]}
    assert difference(by_plain(turned, states, pressures), by_plain(tyre, states, pressures)) > 1e4 * TOLERANCE


@pytest.mark.parametrize("name", OF_PAC2002)
def test_each_coefficient_of_the_torques_is_seen(name):
    tyre, states = pressed_tyre(0), random_states(100)
    pressures, less = np.full(len(states), 2.8e5), {**tyre, name: 0.7 * tyre[name]}
    assert difference(by_plain(less, states, pressures), by_plain(tyre, states, pressures)) > 1e4 * TOLERANCE


def test_pure_slip_without_camber_is_that_of_6_1():
    """The pressure terms are those of Besselink, Schmeitz and Pacejka (2010)."""
    tyre = {
        name: x for name, x in pressed_tyre(3).items() if not name.startswith(("QS", "QHZ", "PHY", "PVY", "PHX", "PVX"))
    }
    tyre |= dict.fromkeys(("LFZO", "LIP", "LMUY", "LKY", "LGAX", "LGAY", "LGAZ"), 1.0)
    names = {"QPZ1": "PPZ1", "QPZ2": "PPZ2", "QPX1": "PPMX1", "IP_NOM": "NOMPRES", "IP": "INFLPRES"}
    later = (
        dict.fromkeys(COEFFICIENTS_6, 0.0)
        | dict.fromkeys(SCALES_6, 1.0)
        | {**OF_THE_BODY, "PKY4": 2.0, "QSY7": 1.0, "LMUV": 0.0, "PHYP1": 1.0}
    )
    later |= {names.get(name, name): x for name, x in tyre.items()}
    rng = np.random.default_rng(5)
    package = TyreProperties(coefficients=tyre)
    for _ in range(50):
        load, alpha, pressure = rng.uniform(1000, 8000), rng.uniform(-0.3, 0.3), rng.uniform(1.6e5, 3e5)
        state = {
            "Fz": load,
            "kappa": 0.0,
            "alpha": alpha,
            "gamma": 0.0,
            "p": pressure,
            "Vx": 16.0,
            "phit": None,
            "mu": 1.0,
            "Re": 0.3,
        }
        expected = plain_wrench_6(later, state)
        found = package.steady_state(load, 0.0, alpha, 0.0, pressure, 16.0)
        for column in ("Fy", "Kya", "Kxk", "muy", "mux", "t"):
            assert found[column] == pytest.approx(expected[column], rel=1e-9), column


SOFT = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.32, "VERTICAL_STIFFNESS": 2e5, "PCX1": 1.6, "PDX1": 1.1, "PKX1": 21.0, "PCY1": 1.3,
    "PDY1": 1.0, "PKY1": -14.0, "PKY2": 1.8, "PPX1": -0.4, "PPY1": 0.3, "PPY3": 0.1, "QPFZ1": 0.7, "IP_NOM": NOMINAL, "IP": PRESSURE,
}  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("given", [None, 1.8e5])
@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_a_wheel_on_the_road(given, hand):
    """The pressure of the file, or of the scene, stiffens the tyre and changes its forces; also in reverse and mirrored."""
    properties = TyreProperties(coefficients=SOFT)
    tyre = MagicFormulaTyre(i="wheel", properties=properties, pressure=given, hand=hand)
    pressure = PRESSURE if given is None else given
    stiffness = 2e5 * (1 + 0.7 * (pressure / NOMINAL - 1))
    for speed in (20.0, -15.0):
        found = reported(wheel(tyre, 0.32, 0.02, 0.05, 0.03, speed, 1.02 * speed / 0.3133))
        assert found["load"] == pytest.approx(0.02 * stiffness, rel=1e-9)
        state = properties.steady_state(
            found["load"], found["slip"], found["slip_angle"], found["camber"], pressure, speed
        )
        for channel, symbol in WRENCH.items():
            assert found[channel] == pytest.approx(float(state[symbol]), rel=1e-9, abs=1e-6), channel
        assert state["rho"] == pytest.approx(0.02, rel=1e-9)
    in_the_air = reported(wheel(tyre, 0.32, -0.01, 0.05, 0.0, 20.0, 60.0))
    assert [in_the_air[name] for name in ("load", "longitudinal", "lateral", "aligning")] == pytest.approx(
        [0, 0, 0, 0], abs=1e-9
    )


PRESSED = FILE.replace("PCX1 = 1.6", "PCX1 = 1.6\nPPX1 = -0.4\nPPX3 = 0.1")
CONDITIONS = "[TIRE_CONDITIONS]\nIP = 0.00027\nIP_NOM = 0.00022\n"


@pytest.mark.parametrize("fittyp", ["", "FITTYP = 6\n"])
def test_a_nominal_pressure_selects_the_equations(read, fittyp):
    tyre = read(PRESSED.replace("LONGVL", f"{fittyp}LONGVL") + CONDITIONS)
    assert (tyre.version, tyre.is_pac2002, tyre.nominal_pressure) == ("5.2", True, pytest.approx(PRESSURE))
    assert not any("PPX1" in note or "IP" in note for note in tyre.notes())
    stiffness = tyre.steady_state(4000.0, p=[NOMINAL, PRESSURE])["Kxk"]
    assert stiffness[1] / stiffness[0] == pytest.approx(1 - 0.4 * (PRESSURE / NOMINAL - 1), rel=1e-12)
    assert tyre.steady_state(4000.0)["Kxk"] == pytest.approx(stiffness[1], rel=1e-12)


@pytest.mark.parametrize(("unit", "factor"), [("pascal", 1.0), ("kPa", 1e3), ("bar", 1e5), ("psi", 6894.757293168)])
def test_the_unit_of_pressure(read, unit, factor):
    units = PRESSED.replace("MASS", f"PRESSURE = '{unit}'\nMASS")
    tyre = read(f"{units}[TIRE_CONDITIONS]\nIP = {PRESSURE / factor}\nIP_NOM = {NOMINAL / factor}\n")
    assert tyre.coefficients["IP"] == pytest.approx(PRESSURE)
    assert tyre.coefficients["IP_NOM"] == pytest.approx(NOMINAL)


def test_coefficients_without_a_nominal_pressure(read):
    with pytest.raises(InputError, match=r"line 23: found PPX1 without FITTYP, .* no effect, or IP_NOM of PAC2002$"):
        read(PRESSED)
    alone = read(PRESSED.replace("LONGVL", "FITTYP = 6\nLONGVL"))
    assert alone.nominal_pressure is None
    assert any("PPX1" in note for note in alone.notes())
    with pytest.raises(
        InputError, match=r"found a pressure for a tyre of version 5.2, expected a tyre of 6.1 or 6.2, or of PAC2002"
    ):
        alone.steady_state(4000.0, p=PRESSURE)
    with pytest.raises(InputError, match="found PPX1 without FITTYP"):
        read(PRESSED.replace("PAC2002", "MF_05") + CONDITIONS)


def test_coefficients_of_6_1_stay_refused(read):
    with pytest.raises(
        InputError, match=r"found PKY6 without FITTYP, .* that is not modelled in PAC2002, expected FITTYP = 61"
    ):
        read(PRESSED.replace("PCX1 = 1.6", "PCX1 = 1.6\nPKY6 = -0.9") + CONDITIONS)


def test_an_exponent_of_zero_is_neutral_in_pac2002(read):
    """My is Fz (Fz/FNOMIN)^QSY7 in Pacejka (2012), 4.E70, and in PAC2002; FNOMIN (Fz/FNOMIN)^QSY7 in MF-Tyre."""
    text = PRESSED + "[ROLLING_COEFFICIENTS]\nQSY1 = 0.01\nQSY7 = 0\nQSY8 = -0.5\n"
    tyre = read(text + CONDITIONS)
    assert tyre.steady_state(4000.0)["My"] == pytest.approx(-0.32 * 4000 * 0.01 * (PRESSURE / NOMINAL) ** -0.5)
    less = read(text.replace("QSY7 = 0", "QSY7 = 0.9") + CONDITIONS)
    assert less.steady_state(2000.0)["My"] == pytest.approx(tyre.steady_state(2000.0)["My"] * 0.5**0.9)


TORQUES = "[OVERTURNING_COEFFICIENTS]\nQSX4 = 0.02\nQSX5 = 0.8\nQSX6 = 1\nQSX7 = 3\nQSX8 = 0.5\nQSX9 = 2\nQSX10 = 0.1\nQSX11 = 1.5\n"


def test_the_torques_of_a_pac2002_file_without_a_nominal_pressure(read):
    """QSX4 to QSX11 and QSY5 to QSY7 act in PAC2002, with and without FITTYP, and have no effect in MF-Tyre 5.2."""
    text = FILE + TORQUES + "[ROLLING_COEFFICIENTS]\nQSY1 = 0.01\nQSY5 = 0.3\nQSY6 = 0.2\nQSY7 = 0.8\n"
    state = {"Fz": 3000.0, "alpha": 0.05, "gamma": 0.1}
    for written in (text, text.replace("LONGVL", "FITTYP = 6\nLONGVL")):
        tyre = read(written)
        assert not any("QS" in note for note in tyre.notes())
        found, n = tyre.steady_state(**state), 3000 / tyre.coefficients["FNOMIN"]
        side = found["Fy"] / tyre.coefficients["FNOMIN"]
        hill = 0.02 * np.cos(0.8 * np.arctan(n**2)) * np.sin(0.3 + 0.5 * np.arctan(2 * side))
        R = tyre.coefficients["UNLOADED_RADIUS"]
        assert found["Mx"] == pytest.approx(R * 3000 * (hill + 0.01 * np.arctan(1.5 * n)), rel=1e-12)
        assert found["My"] == pytest.approx(-R * 3000 * (0.01 + (0.3 + 0.2 * n) * 0.01) * n**0.8, rel=1e-10)
    other = text.replace("PAC2002", "MF_05")
    with pytest.raises(InputError, match="found QSX4 without FITTYP"):
        read(other)
    assert any("QSX4" in note for note in read(other.replace("LONGVL", "FITTYP = 6\nLONGVL")).notes())
    with pytest.raises(InputError, match=r"found QSX4 of a tyre of MF-Tyre 5\.2, expected one of PAC2002"):
        TyreProperties(coefficients={**tyre.coefficients})


def test_the_nominal_pressure_is_that_of_a_file_without_another(read):
    assert read(f"{PRESSED}[TIRE_CONDITIONS]\nIP_NOM = 0.00022\n").nominal_pressure == pytest.approx(NOMINAL)
    with pytest.raises(InputError, match=r"found IP_NOM = 2.2, 2.2e\+09 Pa by \[UNITS\], expected 10000 to 5e\+06 Pa"):
        read(f"{PRESSED}[TIRE_CONDITIONS]\nIP_NOM = 2.2\n")


@pytest.mark.parametrize("units", [None, {"LENGTH": "mm", "FORCE": "kN"}, {"PRESSURE": "bar"}])
def test_a_written_file_is_read_as_the_same_tyre(tmp_path, units):
    tyre = TyreProperties(coefficients=pressed_tyre(7), is_pac2002=True)
    tyre.to_file(tmp_path / "copy.tir", units)
    copy = TyreProperties.from_file(tmp_path / "copy.tir")
    assert copy.remarks == ()
    assert copy.coefficients == pytest.approx(tyre.coefficients, rel=1e-14)


def test_the_combined_slip_of_a_tyre_with_a_nominal_pressure_is_that_of_pac2002(tmp_path):
    """Without weights of combined slip; the written file has the format PAC2002, which selects them too."""
    tyre = TyreProperties(coefficients=SOFT)
    tyre.to_file(tmp_path / "copy.tir")
    state = {"Fz": 4000.0, "kappa": 0.1, "alpha": 0.08}
    stated = TyreProperties(coefficients=SOFT, is_pac2002=True)
    for other in (stated, TyreProperties.from_file(tmp_path / "copy.tir")):
        assert tyre.steady_state(**state)["Fx"] == pytest.approx(float(other.steady_state(**state)["Fx"]), rel=1e-12)


@pytest.mark.parametrize("name", ["PPX1", "QPFZ1", "IP"])
def test_coefficients_by_name_need_a_nominal_pressure(name):
    given = {key: x for key, x in SOFT.items() if key not in ("IP", "IP_NOM", *OF_PRESSURE)}
    TyreProperties(coefficients=given)
    with pytest.raises(InputError, match=f"found {name} without IP_NOM, expected the nominal pressure"):
        TyreProperties(coefficients={**given, name: 2e5})
