"""Outputs of a study: channels, their reductions, and formulas of both."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any, Protocol

import numpy as np

from ..errors import ChannelError, InputError
from ..reading.did_you_mean import did_you_mean
from ..reading.names import owner_of
from ..results.channels import as_request

Series = np.ndarray
TIME = "time"


class Reported(Protocol):
    """Solution or equivalent object: output instants, and channels by name."""

    @property
    def time(self) -> np.ndarray:
        """Output instants, s."""

    def __getitem__(self, channel: str, /) -> np.ndarray: ...


def _integral(t: Series, x: Series) -> float:
    return float(np.trapezoid(x, t))


def _mean(t: Series, x: Series) -> float:
    return float(np.divide(_integral(t, x), t[-1] - t[0]))


REDUCTIONS: dict[str, Callable[[Series, Series], float]] = {
    "peak": lambda t, x: float(np.max(np.abs(x))), "t_peak": lambda t, x: float(t[int(np.argmax(np.abs(x)))]),
    "rms": lambda t, x: float(np.sqrt(_mean(t, x * x))), "mean": _mean, "integral": _integral,
    "final": lambda t, x: float(x[-1]), "first": lambda t, x: float(x[0]),
    "min": lambda t, x: float(np.min(x)), "max": lambda t, x: float(np.max(x)),
    "t_min": lambda t, x: float(t[int(np.argmin(x))]), "t_max": lambda t, x: float(t[int(np.argmax(x))]),
}  # fmt: skip
"""Reductions of a channel over time: ``peak`` is the largest magnitude; integrals use the trapezoidal rule."""
TIMES = ("t_peak", "t_min", "t_max")
"""Reductions that are times."""
FUNCTIONS: dict[str, Callable[..., object]] = {
    "abs": np.abs, "sqrt": np.sqrt, "exp": np.exp, "log": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan,
    "atan2": np.arctan2, "hypot": np.hypot,
}  # fmt: skip
OPERATORS: dict[type[ast.AST], Callable[..., object]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide, ast.Pow: np.power,
    ast.USub: np.negative, ast.UAdd: np.positive,
}  # fmt: skip


@dataclass(frozen=True)
class Output:
    """Output variable of a study."""

    name: str
    # a formula of channels, ``time`` and `REDUCTIONS`: ``peak(rail.fy)``, ``rms(chassis.ay - front.ay)``, ``rail.fy``
    text: str

    def value(self, solution: Reported) -> float | np.ndarray:
        """Return the number, or the series over the output instants, of a run.

        Raises InputError if the formula names an unknown channel.
        """
        with np.errstate(all="ignore"):
            found = evaluated(
                parsed(self.text).body, partial(_channel, solution), lambda name, x: REDUCTIONS[name](solution.time, x)
            )
        return np.asarray(found, dtype=float) if np.ndim(found) else float(found)

    def refuse_unknown(self, known: Collection[str]) -> None:
        """Reject a channel that is not among the known ones."""
        for name in self.channels:
            if name != TIME and name not in known:
                near = [channel for channel in known if owner_of(channel) == owner_of(name)] or list(known)[:12]
                raise InputError(
                    f"output '{self.text}': found no channel '{name}'{did_you_mean(name, known)}, expected one such as "
                    f"{', '.join(near)}"
                )

    @property
    def channels(self) -> tuple[str, ...]:
        """Return the channels that the formula names."""
        return tuple(_channels(parsed(self.text).body))

    def unit(self, of: Mapping[str, str]) -> str:
        """Return the unit of a channel or of its reduction, given those of channels; empty for other formulas."""
        node, unit = parsed(self.text).body, of
        match node:
            case ast.Call(ast.Name(name), [inner], []) if name in REDUCTIONS:
                if name in TIMES:
                    return "s"
                node, unit = inner, {} if name == "integral" else of
        return unit.get(channel_of(node) or "", "")

    @property
    def is_series(self) -> bool:
        """Return True if the output is a series over time."""
        return _is_series(parsed(self.text).body)


def outputs_of(found: Mapping[str, str] | list[str] | tuple[str, ...] | str) -> tuple[Output, ...]:
    """Return the outputs of a study from formulas, or from formulas by name.

    Raises InputError if a formula is invalid.
    """
    if isinstance(found, str):
        found = [found]
    pairs = dict(found) if isinstance(found, Mapping) else {text.strip(): text for text in found}
    for text in pairs.values():
        _check(text, parsed(text).body)
    return tuple(Output(name, text) for name, text in pairs.items())


@lru_cache
def parsed(text: str) -> ast.Expression:
    """Return the syntax tree of a formula."""
    try:
        return ast.parse(text.strip().replace("^", "**"), mode="eval")
    except (SyntaxError, ValueError):
        raise InputError(f"output '{text}': found no formula, expected a formula such as peak(rail.fy)") from None


def channel_of(node: ast.AST) -> str | None:
    """Return the dotted name of a part of a formula, or None if it is not a name."""
    match node:
        case ast.Name(name):
            return name
        case ast.Attribute(owner, name):
            before = channel_of(owner)
            return f"{before}.{name}" if before else None
    return None


def _channel(solution: Reported, name: str) -> np.ndarray:
    """Return a channel of a solution, or the time."""
    if name == TIME:
        return solution.time
    try:
        return solution[name]
    except ChannelError as error:
        raise InputError(str(error)) from None


def _channels(node: ast.AST) -> Iterator[str]:
    """Yield the channels that a formula names."""
    name = channel_of(node)
    if name:
        yield name
        return
    for part in parts_of(node):
        yield from _channels(part)


def parts_of(node: ast.AST) -> list[ast.expr]:
    """Return the arguments of a function, or the operands."""
    parts = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
    return [part for part in parts if isinstance(part, ast.expr)]


def _check(text: str, node: ast.AST) -> None:
    match node:
        case ast.Constant(int() | float()):
            return
        case ast.Call(ast.Name(name), [*arguments], []) if name in REDUCTIONS or name in FUNCTIONS:
            if name in REDUCTIONS and (len(arguments) != 1 or not _is_series(arguments[0])):
                raise InputError(
                    f"output '{text}': found {name} of {len(arguments)} values, expected one channel over time"
                )
        case ast.BinOp(op=operator) | ast.UnaryOp(op=operator) if type(operator) in OPERATORS:
            pass
        case _ if channel_of(node):
            return
        case _:
            known = (*REDUCTIONS, *FUNCTIONS)
            called = channel_of(node.func) if isinstance(node, ast.Call) else None
            near = did_you_mean(called, known) if called else ""
            request = as_request(ast.unparse(node)) if called and not near else ""
            raise InputError(
                f"output '{text}': found '{ast.unparse(node)}'{near}, expected channels, numbers, + - * / ^ and {', '.join(known)}{request}"
            )
    for part in parts_of(node):
        _check(text, part)


def _is_series(node: ast.AST) -> bool:
    if channel_of(node):
        return True
    is_reduced = isinstance(node, ast.Call) and channel_of(node.func) in REDUCTIONS
    return not is_reduced and any(map(_is_series, parts_of(node)))


def evaluated(node: ast.AST, channel: Callable[[str], object], reduced: Callable[[str, Any], object]) -> Any:
    """Return the value of a formula in any algebra that ufuncs of NumPy accept.

    `channel`: returns a channel or the time by name. `reduced`: returns a reduction of a value, given its name.
    """

    def of(part: ast.AST) -> Any:
        return evaluated(part, channel, reduced)

    match node:
        case ast.Constant(value):
            return value
        case ast.Call(ast.Name(name), [argument], []) if name in REDUCTIONS:
            return reduced(name, of(argument))
        case ast.Call(ast.Name(name), [*arguments], []):
            return FUNCTIONS[name](*map(of, arguments))
        case ast.BinOp(left, operator, right):
            return OPERATORS[type(operator)](of(left), of(right))
        case ast.UnaryOp(operator, operand):
            return OPERATORS[type(operator)](of(operand))
    return channel(channel_of(node) or "")
