"""Files of tyre properties: units, notes, and clear errors with their lines."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import constants

import stiffmbs
from stiffmbs import InputError, load_scene
from stiffmbs.commands.main import main
from stiffmbs.elements.tyres.names import AS_BEFORE, LATER, OF_PAC2002
from stiffmbs.elements.tyres.property_file import UNITS
from stiffmbs.spatial import MagicFormulaTyre
from stiffmbs.tyres import TyreProperties

from ..conftest import EXAMPLES

FILE = """$ a tyre
[UNITS]
LENGTH = 'mm'
FORCE = 'kN'
ANGLE = 'degree'
MASS = 'kg'
TIME = 'second'
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'   $ comment
LONGVL = 16700
[DIMENSION]
UNLOADED_RADIUS = 320
[SHAPE]
{radial width}
 1.0 0.0
 0.9 1.0
[VERTICAL]
VERTICAL_STIFFNESS = 0.2
VERTICAL_DAMPING = 5D-4
FNOMIN = 4
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1.6
PDX1 = 1.1  ! peak
PKX1 = 21
[LATERAL_COEFFICIENTS]
PCY1 = 1.3
PDY1 = 1.0
PKY1 = -14
PKY2 = 1.8
OWN1 = 3
"""


def test_numbers_have_the_units_of_the_file(read):
    found = read(FILE).coefficients
    assert found["UNLOADED_RADIUS"] == pytest.approx(0.32)
    assert found["VERTICAL_STIFFNESS"] == pytest.approx(2e5)
    assert found["VERTICAL_DAMPING"] == pytest.approx(500)
    assert (found["FNOMIN"], found["LONGVL"]) == pytest.approx((4000, 16.7))
    assert found["PKX1"] == 21


def test_unknown_keys_and_missing_weights_are_noted(read):
    notes = " ".join(read(FILE).notes())
    assert "OWN1" in notes
    assert "friction ellipse" in notes
    assert "table [SHAPE]" in notes
    assert "[UNITS]" not in notes  # no entry is a mass or an angle


@pytest.mark.parametrize("kind", [7, 21, 2012, 51.5, 0, -5, "'FTIRE'"])
def test_files_of_other_formulas_are_refused_by_their_fittyp(read, kind):
    with pytest.raises(
        InputError, match=r"line 10: found FITTYP = .*expected that of MF-Tyre 5\.2 \(5, 6, 50, 52\), 6\.1"
    ):
        read(FILE.replace("LONGVL = 16700", f"FITTYP = {kind}"))


@pytest.mark.parametrize(
    ("kind", "version"),
    [(5, "5.2"), ("'PAC2002'", "5.2"), (60, "6.1"), (61.0, "6.1"), ("'MF_6.1'", "6.1"), (62, "6.2"), ("'mf62'", "6.2")],
)
def test_fittyp_selects_the_version(read, kind, version):
    found = read(FILE.replace("LONGVL = 16700", f"FITTYP = {kind}"))
    assert found.version == version
    assert any("version 6.0" in note for note in found.notes()) == (kind == 60)


def test_a_format_of_a_later_version_selects_it_without_fittyp(read):
    assert read(FILE.replace("PAC2002", "MF_62")).version == "6.2"
    assert read(FILE.replace("PAC2002", "MF_62").replace("LONGVL", "FITTYP = 52\nLONGVL")).version == "5.2"


def test_pressures_have_the_units_of_the_file(read):
    """1 kN/mm2 is 1e9 Pa."""
    text = FILE.replace("LONGVL", "FITTYP = 61\nLONGVL")
    found = read(f"{text}[OPERATING_CONDITIONS]\nNOMPRES = 0.00024\nINFLPRES = 0.0003\n")
    assert found.coefficients["NOMPRES"] == pytest.approx(2.4e5)
    assert found.nominal_pressure == pytest.approx(3e5)


@pytest.mark.parametrize("kind", [5, 6, 52])
def test_files_of_this_formula_leave_later_coefficients_out(read, kind):
    later = read(FILE.replace("LONGVL = 16700", f"FITTYP = {kind}").replace("PCX1 = 1.6", "PCX1 = 1.6\nPPX1 = -0.4"))
    assert "PPX1" in " ".join(later.notes())


@pytest.mark.parametrize("name", LATER)
def test_later_coefficients_without_fittyp_are_refused(read, name):
    file = FILE.replace("PAC2002", "MF_05") if name in OF_PAC2002 else FILE
    with pytest.raises(InputError, match=f"line 23: found {name} without FITTYP"):
        read(file.replace("PCX1 = 1.6", f"PCX1 = 1.6\n{name} = 0.37"))
    unchanged = read(file.replace("PCX1 = 1.6", f"PCX1 = 1.6\n{name} = {AS_BEFORE[name]}"))
    assert name not in " ".join(unchanged.notes())


UNUSED = {
    "[MODEL]\nVXLOW = 1": "[MODEL] VXLOW",
    "[INERTIA]\nMASS = 9.3\nIYY = 0.8": "(the mass properties are those of the wheel's body): [INERTIA] MASS, [INERTIA] IYY",
    "[CONTACT_COEFFICIENTS]\nQTZ1 = 0.2": "(of the belt's couple, which needs MBELT too): [CONTACT_COEFFICIENTS] QTZ1",
    "[BOTTOMING_CURVE]\n{pen fz}\n0 0\n10 5": "table [BOTTOMING_CURVE]",
    "[OPERATING_CONDITIONS]\nINFLPRES = 2e5": "[OPERATING_CONDITIONS] INFLPRES",
    "[DIMENSION]\nRIM_RADIUS = 190": "[DIMENSION] RIM_RADIUS",
    "[STRUCTURAL]\nPCX1 = 7": "[STRUCTURAL] PCX1",
    "[TURNSLIP_COEFFICIENTS]\nPDXP1 = 0.4": "[TURNSLIP_COEFFICIENTS] PDXP1",
    "[SCALING_COEFFICIENTS]\nLAMU = 2": "[SCALING_COEFFICIENTS] LAMU",
    "[VERTICAL]\nQ_V2 = 0.04": "[VERTICAL] Q_V2",
}


@pytest.mark.parametrize("added", UNUSED)
def test_each_key_that_is_not_used_is_noted_with_its_section(read, added):
    assert UNUSED[added] in " ".join(read(f"{FILE}{added}\n").notes())


def test_the_belt_of_pac2002_has_its_mass_in_the_units_of_the_file(read):
    text = FILE.replace("MASS = 'kg'", "MASS = 'gram'")
    found = read(f"{text}[ALIGNING_COEFFICIENTS]\nQTZ1 = 0.2\nMBELT = 5400\n[SCALING_COEFFICIENTS]\nLGYR = 0.5\n")
    assert found.belt == pytest.approx(0.2 * 5.4 * 0.5)
    assert found.is_pac2002
    assert any("needs relaxation lengths" in note for note in found.notes())


def test_a_missing_nominal_pressure_is_noted(read):
    text = FILE.replace("LONGVL", "FITTYP = 62\nLONGVL")
    for added, pressure in (("", 2e5), ("[OPERATING_CONDITIONS]\nINFLPRES = 0.0003\n", 3e5)):
        found = read(text + added)
        assert found.coefficients["NOMPRES"] == pytest.approx(pressure)
        assert any("there is no NOMPRES" in note for note in found.notes())


def test_a_pressure_outside_its_range_is_noted(read):
    text = FILE.replace("LONGVL", "FITTYP = 61\nLONGVL")
    file = read(
        f"{text}[INFLATION_PRESSURE_RANGE]\nPRESMIN = 0.0001\nPRESMAX = 0.0005\n[OPERATING_CONDITIONS]\nNOMPRES = 0.0002\n"
    )
    assert list(MagicFormulaTyre(i="wheel", properties=file).own_notes()) == []
    (note,) = MagicFormulaTyre(i="wheel", properties=file, pressure="600 kPa").own_notes()
    assert "the pressure of 600000 Pa is outside the valid range of its data, 100000 to 500000 Pa" in note


def test_values_without_effect_are_not_noted(read):
    neutral = "[SCALING_COEFFICIENTS]\nLAMU = 1\nLGYR = 1.0\n[ALIGNING_COEFFICIENTS]\nQTZ1 = 0\n[MDI_HEADER]\nFILE_TYPE = 'tir'\n"
    assert list(read(FILE + neutral).notes()) == list(read(FILE).notes())


def test_sections_are_namespaces(read):
    """MASS is a unit in [UNITS] and a mass in [INERTIA], and a key counts in the section that it belongs to."""
    twice = read(
        f"{FILE}[INERTIA]\nMASS = 9.3\nFORCE = 7\n[OTHER]\nFNOMIN = 8\nPCX1 = 7\nUSE_MODE = 99\n[MODEL]\nUSE_MODE = 4\n"
    )
    assert twice.coefficients["FNOMIN"] == pytest.approx(4000)
    assert (twice.coefficients["PCX1"], twice.use_mode) == (1.6, 4)


def test_a_key_in_two_sections_that_it_does_not_belong_to_is_refused(read):
    moved = FILE.replace("[LATERAL_COEFFICIENTS]", "[LATERAL]")
    with pytest.raises(
        InputError, match=r"found PCY1 in \[MINE\] and in \[LATERAL\] \(line \d+\), expected it in one section"
    ):
        read(f"{moved}[MINE]\nPCY1 = 7\n")
    assert read(f"{moved}[MINE]\nPCY1 = 1.3\n").coefficients["PCY1"] == 1.3


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("PCX1 = 1.6", "PCX1 = 1.6x", "line 22: PCX1: found '1.6x', expected a number"),
        ("PCX1 = 1.6", "PCX1 =", "line 22: found no value after '='"),
        ("PCX1 = 1.6", "PKX1 = 1.6", "line 24: found PKX1 again, which line 22 has too"),
        ("PCX1 = 1.6", "", "found no PCX1, expected one"),
        ("PCX1 = 1.6", "PCX1 1.6", "line 22: found 'PCX1', expected a number"),
        ("LENGTH = 'mm'", "LENGTH = 'furlong'", "line 3: LENGTH: found the unit 'furlong'"),
        ("[MODEL]", "[MODEL", "line 8: found '[MODEL', expected a section"),
        ("'PAC2002'", "'FTIRE'", "line 9: found the format 'FTIRE', expected PAC2002"),
        ("FNOMIN = 4", "FNOMIN = -4", "found FNOMIN = -4000, expected a number above zero"),
        (FILE, "", "found no KEY = value"),
        ("LONGVL = 16700", "USE_MODE = 5", "line 10: found USE_MODE = 5, expected 0 to 4 for steady slip"),
        ("LONGVL = 16700", "TYRESIDE = 'TOP'", "line 10: found TYRESIDE = 'top', expected one of left, right"),
    ],
)
def test_faults_are_told_with_their_lines(read, old, new, said):
    with pytest.raises(InputError) as error:
        read(FILE.replace(old, new))
    assert said in str(error.value)
    assert "front.tir" in str(error.value)


SCENE = """
dimensions: 3
bodies: {wheel: {mass: 20, inertia: [1, 1, 1], position: [0, 0, 0.3]}}
forces: {tyre: {type: magic_formula_tyre, i: wheel, properties: front.tir}}
run: {duration: 1 ms}
"""


@pytest.mark.long
def test_a_scene_finds_the_file_beside_it(read, tmp_path):
    read(FILE)
    (tmp_path / "scene.yaml").write_text(SCENE)
    scene = load_scene(tmp_path / "scene.yaml")
    assert scene.forces["tyre"].properties.coefficients["FNOMIN"] == pytest.approx(4000)
    import stiffmbs

    solution = stiffmbs.run(scene)
    assert any(note.startswith("tyre: ") and "friction ellipse" in note for note in solution.notes)
    (tmp_path / "front.tir").unlink()
    with pytest.raises(InputError, match=r"forces.tyre.properties: .*front.tir: found no such file"):
        load_scene(tmp_path / "scene.yaml")


def test_units_are_those_of_scipy():
    length = {"in": constants.inch, "inch": constants.inch, **dict.fromkeys(("foot", "feet", "ft"), constants.foot)}
    force = {
        **dict.fromkeys(("kg_force", "kgf"), constants.kgf),
        **dict.fromkeys(("pound_force", "lbf"), constants.lbf),
    }
    mass = {
        "pound_mass": constants.pound,
        "slug": constants.slug,
        "tonne": constants.metric_ton,
        "gram": constants.gram,
    }
    for quantity, known in (("LENGTH", length), ("FORCE", force), ("MASS", mass)):
        assert {name: UNITS[quantity][name] for name in known} == pytest.approx(known, rel=1e-12)


IMPLAUSIBLE = {
    "LENGTH = 'mm'>LENGTH = 'meter'": r"line 12: found UNLOADED_RADIUS = 320, 320 m by \[UNITS\], expected 0.01 to 5 m",
    "FORCE = 'kN'>FORCE = 'newton'": r"line 20: found FNOMIN = 4, 4 N by \[UNITS\], expected 10 to 2e\+06 N",
    "FNOMIN = 4>FNOMIN = 4000": r"line 20: found FNOMIN = 4000, 4e\+06 N by",
    "STIFFNESS = 0.2>STIFFNESS = 200": r"line 18: found VERTICAL_STIFFNESS = 200, by which FNOMIN deflects the tyre by 2e-05 m",
    "STIFFNESS = 0.2>STIFFNESS = 0.01": r"deflects the tyre by 0.4 m, expected 0.00032 to 0.32 m",
    "DAMPING = 5D-4>DAMPING = -5D-4": "line 19: found VERTICAL_DAMPING = -5D-4, -500 N s/m by",
    "LONGVL = 16700>LONGVL = 0": "line 10: found LONGVL = 0, 0 m/s by",
    "LONGVL = 16700>LONGVL = 16.7": "found LONGVL = 16.7, 0.0167 m/s by",
    "PKY1 = -14>PKY1 = 14": "line 28: found PKY1 = 14, the cornering stiffness of SAE axes, expected the sign of ISO axes",
    "PKX1 = 21>PKX1 = -21": "line 24: found PKX1 = -21, expected a slip stiffness above zero",
}


@pytest.mark.parametrize("change", IMPLAUSIBLE)
def test_wrong_units_and_signs_are_refused_with_their_line(read, change):
    with pytest.raises(InputError, match=IMPLAUSIBLE[change]):
        read(FILE.replace(*change.split(">")))


def test_a_negative_peak_has_the_forces_of_a_positive_one(read):
    """D sin(C atan(B x)) with B = K/(C D) is even in D; Pacejka (2002), appendix 3, has p_Dy1 = -0.990."""
    usual, negative = (read(FILE.replace("PDY1 = 1.0", f"PDY1 = {peak}")) for peak in ("1.0", "-1.0"))
    slips = {"slip_angle": np.linspace(-0.2, 0.2, 9), "camber": 0.02}
    expected = usual.wrench(4e3, **slips)
    for name, values in negative.wrench(4e3, **slips).items():
        np.testing.assert_allclose(values, expected[name], rtol=1e-12, atol=1e-9, err_msg=name)


@pytest.mark.parametrize(
    ("name", "least", "most"), [("UNLOADED_RADIUS", 10, 5000), ("FNOMIN", 0.01, 2000), ("LONGVL", 100, 2e5)]
)
def test_the_ranges_of_plausible_numbers(read, name, least, most):
    """From tyres of models to those of aircraft; the stiffness gives a deflection of a sixteenth of the radius."""

    def changed(value):
        text = "\n".join(f"{name} = {value}" if line.startswith(name) else line for line in FILE.splitlines())
        numbers = {line.split(" = ")[0]: line.split(" = ")[1] for line in text.splitlines() if " = " in line}
        stiffness = 16 * float(numbers["FNOMIN"]) / float(numbers["UNLOADED_RADIUS"])
        return text.replace("VERTICAL_STIFFNESS = 0.2", f"VERTICAL_STIFFNESS = {stiffness}") + "\n"

    for inside in (1.1 * least, 0.9 * most):
        read(changed(inside))
    for outside in (0.9 * least, 1.1 * most):
        with pytest.raises(InputError, match=f"found {name} = "):
            read(changed(outside))


@pytest.mark.parametrize("pressure", ["2.4", "0.009e-3", "6"])
def test_an_inflation_pressure_in_other_units_is_refused(read, pressure):
    text = FILE.replace("LONGVL", "FITTYP = 61\nLONGVL") + "[OPERATING_CONDITIONS]\nNOMPRES = 0.00024\n"
    with pytest.raises(InputError, match=r"found INFLPRES = .*Pa by \[UNITS\], expected 10000 to 5e\+06 Pa"):
        read(f"{text}INFLPRES = {pressure}\n")
    assert read(f"{text}INFLPRES = 0\n").nominal_pressure == pytest.approx(2.4e5)
    tyre = read(text)
    for value in (230.0, 9e3, 6e6):
        with pytest.raises(InputError, match=r"pressure: found .* Pa, expected 10000 to 5e\+06 Pa"):
            MagicFormulaTyre(i="wheel", properties=tyre, pressure=value)


@pytest.mark.parametrize(
    ("unit", "angle", "narrow"),
    [("degree", "0.6", True), ("degree", "1.9", True), ("degree", "2.1", False), ("rad", "0.6", False)],
)
def test_radians_read_as_degrees_are_noted(read, unit, angle, narrow):
    limits = f"[SLIP_ANGLE_RANGE]\nALPMIN = -{angle}\nALPMAX = {angle}\n"
    notes = " ".join(read(FILE.replace("'degree'", f"'{unit}'") + limits).notes())
    for line, name, sign in ((32, "ALPMIN", "-"), (33, "ALPMAX", "")):
        assert (
            f"line {line}: {name} = {sign}{angle} is {sign}{angle} deg by [UNITS], a narrow range" in notes
        ) == narrow


def test_missing_sections_are_named(read):
    notes = " ".join(read(FILE).notes())
    assert "there are no [ALIGNING_COEFFICIENTS]: the aligning torque is zero" in notes and "[UNITS]" not in notes
    assert "ALIGNING" not in " ".join(read(f"{FILE}[ALIGNING_COEFFICIENTS]\nQDZ1 = 0.1\n").notes())
    si = FILE.partition("[MODEL]")[2].replace("16700", "16.7").replace("320", "0.32").replace("0.2\n", "2e5\n", 1)
    si = si.replace("FNOMIN = 4", "FNOMIN = 4000").replace("5D-4", "500")
    assert "there is no [UNITS]: numbers are taken as SI units" in " ".join(read(f"[MODEL]{si}").notes())
    start, _, end = FILE.partition("[VERTICAL]")
    with pytest.raises(InputError, match=r"found no FNOMIN, expected one in \[VERTICAL\]"):
        read(f"{start}[LONGITUDINAL_COEFFICIENTS]{end.partition('[LONGITUDINAL_COEFFICIENTS]')[2]}")


def test_a_key_without_a_value_that_no_formula_uses_is_noted_alone(tmp_path):
    """Any empty value stopped the file; one that a formula uses still does."""
    text = (EXAMPLES / "car.tir").read_text()
    file = tmp_path / "empty.tir"
    file.write_text(text.replace("[DIMENSION]", "[COMMENTS]\nAUTHOR =\nTYRESIZE =   $ not known\n[DIMENSION]"))
    found = TyreProperties.from_file(file)
    assert found.coefficients == TyreProperties.from_file(EXAMPLES / "car.tir").coefficients
    assert any("AUTHOR" in note and "TYRESIZE" in note for note in found.notes())
    file.write_text(text.replace("PKX2 = 0.5", "PKX2 ="))
    with pytest.raises(InputError, match=r"line 28: found no value after '=' of PKX2, expected a number"):
        TyreProperties.from_file(file)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("version", ["5.2", "6.2"])
def test_a_tyre_without_vertical_stiffness_has_its_forces_alone(tmp_path, version):
    file = tmp_path / "forces.tir"
    text = (
        (EXAMPLES / "car.tir")
        .read_text()
        .replace("PROPERTY_FILE_FORMAT = 'PAC2002'", f"FITTYP = {6 if version == '5.2' else 62}")
    )
    file.write_text(text)
    whole = TyreProperties.from_file(file)
    assert whole.version == version
    file.write_text(text.replace("VERTICAL_STIFFNESS = 220000\n", ""))
    found = TyreProperties.from_file(file)
    assert any("there is no VERTICAL_STIFFNESS" in note for note in found.notes())
    expected, forces = (each.steady_state([2000.0, 5000.0], 0.05, -0.04, 0.02) for each in (whole, found))
    for name in ("Fx", "Fy", "Mz", "Kxk", "Kya"):
        assert forces[name] == pytest.approx(expected[name], rel=1e-12)
    for name in ("rho", "Rl", "Re"):
        assert np.all(np.isnan(forces[name])), name
    with pytest.raises(InputError, match="found no VERTICAL_STIFFNESS, expected one: the load follows"):
        stiffmbs.read_scene(f"""
dimensions: 3
bodies: {{wheel: {{mass: 20, inertia: [1, 2, 1]}}}}
roads: {{flat: {{type: flat}}}}
forces: {{tyre: {{type: magic_formula_tyre, i: wheel, properties: {file}, road: flat}}}}
""")
    printed = CliRunner().invoke(main, ["tyre", str(file), "--json"])
    assert json.loads(printed.stdout)["curves"][0]["rho"] is None
