"""Each parameter of a table changes a decision if it is halved or doubled.

A decision is a number that one function returns: a bound, a length, or the value of an argument at which the result changes. Functions
of compiled code run in Python (`tests.interpreted`), so that nothing is compiled, and rounding changes no decision.
"""

from __future__ import annotations

import sys
from contextlib import ExitStack, contextmanager
from importlib import import_module
from unittest.mock import patch

import pytest

from stiffmbs import tuning
from tests.parameters import changed, factors_of_tests

MODULES = [
    import_module(f"tests.decisions.{name}")
    for name in (
        "auto", "dynamics", "equilibria", "error_control", "event_search", "events", "explicit_steps", "linear_analysis",
        "linear_solvers", "presolve", "radau", "redundancy", "results", "run_checks", "sensitivities", "verification",
    )
]  # fmt: skip
TABLE = {name: decision for module in MODULES for name, decision in module.DECISIONS.items()}
EXPECTED = {name: value for module in MODULES for name, value in module.EXPECTED.items()}


@contextmanager
def imported_with(place, factor):
    """Multiply a number of a module within a context, there and in all modules that have imported it."""
    defined_in, name = place.split(":")
    value = getattr(import_module(f"stiffmbs.{defined_in}"), name)
    with ExitStack() as stack:
        for module in [*sys.modules.values()]:
            if module.__name__.startswith("stiffmbs.") and vars(module).get(name) is value:
                stack.enter_context(patch.object(module, name, type(value)(factor * value)))
        yield


def with_others(parameter):
    """Yield contexts in which a parameter is halved or doubled; of a tuple, each number."""
    if ":" in parameter:
        yield from (imported_with(parameter, factor) for factor in (0.5, 2.0))
    else:
        name, field = parameter.split(".")
        value = getattr(tuning.defaults_of(name), field)
        for factor in (0.5, 2.0):
            if isinstance(value, tuple):
                for k, each in enumerate(value):
                    yield tuning.in_use({name: {field: (*value[:k], changed(each, factor), *value[k + 1 :])}})
            else:
                yield tuning.in_use({name: {field: changed(value, factor)}})


@pytest.mark.parametrize(
    "package",
    [
        "dynamics",
        "equilibria",
        "linear_analysis",
        "presolve",
        "redundancy",
        "results",
        "run_checks",
        "sensitivity_equations",
        "solve",
        "sparse",
        "verification",
    ],
)
def test_all_parameters_of_a_package_are_halved_and_doubled(package):
    """By this table, or those of `test_parameter_thresholds` and `test_parameter_counts`."""
    assert [name for name, (factors, _) in factors_of_tests(package).items() if len(factors) < 2] == []


@pytest.mark.parametrize("parameter", TABLE)
def test_a_decision_changes_if_its_parameter_is_halved_or_doubled(parameter):
    decision = TABLE[parameter]
    assert decision() == pytest.approx(EXPECTED[parameter], rel=1e-6, abs=0.0)
    for context in with_others(parameter):
        with context:
            assert decision() != pytest.approx(EXPECTED[parameter], rel=0.01, abs=0.0)
