"""Files of tyre properties: units, notes, and clear errors with their lines."""

import pytest

from stiffmbs import InputError, load_scene
from stiffmbs.tyres import TyreProperties

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


@pytest.fixture
def read(tmp_path):
    def reader(text=FILE):
        (tmp_path / "front.tir").write_text(text)
        return TyreProperties.from_file(tmp_path / "front.tir")

    return reader


def test_numbers_have_the_units_of_the_file(read):
    found = read().coefficients
    assert found["UNLOADED_RADIUS"] == pytest.approx(0.32)
    assert found["VERTICAL_STIFFNESS"] == pytest.approx(2e5)
    assert found["VERTICAL_DAMPING"] == pytest.approx(500)
    assert (found["FNOMIN"], found["LONGVL"]) == pytest.approx((4000, 16.7))
    assert found["PKX1"] == 21


def test_unknown_keys_and_missing_weights_are_noted(read):
    notes = " ".join(read().notes())
    assert "OWN1" in notes
    assert "friction ellipse" in notes
    assert "FITTYP" not in notes
    later = " ".join(read(FILE.replace("PCX1 = 1.6", "PCX1 = 1.6\nFITTYP = 61")).notes())
    assert "line 23: FITTYP is that of a later Magic Formula" in later


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("PCX1 = 1.6", "PCX1 = 1.6x", "line 22: PCX1: found '1.6x', expected a number"),
        ("PCX1 = 1.6", "PCX1 =", "line 22: found nothing behind '='"),
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


def test_a_scene_finds_the_file_beside_it(read, tmp_path):
    read()
    (tmp_path / "scene.yaml").write_text(SCENE)
    scene = load_scene(tmp_path / "scene.yaml")
    assert scene.forces["tyre"].properties.coefficients["FNOMIN"] == pytest.approx(4000)
    import stiffmbs

    solution = stiffmbs.run(scene)
    assert any(note.startswith("tyre: ") and "friction ellipse" in note for note in solution.notes)
    (tmp_path / "front.tir").unlink()
    with pytest.raises(InputError, match=r"forces.tyre.properties: .*front.tir: found no such file"):
        load_scene(tmp_path / "scene.yaml")
