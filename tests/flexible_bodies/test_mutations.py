"""Mutated meshes and matrices are refused with one sentence, or give a body of the right mass: no traceback."""

import pytest

from tests.stress.case import Outcome
from tests.stress.fuzzers.meshes import trial


@pytest.mark.long
def test_damaged_meshes_and_matrices():
    found = [trial(seed) for seed in range(120)]
    wrong = [f"seed {seed}: {verdict.detail}" for seed, verdict in enumerate(found) if verdict.outcome is Outcome.WRONG]
    assert not wrong
    assert sum(verdict.outcome is Outcome.TOLD for verdict in found) > 60


def test_elements_folded_by_a_node_on_an_edge_are_refused():
    assert "inverted or flat in places" in trial(259).detail
