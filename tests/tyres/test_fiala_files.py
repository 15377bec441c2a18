"""Property files of Adams' Fiala tyre against an independent evaluation, in several units, and what is refused."""

import math

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.elements.tyres.file_fields import RELAXED, SLIGHTLY, WIDEST
from stiffmbs.spatial import MagicFormulaTyre
from stiffmbs.studies.tyre_curves import TyreSweep, tyre_curves
from stiffmbs.tyres import TyreProperties

from .test_relaxation import gliding
from .wheels import reported, wheel

R, WIDTH, STIFFNESS, DAMPING, ARM, ALONG, ACROSS, LEAST, MOST = 0.31, 0.21, 2.3e5, 400.0, 0.004, 7e4, 5.2e4, 0.8, 1.05
INCH, POUND = 0.0254, 4.4482216152605
UNITS = {
    "SI": ("meter", "newton", "radians", 1.0, 1.0, 1.0),
    "mm-N-deg": ("mm", "newton", "degree", 1e-3, 1.0, math.pi / 180),
    "inch-pound": ("inch", "pound_force", "degrees", INCH, POUND, math.pi / 180),
}


def file_of(units="SI", mode=1, more="", **changed):
    """A property file of the same tyre in other units."""
    length, force, angle, m, n, rad = UNITS[units]
    numbers = {
        "VERTICAL_STIFFNESS": STIFFNESS * m / n, "VERTICAL_DAMPING": DAMPING * m / n, "ROLLING_RESISTANCE": ARM / m, "CSLIP": ALONG / n,
        "CALPHA": ACROSS * rad / n, "CGAMMA": 0.0, "UMIN": LEAST, "UMAX": MOST, "RELAX_LENGTH_X": 0.25 / m, "RELAX_LENGTH_Y": 0.5 / m,
    } | changed  # fmt: skip
    lines = "\n".join(f"{name} = {value!r}" for name, value in numbers.items() if value is not None)
    return (
        f"[UNITS]\nLENGTH = '{length}'\nFORCE = '{force}'\nANGLE = '{angle}'\nMASS = 'kg'\nTIME = 'sec'\n"
        f"[MODEL]\nPROPERTY_FILE_FORMAT = 'FIALA'\nUSE_MODE = {mode}\n"
        f"[DIMENSION]\nUNLOADED_RADIUS = {R / m!r}\nWIDTH = {WIDTH / m!r}\n[PARAMETER]\n{lines}\n{more}"
    )


def published(load, kappa, alpha, direction=1.0, friction=1.0):
    """Fx, Fy, My, Mz of MSC Adams/Tire's Fiala model in ISO axes; arrays."""
    load = np.maximum(load, 1e-12)
    slope = np.abs(np.tan(alpha))
    whole = np.minimum(np.hypot(kappa, slope), 1.0)
    most = friction * (MOST - (MOST - LEAST) * whole) * load
    critical = np.abs(most / (2 * ALONG))
    with np.errstate(divide="ignore", invalid="ignore"):
        sliding = np.sign(kappa) * (most - np.abs(most**2 / (4 * np.abs(kappa) * ALONG)))
    fx = np.where(np.abs(kappa) <= critical, ALONG * kappa, sliding)
    elastic = np.abs(alpha) <= np.arctan(3 * most / ACROSS)
    H = 1 - ACROSS * slope / (3 * most)
    fy = np.where(elastic, -most * (1 - H**3), -most) * np.sign(alpha)
    mz = np.where(elastic, most * WIDTH * (1 - H) * H**3 * np.sign(alpha), 0.0) * direction
    return fx, fy, -ARM * load * direction, mz


def random_states(seed, count):
    rng = np.random.default_rng(seed)
    small = rng.random(count) < 0.5
    kappa = np.where(small, rng.uniform(-0.05, 0.05, count), rng.uniform(-1.2, 1.2, count))
    alpha = np.where(small, rng.uniform(-0.15, 0.15, count), rng.uniform(-1.2, 1.2, count))
    load = np.where(rng.random(count) < 0.05, 0.0, rng.uniform(0, 15e3, count))
    return (
        load,
        kappa,
        alpha,
        rng.uniform(-0.3, 0.3, count),
        rng.choice([-20.0, 20.0], count),
        rng.uniform(0.2, 1, count),
    )


