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


@pytest.mark.long
def test_equilibrium_is_the_static_solution_of_the_mesh(clamped):
    """Static modes of the interfaces make the reduction exact for loads on them."""
    path, stiffness, _, entries = clamped
    loads = np.zeros(stiffness.shape[0])
    loads[entries] = 1.0, -2.0
    expected = splu(stiffness.tocsc()).solve(loads)[entries]
    found = stiffmbs("equilibrium", path, "--set", "force=1", "--json")["channels"]
    shown = found["bar.tip.y"] - 0.015, found["bar.tip.z"] - 0.01
    assert shown == pytest.approx(expected, rel=1e-5)


@pytest.mark.long
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


ON_BUSHINGS = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  bar:
    type: flexible
    matrices: bar.npz
    units: {length: 1 m}
    interfaces: {INTERFACES}
    modes: MODES
    residual_modes: true
forces: {FORCES}
run: {duration: 0.1}
"""


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("modes", [0, 6, pytest.param(15, marks=pytest.mark.long)])
def test_a_body_on_bushings_at_points_comes_to_rest_as_its_mesh(tmp_path, modes):
    """The mass matrix of a flexible body is not diagonal, so its accelerations are not forces over masses."""
    model = bar(tmp_path, "hexahedron27", along=4, across=1)
    corners = [int(np.argmin(np.linalg.norm(model.nodes - [x, y, 0], axis=1))) for x in (0, LENGTH) for y in (0, 0.03)]
    arrays = {"nodes": model.nodes, "K": model.stiffness.toarray(), "M": model.mass.toarray()}
    np.savez(tmp_path / "bar.npz", **arrays)
    points = ", ".join(f"p{k}: {{nodes: [{node}], type: point}}" for k, node in enumerate(corners))
    at = [", ".join(f"{x:.17g}" for x in model.nodes[node]) for node in corners]
    forces = ", ".join(
        f"s{k}: {{type: bushing, i: bar.p{k}, j: {{body: ground, point: [{place}]}}, stiffness: [1e6, 1e6, 1e6, 0, 0, 0]}}"
        for k, place in enumerate(at)
    )
    path = tmp_path / "scene.yaml"
    path.write_text(ON_BUSHINGS.replace("INTERFACES", points).replace("FORCES", forces).replace("MODES", str(modes)))
    held = model.stiffness.tolil()
    for entry in (3 * np.array(corners)[:, None] + np.arange(3)).ravel():
        held[entry, entry] += 1e6
    weight = model.mass @ np.tile([0.0, 0.0, -9.81], len(model.nodes))
    expected = splu(held.tocsc()).solve(weight)
    found = stiffmbs("equilibrium", path, "--json")["channels"]
    for k, node in enumerate(corners):
        for axis, name in enumerate("xyz"):
            assert found[f"s{k}.f{name}"] == pytest.approx(
                -1e6 * expected[3 * node + axis], abs=2e-4 * abs(weight.sum())
            )
