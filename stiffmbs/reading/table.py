"""Functions defined by points."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import Literal

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, ValidationInfo, field_validator, model_validator

from .fields import Described
from .formula.dimension import UNKNOWN, Known, known_of, same
from .units import si
from .units.quantity import quantity
from .units.units import Quantity, named_unit


class Table(Described):
    """Function through points, by default a monotone piecewise cubic with continuous slope (PCHIP).

    Outside its points a table follows `beyond`, by default the slope of its end; a run that leaves the points notes how
    far and how long. Akima, A new method of interpolation and smooth curve fitting, J. ACM 17 (1970) 589-602.
    """

    table: tuple[tuple[si.Anything, si.Anything], ...] = Field(
        min_length=2, description="pairs of argument and value, arguments increasing"
    )
    ends: Literal["natural", "clamped", "periodic", "not-a-knot"] | None = Field(
        None,
        description="end condition, which selects a cubic spline: natural (zero curvature, the default of a spline), clamped (zero slope), not-a-knot, periodic (equal first and last value; also for lines)",
    )
    beyond: Literal["extend", "hold", "error", "repeat"] | None = Field(
        None,
        description="values outside the points: extend (the slope of the end; the default, as in Adams and Modelica, with a note), hold (the value of the end), error (the run stops there), repeat (periodic, the default of 'ends: periodic'; equal first and last value)",
    )
    lines: bool = Field(False, description="straight lines between the points, which are breakpoints")
    akima: bool = Field(
        False, description="Akima's local cubics, which may overshoot unevenly spaced points (Adams: AKISPL)"
    )
    spline: bool = Field(
        False, description="a cubic spline with continuous curvature, which may overshoot its points (Adams: CUBSPL)"
    )

    smoothing: si.Anything | None = Field(
        None,
        gt=0,
        description="root mean square distance from the points, such as their measuring error, of a smoothing spline: the straightest cubic spline that comes that near",
    )

    _argument: Known = PrivateAttr(UNKNOWN)
    _value: Known = PrivateAttr(UNKNOWN)

    @property
    def interpolation(self) -> Literal["monotone", "lines", "akima", "spline", "smoothing"]:
        """Name the interpolation between the points."""
        if self.smoothing is not None:
            return "smoothing"
        if self.lines or self.akima:
            return "lines" if self.lines else "akima"
        return "spline" if self.spline or self.ends else "monotone"

    @property
    def repeats(self) -> bool:
        """Return True if the table is periodic."""
        return self.beyond == "repeat" or self.ends == "periodic"

    @property
    def dimensions(self) -> tuple[Known, Known]:
        """Dimensions of argument and value, as far as the table has units."""
        return self._argument, self._value

    @model_validator(mode="wrap")
    @classmethod
    def _measured(cls, found: object, handler: ModelWrapValidatorHandler[Table], info: ValidationInfo) -> Table:
        table = handler(found)
        if isinstance(found, dict):
            parameters = (info.context or {}).get("parameters") or {}
            columns = zip(*found["table"], strict=True)
            argument, values = columns
            table._argument = _of_column(argument, parameters)
            table._value = _of_column([*values, found.get("smoothing")], parameters)
        return table

    @field_validator("table")
    @classmethod
    def _increasing(cls, table: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        for (before, _), (after, _) in itertools.pairwise(table):
            if not after > before:
                raise ValueError(f"found {after:g} after {before:g} in a table, expected increasing arguments")
        return table

    @model_validator(mode="after")
    def _closed(self) -> Table:
        first, last = self.table[0][1], self.table[-1][1]
        if self.repeats and abs(first - last) > 1e-9 * max(abs(first), abs(last), 1e-300):
            raise ValueError(
                f"found {first:g} at the start and {last:g} at the end, expected a periodic table to close"
            )
        if self.ends and self.beyond and self.repeats and (self.ends, self.beyond) != ("periodic", "repeat"):
            raise ValueError(
                f"found beyond: {self.beyond} with ends: {self.ends}, expected periodic ends for a table that repeats"
            )
        if self.akima and (self.lines or self.ends or self.spline):
            raise ValueError("found akima with lines or ends, expected it alone")
        if self.lines and (self.spline or self.ends in ("clamped", "not-a-knot")):
            raise ValueError("found lines with a spline or its ends, expected lines alone or with periodic ends")
        if self.smoothing is not None and (
            self.lines or self.akima or self.repeats or self.ends not in (None, "natural")
        ):
            raise ValueError(
                "found smoothing with another interpolation or periodic ends, expected it alone or with natural ends"
            )
        if self.smoothing is not None and len(self.table) < 5:
            raise ValueError(f"found {len(self.table)} points, expected 5 or more for smoothing")
        if self.ends == "not-a-knot" and len(self.table) < 4:
            raise ValueError(f"found {len(self.table)} points, expected 4 or more for not-a-knot ends")
        return self


def _of_column(column: Iterable[object], parameters: Mapping[str, Quantity]) -> Known:
    """Return the dimension of a table's arguments or values, unknown for plain numbers."""
    found = [quantity(entry, parameters) for entry in column if isinstance(entry, str)]
    known = [each for each in map(known_of, found) if each.stated]
    for other in known[1:]:
        if not same(known[0].exponents, other.exponents):  # type: ignore[arg-type]
            units = " and ".join(named_unit(each.exponents) for each in (known[0], other))  # type: ignore[arg-type]
            raise ValueError(f"found {units} in one column of a table, expected one unit")
    return known[0] if known else UNKNOWN
