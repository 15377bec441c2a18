"""Shells of second order: their division, convergence on curved and flat surfaces, and files."""

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.areas import unit_loads
from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.mesh import from_mesh

from ..bars import STEEL, with_middles
from .meshes import places, surface, under

KINDS = "triangle6", "quad8", "quad9"


def curved(count, kind, place):
    """Return a mesh at a function of two numbers from 0 to 1, with nodes on curved edges."""
    linear = kind.rstrip("0123456789")
    flat, cells, _ = surface(count, count, lambda a, b: (a, b, 0), linear)
    mesh = with_middles(flat, linear, cells[linear], kind)
    mesh.points = np.array([place(a, b) for a, b, _ in mesh.points])
    return mesh


def model(folder, mesh, E, nu, thickness):
    mesh.write(folder / "a.vtu")
    return from_mesh(folder / "a.vtu", 1.0, Material(E=E, nu=nu, density=1.0), thickness=thickness)


@pytest.mark.parametrize(("kind", "error"), [("triangle6", 0.02), ("quad8", 0.015), ("quad9", 0.006)])
def test_a_clamped_plate_under_pressure(tmp_path, kind, error):
    """S. P. Timoshenko, S. Woinowsky-Krieger, Theory of plates and shells (1959), table 35: 0.00126 p a^4 / D in the middle."""
    found = model(tmp_path, curved(8, kind, lambda a, b: (a, b, 0)), 1e9, 0.3, 2e-3)
    x, y, _ = found.nodes.T
    edge = np.flatnonzero((np.minimum(x, 1 - x) < 1e-9) | (np.minimum(y, 1 - y) < 1e-9))
    load = -unit_loads(found, np.arange(len(x)), np.array([0.0, 0.0, 1.0]), 1.0)[:, 0]
    middle = np.flatnonzero((np.abs(x - 0.5) < 1e-9) & (np.abs(y - 0.5) < 1e-9))
    moved = under(found.stiffness, places(edge, range(6)), load)[middle, 2].item()
    bending = 1e9 * 8e-9 / (12 * (1 - 0.09))
    assert moved * bending == pytest.approx(0.0012653, rel=error)


@pytest.mark.parametrize("kind", KINDS)
def test_the_roof_of_scordelis_and_lo(tmp_path, kind):
    """R. H. MacNeal, R. L. Harder, A proposed standard set of problems, Finite Elem. Anal. Des. 1 (1985): 0.3024 at the middle of the free edge."""

    def place(a, b):
        angle = np.radians(40) * b
        return 25 * a, 25 * np.sin(angle), 25 * np.cos(angle)

    found = model(tmp_path, curved(8, kind, place), 4.32e8, 0.0, 0.25)
    x, y, _ = found.nodes.T
    held = np.concatenate([
        places(np.flatnonzero(x < 1e-9), [0, 4, 5]), places(np.flatnonzero(x > 25 - 1e-9), [1, 2]),
        places(np.flatnonzero(y < 1e-9), [1, 3, 5]),
    ])  # fmt: skip
    areas = np.zeros(len(x))
    for cells in found.shell_cells.values():
        for triangle in (
            cells if cells.shape[1] == 3 else np.vstack([cells[:, list(three)] for three in ((0, 1, 2), (0, 2, 3))])
        ):
            one, two, three = found.nodes[triangle]
            areas[triangle] += np.linalg.norm(np.cross(two - one, three - one)) / 6
    forces = np.zeros((len(x), 6))
    forces[:, 2] = -90 * areas
    end = np.flatnonzero((x < 1e-9) & (np.abs(y - 25 * np.sin(np.radians(40))) < 1e-6))
    assert -under(found.stiffness, held, forces.ravel())[end, 2].item() == pytest.approx(0.3024, rel=0.015)


@pytest.mark.parametrize("kind", ["triangle6", "quad8"])
def test_parts_of_an_element_are_in_its_groups(tmp_path, kind):
    mesh = curved(2, kind, lambda a, b: (a, b, 0))
    count = len(mesh.cells[0].data)
    mesh.cell_sets = {"left": [np.arange(count // 2)], "right": [np.arange(count // 2, count)]}
    mesh.point_sets = {"first": np.array([0, 1])}
    mesh.write(tmp_path / "a.inp")
    thick = from_mesh(tmp_path / "a.inp", 1.0, STEEL, thickness={"left": 1e-3, "right": 2e-3})
    assert thick.mass[::6, ::6].sum() == pytest.approx(7850 * 1.5e-3)
    assert thick.groups["first"].tolist() == [0, 1]
    assert len(thick.nodes) == len(mesh.points)


def nastran(card, nodes, more=""):
    grids = "".join(f"GRID,{k + 1},,{x},{y},0.\n" for k, (x, y) in enumerate(nodes))
    return f"BEGIN BULK\nPSHELL,1,1,1.\n{grids}{card}{more}\nENDDATA\n"


TRIANGLE = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)]
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)]
CURVED = {
    "CTRIA6": (TRIANGLE, "CTRIA6,1,1,1,2,3,4,5,6,+\n+", 0.5, ",30.,{offset},,{thick}"),
    "CQUAD8": (SQUARE, "CQUAD8,1,1,1,2,3,4,5,6,+\n+,7,8", 1.0, ",,{thick},,,30.,{offset}"),
}


@pytest.mark.parametrize("card", CURVED)
def test_curved_shells_of_nastran(tmp_path, card):
    nodes, line, area, more = CURVED[card]
    path = tmp_path / "a.bdf"
    path.write_text(nastran(line, nodes, more.format(offset="", thick="")))
    found = from_mesh(path, 1.0, STEEL, thickness=1e-3)
    assert found.mass[::6, ::6].sum() == pytest.approx(7850 * 1e-3 * area)
    assert "PSHELL" in found.unused
    for given, message in (
        ({"offset": "0.1", "thick": ""}, "1 with an offset of 0.1"),
        ({"offset": "", "thick": "2."}, "thicknesses at its nodes"),
    ):
        path.write_text(nastran(line, nodes, more.format(**given)))
        with pytest.raises(InputError, match=message):
            from_mesh(path, 1.0, STEEL, thickness=1e-3)
    path.write_text(nastran(line.replace(",4,", ",,"), nodes))
    with pytest.raises(InputError, match="without a node on each edge"):
        from_mesh(path, 1.0, STEEL, thickness=1e-3)


@pytest.mark.parametrize(
    ("name", "kind"), [("S6", "triangle6"), ("S8", "quad8"), ("S8R", "quad8"), ("STRI65", "triangle6")]
)
def test_curved_shells_of_abaqus_and_calculix(tmp_path, name, kind):
    nodes, area = (TRIANGLE, 0.5) if kind == "triangle6" else (SQUARE, 1.0)
    listed = "".join(f"{k + 1}, {x}, {y}, 0.\n" for k, (x, y) in enumerate(nodes))
    numbers = ", ".join(str(k + 1) for k in range(len(nodes)))
    (tmp_path / "a.inp").write_text(f"*Node\n{listed}*Element, type={name}\n1, {numbers}\n")
    found = from_mesh(tmp_path / "a.inp", 1.0, STEEL, thickness=1e-3)
    assert found.mass[::6, ::6].sum() == pytest.approx(7850 * 1e-3 * area)
    assert found.components == 6
