"""Matrices of finite element programs give the model that has written them; bad files are refused with one sentence."""

import struct
import subprocess
import sys

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import block_diag, coo_array, csr_array

from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.description import FlexibleBody
from stiffmbs.flexible_bodies.reduced import reduced_body

from .bars import bar

NUMBERS = 11
"""Difference of successive numbers of nodes in the files."""


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return bar(tmp_path_factory.mktemp("bar"), "hexahedron", along=3, across=1)


def numbers(model):
    return NUMBERS * (1 + np.arange(len(model.nodes)))


def op4(path, **matrices):
    pytest.importorskip("pyyeti")
    from pyyeti.nastran import op4

    op4.write(str(path), list(matrices), [matrix.toarray() for matrix in matrices.values()])


def op4_by_hand(path, name, matrix):
    """Write the dense text form: a header, then each column with its first row and its values."""
    size = matrix.shape[0]
    lines = [f"{size:8d}{size:8d}{6:8d}{2:8d}{name:8s}1P,3E23.16"]
    for k, column in enumerate(matrix.toarray().T):
        lines.append(f"{k + 1:8d}{1:8d}{size:8d}")
        lines += ["".join(f"{value:23.16E}" for value in column[i : i + 3]) for i in range(0, size, 3)]
    lines += [f"{size + 1:8d}{1:8d}{1:8d}", f"{1.0:23.16E}"]
    path.write_text("\n".join(lines) + "\n")


def op2(path, **matrices):
    """Write an OUTPUT2 file without header: for each matrix its name, trailer, and columns of doubles."""

    def record(content):
        return struct.pack("i", len(content)) + content + struct.pack("i", len(content))

    def keys(*values):
        return b"".join(record(struct.pack("i", value)) for value in values)

    out = b""
    for number, (name, matrix) in enumerate(matrices.items()):
        size, title = matrix.shape[0], name.ljust(8).encode()
        out += (
            keys(2) + record(title) + keys(-1, 7) + record(struct.pack("7i", 101 + number, size, size, 6, 2, size, 0))
        )
        out += keys(-2, 1, 0, 2) + record(title) + keys(-3, 1, 1)
        for k, column in enumerate(matrix.toarray().T):
            out += keys(1 + 2 * size) + record(struct.pack("i", 1) + column.tobytes()) + keys(0, -4 - k, k + 1 < size)
        out += keys(0)
    path.write_bytes(out + keys(0))


def punch(path, labels, **matrices):
    """Write DMIG entries of the lower triangles, in the large field format."""
    lines = []
    for name, matrix in matrices.items():
        lines.append(f"DMIG    {name:8s}{0:8d}{6:8d}{2:8d}{0:8d}")
        for k in range(matrix.shape[0]):
            lines.append(f"DMIG*   {name:8s}{'':8s}{labels[k][0]:16d}{labels[k][1]:16d}")
            column = matrix[:, [k]].toarray()[:, 0]
            for row in range(k, len(column)):
                if column[row]:
                    value = f"{column[row]:.8E}".replace("E", "D")
                    lines.append(f"*       {labels[row][0]:16d}{labels[row][1]:16d}{value:>16s}")
    path.write_text("\n".join(lines) + "\n")


def bulk(path, model, system=""):
    lines = ["BEGIN BULK"]
    for number, point in reversed(list(zip(numbers(model), model.nodes, strict=True))):
        lines.append(f"GRID,{number},{system}," + ",".join(f"{1e3 * part:.6f}" for part in point))
    path.write_text("\n".join([*lines, "ENDDATA"]) + "\n")


def abaqus(path, model):
    lines = ["*HEADING", "*NODE, NSET=all"]
    lines += [
        f"{number}, " + ", ".join(f"{1e3 * part:.9g}" for part in point)
        for number, point in zip(numbers(model), model.nodes, strict=True)
    ]
    lines += [
        "** ends",
        "*NSET, NSET=end, GENERATE",
        f"{NUMBERS}, {4 * NUMBERS}, {NUMBERS}",
        "*NSET, NSET=two",
        "11, 22",
    ]
    path.write_text("\n".join(lines) + "\n")


def labels(model):
    return [(number, component) for number in numbers(model).tolist() for component in (1, 2, 3)]


def with_rotations(matrix):
    """Return a matrix with three empty rows after those of each node."""
    count = matrix.shape[0] // 3
    place = (6 * np.arange(count)[:, None] + np.arange(3)).ravel()
    found = matrix.tocoo()
    return coo_array((found.data, (place[found.row], place[found.col])), shape=(6 * count, 6 * count)).tocsr()


