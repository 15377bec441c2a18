"""Names of variables in .nc files."""

import json

import numpy as np
import pytest

import stiffmbs
from stiffmbs.results import files


def test_channels_that_differ_by_a_dot_are_both_written(tmp_path):
    xarray = pytest.importorskip("xarray")
    found = {"bodies": {"a": {"mass": 1, "inertia": 1, "velocity": [1, 0]}}, "requests": {"a_x": "2*t"}}
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(found)), duration=1, points=3)
    path = tmp_path / "a.nc"
    files.WRITERS[".nc"](path, solution)
    with xarray.open_dataset(path, engine="scipy") as written:
        by_channel = {variable.attrs["channel"]: variable.values for variable in written.data_vars.values()}
    assert set(by_channel) == set(solution)
    assert np.array_equal(by_channel["a_x"], solution["a_x"])
