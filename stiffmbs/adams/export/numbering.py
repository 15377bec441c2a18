"""Text of statements, and numbering of the parts, markers and splines of a dataset."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from ...elements.spatial.body import Body
from ...elements.spatial.orientation import IDENTITY, matrix
from ...model.spatial_model import SpatialData
from ...reading.files.written_fields import unwritten
from ...reading.marker import GROUND, MarkerReference
from ...reading.table import Table
from ..statements.outputs import FEWEST_POINTS

WIDTH = 76
"""Characters per line; Adams/Solver reads 80."""
_CUT = re.compile(r"(?<=[,*/+)])(?<!\dE\+)(?!\*)")
"""Positions of line breaks, neither within ** nor within an exponent."""


class Refusal(Exception):
    """Element or field without an equivalent in Adams/Solver; the message states both and the alternatives."""


def number(value: float) -> str:
    """Return a number with all its digits and the exponent sign E of Adams."""
    value = float(value)
    text = str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return text.replace("e", "E")


def numbers(values: Iterable[float]) -> str:
    """Return a comma-separated list of numbers."""
    return ", ".join(map(number, values))


def statement(keyword: str, ident: int | None, *arguments: str) -> str:
    """Return a statement: its first line, and a continuation line for each argument."""
    head = f"{keyword}/" if ident is None else f"{keyword}/{ident}"
    return "\n".join([head, *(line for argument in arguments for line in _lines(argument))])


def _lines(argument: str) -> list[str]:
    """Return an argument as continuation lines."""
    found = [", "]
    for piece in _CUT.split(argument):
        if len(found[-1]) + len(piece) > WIDTH and found[-1].strip(" ,"):
            found.append(", ")
        found[-1] += piece
    return found


CURVES = {"akima": "AKISPL", "lines": "INTERP", "not-a-knot": "CUBSPL"}


class Numbering:
    """Numbering of parts, markers and splines. `model`: the scene. `left_out`: bodies that are not exported."""

    def __init__(self, model: SpatialData, left_out: Collection[str] = ()) -> None:
        self._model, self._left_out = model, left_out
        parts = [GROUND, *(name for name in model.bodies if name not in left_out)]
        self.parts = {name: k for k, name in enumerate(parts, 1)}
        self._markers: dict[tuple[str, tuple[float, ...], tuple[float, ...]], int] = {}
        self._floating: dict[str, int] = {}
        self._splines: dict[str, tuple[int, Table]] = {}
        self._numbers = itertools.count(1)

    def marker(self, reference: MarkerReference) -> int:
        """Return the number of a marker, named or inline."""
        place = self._model.place(reference)
        return self.placed(reference.body, place.point, place.orientation)

    def center(self, body: str) -> int:
        """Return the number of a marker at a body's centre of mass, along the body axes."""
        return self.placed(body, self._model.bodies[body].center_of_mass, IDENTITY)

    def placed(self, body: str, point: Sequence[float], orientation: Sequence[float]) -> int:
        """Return the number of a marker with the given position and orientation on a body."""
        key = body, tuple(float(x) for x in point), tuple(float(x) for x in orientation)
        if key not in self._markers:
            self._markers[key] = next(self._numbers)
        return self._markers[key]

    def floating(self, body: str) -> int:
        """Return the number of the floating marker of a body, on which reactions act."""
        if body not in self._floating:
            self._floating[body] = next(self._numbers)
        return self._floating[body]

    def ends(self, element: Any) -> tuple[str, str]:
        """Return the arguments I and J of a joint or a force."""
        return f"I = {self.marker(element.i)}", f"J = {self.marker(element.j)}"

    def spline(self, name: str, table: Table) -> tuple[str, int]:
        """Return the function that evaluates a table, and the number of its spline.

        Raises Refusal if Adams has no such interpolation, or the table has too few points.
        """
        if table.beyond in ("hold", "error"):
            raise Refusal(f"found the table {name} with beyond: {table.beyond}, expected extend: Adams extrapolates")
        if table.smoothing is not None:
            raise Refusal(f"found the table {name} with smoothing, expected its points to be interpolated")
        if others := unwritten(table, "table", "ends", "lines", "akima", "spline", "beyond", "smoothing"):
            raise Refusal(f"found {others} of the table {name}, expected none")
        method = "periodic" if table.repeats else table.ends if table.interpolation == "spline" else table.interpolation
        if method is None or method not in CURVES:
            raise Refusal(f"found the table {name} ({method or 'natural'}), expected akima, lines, or ends: not-a-knot")
        if len(table.table) < FEWEST_POINTS and method != "lines":
            raise Refusal(
                f"found a curve through {len(table.table)} points, expected {FEWEST_POINTS} or more, or straight lines"
            )
        if name not in self._splines:
            self._splines[name] = len(self._splines) + 1, table
        return CURVES[method], self._splines[name][0]

    def statements(self, moving: bool = True) -> Iterator[str]:
        """Yield the statements of parts, markers and splines.

        `moving`: False for a start at rest, without the described velocities.
        """
        moving = moving and any(any(body.velocity) or any(body.omega) for body in self._model.bodies.values())
        yield statement("PART", self.parts[GROUND], "GROUND")
        yield from self._of(GROUND)
        for name, body in self._model.bodies.items():
            if name in self._left_out:
                continue
            centre = self.center(name)
            yield f"! adams_view_name='{name}'"
            yield statement("PART", self.parts[name], *_part(body, centre, moving))
            yield from self._of(name)
        for ident, table in self._splines.values():
            x, y = zip(*_enough(table), strict=True)
            outside = ["LINEAR_EXTRAPOLATE"] if table.lines else []
            yield statement("SPLINE", ident, *outside, f"X = {numbers(x)}", f"Y = {numbers(y)}")

    def _of(self, body: str) -> Iterator[str]:
        part = f"PART = {self.parts[body]}"
        for (owner, point, orientation), ident in self._markers.items():
            if owner == body:
                turned = [] if orientation == IDENTITY else [f"REULER = {numbers(euler(orientation))}"]
                yield statement("MARKER", ident, part, f"QP = {numbers(point)}", *turned)
        if body in self._floating:
            yield statement("MARKER", self._floating[body], part, "FLOATING")