def read(folder, **files):
    """Return the model of files in mm and tonnes."""
    files = {key: str(value) for key, value in files.items()}
    return FlexibleBody(matrices=files, units={"length": 1e-3, "mass": 1e3}).model(folder)


def in_tonnes(matrix):
    return csr_array(matrix / 1e3)


def check_same(found, model, digits=1e-12):
    np.testing.assert_allclose(found.nodes, model.nodes, atol=1e-9)
    for name in ("stiffness", "mass"):
        own, expected = getattr(found, name), getattr(model, name)
        assert np.abs((own - expected).data).max(initial=0.0) <= digits * np.abs(expected.data).max(), name


@pytest.fixture(autouse=True)
def printed_as_before():
    """Restore the format of numbers, which pyYeti sets when it is imported."""
    with np.printoptions():
        yield


def test_numbers_are_printed_as_before(tmp_path):
    """pyYeti sets the format of NumPy 1.13 for the whole process."""
    pytest.importorskip("pyyeti")
    for name in ("stiffness.op4", "nodes.bdf"):
        (tmp_path / name).write_bytes(b"")
    program = """
import sys, numpy as np, stiffmbs
from pathlib import Path
from stiffmbs.flexible_bodies.description import FlexibleBody
before = np.get_printoptions()
try:
    files = {"stiffness": "stiffness.op4", "mass": "stiffness.op4", "nodes": "nodes.bdf"}
    FlexibleBody(matrices=files, units={"length": 1, "mass": 1}).model(Path(sys.argv[1]))
except Exception:
    assert "pyyeti" in sys.modules
assert np.get_printoptions() == before
"""
    subprocess.run([sys.executable, "-c", program, str(tmp_path)], check=True)


@pytest.mark.parametrize("rotations", [False, True])
@pytest.mark.parametrize("kind", ["op4", "op4 by hand", "op2", "pch", "sti", "mtx"])
def test_files_give_the_model(tmp_path, model, kind, rotations):
    if kind in ("op4", "op4 by hand", "op2", "pch"):
        pytest.importorskip("pyyeti")
    K, M = in_tonnes(model.stiffness), in_tonnes(model.mass)
    of_rows = labels(model)
    if rotations:
        K, M = with_rotations(K), with_rotations(M)
        of_rows = [(number, component) for number in numbers(model).tolist() for component in range(1, 7)]
    bulk(tmp_path / "nodes.bdf", model)
    files = {"nodes": "nodes.bdf", "digits": 1e-12}
    match kind:
        case "op4":
            op4(tmp_path / "part.op4", KGG=K, MGG=M)
            files |= {"stiffness": "part.op4", "mass": "part.op4"}
        case "op4 by hand":
            op4_by_hand(tmp_path / "K.op4", "A", K)
            op4_by_hand(tmp_path / "M.op4", "B", M)
            files |= {"stiffness": "K.op4", "mass": "M.op4"}
        case "op2":
            op2(tmp_path / "part.op2", KGG=K, MGG=M, MFF=M * 2)
            files |= {"stiffness": "part.op2", "mass": "part.op2", "mass_name": "mgg"}
        case "pch":
            punch(tmp_path / "part.pch", of_rows, KAAX=K, MAAX=M)
            files |= {"stiffness": "part.pch", "mass": "part.pch", "digits": 1e-8}
        case "sti":
            abaqus(tmp_path / "part.inp", model)
            order = np.random.default_rng(1).permutation(K.shape[0])
            for name, matrix in (("part.sti", K), ("part.mas", M)):
                found = matrix[order][:, order].tocoo()
                lines = zip(found.row + 1, found.col + 1, found.data, strict=True)
                (tmp_path / name).write_text("".join(f"{i} {j} {v:.17g}\n" for i, j, v in lines if i <= j))
            (tmp_path / "part.dof").write_text("".join(f"{of_rows[k][0]}.{of_rows[k][1]}\n" for k in order))
            files |= {"stiffness": "part.sti", "mass": "part.mas", "rows": "part.dof", "nodes": "part.inp"}
        case "mtx":
            mmwrite(tmp_path / "K.mtx", K.tocoo(), symmetry="symmetric", precision=17)
            mmwrite(tmp_path / "M.mtx", M.tocoo(), symmetry="symmetric", precision=17)
            nodes = np.column_stack([numbers(model), 1e3 * model.nodes])
            np.savetxt(tmp_path / "nodes.csv", nodes, delimiter=",")
            files |= {"stiffness": "K.mtx", "mass": "M.mtx", "nodes": "nodes.csv"}
    digits = files.pop("digits")
    found = read(tmp_path, **files)
    check_same(found, model, digits)
    np.testing.assert_array_equal(found.numbers, numbers(model))


