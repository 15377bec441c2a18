"""Statements of Nastran and Abaqus files besides nodes and elements: sets, supports, coordinate systems, instances."""

import contextlib
import signal
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from meshio._helpers import extension_to_filetypes

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.mesh import _as_vtk, _read, from_mesh
from stiffmbs.flexible_bodies.mesh_files import for_reader
from stiffmbs.flexible_bodies.reduction import reduce
from stiffmbs.flexible_bodies.shapes import ELEMENTS as KINDS
from tests.flexible_bodies.bars import STEEL, mesh_of_bar

POINTS = [(x, y, z) for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)]
ELEMENTS = [(1, 5, 7, 3, 2, 6, 8, 4), (5, 9, 11, 7, 6, 10, 12, 8)]
NODES = "".join(f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(POINTS))
ABAQUS = f"*Node\n{NODES}*Element, type=C3D8R, elset=body\n" + "".join(
    f"{k + 1}, {', '.join(map(str, nodes))}\n" for k, nodes in enumerate(ELEMENTS)
)


def nastran(system="", more=""):
    grids = "".join(f"GRID,{k + 1},{system},{x}.,{y}.,{z}.\n" for k, (x, y, z) in enumerate(POINTS))
    cells = "".join(f"CHEXA,{k + 1},1,{','.join(map(str, n[:6]))},+\n+,{n[6]},{n[7]}\n" for k, n in enumerate(ELEMENTS))
    return f"SOL 103\nCEND\nBEGIN BULK\nPSOLID,1,1\n{grids}{cells}{more}ENDDATA\n"


def read(path, text):
    path.write_text(text)
    return from_mesh(path, 1.0, STEEL)


def test_supports_and_rigid_elements_are_left_out(tmp_path):
    more = "GRID,100,,3.,.5,.5\nRBE2,50,100,123456,9,10,11,12\nSPC1,1,123456,1,2,3,4\n"
    found = read(tmp_path / "a.bdf", nastran(more=more))
    assert len(found.nodes) == 12
    assert found.mass.sum() / 3 == pytest.approx(2 * 7850)


def test_sets_of_nodes_elements_and_sets(tmp_path):
    text = (
        ABAQUS + "*Nset, nset=start, generate\n1, 4, 1\n*Nset, nset=end\n9, 10,\n11, 12\n*Nset, nset=ends\nstart, end\n"
    )
    groups = read(tmp_path / "a.inp", text + "*Elset, elset=first\n1\n").groups
    wanted = {"start": range(4), "end": range(8, 12), "ends": [*range(4), *range(8, 12)], "first": range(8)}
    assert {name: groups[name].tolist() for name in wanted} == {name: list(nodes) for name, nodes in wanted.items()}


def test_files_of_gmsh(tmp_path):
    """Bulk data of Nastran alone; elements of a surface that meshio does not know, which form a group."""
    _, _, bulk = nastran().partition("BEGIN BULK\n")
    assert len(read(tmp_path / "a.bdf", bulk).nodes) == 12
    nodes = "".join(f"{k}, {k}., 5., 0.\n" for k in (13, 14))
    surface = "*ELEMENT, type=CPS6, ELSET=side\n9, 1, 2, 3, 4, 13, 14\n"
    found = read(tmp_path / "a.inp", ABAQUS.replace("*Element", nodes + "*Element", 1) + surface)
    assert found.groups["side"].tolist() == [0, 1, 2, 3]
    assert len(found.nodes) == 12
    assert for_reader(tmp_path / "a.inp")[0].name == str(tmp_path / "a.inp")  # the folder of included files


def test_the_type_of_an_unknown_element_is_named(tmp_path):
    with pytest.raises(InputError, match="Element type not available: CAX8"):
        read(tmp_path / "a.inp", ABAQUS + "*ELEMENT, type=CAX8\n9, 1, 2, 3, 4, 5, 6, 7, 8\n")


@pytest.mark.parametrize(("name", "text", "message"), [
    ("a.bdf", nastran("7", "CORD2R,7,0,0.,0.,0.,0.,0.,1.,+\n+,0.,1.,0.\n"), "found GRID 1 in the coordinate system 7"),
    ("a.bdf", nastran(more="GRDSET,,7\n"), "found GRDSET"),
    ("a.bdf", nastran(more="CONM2,9,1,,5.\n"), "found CONM2, a mass besides the elements"),
    ("a.inp", "*System\n5., 0., 0.\n" + ABAQUS, r"found '\*System'"),
    ("a.inp", ABAQUS.replace("*Node", "*Node, system=C"), r"found '\*Node, system=C'"),
    ("a.inp", ABAQUS + "*Instance, name=i, part=p\n10., 0., 0.\n*End Instance\n", "an instance moved by 10., 0., 0."),
    ("a.inp", ABAQUS + "*Instance, name=i\n*End Instance\n*Instance, name=j\n*End Instance\n", "found 2 instances"),
])  # fmt: skip
def test_statements_that_would_be_ignored_are_refused(tmp_path, name, text, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path / name, text)


