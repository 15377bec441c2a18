"""Names have letters of any script, in formulas, parameters, channels and every file."""

import unicodedata
from zipfile import ZipFile

import numpy as np
import pytest

import stiffmbs
from stiffmbs.adams.export.dataset_text import written_dataset
from stiffmbs.adams.load import read_adams
from stiffmbs.errors import InputError
from stiffmbs.reading.ascii import in_ascii

SCENE = """
name: Kurbel Ä
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {Θ: 0.3, m_ä: 2 kg, länge: 1 m}
bodies:
  Kurbel_ä:
    mass: m_ä
    inertia: [0.1, 0.1, 0.1]
    position: [länge, 0, 0]
    markers: {Öse: {point: [-länge, 0, 0], orientation: {x: [1, 0, 0], z: [0, 1, 0]}}}
joints:
  Gelenk_ß: {type: revolute, i: Kurbel_ä.Öse, j: {body: ground, orientation: {x: [1, 0, 0], z: [0, 1, 0]}}}
states: {σ: {rate: "(Kurbel_ä.vz - σ)/Θ", start: 0}}
forces:
  Kraft_力: {type: force, i: Kurbel_ä, force: [0, 0, "Θ*sin(t) - 0.1*vz(Kurbel_ä) - 0.01*σ + 0.1*dm(Kurbel_ä.Öse, ground)"]}
requests: {φ: "Kurbel_ä.z + Θ"}
figure: {y: [φ]}
run: {duration: 0.2, points: 5}
"""
PLAIN = (
    SCENE.replace("Kurbel_ä", "crank").replace("Öse", "eye").replace("Gelenk_ß", "hinge").replace("Kraft_力", "push")
)
PLAIN = PLAIN.replace("länge", "L").replace("m_ä", "m0").replace("Θ", "theta").replace("σ", "lag").replace("φ", "f")


@pytest.fixture(scope="module")
def solution():
    return stiffmbs.run(stiffmbs.read_scene(SCENE))


@pytest.mark.long
def test_the_motion_is_that_of_plain_names(solution):
    plain = stiffmbs.run(stiffmbs.read_scene(PLAIN))
    np.testing.assert_array_equal(solution["φ"], plain["f"])
    np.testing.assert_array_equal(solution["Gelenk_ß.fz"], plain["hinge.fz"])


def test_letters_and_their_accents_may_be_two_characters(solution):
    """macOS writes them so."""
    found = stiffmbs.read_scene(unicodedata.normalize("NFD", SCENE))
    assert list(found.bodies) == ["Kurbel_ä"]
    np.testing.assert_array_equal(stiffmbs.run(found)["φ"], solution["φ"])


def test_parameters_have_an_effect(solution):
    other = stiffmbs.run(stiffmbs.read_scene(SCENE, [("Θ", "0.4")]))
    assert other["φ"][-1] - solution["φ"][-1] == pytest.approx(0.1, abs=5e-3)
    pytest.importorskip("xarray")
    swept = stiffmbs.sweep(stiffmbs.read_scene(SCENE), {"Θ": [0.3, 0.4]}, outputs=["final(φ)"])
    np.testing.assert_allclose(swept["final(φ)"], [solution["φ"][-1], other["φ"][-1]], rtol=1e-12)


@pytest.mark.parametrize("ending", ["npz", "csv", "nc", "tab", "res"])
def test_files_have_these_names(solution, tmp_path, ending):
    if ending == "nc":
        pytest.importorskip("xarray")
    path = tmp_path / f"out.{ending}"
    solution.save(path)
    if ending in ("npz", "csv", "nc"):
        state = stiffmbs.read_state(path)
        assert all(state.channels[name] == solution[name][-1] for name in solution)
        again = stiffmbs.run(stiffmbs.read_scene(SCENE), start_from=state, duration=0.01)
        assert again["Kurbel_ä.z"][0] == pytest.approx(solution["Kurbel_ä.z"][-1], abs=1e-12)
    if ending != "nc":
        assert max(one.largest for one in stiffmbs.differences(solution, path)) == 0


def test_tables_of_studies_have_these_names(tmp_path):
    xarray = pytest.importorskip("xarray")
    from stiffmbs.studies.data_set import write

    write(tmp_path / "out.nc", stiffmbs.sweep(stiffmbs.read_scene(SCENE), {"Θ": [0.3, 0.4]}, outputs=["final(φ)"]))
    found = xarray.load_dataset(tmp_path / "out.nc")
    assert found["Theta"].attrs["long_name"] == "Θ" and found["final(phi)"].attrs["long_name"] == "final(φ)"


@pytest.mark.long
def test_datasets_are_in_ascii():
    found = written_dataset(stiffmbs.read_scene(SCENE))
    assert found.text.isascii() and found.commands.isascii() and "ASCII" in found.notes[-1]
    assert "adams_view_name='Kurbel_a'" in found.text and "adams_view_name='phi'" in found.text
    again = stiffmbs.run(read_adams(found.text), duration=0.2, points=5)
    np.testing.assert_allclose(again["REQUEST_1.f2"], stiffmbs.run(stiffmbs.read_scene(SCENE))["φ"], atol=1e-5)


def test_fmus_have_these_names(tmp_path):
    pytest.importorskip("pythonfmu")
    (tmp_path / "Kurbel_ä.yaml").write_text(SCENE, encoding="utf-8")
    assert stiffmbs.build_fmu(tmp_path / "Kurbel_ä.yaml", tmp_path / "out.fmu") == ("φ",)
    with ZipFile(tmp_path / "out.fmu") as archive:
        described = archive.read("modelDescription.xml").decode("utf-8")
    assert 'name="φ"' in described and 'name="Θ"' in described


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("µ", "write 'μ'"),
        ("ﬁ", "write 'fi'"),
        ("x²", "write 'x2'"),
        ("٣a", ""),
        ("a-b", ""),
        ("a b", ""),
        ("", ""),
        ("é\u200b", ""),
    ],
)
def test_names_that_formulas_would_not_find_are_refused(name, hint):
    with pytest.raises(InputError, match=f"expected letters, digits and _.*{hint}"):
        stiffmbs.read_scene(f"bodies: {{'{name}': {{mass: 1, inertia: 1}}}}")
    with pytest.raises(InputError, match=f"expected letters, digits and _.*{hint}"):
        stiffmbs.read_scene(f"parameters: {{'{name}': 1}}\nbodies: {{b: {{mass: 1, inertia: 1}}}}")


@pytest.mark.parametrize(
    ("text", "plain"),
    [("Kurbel_ä", "Kurbel_a"), ("ΘΩ", "ThetaOmega"), ("Ж", "Zhe"), ("ß", "ss"), ("力", "u529b"), ("a.b", "a.b")],
)
def test_other_letters_have_words_in_ascii(text, plain):
    assert in_ascii(text) == plain


def test_a_star_import_keeps_the_built_in_open():
    names: dict[str, object] = {}
    exec("from stiffmbs import *", names)
    assert "open" not in names and names["run"] is stiffmbs.run and callable(stiffmbs.open)