@pytest.mark.parametrize("units", UNITS)
def test_thousands_of_states_in_any_units(read, units):
    tyre = read(file_of(units))
    assert tyre.version == "Fiala"
    load, kappa, alpha, gamma, speed, friction = random_states(1, 4000)
    found = tyre.steady_state(load, kappa, alpha, gamma, Vx=speed, friction=friction)
    expected = published(load, kappa, alpha, np.sign(speed), friction)
    for name, values in zip(("Fx", "Fy", "My", "Mz"), expected, strict=True):
        np.testing.assert_allclose(found[name], values, rtol=1e-11, atol=1e-8, err_msg=name)
    assert not np.any(found["Mx"])
    np.testing.assert_allclose(found["Rl"], R - load / STIFFNESS, rtol=1e-13)
    np.testing.assert_allclose(found["omega"] * found["Rl"], speed + kappa * np.abs(speed), rtol=1e-12)


def test_slopes_at_zero_slip_and_the_trail(read):
    found = read(file_of()).steady_state(3000.0, 0.0, np.array([0.0, 0.05]))
    assert (found["Kxk"][0], found["Kya"][0], found["mux"][0]) == pytest.approx((ALONG, -ACROSS, MOST))
    assert found["t"][0] == pytest.approx(WIDTH / 3)
    assert found["t"][1] == pytest.approx(-found["Mz"][1] / found["Fy"][1])


@pytest.mark.parametrize("mode", [1, 11])
def test_a_wheel_on_the_road(read, mode):
    """Loads, slips and torques of the element, with camber, mirrored, in reverse, in the air, and at walking pace."""
    properties = read(file_of("mm-N-deg", mode))
    for hand in (1.0, -1.0):
        tyre = MagicFormulaTyre(i="wheel", properties=properties, hand=hand, transient=False)
        for speed, slip, alpha, camber, deflection in (
            (20, 0.02, 0.03, 0.0, 0.015), (20, -0.4, 0.2, 0.1, 0.02), (-12, 0.05, -0.08, -0.2, 0.01), (15, 0.0, 0.1, 0.0, -0.01),
            (0.3, 0.02, 0.03, 0.05, 0.015), (-0.1, 0.1, 0.2, 0.0, 0.02), (0.0, 0.0, 0.0, 0.1, 0.02),
        ):  # fmt: skip
            spin = (speed + slip * abs(speed)) / (R - max(deflection, 0))
            found = reported(wheel(tyre, R, deflection, alpha, camber, speed, spin))
            reference = abs(speed) if abs(speed) > 1 else (1 + speed**2) / 2
            load = STIFFNESS * max(deflection, 0)
            assert found["load"] == pytest.approx(load, rel=1e-9)
            kappa, tangent = slip * abs(speed) / reference, abs(speed) * math.tan(alpha) / reference
            fx, fy, my, mz = map(float, published(load, kappa, math.atan(tangent), speed / reference))
            got = [found[name] for name in ("longitudinal", "lateral", "rolling", "aligning", "overturning")]
            assert got == pytest.approx([fx, fy, my, mz, 0.0], rel=1e-8, abs=1e-6), (speed, slip, hand)


@pytest.mark.long
def test_the_lateral_slip_lags_by_the_relaxation_length_of_the_file(read):
    tyre = MagicFormulaTyre(i="wheel", properties=read(file_of("inch-pound", 12)))
    assert tyre.own_states() == ("deflection_x", "deflection_y")
    assert MagicFormulaTyre(i="wheel", properties=read(file_of(mode=2))).own_states() == ()
    speed, rate, swing, length = 20.0, 15.0, 0.01, 0.5
    found = gliding(tyre, speed, sideways=f"{swing}*sin({rate}*t)").run(duration=1, output=0.01, rtol=1e-8)
    late = found.time > 0.8
    slip = swing * rate / speed / (1 + 1j * rate * length / speed)
    expected = np.real(slip * np.exp(1j * rate * found.time[late]))
    assert np.tan(found["tyre.slip_angle"][late]) == pytest.approx(expected, abs=1e-6)


def test_one_relaxation_length_is_that_of_both_directions(read):
    tyre = read(file_of("mm-N-deg", 11, RELAX_LENGTH_X=None, RELAX_LENGTH_Y=None, RELAXATION_LENGTH=400.0))
    assert [tyre.coefficients[f"RELAX_LENGTH_{axis}"] for axis in "XY"] == pytest.approx([0.4, 0.4])
    assert not any("RELAXATION" in note for note in tyre.notes())


