"""The arguments of one statement by their full names, and the functions in them that cannot be used there."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields

from .functions.adams_functions import ADAMS_FUNCTIONS
from .functions.angles import ANGLES_OF_AXES
from .functions.expression import ExpressionError, parse
from .functions.inputs import PLANTS
from .functions.reactions import REACTIONS
from .functions.splines import CURVES
from .functions.translate import (
    ANGLES,
    ANGULAR_VELOCITIES,
    COUPLED,
    PLAIN,
    POSITIONS,
    VELOCITIES,
)  # fmt: skip
from .functions.translate_output import ACCELERATIONS, ANGULAR_ACCELERATIONS, ROUNDING_FUNCTIONS
from .statements.dataset import read_statement
from .statements.fault import DatasetFault
from .statements.text import Statement
from .statements.units import Units

ANYWHERE = {
    *POSITIONS, *ANGLES, *VELOCITIES, *ANGULAR_VELOCITIES, *PLAIN, *ADAMS_FUNCTIONS, *CURVES, *ANGLES_OF_AXES, *REACTIONS,
    "INTERP", "ARYVAL", *PLANTS, "VARVAL", "DIF", "DIF1", "INCANG", "SENVAL",
}  # fmt: skip
IN_REQUESTS = {*ANYWHERE, *COUPLED, *ACCELERATIONS, *ANGULAR_ACCELERATIONS, *ROUNDING_FUNCTIONS, "ORIENT"}
REPORTED = ("REQUEST", "VARIABLE", "SENSOR")
"""Statements whose functions may be such as requests alone can use; a VARIABLE that forces use is told when the scene is made."""
Found = Mapping[str, tuple[int, tuple[str, ...]]]


@dataclass(frozen=True)
class _Heard(Statement):
    """A statement that keeps what its arguments are read as."""

    heard: dict[str, tuple[int, tuple[str, ...]]] = field(default_factory=dict)

    def read_as(self, arguments: Found) -> None:
        self.heard.update(arguments)


def arguments_of(statement: Statement, name: str) -> Found:
    """The arguments of a statement by their full names, each with its line and values; those up to a fault."""
    heard = _Heard(**{each.name: getattr(statement, each.name) for each in fields(statement)})
    with suppress(DatasetFault):
        read_statement(name, heard, Units())
    return heard.heard


def unread_functions(name: str, values: Sequence[str]) -> Iterator[str]:
    """The functions in an argument of a statement that cannot be used there."""
    known = IN_REQUESTS if name in REPORTED else ANYWHERE
    for value in values:
        if not re.search(r"[A-Za-z_]\w*\s*\(", value):
            continue
        try:
            tree = parse(value.strip().strip('"'))
        except ExpressionError:
            continue
        called = [
            node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
        ]
        yield from (function for function in dict.fromkeys(called) if function not in known)
