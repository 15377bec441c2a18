"""Fuzzers of analyses about a state find nothing wrong, and find what is made wrong."""

from dataclasses import replace

import pytest

from stiffmbs.analyses.linearised import inputs
from stiffmbs.linear_analysis import tangent_space
from tests.stress.case import Outcome
from tests.stress.fuzzers import modes, stability, transfer

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes


@pytest.mark.sampled(6)
@pytest.mark.parametrize("fuzzer", [modes, transfer])
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.long) for seed in (7, 8, 16, 101)])
def test_nothing_is_wrong(fuzzer, seed):
    verdict = fuzzer.trial(seed)
    assert verdict.outcome in (Outcome.RIGHT, Outcome.TOLD), verdict


def test_a_wrong_sign_in_the_accelerations_is_found(monkeypatch):
    right = tangent_space.linearised

    def wrong(*state):
        found = right(*state)
        return replace(found, acceleration_at_velocity=-found.acceleration_at_velocity)

    monkeypatch.setattr("stiffmbs.analyses.linearised.kink.linearised", wrong)
    assert modes.trial(7).outcome is Outcome.WRONG


def test_a_load_at_the_origin_in_place_of_the_centre_of_mass_is_found(monkeypatch):
    monkeypatch.setattr(inputs, "_place", lambda data, body, marker: {"body": body})
    assert transfer.trial(7).outcome is Outcome.WRONG


def test_a_growing_motion_without_a_note_is_found(monkeypatch):
    assert stability.trial(15).outcome is Outcome.RIGHT
    monkeypatch.setattr("stiffmbs.analyses.settled._growth", lambda dynamics, t: [])
    assert stability.trial(15).outcome is Outcome.WRONG
