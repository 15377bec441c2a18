"""Laws periodic in the state: every period is felt at every tolerance, and what cannot be resolved is reported."""

import pytest

from stiffmbs.stress.case import Outcome
from stiffmbs.stress.families.events import periodic_laws
from stiffmbs.stress.fuzzers import laws


@pytest.mark.parametrize("case", periodic_laws.CASES, ids=lambda case: case.name)
def test_each_period_of_a_law_is_felt(case):
    verdict = case.judge()
    assert verdict.outcome is case.expected, verdict


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_random_laws_over_a_state(seed):
    verdict = laws.trial(seed)
    assert verdict.outcome in (Outcome.RIGHT, Outcome.TOLD), verdict