def test_groups_and_numbers_of_the_file_select_the_nodes_of_an_interface(tmp_path, model):
    abaqus(tmp_path / "part.inp", model)
    mmwrite(tmp_path / "K.mtx", in_tonnes(model.stiffness), precision=17)
    mmwrite(tmp_path / "M.mtx", in_tonnes(model.mass), precision=17)
    files = {"stiffness": "K.mtx", "mass": "M.mtx", "nodes": "part.inp"}

    def reduced(selection):
        body = FlexibleBody(matrices=files, units={"length": 1e-3, "mass": 1e3}, interfaces={"end": selection}, modes=2)
        return reduced_body(body, tmp_path)

    by_group, by_number = reduced({"group": "end"}), reduced({"nodes": [11, 22, 33, 44]})
    np.testing.assert_allclose(by_group.points, model.nodes[:4].mean(axis=0)[None], atol=1e-9)
    np.testing.assert_allclose(by_number.frequencies, by_group.frequencies)
    with pytest.raises(
        InputError, match=r"interfaces.end.nodes: found node 3, expected 11 to .* \(numbers of the file\)"
    ):
        reduced({"nodes": [11, 3]})


def test_nodes_without_rows_are_left_out(tmp_path, model):
    pytest.importorskip("pyyeti")
    bulk(tmp_path / "nodes.bdf", model)
    text = (tmp_path / "nodes.bdf").read_text()
    (tmp_path / "nodes.bdf").write_text(text.replace("ENDDATA", "GRID,7,,1.,2.,3.\nENDDATA"))
    punch(tmp_path / "part.pch", labels(model), KAAX=in_tonnes(model.stiffness), MAAX=in_tonnes(model.mass))
    check_same(read(tmp_path, stiffness="part.pch", mass="part.pch", nodes="nodes.bdf"), model, 1e-8)


def test_the_ansys_file_of_a_held_beam_is_refused(tmp_path):
    examples = pytest.importorskip("ansys.mapdl.reader").examples
    with pytest.raises(InputError, match=r"stiffness: found 63 supported displacements, expected .* the free body"):
        read(tmp_path, stiffness=examples.fullfile, mass=examples.fullfile, nodes=examples.hexarchivefile)