def test_an_instance_in_place_is_read(tmp_path):
    text = ABAQUS + "*Instance, name=i, part=p\n0., 0.0E+00, 0.\n*End Instance\n"
    assert np.ptp(read(tmp_path / "a.inp", text).nodes, axis=0).tolist() == [2, 1, 1]


def test_repeated_elements_are_refused_but_for_groups_of_gmsh(tmp_path):
    repeated = [*ELEMENTS, ELEMENTS[1]]
    elements = "".join(f"{k + 1}, {', '.join(map(str, nodes))}\n" for k, nodes in enumerate(repeated))
    with pytest.raises(InputError, match=r"1 elements between the same nodes as others, the first with nodes 4, 8, 10"):
        read(tmp_path / "a.inp", f"*Node\n{NODES}*Element, type=C3D8, elset=body\n{elements}")
    nodes = NODES.replace(",", "")
    cells = "".join(
        f"{k + 1} 5 2 {tag} 1 {' '.join(map(str, nodes))}\n"
        for k, (nodes, tag) in enumerate(zip(repeated, (1, 1, 2), strict=True))
    )
    found = read(
        tmp_path / "a.msh",
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 "body"\n3 2 "end"\n$EndPhysicalNames\n'
        f"$Nodes\n12\n{nodes}$EndNodes\n$Elements\n3\n{cells}$EndElements\n",
    )
    assert found.mass.sum() / 3 == pytest.approx(2 * 7850)
    assert found.groups["end"].tolist() == list(range(4, 12))


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "tetra10", "hexahedron27"])
def test_nodes_at_one_place_stay_apart_at_a_slit(tmp_path, kind):
    def stiffness(opening, end=199):
        mesh = mesh_of_bar(kind, along=4)
        points, (block,) = mesh.points, mesh.cells
        above = points[block.data].mean(axis=1)[:, 1] > 15
        slit = np.flatnonzero((np.abs(points[:, 1] - 15) < 1e-9) & (points[:, 0] < end))
        other = np.arange(len(points))
        other[slit] = len(points) + np.arange(len(slit))
        mesh.points = np.vstack([points, points[slit] + [0, opening, 0]])
        block.data[above] = other[block.data[above]]
        mesh.write(tmp_path / "slit.vtu")
        found = from_mesh(tmp_path / "slit.vtu", 1e-3, STEEL)
        found.check()
        return found.stiffness

    closed, open_ = stiffness(0.0), stiffness(1e-5)
    assert np.abs((closed - open_).data).max() < 1e-4 * np.abs(closed.data).max()
    if kind in ("tetra10", "hexahedron27"):
        with pytest.raises(InputError, match="share nodes on edges or faces but not their corners"):
            stiffness(0.0, end=149)


def test_elements_that_share_an_edge_share_the_node_on_it(tmp_path):
    mesh = mesh_of_bar("tetra10", along=4)
    mesh.points = np.vstack([mesh.points, mesh.points[mesh.cells[0].data[0, 4]]])
    mesh.cells[0].data[0, 4] = len(mesh.points) - 1
    mesh.write(tmp_path / "a.vtu")
    with pytest.raises(InputError, match=r"found the nodes [0-9]+ and [0-9]+ at the same place"):
        from_mesh(tmp_path / "a.vtu", 1e-3, STEEL)


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (np.empty((3, 0), dtype=int), "found 3 elements of 0 nodes of the type tetra, expected some of 4"),
        ([[0, 1, 2, 40]], "found an element with a node outside the 4 nodes"),
        ([[0, 1, 2, -1]], "found an element with a node outside the 4 nodes"),
    ],
)
def test_elements_without_their_nodes_are_refused(monkeypatch, tmp_path, cells, message):
    mesh = SimpleNamespace(
        points=np.vstack([np.zeros(3), np.eye(3)]), cells=[SimpleNamespace(type="tetra", data=np.array(cells))]
    )
    monkeypatch.setattr("stiffmbs.flexible_bodies.mesh._read", lambda _: mesh)
    with pytest.raises(InputError, match=message):
        from_mesh(tmp_path / "a.vtk", 1.0, STEEL)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.msh", "(0 "),
        ("a.msh", '(2 3)\n(10 (0 1 4 0 3))\n(10 (1 1 4 1 3) ('),
        ("a.bdf", "$ BEGIN BULK\nENDDATA\n"),
        ("a.ele", "2 4 0\n0 0 1 2 3\n"),
        ("a.dat", 'TITLE = "a"\nVARIABLES = "X", "Y", "Z"\nZONE NODES=4, ELEMENTS=1\n0 0'),
        ("a.off", "OFF\n"),
    ],
)  # fmt: skip
def test_an_incomplete_file_is_refused(tmp_path, name, text):
    with pytest.raises(InputError, match=r"found .*expected"):
        read(tmp_path / name, text)


