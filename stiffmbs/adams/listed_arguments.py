"""Arguments of a statement by full name, and unsupported functions in them."""

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
"""Statements that may use request functions; a VARIABLE used by forces is checked when the scene is built."""
Found = Mapping[str, tuple[int, tuple[str, ...]]]


@dataclass(frozen=True)
class _Heard(Statement):
    """Statement that records its arguments as they are read."""

    heard: dict[str, tuple[int, tuple[str, ...]]] = field(default_factory=dict)

    def read_as(self, arguments: Found) -> None:
        self.heard.update(arguments)


def arguments_of(statement: Statement, name: str) -> Found:
    """Return the arguments of a statement by full name, with line and values, up to the first fault."""
    heard = _Heard(**{each.name: getattr(statement, each.name) for each in fields(statement)})
    with suppress(DatasetFault):
        read_statement(name, heard, Units())
    return heard.heard


def unread_functions(name: str, values: Sequence[str]) -> Iterator[str]:
    """Yield the unsupported functions in an argument of a statement."""
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