@pytest.mark.parametrize("part", [0.5 * RELAXED[0], 2 * RELAXED[1]])
def test_lengths_in_another_unit_are_left_out_or_refused(read, part):
    """Adams' own file in mm has a length of 0.05."""
    shown = repr(1e3 * part * R)
    wrong = {"RELAX_LENGTH_X": float(shown)}
    steady = read(file_of("mm-N-deg", 2, **wrong))
    assert any("RELAX_LENGTH_X = " in note and "steady slip does without it" in note for note in steady.notes())
    assert steady.coefficients["RELAX_LENGTH_X"] == 0
    with pytest.raises(
        InputError, match=r"line \d+: found RELAX_LENGTH_X = .* m by \[UNITS\], expected 0\.0031 to 3\.1 m"
    ):
        read(file_of("mm-N-deg", 12, **wrong))
    for inside in (2 * RELAXED[0], 0.5 * RELAXED[1]):
        read(file_of("mm-N-deg", 12, RELAX_LENGTH_X=1e3 * inside * R))


def test_a_curve_of_load_and_the_largest_load(read):
    curve = "[DEFLECTION_LOAD_CURVE]\n{pen fz}\n0 0.0\n10 2000.0\n20 5000.0\n30 9000.0\n"
    tyre = read(file_of("mm-N-deg", more=curve))
    found = tyre.steady_state(np.array([2000.0, 5000.0, 9000.0]))
    assert found["rho"] == pytest.approx([0.01, 0.02, 0.03], rel=1e-9)
    on_road = reported(wheel(MagicFormulaTyre(i="wheel", properties=tyre), R, 0.02, speed=20, spin=20 / (R - 0.02)))
    assert on_road["load"] == pytest.approx(5000, rel=1e-9)
    assert on_road["rolling"] == pytest.approx(-ARM * 5000, rel=1e-9)


@pytest.mark.parametrize("units", [None, {"LENGTH": "inch", "FORCE": "pound_force", "ANGLE": "deg"}])
def test_a_written_file_is_read_as_the_same_tyre(read, tmp_path, units):
    tyre = read(file_of(mode=12, more="[DEFLECTION_LOAD_CURVE]\n0 0\n0.01 2000\n0.03 7000\n"))
    tyre.to_file(tmp_path / "copy.tir", units)
    copy = TyreProperties.from_file(tmp_path / "copy.tir")
    assert (copy.version, copy.use_mode, copy.remarks) == ("Fiala", 12, ())
    assert copy.coefficients == pytest.approx(tyre.coefficients, rel=1e-14)
    text = (tmp_path / "copy.tir").read_text()
    assert text.index("[PARAMETER]") < text.index("VERTICAL_STIFFNESS")
    assert "[VERTICAL]" not in text and "FITTYP" not in text


def test_curves_have_usual_loads_without_a_nominal_one(read):
    curves = tyre_curves(read(file_of()), TyreSweep(points=11))
    nominal = 0.05 * R * STIFFNESS
    assert SLIGHTLY == 0.05
    assert [curve.load for curve in curves] == pytest.approx([0.5 * nominal, nominal, 1.5 * nominal])


def test_notes(read):
    notes = " ".join(read(file_of(mode=2, CGAMMA=300.0, LOW_SPEED_THRESHOLD=2.5)).notes())
    assert "forces that rise at the start of a run: they act in full, as with 1" in notes
    assert "(camber has no effect on Fiala's forces): [PARAMETER] CGAMMA" in notes
    assert "[PARAMETER] LOW_SPEED_THRESHOLD" in notes
    assert list(read(file_of(mode=1)).notes()) == []
    lengths = {"RELAX_LENGTH_X": None, "RELAX_LENGTH_Y": 0.0}
    notes = " ".join(read(file_of(mode=11, **lengths)).notes())
    assert "asks for relaxation lengths, and there are none (RELAX_LENGTH_X, RELAX_LENGTH_Y)" in notes