@pytest.mark.sampled(3)
@pytest.mark.filterwarnings("ignore:genfromtxt")
@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="a reader that does not end is interrupted by a timer")
@pytest.mark.parametrize("suffix", sorted(extension_to_filetypes))
def test_a_file_of_any_format_that_ends_early_is_read_or_refused(tmp_path, suffix):
    """A truncated .ply and .mdpa were read for ever."""
    path = tmp_path / f"a{suffix}"
    with contextlib.suppress(Exception, SystemExit):  # formats that cannot be written, or not with these elements
        meshio.write(path, meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])]))
    content = path.read_bytes() if path.is_file() else b""

    def interrupt(*_):
        pytest.fail(f"{suffix} is read for ever")

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        for size in {0, 4, *(len(content) * k // 16 for k in range(16))}:
            path.write_bytes(content[:size])
            signal.setitimer(signal.ITIMER_REAL, 10)
            with contextlib.suppress(InputError):
                _read(path)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


ORDERS = {
    ("hexahedron27", ".inp"): "01 12 23 30 45 56 67 74 04 15 26 37 01234567 0123 4567 0154 1265 2376 3740",
    ("pyramid", ".inp"): "",
    ("hexahedron20", ".inp"): "01 12 23 30 45 56 67 74 04 15 26 37",
    ("hexahedron20", ".bdf"): "01 12 23 30 04 15 26 37 45 56 67 74",
    ("hexahedron20", ".msh"): "01 03 04 12 15 23 26 37 45 47 56 67",
    ("wedge15", ".inp"): "01 12 20 34 45 53 03 14 25",
    ("wedge15", ".bdf"): "01 12 20 03 14 25 34 45 53",
    ("wedge15", ".msh"): "01 02 03 12 14 25 34 35 45",
    ("wedge18", ".msh"): "01 02 03 12 14 25 34 35 45 0143 0352 1254",
    ("tetra10", ".inp"): "01 12 20 03 13 23",
    ("tetra10", ".bdf"): "01 12 20 03 13 23",
    ("tetra10", ".msh"): "01 12 20 03 23 13",
}
"""Corners between which the nodes on edges are, in the order of Abaqus' and Nastran's manuals and of Gmsh."""
WORDS = {
    "hexahedron20": ("C3D20", "CHEXA", 17),
    "wedge15": ("C3D15", "CPENTA", 18),
    "tetra10": ("C3D10", "CTETRA", 11),
    "wedge18": ("", "", 13),
    "hexahedron27": ("C3D27", "", 12),
    "pyramid": ("C3D5", "", 7),
}


@pytest.mark.parametrize(("kind", "suffix"), ORDERS)
def test_nodes_on_edges_are_in_the_order_of_the_file(tmp_path, kind, suffix):
    corners = KINDS[kind].shape.corners.astype(float)
    edges = ORDERS[kind, suffix].split()
    points = [*corners, *(corners[[int(k) for k in between]].mean(axis=0) for between in edges)]
    grid = [(k + 1, *point) for k, point in enumerate(points)]
    numbers = [str(k + 1) for k in range(len(points))]
    abaqus, nastran, gmsh = WORDS[kind]
    if suffix == ".inp":
        nodes = "".join(f"{k}, {x}, {y}, {z}\n" for k, x, y, z in grid)
        text = f"*Node\n{nodes}*Element, type={abaqus}\n1, {', '.join(numbers[:15])}" + (
            f",\n{', '.join(numbers[15:])}\n" if numbers[15:] else "\n"
        )
    elif suffix == ".bdf":
        nodes = "".join(f"GRID,{k},,{x},{y},{z}\n" for k, x, y, z in grid)
        lines = [["1", "1", *numbers[:6]], numbers[6:14], numbers[14:]]
        text = f"BEGIN BULK\nPSOLID,1,1\n{nodes}{nastran}," + ",+\n+,".join(",".join(line) for line in lines if line)
        text += "\nENDDATA\n"
    else:
        nodes = "".join(f"{k} {x} {y} {z}\n" for k, x, y, z in grid)
        text = f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(grid)}\n{nodes}$EndNodes\n"
        text += f"$Elements\n1\n1 {gmsh} 2 1 1 {' '.join(numbers)}\n$EndElements\n"
    found = read(tmp_path / f"a{suffix}", text)
    volume = {
        "hexahedron20": 1.0,
        "hexahedron27": 1.0,
        "pyramid": 4 / 3,
        "wedge15": 0.5,
        "wedge18": 0.5,
        "tetra10": 1 / 6,
    }[kind]
    assert found.mass.sum() / 3 == pytest.approx(7850 * volume)
    (cells,) = found.cells.values()
    for k, between in enumerate(KINDS[kind].middles, len(corners)):
        np.testing.assert_allclose(found.nodes[cells[:, k]], found.nodes[cells[:, list(between)]].mean(axis=1))


THIRD = "9, 13, 15, 11, 10, 14, 16, 12"
ROW = ABAQUS.replace("*Element", "13, 3, 0, 0\n14, 3, 0, 1\n15, 3, 1, 0\n16, 3, 1, 1\n*Element", 1)
"""Three bricks in a row, of which the third has an element section of its own."""


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (f"*Element, type=C3D8, elset=body\n3, {THIRD}\n", {"body": 16}),
        (f"*Elset, elset=some\n1\n*Element, type=C3D8\n3, {THIRD}\n*Elset, elset=some\n3\n", {"some": 16, "body": 12}),
        (f"*Element, type=C3D8\n3, {THIRD}\n*Elset, elset=some, generate\n1, 2\n3, 3, 1\n", {"some": 16}),
        (f"*Element, type=C3D8\n3, {THIRD}\n*Elset, elset=a\n3 ,\n*Elset, elset=none\n*Elset, elset=b\na, none\n", {"b": 8}),
        (f"*Element, type=C3D8\n3, {THIRD}\n*Nset, nset=n\n1, 2\n*Nset, nset=n\n3\n*Nset, nset=\"m\"\nn, 16\n", {"n": 3, "m": 4}),
        (f"*Element, type=C3D8\n3, {THIRD}\n*Element, type=S4, elset=s\n4, 1, 5, 7, 3\n*Element, type=S4, elset=s\n5, 5, 9, 11, 7\n6, 1, 2, 4, 3\n", {"s": 8}),
    ],
)  # fmt: skip
def test_sets_of_abaqus_add_up(tmp_path, text, wanted):
    """meshio gives all sections with one name the elements of the last, and replaces sets that are stated again."""
    groups = read(tmp_path / "a.inp", ROW + text).groups
    assert {name: len(groups[name]) for name in wanted} == wanted


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*Nset, nset=n\n1, 77\n", "set n: found 77, expected numbers or sets of the file"),
        ("*Nset, nset=a\nb\n*Nset, nset=b\na\n", "found the set 'a' within itself"),
    ],
)
def test_members_that_are_not_in_the_file_are_refused(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path / "a.inp", ABAQUS + text)


