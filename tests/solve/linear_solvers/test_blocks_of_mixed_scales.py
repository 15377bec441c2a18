"""Blocks without pivots on chains and loops of very soft and very stiff bushings, next to no mass and redundant joints, against pivots."""

import numpy as np
import pytest

from stiffmbs.analyses.job import prepare
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.linear_solvers.block_lu import BlockLU
from stiffmbs.solve.linear_solvers.native.layouts import BLOCK_LU
from tests.bench.problems.linear_algebra import by_sparse_lu


def links(random, n):
    """Rods along x, masses of 1e-6 to 1e3 kg."""
    lines = ["bodies:"]
    for k in range(n):
        light, heavy = random.uniform(size=2) < 0.3
        mass = 10 ** random.uniform(-6 if light else -1, 3 if heavy else 1)
        slender = 10 ** random.uniform(-1, 0)
        inertia = ", ".join(f"{mass * part * slender:.6g}" for part in (0.1, 0.08, 0.05))
        markers = (
            "{left: {point: [-0.5, 0, 0], orientation: {z: [0, 0.3, 1]}}, right: {point: [0.5, 0, 0]}}"
        )  # fmt: skip
        lines.append(
            f"  b{k}: {{mass: {mass:.6g}, inertia: [{inertia}], position: [{k + 0.5}, 0, 0], markers: {markers}}}"
        )
    return lines


def connections(random, n):
    """Ball joints, or bushings whose six stiffnesses are between 1e-2 and 1e9; some chains end at the ground, held once or twice."""
    joints, forces = ["joints:"], []
    for k in range(n):
        before = f"b{k - 1}.right" if k else "{body: ground}"
        if k == 0 or random.uniform() < 0.5:
            joints.append(f"  j{k}: {{type: spherical, i: b{k}.left, j: {before}}}")
            continue
        stiffness = 10 ** random.uniform(-2, 9, 6)
        damping = 2 * random.uniform(0.01, 1) * np.sqrt(stiffness)
        numbers = [", ".join(f"{number:.4g}" for number in part) for part in (stiffness, damping)]
        forces.append(
            f"  f{k}: {{type: bushing, i: b{k}.left, j: {before}, stiffness: [{numbers[0]}], damping: [{numbers[1]}]}}"
        )
    for name in ("first", "twice")[: random.integers(0, 3)]:
        joints.append(f"  {name}: {{type: spherical, i: b{n - 1}.right, j: {{body: ground, point: [{n}, 0, 0]}}}}")
    return [*joints, *(["forces:", *forces] if forces else [])]


def scene(seed):
    random = np.random.default_rng(seed)
    n = int(random.integers(3, 6))
    head = ["name: mixed", "dimensions: 3", "gravity: [0, 0.3, -9.81]"]
    run = ["run: {duration: 0.3, points: 31}"]
    return read_scene("\n".join([*head, *links(random, n), *connections(random, n), *run]) + "\n")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", [0, *range(2, 8), 28, 43, 76])
def test_motion_is_that_of_the_sparse_lu(seed):
    by_blocks, sparse = (prepare(scene(seed), solver="bdf", rtol=1e-6) for _ in range(2))
    ours, expected = by_blocks.integrate(), by_sparse_lu(sparse).integrate()
    assert "blocks" in str(ours.statistics["linear_solver"]) and "sparse" in str(expected.statistics["linear_solver"])
    np.testing.assert_allclose(ours.q, expected.q, atol=2e-5)


@pytest.mark.parametrize("seed", [43, 76])
def test_pivots_within_blocks_serve_for_all_of_them(seed, monkeypatch):
    """Without such pivots these factors were refused at times."""
    tables, memory = [], BlockLU.memory

    def noted(self, array_of):
        made = memory(self, array_of)
        tables.append(made.content)
        return made

    monkeypatch.setattr(BlockLU, "memory", noted)
    prepare(scene(seed), solver="bdf", rtol=1e-6).integrate()
    assert max(table.view(BLOCK_LU.cells)[0]["refused"] for table in tables) == 0
