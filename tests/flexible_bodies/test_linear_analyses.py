"""`equilibrium` and `response` of a flexible body against the stiffness and mass matrix of its mesh."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.sparse.linalg import splu

from stiffmbs.commands.main import main

from .bars import LENGTH, bar

SCENE = """
name: Cantilever
dimensions: 3
parameters: {force: 0 N}
bodies:
  bar:
    type: flexible
    matrices: bar.npz
    units: {length: 1 m}
    interfaces: {root: {group: root}, tip: {nodes: [TIP], type: point}}
    modes: 20
    damping: {stiffness: 1e-4 s}
joints:
  clamp: {type: fixed, i: bar.root, j: {body: ground, point: [0, 15 mm, 10 mm]}}
forces:
  load: {type: force, i: bar.tip, force: [0, force, -2*force]}
run: {duration: 0.1}
"""
RAYLEIGH = 1e-4
"""Damping matrix relative to the stiffness, s."""


@pytest.fixture(scope="module")
def clamped(tmp_path_factory):
    """A scene, and K and M of its mesh without the clamped nodes, with the tip's entries along y and z."""
    folder = tmp_path_factory.mktemp("cantilever")
    model = bar(folder, "hexahedron27", along=4, across=1)
    root = np.flatnonzero(model.nodes[:, 0] < 1e-9)
    tip = int(np.argmin(np.linalg.norm(model.nodes - [LENGTH, 0.015, 0.01], axis=1)))
    arrays = {"nodes": model.nodes, "root": root, "K": model.stiffness.toarray(), "M": model.mass.toarray()}
    np.savez(folder / "bar.npz", **arrays)
    path = folder / "scene.yaml"
    path.write_text(SCENE.replace("TIP", str(tip)))
    free = np.setdiff1d(np.arange(3 * len(model.nodes)), (3 * root[:, None] + np.arange(3)).ravel())
    entries = np.searchsorted(free, [3 * tip + 1, 3 * tip + 2])
    return path, model.stiffness[free][:, free], model.mass[free][:, free], entries


def stiffmbs(*arguments):
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return json.loads(result.output)


def test_equilibrium_is_the_static_solution_of_the_mesh(clamped):
    """Static modes of the interfaces make the reduction exact for loads on them."""
    path, stiffness, _, entries = clamped
    loads = np.zeros(stiffness.shape[0])
    loads[entries] = 1.0, -2.0
    expected = splu(stiffness.tocsc()).solve(loads)[entries]
    found = stiffmbs("equilibrium", path, "--set", "force=1", "--json")["channels"]
    shown = found["bar.tip.y"] - 0.015, found["bar.tip.z"] - 0.01
    assert shown == pytest.approx(expected, rel=1e-5)


def test_frequency_response_is_that_of_the_mesh(clamped):
    """20 modes up to 20 kHz, 1 Hz to 2 kHz: three resonances in each direction, with damping by the stiffness."""
    path, stiffness, mass, entries = clamped
    found = stiffmbs(
        "response", path, "--input", "force", "--output", "bar.tip.y", "--output", "bar.tip.z", "--from", 1, "--to", 2000,
        "--points", 40, "--json",
    )  # fmt: skip
    loads = np.zeros(stiffness.shape[0])
    loads[entries] = 1.0, -2.0
    for k, frequency in enumerate(found["frequencies"]):
        rate = 2j * np.pi * frequency
        matrix = stiffness * (1 + rate * RAYLEIGH) + mass * rate**2
        expected = splu(matrix.tocsc()).solve(loads.astype(complex))[entries]
        shown = [complex(*found["response"]["force"][f"bar.tip.{axis}"][k]) for axis in "yz"]
        assert shown == pytest.approx(expected, rel=1e-3)
