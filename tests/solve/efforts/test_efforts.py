"""Evaluations of runs and equilibria compared with recorded numbers, which changes of step control or of an iteration alter.

If a change is intended, record the numbers again: ``python -m tests.solve.efforts.measure``.
"""

import csv

import numpy as np
import pytest

from .measure import RECORDED, cases, evaluations

MEAN, EACH = 0.012, 0.25
"""Relative differences that rounding may cause: of the geometric mean over all scenes, and of one scene."""


def _recorded() -> dict[tuple[str, float], dict[str, int]]:
    found: dict[tuple[str, float], dict[str, int]] = {}
    with RECORDED.open() as file:
        for row in csv.DictReader(file):
            found.setdefault((row["analysis"], float(row["rtol"])), {})[row["scene"]] = int(row["evaluations"])
    return found


CASES = [
    pytest.param(analysis, rtol, marks=[pytest.mark.long] * (analysis == "equilibrium"))
    for analysis, rtol in sorted(_recorded())
]


@pytest.mark.sampled(4)
@pytest.mark.long
@pytest.mark.parametrize(("analysis", "rtol"), CASES)
def test_evaluations_are_those_recorded(analysis, rtol):
    recorded = _recorded()[analysis, rtol]
    ratios = {name: evaluations(name, analysis, rtol) / number for name, number in recorded.items()}
    assert {name: ratio for name, ratio in ratios.items() if abs(ratio - 1) > EACH} == {}
    assert float(np.exp(np.mean(np.log(list(ratios.values()))))) == pytest.approx(1, abs=MEAN)


def test_all_cases_are_recorded():
    assert {(name, *key) for key, scenes in _recorded().items() for name in scenes} == set(cases())
