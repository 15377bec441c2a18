"""Dependences between requests: order of evaluation, dimensions and units."""

from __future__ import annotations

import ast
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter

from ...errors import prefixed
from ...reading.formula import measured
from ...reading.formula.dimension import Known, alike, measured_in, of_branch, of_first, of_step, plain_always
from ...reading.formula.field import FormulaOf
from ...reading.formula.functions import FUNCTIONS, Rule
from ...reading.formula.text import FormulaError
from ...reading.units.units import NUMBER, named_unit
from .names import OF_RUN
from .output import Output, Term, channel, placeholder

ALIKE: dict[Rule, slice] = {of_first: slice(1), alike: slice(None), of_step: slice(2, 5, 2), of_branch: slice(1, 4)}
"""Arguments whose unit the value of a function has, by the rule for its dimension."""
ANGLES = ("asin", "acos", "atan", "atan2")
"""Functions with values in rad."""
_ANYTHING = FormulaOf(coordinates=True, velocities=True)
_ENERGIES = {f"energy.{name}": measured_in("torque") for name in OF_RUN["energy"]}


def in_order(outputs: Mapping[str, Output]) -> tuple[str, ...]:
    """Return the channels of requests in order of dependence.

    `outputs`: by channel. Raises ValueError for a request that depends on itself.
    """
    named = {name: [of for of in channels_in(output) if of in outputs] for name, output in outputs.items()}
    try:
        return tuple(TopologicalSorter(named).static_order())
    except CycleError as error:
        circle = error.args[1][::-1]  # each depends on the next
        raise ValueError(
            f"requests.{circle[0]}: found a request that depends on itself ({' -> '.join(circle)}), expected one that does not"
        ) from None


def channels_in(output: Output) -> list[str]:
    """Return the channels that a request reads."""
    return [channel(*parts) for parts in output.channels()]


def with_named(channels: Iterable[str], requests: Mapping[str, Output]) -> dict[str, Output]:
    """Return some requests by channel, with those that they depend on."""
    found: dict[str, Output] = {}
    ahead = list(channels)
    while ahead:
        name = ahead.pop()
        if name not in found and name in requests:
            found[name] = requests[name]
            ahead += channels_in(found[name])
    return found


def dimensions(outputs: Mapping[str, Output]) -> dict[str, Known]:
    """Return the known dimension of each request, by channel.

    Raises ValueError: for circular requests, and for a request that contains a unit and inconsistent dimensions.
    """
    found: dict[str, Known] = {}
    for name in in_order(outputs):
        with prefixed(f"requests.{name}: ", FormulaError, ValueError):
            found[name] = dimension(outputs[name], found)
    return found


def dimension(output: Output, requests: Mapping[str, Known]) -> Known:
    """Return the dimension of a formula, given those of the requests that it names. Raises FormulaError."""
    terms = {placeholder(k): measured.MEASURES[term.function] for k, term in enumerate(output.terms)}
    return _ANYTHING.dimension_of(output.tree, output.quantities, output.tables, {**_ENERGIES, **requests, **terms})


def reading(outputs: Mapping[str, Output], channels: Container[str], measured_so: Callable[[Term], bool]) -> set[str]:
    """Return the requests that depend on some channels or terms."""
    found: set[str] = set()
    for name in in_order(outputs):
        read = channels_in(outputs[name])
        if any(of in found or of in channels for of in read) or any(map(measured_so, outputs[name].terms)):
            found.add(name)
    return found


def units(outputs: Mapping[str, Output]) -> dict[str, str]:
    """Return the SI unit of each request, by channel; empty for plain numbers and unknown units."""
    known, found = dimensions(outputs), dict.fromkeys(_ENERGIES, "J")
    for name in in_order(outputs):
        output = outputs[name]
        terms = {placeholder(k): measured.unit_of_measure(term.function) for k, term in enumerate(output.terms)}
        found[name] = _unit(output.tree, known[name], {**found, **terms})
    return {name: found[name] for name in outputs}


def _unit(tree: ast.expr, known: Known, named: Mapping[str, str]) -> str:
    """Return the unit of a formula: that of its parts if it is preserved, such as rad, else that of its dimension."""
    if known.exponents is None:
        return ""

    def of_name(name: str) -> str:
        return named[name] if name in named else measured.unit_of_coordinate(name)

    kept = next(filter(None, _kept(tree, of_name)), "")
    if kept or known.fits_all or known.exponents == NUMBER:
        return kept
    return named_unit(known.exponents)


def _kept(tree: ast.expr, of_name: Callable[[str], str]) -> Iterator[str]:
    """Yield the units of the parts that determine a formula's unit."""
    match tree:
        case ast.Name(name):
            yield of_name(name)
        case ast.Attribute(ast.Name(owner), name):
            yield of_name(f"{owner}.{name}")
        case ast.UnaryOp(_, operand):
            yield from _kept(operand, of_name)
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            yield from _kept(left, of_name)
            yield from _kept(right, of_name)
        case ast.Call(ast.Name(name), _) if name in ANGLES:
            yield "rad"
        case ast.Call(ast.Name(name), arguments):
            rule = FUNCTIONS[name].dimension if name in FUNCTIONS else plain_always
            for part in arguments[ALIKE[rule]] if rule in ALIKE else ():
                yield from _kept(part, of_name)
