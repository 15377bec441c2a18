"""Parameters in use of solvers and checks: the defaults, or those that the settings of a run change.

Each subsystem has one frozen dataclass of its parameters. Its instance of defaults is registered by `tuned`, which
returns an object with the same attributes. Their values are the defaults, except within `in_use`. Compiled code
contains the values as constants; `values_in` is part of its cache key.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields, replace
from functools import cache
from operator import attrgetter
from types import FunctionType, MappingProxyType
from typing import Any, TypeVar, cast

SUBSYSTEMS = {
    "auto": "solve.auto:AUTO",
    "chattering": "solve.events.chattering:CHATTERING",
    "consistency": "dynamics.native.parameters:CONSISTENCY",
    "cost": "solve.cost:COSTS",
    "divergence": "solve.events.refusals:DIVERGENCE",
    "elimination": "dynamics.native.parameters:ELIMINATION",
    "equilibria": "equilibria.parameters:EQUILIBRIA",
    "error_estimate": "error_estimate.parameters:ESTIMATE",
    "error_filter": "solve.error_control.native.parameters:FILTER",
    "error_test": "solve.error_control.error_test:PLANAR",
    "error_test_in_space": "solve.error_control.error_test:SPATIAL",
    "error_test_of_radau": "solve.radau.radau:CONTROL",
    "event_search": "solve.events.native.parameters:SEARCH",
    "explicit_checks": "solve.explicit.adaptive:CHECKS",
    "explicit_ends": "solve.explicit.native.parameters:ENDS",
    "explicit_events": "solve.explicit.native.parameters:LOCATION",
    "explicit_first_step": "solve.explicit.native.parameters:FIRST_STEP",
    "explicit_rounding": "solve.explicit.rounding:ROUNDING",
    "explicit_steps": "solve.explicit.native.parameters:CONTROL",
    "fastest_rate": "solve.explicit.native.parameters:FASTEST_RATE",
    "fixed_steps": "solve.explicit.fixed:FIXED_STEP",
    "jumps": "solve.events.discontinuity:JUMP",
    "kinematic": "solve.driven_states:KINEMATIC",
    "linear_analysis": "linear_analysis.parameters:LINEAR_ANALYSIS",
    "linear_solver": "solve.linear_solvers.linear_solver:COSTS",
    "linearly_implicit_steps": "solve.explicit.native.parameters:LINEARLY_IMPLICIT_STEPS",
    "loop": "solve.ida.native.parameters:LOOP",
    "matrices": "sparse.parameters:MATRICES",
    "narrow_inputs": "solve.events.narrow_inputs:NARROW_INPUTS",
    "newton": "solve.error_control.native.parameters:NEWTON",
    "next_step": "solve.events.native.parameters:NEXT_STEP",
    "pivots": "solve.linear_solvers.native.parameters:PIVOTS",
    "polishing": "solve.error_control.native.parameters:POLISHING",
    "precision": "solve.error_control.precision:PRECISION",
    "presolve": "presolve.relations:PRESOLVE",
    "radau": "solve.radau.parameters:RADAU",
    "real_time": "real_time.parameters:REAL_TIME",
    "redundancy": "redundancy.parameters:REDUNDANCY",
    "relaxation": "solve.error_control.relaxation:RELAXATION",
    "restarts": "solve.events.restart:RESTARTS",
    "run_checks": "run_checks.parameters:RUN_CHECKS",
    "sensitivities": "sensitivity_equations.recorded:SENSITIVITIES",
    "stability_bound": "solve.explicit.stable_step:STABILITY_BOUND",
    "stability_limit": "solve.error_control.stability_limit:STABILITY_LIMIT",
    "stepping": "studies.stepping:STEPPING",
    "storage": "dynamics.storage:STORAGE",
    "variational_stages": "sensitivity_equations.native.parameters:ITERATION",
    "velocity_jumps": "solve.events.discontinuity:VELOCITY_JUMP",
    "verification": "verification.parameters:VERIFICATION",
}
"""Names of the subsystems in ``run.tuning``, and the places of their defaults."""
Values = Mapping[str, Mapping[str, Any]]
"""Changed values by the names of subsystem and parameter."""
Parameters = TypeVar("Parameters")
_CHANGED: ContextVar[Mapping[str, Any]] = ContextVar("changed", default=MappingProxyType({}))
"""Changed parameters by the name of their subsystem."""


class Tuned:
    """Parameters of a subsystem, with the attributes of its dataclass; its fields are properties, which are read fast."""

    __slots__ = ("_defaults", "_name")

    def __init__(self, name: str, defaults: Any) -> None:
        self._name, self._defaults = name, defaults

    def __getattr__(self, name: str) -> Any:
        return getattr(parameters_of(self), name)

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return _registered, (self._name,)


def tuned(name: str, defaults: Parameters) -> Parameters:
    """Register the default parameters of a subsystem; the result has their attributes, with the values in use."""
    readers = {field: property(_reader(attrgetter(field))) for field in defaults.__dataclass_fields__}  # type: ignore[attr-defined]
    kind = type("Tuned", (Tuned,), {"__slots__": (), **readers})
    return cast("Parameters", kind(name, defaults))


def _reader(value: Callable[[Any], Any]) -> Callable[[Tuned], Any]:
    def read(found: Tuned) -> Any:
        changed = _CHANGED.get()
        return value(changed.get(found._name, found._defaults) if changed else found._defaults)

    return read


def parameters_of(found: object) -> Any:
    """Return the instance in use of registered parameters, and any other object as it is."""
    if not isinstance(found, Tuned):
        return found
    return _CHANGED.get().get(found._name, found._defaults)


def parameters_are_changed() -> bool:
    """Return True if parameters in use differ from the defaults."""
    return bool(_CHANGED.get())


@cache
def _read_by(module: str) -> frozenset[str]:
    """Return the names of the subsystems whose parameters the functions of a module read, also by calls."""
    found, seen, modules = set(), set(), [module]
    while modules:
        name = modules.pop()
        seen.add(name)
        for value in vars(importlib.import_module(name)).values():
            if isinstance(value, Tuned):
                found.add(value._name)
            elif isinstance(value, FunctionType) and value.__module__ not in seen:
                modules.append(value.__module__)
    return frozenset(found)


def values_in(module: str) -> str:
    """Return the changed parameters in the compiled functions of a module, as text for cache keys; empty if none."""
    changed = _CHANGED.get()
    return (
        "; ".join(f"{name}: {changed[name]!r}" for name in sorted(changed.keys() & _read_by(module))) if changed else ""
    )


@contextmanager
def in_use(changes: Values) -> Iterator[None]:
    """Change parameters within a context, for the current thread; those that are not named have their defaults."""
    token = _CHANGED.set({name: replace(defaults_of(name), **changes[name]) for name in changes})
    try:
        yield
    finally:
        _CHANGED.reset(token)


def defaults_of(name: str) -> Any:
    """Return the default parameters of a subsystem."""
    return _registered(name)._defaults


def _registered(name: str) -> Tuned:
    module, _, variable = SUBSYSTEMS[name].partition(":")
    found: Tuned = getattr(importlib.import_module(f"{__package__}.{module}"), variable)
    return found


def numbers_of(parameters: Any) -> dict[str, Any]:
    """Return the numeric parameters among the fields of a dataclass, and tuples of numbers."""
    found = {field.name: getattr(parameters, field.name) for field in fields(parameters)}
    return {
        name: value for name, value in found.items() if isinstance(value, int | float | tuple) and value is not True
    }


def changed_values() -> dict[str, dict[str, Any]]:
    """Return the values in use of the subsystems that have changed ones, by subsystem and name."""
    return {name: numbers_of(used) for name, used in _CHANGED.get().items()}


def changes_in_use() -> Iterator[str]:
    """Yield each changed parameter with its value and its default."""
    for name, used in _CHANGED.get().items():
        usual = numbers_of(defaults_of(name))
        for field, value in numbers_of(used).items():
            if value != usual[field]:
                yield f"{name}.{field} = {value} (default {usual[field]})"


def described() -> Iterator[str]:
    """Yield a line for each subsystem, with its parameters in use; changed ones are followed by their defaults."""
    for name in SUBSYSTEMS:
        usual = numbers_of(defaults_of(name))
        used = numbers_of(_CHANGED.get().get(name, defaults_of(name)))
        values = (f"{key} = {used[key]}" + f" (default {usual[key]})" * (used[key] != usual[key]) for key in usual)
        yield f"parameters {name}: {', '.join(values)}"