def test_materials_of_sections_with_one_name(tmp_path):
    text = f"{ROW}*Element, type=C3D8, elset=body\n3, {THIRD}\n"
    (tmp_path / "a.inp").write_text(text)
    assert from_mesh(tmp_path / "a.inp", 1.0, {"body": STEEL}).mass.sum() / 3 == pytest.approx(3 * 7850)


def test_entities_of_gmsh_are_no_groups(tmp_path):
    mesh = mesh_of_bar("hexahedron", 2, 1)
    mesh.cell_sets["gmsh:bounding_entities"] = [np.array([5, 77])]
    assert not _as_vtk(mesh).cell_sets


def test_parts_joined_at_a_corner_are_refused(tmp_path):
    points = np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    meshio.Mesh(points, [("tetra", [[0, 1, 2, 3], [0, 5, 4, 6]])]).write(tmp_path / "a.vtu")
    with pytest.raises(InputError, match="found 2 parts that are not connected by faces"):
        from_mesh(tmp_path / "a.vtu", 1.0, STEEL)


def test_statements_and_beams_that_are_not_used_are_listed(tmp_path):
    more = "*Material, name=STEEL\n*Elastic\n2.1e5, 0.3\n*Boundary\n1, 1, 3\n*Boundary\n2, 1, 3\n*Element, type=B31\n9, 1, 2\n"
    assert read(tmp_path / "a.inp", ABAQUS).unused == ""
    found = read(tmp_path / "a.inp", ABAQUS + more)
    assert found.unused == "*MATERIAL, *ELASTIC, *BOUNDARY (2), elements B31"
    (note,) = (each for each in reduce(found, [], 1).notes if "not used" in each)
    assert found.unused in note
    more = "CBAR,8,2,1,2,0.,0.,1.\nSPC1,1,123,1\nRBE2,50,1,123456,2,3\n"
    assert read(tmp_path / "a.bdf", nastran(more=more)).unused == "PSOLID, CBAR, SPC1, RBE2"