WRONG = {
    "CSLIP = 70000.0>": r"found no CSLIP, expected one in \[PARAMETER\]",
    "CALPHA = 52000.0>CALPHA = -52000": "found CALPHA = -52000, expected a number above zero",
    "CALPHA = 52000.0>CALPHA = 907.6": r"line \d+: found CALPHA = 907.6, by which the tyre slides from 8\d deg, expected 1 to 60 deg",
    "ANGLE = 'radians'>ANGLE = 'degrees'": r"found CALPHA = 52000.0, by which the tyre slides from 0.\d+ deg, .* a force per angle of \[UNITS\]",
    "CSLIP = 70000.0>CSLIP = 0": "found CSLIP = 0, expected a number other than zero",
    "UMIN = 0.8>UMIN = 1.2": r"line 20: found UMIN = 1.2, expected at most UMAX = 1.05",
    "UMAX = 1.05>UMAX = 105": r"found UMAX = 105, 105 by \[UNITS\], expected 0 to 10",
    "USE_MODE = 1>USE_MODE = 4": "line 9: found USE_MODE = 4, expected 1 or 2 for steady slip, 11 or 12 for slip with relaxation",
    "USE_MODE = 1>USE_MODE = -1": "found USE_MODE = -1, expected 1 or 2",
    "USE_MODE = 1>USE_MODE = 10": "found USE_MODE = 10, expected 1 or 2",
    "FORCE = 'newton'>FORCE = 'kN'\nMASS_ = 1": r"found VERTICAL_STIFFNESS = .* N deflect the tyre by 0.05 radii, expected 10 to 2e\+06 N",
    "LENGTH = 'meter'>LENGTH = 'mm'": r"found UNLOADED_RADIUS = 0.31, 0.00031 m by \[UNITS\]",
    "WIDTH = 0.21>WIDTH = 210": r"found WIDTH = 210, 210 m by \[UNITS\], expected 0 to 1.55 m",
    "ROLLING_RESISTANCE = 0.004>ROLLING_RESISTANCE = 4": r"found ROLLING_RESISTANCE = 4, 4 m by \[UNITS\], expected 0 to 0.31 m",
    "ROLLING_RESISTANCE = 0.004>ROLLING_RESISTANCE = -4": "found ROLLING_RESISTANCE = -4, -4 m by",
    "VERTICAL_DAMPING = 400.0>VERTICAL_DAMPING = -4": "found VERTICAL_DAMPING = -4, -4 N s/m by",
    "'FIALA'>'FIALA2'": r"line 8: found the format 'FIALA2', expected PAC2002, MF-Tyre or Fiala",
}


@pytest.mark.parametrize(("angle", "valid"), [(0.8, False), (1.2, True), (50, True), (75, False)])
def test_the_slip_angles_from_which_a_tyre_slides(read, angle, valid):
    """3 UMAX Fz/CALPHA = tan(alpha) of a load that deflects the tyre by 0.05 radii."""
    load = SLIGHTLY * R * STIFFNESS
    text = file_of(CALPHA=3 * MOST * load / math.tan(math.radians(angle)))
    if valid:
        read(text)
        return
    with pytest.raises(InputError, match="found CALPHA"):
        read(text)


@pytest.mark.parametrize(("width", "valid"), [(0.8 * WIDEST, True), (1.2 * WIDEST, False)])
def test_the_widest_tyre(read, width, valid):
    text = file_of().replace("WIDTH = 0.21", f"WIDTH = {width * R}")
    if valid:
        read(text)
        return
    with pytest.raises(InputError, match="found WIDTH"):
        read(text)


@pytest.mark.parametrize("change", WRONG)
def test_bad_files_are_refused_in_one_sentence(read, change):
    old, new = change.split(">")
    text = file_of()
    assert old in text
    with pytest.raises(InputError, match=WRONG[change]) as error:
        read(text.replace(old, new))
    assert "\n" not in str(error.value)


def test_a_pressure_and_turn_slip_are_refused(read):
    tyre = read(file_of())
    for fields, said in (
        ({"pressure": 2e5}, "pressure: found one for a tyre of version Fiala"),
        ({"turn_slip": True}, "turn_slip: "),
    ):
        with pytest.raises(InputError, match=said):
            MagicFormulaTyre(i="wheel", properties=tyre, **fields)
    without = {"RELAX_LENGTH_X": None, "RELAX_LENGTH_Y": None}
    with pytest.raises(InputError, match="transient: found properties without RELAX_LENGTH_X and RELAX_LENGTH_Y"):
        MagicFormulaTyre(i="wheel", properties=read(file_of(**without)), transient=True)


def test_a_tyre_without_width_has_no_aligning_torque(read):
    text = file_of().replace("WIDTH = 0.21", "WIDTH = 0").replace("UMIN = 0.8", "UMIN = 0")
    assert not np.any(read(text).steady_state(3000.0, 0.0, np.linspace(-0.2, 0.2, 9))["Mz"])
