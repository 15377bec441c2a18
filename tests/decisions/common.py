"""Records and replacements for functions of solvers that make decisions."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np

from stiffmbs import tuning
from stiffmbs.errors import StiffmbsError
from stiffmbs.solve.events.native import bounds


class Record(SimpleNamespace):
    """Fields of a table or of an object."""


BELOW = 0.9 * 2.0 ** (-0.25 * np.arange(400))
"""Decreasing numbers that are no powers of 2."""


class Reached(Exception):
    """The decision has been made; the rest of the function is not needed."""


def refused(call):
    """Return True if a call raises an error of the package, or one that a validator reports."""
    try:
        call()
    except (StiffmbsError, ValueError):
        return True
    return False


def reached(call):
    """Return the value with which a call raises `Reached`."""
    try:
        call()
    except Reached as found:
        return found.args[0]
    raise AssertionError("the decision was not made")


def reach(value):
    """Raise `Reached` with a value."""
    raise Reached(value)


def module(name):
    """Return a module of the package, where a package exports a function of the same name."""
    return import_module(f"stiffmbs.{name}")


def executed(name):
    """Return the names of a module that is executed again with the current values of its numbers, which some statements read."""
    original = module(name)
    tree = ast.parse(Path(original.__file__).read_text(encoding="utf-8"))
    for statement in tree.body:
        target = statement.targets[0] if isinstance(statement, ast.Assign) else getattr(statement, "target", None)
        names = [one.id for one in ast.walk(target or ast.Tuple([])) if isinstance(one, ast.Name)]
        numbers = [getattr(original, name, None) for name in names]
        derived = any(isinstance(one, ast.Name) for one in ast.walk(getattr(statement, "value", None) or ast.Tuple([])))
        if numbers and not derived and all(isinstance(number, int | float) for number in numbers):
            constants = [ast.Constant(number) for number in numbers]
            value = constants[0] if isinstance(target, ast.Name) else ast.Tuple(constants, ast.Load())
            statement.value = ast.fix_missing_locations(ast.copy_location(value, statement.value))
    again = ModuleType(original.__name__)
    again.__package__, again.__file__ = original.__package__, original.__file__
    exec(compile(tree, original.__file__, "exec"), vars(again))
    return again


def nothing(*_):
    """Return 0, the status of success."""
    return 0


def always(*_):
    return True


def never(*_):
    return False


def parameters(name):
    return tuning.parameters_of(tuning._registered(name))


def searched(**fields):
    """Return the record of a search for one event function, from 1 to -1 along a line."""
    line = {
        "value_before": 1.0,
        "value_after": -1.0,
        "rate_before": -2.0,
        "rate_after": -2.0,
        "a": 1.0,
        "b": -1.0,
        "a_rate": -2.0,
        "b_rate": -2.0,
    }
    cells = {
        "m": 1.0 - 2.0 * bounds.LOOKED_AT,
        "m2": 1.0 - 2.0 * bounds.ALSO_AT,
        "noise": 0.0,
        "left_low": 0.0,
        "left_high": -1.0,
    }
    arrays = {
        name: np.array([value])
        for name, value in {**line, **cells, "period": 0.0, "apart": 0.0, "radians": 1.0}.items()
    }
    integers = {"first_breakpoint": [0, 2], "near": [1], "call": [0], "found": [0], "turn": [0], "angle": [0]}
    usual = {
        **arrays, "breakpoints": np.array([0.0, np.inf]), "overlap": np.zeros(2), "band": np.zeros(1), "farthest": np.zeros(1), "n_lam": 0, **{name: np.array(value) for name, value in integers.items()},
        "interval_low": np.array([0.0]), "interval_high": np.array([np.inf]), "n": 1, "n_event_functions": 1, "n_with_intervals": 1, "n_angles": 0, "n_turns": 0, "n_jumping": 0, "jumping": np.empty(0, dtype=np.int64),
        "n_calls": 1, "n_nodes": 1, "n_state": 1, "row": np.ones(2), "depth": 0.0, "least": 0.0, "duration": 1.0, "narrow": 0, "begins": 0.0,
        "longest": 1.0, "unresolved": 0, "under_way": 0, "begun": 0.0, "target": np.inf, "passed": 0.0, "passage": 0.0, "first": 0.0,
        "usual": 1.0, "count": 0, "room": 10, "at_kinks": 0, "by_accelerations": 0,
    }  # fmt: skip
    return Record(**{**usual, **fields})
