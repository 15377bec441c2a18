"""Archives of results: NumPy and other programs read what was written."""

from __future__ import annotations

import io
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from stiffmbs.results.files import write_archive

ROWS = np.random.default_rng(1).normal(size=(500, 3))
ARRAYS = {
    "time": np.linspace(0, 1, 500),
    "wheel.x": ROWS[:, 1],
    "Rädchen/über": np.arange(7),
    "flag": np.array(True),
    "number": np.array(3.5),
    "names": np.array(["a", "längste"]),
    "text": np.array("{}"),
    "empty": np.empty(0),
    "no_rows": np.empty((0, 3)),
    "matrix": ROWS,
    "columns_first": np.asfortranarray(ROWS),
}


def test_archives_contain_the_arrays(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    write_archive(path, ARRAYS)
    with ZipFile(path) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == [f"{name}.npy" for name in ARRAYS]
    with np.load(path, allow_pickle=False) as found:
        assert list(found) == list(ARRAYS)
        for name, values in ARRAYS.items():
            assert found[name].dtype == values.dtype and found[name].shape == values.shape
            np.testing.assert_array_equal(found[name], values)


def test_members_are_those_of_numpy(tmp_path: Path) -> None:
    """Heads of channels are written once for all of a type and length."""
    path, expected = tmp_path / "a.npz", io.BytesIO()
    write_archive(path, ARRAYS)
    with ZipFile(path) as archive:
        for name, values in ARRAYS.items():
            expected.seek(0)
            expected.truncate()
            np.save(expected, values)
            assert archive.read(f"{name}.npy") == expected.getvalue(), name


def test_the_same_arrays_are_the_same_file(tmp_path: Path) -> None:
    for name in "a.npz", "b.npz":
        write_archive(tmp_path / name, ARRAYS)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