def test_an_ansys_file_has_both_triangles_and_the_mass_of_the_beam(tmp_path):
    reader = pytest.importorskip("ansys.mapdl.reader")
    from stiffmbs.flexible_bodies import matrix_files

    labels, K, _ = reader.read_binary(reader.examples.fullfile).load_km(sort=False)
    order = np.lexsort(labels.T[::-1])
    monkey = pytest.MonkeyPatch()
    monkey.setattr(reader.full.FullFile, "const", np.empty((0, 2)))
    try:
        found, of_rows = matrix_files._read(tmp_path / reader.examples.fullfile, "K", None)
    finally:
        monkey.undo()
    whole = (K + K.T).toarray()
    whole[np.diag_indices(len(whole))] /= 2
    np.testing.assert_allclose(found.toarray(), whole[order][:, order])
    np.testing.assert_array_equal(of_rows, labels[order] + [0, 1])


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"stiffness": "K.txt"}, r"stiffness: found the type '.txt', expected one of .mtx, .op4"),
        ({"stiffness": "nodes.bdf"}, "stiffness: found the type '.bdf'"),
        ({"stiffness": "other.op4"}, "other.op4: found no such file"),
        (
            {"stiffness": "two.op4"},
            "stiffness: found the matrices kaa, kgg, expected exactly one with a name that begins with K",
        ),
        ({"stiffness": "two.op4", "stiffness_name": "KXX"}, "found the matrices kaa, kgg, expected 'KXX'"),
        ({"mass": "small.op4"}, "mass: found 45 rows for 16 nodes, expected 48"),
        ({"mass": "none.op4"}, "mass: found no OUTPUT4 file"),
        ({"mass": "none.pch"}, "mass: found the matrices none, expected exactly one with a name that begins with M"),
        ({"mass": "turned.op4"}, "mass: found entries for the rotations of node 11, expected solid elements"),
        ({"mass": "reduced.op4"}, "depend on the direction .y, y., expected the mass matrix of solid elements"),
        ({"mass": "other.pch"}, "mass: found a row of node 5, expected only rows of the 16 nodes"),
        ({"mass": "scalar.pch"}, "mass: found scalar point 9001, a modal coordinate"),
        ({"stiffness": "M.op4"}, "stiffness: found a force of .* under a rigid"),
        ({"stiffness": "held.op4"}, "the matrix must belong to the free body without supports"),
        ({"stiffness": "skew.op4"}, "stiffness: found entries that differ from those across the diagonal"),
        ({"nodes": "local.bdf"}, "nodes: found node 176 in a local coordinate system, expected the basic one"),
        ({"nodes": "twice.bdf"}, "nodes: found node 11 twice"),
        ({"nodes": "K.op4"}, "nodes: found no table"),
        ({"nodes": "empty.bdf"}, "nodes: found no GRID entry"),
        ({"nodes": "empty.csv"}, "nodes: found an empty file"),
        ({"rows": "long.dof", "nodes": "nodes.bdf"}, "stiffness: found 48 rows, expected the 1 of the file of rows"),
        ({"rows": "bad.dof"}, "rows: found no list of node.component"),
    ],
)
def test_bad_files_are_refused_with_one_sentence(tmp_path, model, change, message):
    pytest.importorskip("pyyeti")
    K, M = in_tonnes(model.stiffness), in_tonnes(model.mass)
    of_rows = labels(model)
    bulk(tmp_path / "nodes.bdf", model)
    bulk(tmp_path / "local.bdf", model, system="3")
    (tmp_path / "twice.bdf").write_text("GRID,11,,0.,0.,1.\n" + (tmp_path / "nodes.bdf").read_text())
    (tmp_path / "empty.bdf").write_text("BEGIN BULK\nENDDATA\n")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "bad.dof").write_text("11.1\nx\n")
    (tmp_path / "long.dof").write_text("11.1\n")
    (tmp_path / "K.txt").write_text("")
    op4(tmp_path / "K.op4", KGG=K)
    op4(tmp_path / "M.op4", MGG=M)
    op4(tmp_path / "two.op4", KAA=K, KGG=K)
    op4(tmp_path / "small.op4", MGG=M[:-3][:, :-3])
    (tmp_path / "none.op4").write_bytes(b"nonsense")
    (tmp_path / "none.pch").write_text("$ nothing\n")
    turned = with_rotations(M).tolil()
    turned[3, 3] = M[0, 0]
    op4(tmp_path / "turned.op4", MGG=turned.tocsr())
    op4(tmp_path / "reduced.op4", MGG=M + csr_array(([M[0, 0], M[0, 0]], ([0, 4], [0, 4])), shape=M.shape))
    punch(tmp_path / "other.pch", [(5, 1), *of_rows[1:]], MAAX=M)
    punch(tmp_path / "scalar.pch", [*of_rows, (9001, 0)], MAAX=csr_array(block_diag([M, [[1.0]]])))
    op4(tmp_path / "held.op4", KGG=K + csr_array(([K[0, 0]], ([0], [0])), shape=K.shape))
    op4(tmp_path / "skew.op4", KGG=K + csr_array(([K[0, 0]], ([0], [7])), shape=K.shape))
    files = {"stiffness": "K.op4", "mass": "M.op4", "nodes": "nodes.bdf"} | change
    with pytest.raises(InputError, match=message) as found:
        read(tmp_path, **files)
    assert "\n" not in str(found.value)


@pytest.mark.sampled(3)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("kind", ["op4", "op2", "pch", "bdf"])
def test_damaged_files_are_refused_or_read(tmp_path, model, kind):
    pytest.importorskip("pyyeti")
    K, M = in_tonnes(model.stiffness), in_tonnes(model.mass)
    bulk(tmp_path / "nodes.bdf", model)
    part = "part.pch" if kind == "bdf" else f"part.{kind}"
    match kind:
        case "op4":
            op4(tmp_path / part, KGG=K, MGG=M)
        case "op2":
            op2(tmp_path / part, KGG=K, MGG=M)
        case _:
            punch(tmp_path / part, labels(model), KAAX=K, MAAX=M)
    damaged = tmp_path / ("nodes.bdf" if kind == "bdf" else part)
    whole, random = damaged.read_bytes(), np.random.default_rng(5)
    for k in range(15):
        content = bytearray(whole)
        if k % 3:
            content[random.integers(len(content))] = random.integers(256)
        else:
            del content[random.integers(len(content)) :]
        damaged.write_bytes(content)
        try:
            read(tmp_path, stiffness=part, mass=part, nodes="nodes.bdf")
        except InputError as error:
            assert "\n" not in str(error) and len(str(error)) < 600
