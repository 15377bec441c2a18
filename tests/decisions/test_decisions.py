"""Each parameter of a table changes a decision if it is halved or doubled.

A decision is a number that one function returns: a bound, a length, or the value of an argument at which the result changes. Functions
of compiled code run in Python (`tests.interpreted`), so that nothing is compiled, and rounding changes no decision.
"""

from __future__ import annotations

import sys
from contextlib import ExitStack, contextmanager
from importlib import import_module
from inspect import isfunction, signature
from unittest.mock import patch

import pytest

from stiffmbs import tuning
from tests.parameters import ROOT, changed, factors_of_tests

MODULES = [
    import_module(f"tests.decisions.{name}")
    for name in (
        "adams", "analyses", "cache", "cad", "commands", "comparison", "compiling", "dynamics", "elements", "equilibria", "error_estimate",
        "flexible_bodies", "linear.linear_analysis", "linear.linearised", "machine", "model", "presolve", "reading", "redundancy", "results", "run_checks",
        "show", "studies", "runs.evaluation", "runs.verification", "solving.auto", "solving.error_control", "solving.event_search",
        "solving.events", "solving.explicit_steps", "solving.linear_solvers", "solving.radau", "solving.real_time", "solving.sensitivities", "vehicles.handling",
        "vehicles.suspension",
    )
]  # fmt: skip
PACKAGES = sorted(file.parent.name for file in (ROOT / "stiffmbs").glob("*/__init__.py"))
TABLE = {name: decision for module in MODULES for name, decision in module.DECISIONS.items()}
EXPECTED = {name: value for module in MODULES for name, value in module.EXPECTED.items()}


@contextmanager
def imported_with(place, factor, k=None):
    """Multiply a number of a module within a context, there, in all modules that import it, and in defaults of arguments.

    `k`: place in a tuple.
    """
    defined_in, name = place.split(":")
    defining = import_module(f"stiffmbs.{defined_in}")
    modules = [module for module in [*sys.modules.values()] if module.__name__.startswith("stiffmbs.")]
    if "." in name:
        owner, field = name.split(".")
        with of_class_with(getattr(defining, owner), field, factor, modules):
            yield
        return
    value = getattr(defining, name)
    other = multiplied(value, factor) if k is None else (*value[:k], multiplied(value[k], factor), *value[k + 1 :])
    with ExitStack() as stack:
        for module in modules:
            if vars(module).get(name) is value:
                stack.enter_context(patch.object(module, name, other))
                for function in filter(isfunction, vars(module).values()):
                    for kind, defaults in with_default(function, value, other).items():
                        stack.enter_context(patch.object(function, kind, defaults))
        yield


def with_default(function, value, other):
    """Return the defaults of a function, of those kinds that have a value, with another one in its place."""
    in_order, by_name = function.__defaults__ or (), function.__kwdefaults__ or {}
    changed = {
        "__defaults__": tuple(other if one is value else one for one in in_order),
        "__kwdefaults__": {name: other if one is value else one for name, one in by_name.items()},
    }
    having = {"__defaults__": in_order, "__kwdefaults__": by_name.values()}
    return {kind: found for kind, found in changed.items() if any(one is value for one in having[kind])}


def multiplied(value, factor):
    """Return a number multiplied by a factor, rounded if it is an integer."""
    return type(value)(factor * value)


@contextmanager
def of_class_with(owner, field, factor, modules):
    """Multiply the default of a field of a dataclass within a context, and the field of its instances in modules."""
    instances = {id(one): one for module in modules for one in vars(module).values() if type(one) is owner}
    own = [(one, getattr(one, field)) for one in instances.values()]
    names = [name for name, one in signature(owner).parameters.items() if one.default is not one.empty]
    defaults = [
        multiplied(value, factor) if name == field else value
        for name, value in zip(names, owner.__init__.__defaults__, strict=True)
    ]
    try:
        for one, number in own:
            object.__setattr__(one, field, multiplied(number, factor))
        with patch.object(owner.__init__, "__defaults__", tuple(defaults)):
            yield
    finally:
        for one, number in own:
            object.__setattr__(one, field, number)


def with_others(parameter):
    """Yield contexts in which a parameter is halved or doubled; of a tuple, each number."""
    if ":" in parameter:
        defined_in, name = parameter.split(":")
        value = getattr(import_module(f"stiffmbs.{defined_in}"), name.split(".")[0])
        places = range(len(value)) if isinstance(value, tuple) else (None,)
        yield from (imported_with(parameter, factor, k) for factor in (0.5, 2.0) for k in places)
    else:
        name, field = parameter.split(".")
        value = getattr(tuning.defaults_of(name), field)
        for factor in (0.5, 2.0):
            if isinstance(value, tuple):
                for k, each in enumerate(value):
                    yield tuning.in_use({name: {field: (*value[:k], changed(each, factor), *value[k + 1 :])}})
            else:
                yield tuning.in_use({name: {field: changed(value, factor)}})


@pytest.mark.parametrize("package", PACKAGES)
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
