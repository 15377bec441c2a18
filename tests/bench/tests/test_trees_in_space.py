"""Trees of links in space: this package and other tools, each by its own algorithm, find the same motion."""

import itertools

import numpy as np
import pytest

from tests.bench.decades import error_of
from tests.bench.peers import missing, peers
from tests.bench.peers.trees.tree import GROUND, Link, Tree
from tests.bench.problems.accelerations import InSpace
from tests.bench.problems.trees_in_space import BENCHMARKS, tilted_chain

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

PROBLEMS = {benchmark.name: benchmark for benchmark in BENCHMARKS}
STEP, RTOL = 1e-3, 1e-9
COMPILED = "compiled"
"""Of peers whose equations a C compiler takes seconds for: the others have the same ones."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name", ["heavy_top", "arm", "tilted_chain_10", pytest.param("tilted_chain_100", marks=pytest.mark.long)]
)
def test_all_tools_solve_the_same_problem(name):
    problem = PROBLEMS[name]
    reference = problem.reference()
    for peer in peers(problem.in_space()):
        if COMPILED in peer.solver and name != "heavy_top":
            continue
        setting = max((step for step in peer.settings if step <= STEP), default=RTOL)
        assert error_of(peer.at(setting)(), reference) < 1e-5, peer.solver
    for own in problem.contestants():
        assert error_of(own.at(RTOL)(), reference) < 1e-6, own.solver


@pytest.mark.skipif("mujoco" in missing(), reason="of the extra robots")
def test_long_steps_pass_over_output_times():
    problem = PROBLEMS["tilted_chain_10"]
    (mujoco,) = (peer for peer in peers(problem.in_space()) if peer.solver == "MuJoCo RK4")
    found = mujoco.at(0.02)()  # two times the spacing
    assert np.isnan(found[1]).all() and np.isfinite(found[2]).all()


def test_all_tools_find_the_same_accelerations():
    """The errors of a row are those of the centres' accelerations."""
    for row in InSpace(10).glanced():
        assert row.error < 1e-9, row.solver


def test_hinges_of_a_tree_turn_what_they_carry():
    """Two links of 1 m: the first is turned upwards, the second back to level."""
    y, x = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    links = tuple(Link(k - 1, y, k * x, (k + 0.5) * x, 1.0, np.eye(3)) for k in range(2))
    assert links[0].parent == GROUND
    tree = Tree(links, np.zeros(3), np.zeros(1))
    np.testing.assert_allclose(tree.places(np.array([[np.pi / 2, -np.pi / 2]])), [[0, 0, 0.5, 0.5, 0, 1]], atol=1e-15)


def test_a_tilted_chain_leaves_every_plane():
    places = PROBLEMS["tilted_chain_10"].reference()[-1].reshape(-1, 3)
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    assert spread[-1] > 0.02 * spread[0]
    axes = [link.axis for link in tilted_chain(3).links]
    assert max(abs(one @ other) for one, other in itertools.pairwise(axes)) < 0.9
