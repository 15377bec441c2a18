"""From the mesh of a part in a file of Abaqus to its largest stress in a mechanism, as docs/flexible.md describes."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from skfem import MeshHex
from skfem.io.meshio import to_meshio

import stiffmbs
from stiffmbs.commands.main import main

SCENE = """
name: Bracket
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  bracket:
    type: flexible
    mesh: bracket.inp
    units: {length: 1 mm}
    material: {E: 210 GPa, nu: 0.3, density: 7850 kg/m^3}
    interfaces: {foot: {group: BASE}, head: {group: TOP}}
    modes: 2
    damping: 0.05
  table: {mass: 5, inertia: [0.1, 0.1, 0.1]}
  motor: {mass: 0.8, inertia: [1e-3, 1e-3, 1e-3], position: [5 mm, 20 mm, HEIGHT]}
joints:
  slide: {type: fixed, i: table, j: ground}
  bolts: {type: fixed, i: bracket.foot, j: {body: table, point: [PLACE, 20 mm, 0]}}
  flange: {type: fixed, i: motor, j: bracket.head}
run: {duration: 2 ms, points: 21, solver: radau}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An L of two plates of hexahedra: the foot 60 mm x 40 mm x 6 mm, upright 10 mm x 40 mm x 80 mm."""
    foot = MeshHex.init_tensor(np.linspace(0, 60, 7), np.linspace(0, 40, 3), np.linspace(0, 6, 2))
    upright = MeshHex.init_tensor(np.linspace(0, 10, 2), np.linspace(0, 40, 3), np.linspace(6, 86, 5))
    mesh = to_meshio(foot + upright)
    points = np.round(mesh.points, 6)
    lines = ["*Heading", "*Node"]
    lines += [f"{k}, {x:g}, {y:g}, {z:g}" for k, (x, y, z) in enumerate(points, 1)]
    lines += ["*Element, type=C3D8"]
    lines += [f"{k}, {', '.join(str(n + 1) for n in cell)}" for k, cell in enumerate(mesh.cells_dict["hexahedron"], 1)]
    for name, height in (("BASE", 0), ("TOP", 86)):
        lines += [f"*Nset, nset={name}", *(str(n + 1) for n in np.flatnonzero(points[:, 2] == height))]
    path = tmp_path_factory.mktemp("bracket")
    (path / "bracket.inp").write_text("\n".join(lines) + "\n")
    for name, place, height in (("exact", "30 mm", "86 mm"), ("moved", "20 mm", "110 mm")):
        (path / f"{name}.yaml").write_text(SCENE.replace("PLACE", place).replace("HEIGHT", height))
    return path


@pytest.mark.long
def test_a_body_that_is_described_elsewhere_is_moved_without_deformation(folder):
    exact, moved = (stiffmbs.run(folder / f"{name}.yaml") for name in ("exact", "moved"))
    for axis in "xyz":
        assert abs(moved[f"bracket.modes1.{axis}"][0]) < 1e-10
        assert moved[f"bracket.modes1.{axis}"][-1] == pytest.approx(exact[f"bracket.modes1.{axis}"][-1], abs=1e-9)
    assert moved["bracket.frame.x"][0] - exact["bracket.frame.x"][0] == pytest.approx(-0.01, abs=1e-9)
    assert stiffmbs.check(folder / "moved.yaml").degrees_of_freedom == 8


@pytest.mark.long
def test_the_largest_stress_is_that_of_the_weights_on_the_upright(folder):
    """Both weights on a section of 40 mm x 10 mm; twice the static stress, as the run starts undeformed."""
    result = CliRunner().invoke(main, ["stresses", str(folder / "moved.yaml"), "bracket", "--json"])
    assert result.exit_code == 0, result.output
    peak = json.loads(result.output)["stress"]["von Mises"]
    static = (0.8 + 7850 * 0.08 * 0.04 * 0.01) * 9.81 / (0.04 * 0.01)
    assert static < peak["value"] < 4 * static
    assert peak["point"][0] <= 0.01
