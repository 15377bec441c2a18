"""Property files in the styles of programs and suppliers: each is read as the tyre that it describes, or refused in one sentence."""

import math

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.tyres import TyreProperties

NUMBERS = {
    "FNOMIN": 4000.0, "UNLOADED_RADIUS": 0.32, "VERTICAL_STIFFNESS": 2e5, "VERTICAL_DAMPING": 50.0, "LONGVL": 16.6, "PCX1": 1.6,
    "PDX1": 1.1, "PDX2": -0.08, "PKX1": 21.0, "PKX3": 0.2, "RBX1": 12.0, "RBX2": -9.0, "RCX1": 1.05, "PCY1": 1.3, "PDY1": 1.0,
    "PEY1": -0.8, "PKY1": -14.0, "PKY2": 1.8, "RBY1": 7.0, "RCY1": 1.05, "QBZ1": 10.0, "QCZ1": 1.1, "QDZ1": 0.1, "QSY1": 0.01,
}  # fmt: skip
"""The tyre of the files of the Magic Formula."""
FIALA = {
    "UNLOADED_RADIUS": 0.3099, "WIDTH": 0.235, "VERTICAL_STIFFNESS": 3.1e5, "VERTICAL_DAMPING": 3100.0, "ROLLING_RESISTANCE": 0.002,
    "CSLIP": 60000.0, "CALPHA": 800 * 180 / math.pi, "UMIN": 0.9, "UMAX": 1.0,
}  # fmt: skip
"""The tyre of the files of Adams' Fiala model."""
SECTIONS = {
    "DIMENSION": "UNLOADED_RADIUS", "VERTICAL": "VERTICAL_STIFFNESS VERTICAL_DAMPING FNOMIN",
    "LONGITUDINAL_COEFFICIENTS": "PCX1 PDX1 PDX2 PKX1 PKX3 RBX1 RBX2 RCX1", "LATERAL_COEFFICIENTS": "PCY1 PDY1 PEY1 PKY1 PKY2 RBY1 RCY1",
    "ROLLING_COEFFICIENTS": "QSY1", "ALIGNING_COEFFICIENTS": "QBZ1 QCZ1 QDZ1",
}  # fmt: skip
UNITS = "[UNITS]\nLENGTH = 'meter'\nFORCE = 'newton'\nANGLE = 'radians'\nMASS = 'kg'\nTIME = 'second'\n"


def body(shown=repr, line="{} = {}", after=""):
    """The sections of coefficients, each number as `shown`, each key and value as `line`."""
    return "".join(
        f"[{section}]{after}\n" + "".join(line.format(name, shown(NUMBERS[name])) + "\n" for name in names.split())
        for section, names in SECTIONS.items()
    )


ADAMS_FIALA = """$---------------------------------------------------------------------MDI_HEADER
[MDI_HEADER]
 FILE_TYPE     =  'tir'
 FILE_VERSION  =  2.0
 FILE_FORMAT   =  'ASCII'
(COMMENTS)
{comment_string}
'Tire - made up, driver's side'
'Pressure - 2.0 bar'

$--------------------------------------------------------------------------units
[UNITS]
 LENGTH = 'mm'
 FORCE  = 'newton'
 ANGLE  = 'degree'
 MASS   = 'kg'
 TIME   = 'sec'
[MODEL]
! use mode  12 11 2 1
 PROPERTY_FILE_FORMAT  = 'FIALA'
 FUNCTION_NAME         = 'TYR902'
 USE_MODE              = 2.0
[DIMENSION]
 UNLOADED_RADIUS = 309.9
 WIDTH           = 235.0
 ASPECT_RATIO    = 0.45
[PARAMETER]
 VERTICAL_STIFFNESS = 310.0
 VERTICAL_DAMPING   = 3.1
 ROLLING_RESISTANCE = 2.0
 CSLIP  = 60000.0
 CALPHA = 800.0
 CGAMMA = 0.0
 UMIN   = 0.9
 UMAX   = 1.0
 RELAX_LENGTH_X = 0.05
 RELAX_LENGTH_Y = 0.15
[SHAPE]
{radial width}
 1.0    0.0
 0.9    1.0
"""
INCHES = f"""! lower case, no spaces
[units]
length='inch'
force='pound_force'
angle='degrees'
mass='slug'
time='sec'
[model]
property_file_format='fiala'
use_mode=1
[dimension]
unloaded_radius={0.3099 / 0.0254!r}
width={0.235 / 0.0254!r}
[parameter]
vertical_stiffness={3.1e5 * 0.0254 / 4.4482216152605!r}
vertical_damping={3100 * 0.0254 / 4.4482216152605!r}
rolling_resistance={0.002 / 0.0254!r}
cslip={60000 / 4.4482216152605!r}
calpha={800 / 4.4482216152605!r}
umin=.9
umax=1.
"""  # fmt: skip