def _part(body: Body, centre: int, moving: bool) -> Iterator[str]:
    """Yield mass, inertia, pose and velocities; products of inertia are the negated off-diagonal entries of the tensor.

    If any body has an initial velocity, all velocities not left open are written: Adams treats missing ones as free.
    """
    yield f"MASS = {number(body.mass)}"
    yield f"CM = {centre}"
    I = np.array(body.inertia)
    yield f"IP = {numbers([*np.diag(I), *(-part for part in (I[0, 1], I[0, 2], I[1, 2]))])}"
    yield f"QG = {numbers(body.position)}"
    if body.orientation != IDENTITY:
        yield f"REULER = {numbers(euler(body.orientation))}"
    for names, given, values in (("VX VY VZ", "velocity", body.velocity), ("WX WY WZ", "omega", body.omega)):
        if moving and given not in body.open:
            yield from (f"{name} = {number(value)}" for name, value in zip(names.split(), values, strict=True))


def _enough(table: Table) -> tuple[tuple[float, float], ...]:
    """Return the points of a piecewise linear table, with points inserted to reach `FEWEST_POINTS`."""
    points = table.table
    if len(points) >= FEWEST_POINTS:
        return points
    x, y = zip(*points, strict=True)
    inner = np.setdiff1d(np.linspace(x[0], x[-1], FEWEST_POINTS + 1)[1:-1], x)
    more = zip(inner.tolist(), np.interp(inner, x, y).tolist(), strict=True)
    return tuple(sorted([*points, *more]))


def euler(orientation: Sequence[float]) -> tuple[float, float, float]:
    """Return the body-fixed z-x-z Euler angles of an orientation, rad."""
    A = matrix(orientation)
    tilt = float(np.arctan2(np.hypot(A[0, 2], A[1, 2]), A[2, 2]))
    if np.hypot(A[0, 2], A[1, 2]) < 1e-15:
        return float(np.arctan2(A[1, 0], A[0, 0])), tilt, 0.0
    return float(np.arctan2(A[0, 2], -A[1, 2])), tilt, float(np.arctan2(A[2, 0], A[2, 1]))
