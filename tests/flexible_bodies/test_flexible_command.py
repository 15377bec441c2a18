"""The command ``stiffmbs flexible``: report, JSON, mode shapes, cache, and one sentence for each mistake."""

import json

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.flexible_bodies.read import read_flexible_body
from stiffmbs.flexible_bodies.reduced import reduced_body

from .bars import LENGTH, MASS, mesh_of_bar

BODY = """
mesh: bar.vtu
units: {length: 1 mm}
material: {E: 210 GPa, nu: 0.3, density: 7850 kg/m^3}
interfaces:
  pin: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}
  end: {sphere: {center: [400 mm, 15 mm, 10 mm], radius: 30 mm}, type: average}
modes: 6
mass: 1.88 kg
"""


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh_of_bar("tetra10").write("bar.vtu")
    (tmp_path / "bar.yaml").write_text(BODY)
    return tmp_path


def stiffmbs(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_the_report_has_mass_frequencies_and_quality(in_folder):
    result = stiffmbs("flexible", "bar.yaml", "--hold", "pin")
    assert result.exit_code == 0
    for part in ("1.884 kg", "pin: point and rotation", "six frequencies", "(pin held)", "effective", "condition"):
        assert part in result.output


def test_json_is_one_object_on_one_line(in_folder):
    result = stiffmbs("flexible", "bar.yaml", "--json", "--hold", "pin", "--hold", "pin,end")
    report = json.loads(result.output)
    assert result.output.count("\n") == 1
    assert report["mass"] == pytest.approx(MASS)
    assert len(report["fixed_frequencies"]) == 6
    assert report["interfaces"]["pin"] == pytest.approx([0, 0.015, 0.01])
    np.testing.assert_allclose(report["held_frequencies"]["pin,end held"], report["fixed_frequencies"], rtol=1e-6)


def test_the_cache_returns_the_same_body_until_its_mesh_changes(in_folder):
    body = read_flexible_body("bar.yaml")
    first, again = reduced_body(body, in_folder), reduced_body(body, in_folder)
    np.testing.assert_array_equal(first.modes, again.modes)
    mesh_of_bar("tetra10", along=6).write("bar.vtu")
    assert len(reduced_body(body, in_folder).modes) != len(first.modes)


def test_mode_shapes_are_written_for_paraview(in_folder):
    assert stiffmbs("flexible", "bar.yaml", "-o", "shapes.vtu").exit_code == 0
    shapes = meshio.read("shapes.vtu")
    assert "tetra10" in shapes.cells_dict
    assert sum(name.startswith("mode") for name in shapes.point_data) == 12
    assert shapes.points[:, 0].max() == pytest.approx(LENGTH)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("foo=1", "bar.yaml: found the unknown key 'foo'"),
        ("mesh=no.msh", "no.msh: found no such file"),
        ("modes=-1", "modes: found -1, expected a number of modes"),
        ("modes=5000", "modes: found 5000, expected .* or fewer"),
        ("modes={up_to: 600 rpm}", "expected a frequency in Hz"),
        ("units.length=1 kg", "units.length: found '1 kg'"),
        (
            "units.length=inch",
            "mass: found .* kg by the density and volume in these units, expected the stated 1.88 kg",
        ),
        ("material.nu=0.5", "material.nu: found 0.5, expected a Poisson's ratio"),
        ("interfaces.pin.group=x", "interfaces.pin: found group and plane of nodes, group, sphere and plane"),
        ("interfaces.pin={group: x}", "interfaces.pin.group: found no group 'x'"),
        ("interfaces.pin={nodes: [99999]}", "interfaces.pin.nodes: found node 99999"),
        ("interfaces.pin={nodes: [3]}", "interfaces.pin: found 1 node, expected three or more"),
        ("matrices=bar.npz", "found both of 'mesh' and 'matrices'"),
    ],
)
def test_each_mistake_is_one_sentence(in_folder, change, message):
    import re

    result = stiffmbs("flexible", "bar.yaml", "--set", change)
    assert result.exit_code == 2
    assert re.search(message, result.output)
    assert result.output.count("\n") == 1


def test_unknown_interfaces_and_suffixes_are_refused(in_folder):
    assert "--hold pim: found no such interface" in stiffmbs("flexible", "bar.yaml", "--hold", "pim").output
    assert "expected .vtu or .vtk" in stiffmbs("flexible", "bar.yaml", "-o", "x.png").output