def fortran(x):
    """1600.0 as +.160000D+04."""
    digits = math.floor(math.log10(abs(x))) + 1
    return f"{'-' if x < 0 else '+'}{abs(x) / 10.0**digits:.12f}D{digits:+03d}".replace("0.", ".")


def plain(x):
    """Shortest form: 16. and 1.E+05."""
    return f"{x:.0f}." if x == int(x) and abs(x) < 1e4 else f"{x / 1e5:.0f}.E+05" if x == 2e5 else repr(x)


FILES = {
    "5.2 of Windows, Latin-1": "! Reifen der Größe 205/55 R16 § 3\n" + UNITS + "[MODEL]\nFITTYP = 6  $ Prüfstand\nLONGVL = 16.6\n" + body(),
    "5.2 of Fortran": UNITS + "[MODEL]\nFITTYP = 5\nLONGVL = +.166D+02\n" + body(fortran, "{:20}={}"),
    "5.2 with blanks, tabs, comments": "$---\n\n" + UNITS + "\n[MODEL]\t! model\nPROPERTY_FILE_FORMAT\t=\t'MF_05'\nLONGVL=16.6$speed\n"
    + body(plain, "  {}\t=\t{}   $ typarr( 15)", "   $ section"),
    "5.2 in lower case, unquoted": (UNITS.replace("'", "") + "[MODEL]\nPROPERTY_FILE_FORMAT = MF-TYRE\nLONGVL = 16.6\n" + body()).lower(),
    "5.2 with a rim and an end": UNITS + "[MODEL]\nFITTYP = 52\nLONGVL = 16.6\n" + body()
    + "[DIMENSION]\nBOTTOMING_RADIUS = 0.2\n[BOTTOMING_CURVE]\n{pen fz}\n0, 0\n0.01, 9000\n$----\n[END]\n\x1a",
    "PAC2002 with tables": UNITS + "[MODEL]\nPROPERTY_FILE_FORMAT = 'PAC2002'\nLONGVL = 16.6\n" + body()
    + "[SHAPE]\n{radial width}\n 1.0 0.0\n 0.9 1.0\n[LOADED_RADIUS_CURVE]\n{fz rl}\n0 0.32\n4000 0.30\n",
    "PAC2002 with a pressure in bar": UNITS + "PRESSURE = 'bar'\n[MODEL]\nPROPERTY_FILE_FORMAT = 'PAC2002'\nLONGVL = 16.6\n" + body()
    + "PPX1 = -0.4\n[TIRE_CONDITIONS]\nIP = 2.0\nIP_NOM = 2.0\n",
    "PAC2002 with repeated keys": UNITS.replace("'", '"') + '[MODEL]\nPROPERTY_FILE_FORMAT = "PAC2002"\nLONGVL = 16.6\n'
    + body(line="{0} = {1}\n{0} = {1} ! again"),
    "6.1 of MF-Tyre": "[MDI_HEADER]\nFILE_TYPE ='tir'\n! : TIRE_VERSION :  MF61\n! : [SIDE] :  left\n\n" + UNITS
    + "[MODEL]\nFITTYP                   = 61                       $Magic Formula Version number\nUSE_MODE = 4\nLONGVL = 16.6\n"
    + "[OPERATING_CONDITIONS]\nINFLPRES = 220000\nNOMPRES = 220000\n" + body(line="{:25}= {:>12}         $text"),
    "6.1 without units": "[MODEL]\nFITTYP = 61.0\nUSE_MODE = 104\nLONGVL = 16.6\n" + body(),
    "6.2 with other comments": "# exported\n" + UNITS.replace("meter", "Meters").replace("newton", "Newtons")
    + "[MODEL]\nFITTYP = 62 # six\nLONGVL = 16.6\n[OPERATING_CONDITIONS]\nNOMPRES = 220000.\n" + body(line="{} = {} # number"),
    "6.2 in UTF-16": UNITS + "[MODEL]\nPROPERTY_FILE_FORMAT = 'MF_62'\nLONGVL = 16.6\n" + body(),
    "Fiala of Adams": ADAMS_FIALA,
    "Fiala in inches": INCHES,
}  # fmt: skip
ENCODINGS = {"5.2 of Windows, Latin-1": "latin-1", "6.2 in UTF-16": "utf-16"}


