"""Equilibria of random mechanisms with springs, bushings, contacts and closed loops, in the plane and in space.

Each is found, has no accelerations by the equations of motion, stays at rest in a run, and is stable by its modes unless
it is told to be unstable (`tests.stress.fuzzers.equilibria`).
"""

import numpy as np
import pytest

from stiffmbs.analyses.equilibrium import EquilibriumFound, equilibrium
from stiffmbs.results.solution import Solution
from tests.stress.case import Outcome
from tests.stress.fuzzers import equilibria
from tests.stress.random_statics import random_statics


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long), 2, 4, 6])
def test_a_random_equilibrium_is_balanced_still_and_stable(seed):
    verdict = equilibria.trial(seed)
    assert verdict.outcome is Outcome.RIGHT, verdict.detail


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("seed", [1000117, 1000671, 1000817])
def test_soft_directions_of_stiff_bodies_are_balanced(seed):
    """The last move along a soft direction rotates a stiff body, and leaves more than it found; the next one leaves nothing."""
    verdict = equilibria.trial(seed)
    assert verdict.outcome is Outcome.RIGHT, verdict.error


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, 200, 20))
@pytest.mark.sampled(11)
def test_two_hundred_random_equilibria(first):
    """All found: 100 in the plane (even seeds), 100 in space."""
    verdicts = {seed: equilibria.trial(seed) for seed in range(first, first + 20)}
    assert {seed: v.detail for seed, v in verdicts.items() if v.outcome is not Outcome.RIGHT} == {}


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_a_pose_beside_an_equilibrium_is_seen_to_be_none(seed, monkeypatch):
    """The judge can fail: accelerations and motion tell a state that is a little off."""
    model = random_statics(np.random.default_rng(seed), in_space=seed % 2 == 1)
    found = equilibrium(model)
    rest, body = found.solution, next(iter(model.bodies))
    off = {name: values + 1e-4 * (name == f"{body}.x") for name, values in rest.channels.items()}
    moved = Solution(**{**vars(rest), "channels": off})
    monkeypatch.setattr(equilibria, "equilibrium", lambda model: EquilibriumFound(**{**vars(found), "solution": moved}))
    assert equilibria.trial(seed).outcome is Outcome.WRONG