@pytest.mark.sampled(9)
@pytest.mark.parametrize("ends", ["\n", "\r\n"], ids=["LF", "CRLF"])
@pytest.mark.parametrize("name", FILES)
def test_each_file_is_read_as_the_same_tyre(read, name, ends):
    tyre = read(FILES[name].replace("\n", ends), ENCODINGS.get(name, "utf-8"))
    version = name.split()[0].replace("PAC2002", "5.2")
    numbers = FIALA if version == "Fiala" else NUMBERS
    expected = TyreProperties(coefficients=numbers, version=version)
    assert tyre.version == version
    assert {key: tyre.coefficients[key] for key in numbers} == pytest.approx(numbers, rel=1e-12)
    state = {
        "Fz": np.linspace(0, 8000, 9)[:, None],
        "kappa": 0.03,
        "alpha": np.linspace(-0.2, 0.2, 7),
        "gamma": 0.03,
        "Vx": 20.0,
    }
    found, reference = tyre.steady_state(**state), expected.steady_state(**state)
    assert np.all(np.isfinite([found["sigma_x"], found["sigma_y"]]))
    for column in ("Fx", "Fy", "Mx", "My", "Mz", "Re"):
        np.testing.assert_allclose(
            found[column], reference[column], rtol=1e-9, atol=1e-9, err_msg=column, equal_nan=False
        )


NOTED = {
    "PAC2002 with tables": ["not used: table [SHAPE], table [LOADED_RADIUS_CURVE]"],
    "6.1 without units": ["there is no [UNITS]", "USE_MODE = 104 asks for contact method 1", "there is no NOMPRES"],
    "Fiala of Adams": [
        "[MODEL] FUNCTION_NAME, [DIMENSION] ASPECT_RATIO, table [SHAPE]",
        "RELAX_LENGTH_Y = 0.15 is 0.00015 m",
    ],
    "Fiala in inches": [],
    "PAC2002 with a pressure in bar": [],
    "PAC2002 with repeated keys": [],
}


@pytest.mark.parametrize("name", NOTED)
def test_what_is_not_used_is_noted(read, name):
    notes = " ".join(read(FILES[name]).notes())
    assert all(words in notes for words in NOTED[name])
    assert bool(notes) == bool(NOTED[name])


BAD = {
    "PDX1 = 1.1>PDX1 = 1,1": "line 17: PDX1: found '1,1', expected a number",
    "PDX1 = 1.1>PDX1 = 1.1\nPDX1 = 1.2": "line 18: found PDX1 again, which line 17 has too, expected it once",
    "FITTYP = 5>FITTYP = 5   version": "line 8: found FITTYP = 5   VERSION, expected that of MF-Tyre",
    "FNOMIN = 4000.0>FNOMIN = 4000.0 // nominal": "FNOMIN: found '4000.0 // nominal', expected a number",
    "FNOMIN = 4000.0>'FNOMIN' = '4000.0'": "line 14: found ''FNOMIN'', expected a number",
    "[MODEL]>** a comment": "line 7: found '**', expected a number",
    "FITTYP = 5>PROPERTY_FILE_FORMAT = 'SWIFT'": "found the format 'SWIFT', expected PAC2002, MF-Tyre or Fiala",
    "LENGTH = 'meter'>LENGTH = 'metros'": "line 2: LENGTH: found the unit 'metros', expected one of",
}


@pytest.mark.parametrize("change", BAD)
def test_bad_lines_are_refused_in_one_sentence(read, change):
    old, new = change.split(">")
    text = UNITS + "[MODEL]\nFITTYP = 5\n" + body()
    assert old in text
    with pytest.raises(InputError) as error:
        read(text.replace(old, new))
    assert BAD[change] in str(error.value)
    assert "\n" not in str(error.value)
