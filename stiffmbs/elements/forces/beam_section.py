"""Elastic cross section of a beam whose strain is interpolated between nodes, the same in the plane and in space."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from ...reading.marker import MarkerReference
from ...reading.units import si
from ..element import CompiledTerms, Force
from ..turns import WithinHalfATurn
from .beam_strain import BEYOND, DOUBT, DampingRatio

MACHINE = "stiffmbs.compile.machine"
CALLS = {
    "f": ("section", "add_forces", "{state}, {to}"),
    "f_q": ("slopes", "add_force_slopes", "{space}, {damped}, {n}, {bodies}, {rest}, {to}, {f_u}"),
    "potential": ("section", "energy", "{state}, 0, {to}"),
    "power": ("section", "energy", "{state}, 1, {to}"),
    "measured": ("section", "add_stress", "{state}, {to}"),
    "limit": ("section", "add_margins", "{space}, {n}, {rest}, {to}"),
}
"""Module, function and arguments of the compiled loop for each term."""


class BeamSectionLaw(WithinHalfATurn, Force):
    """Base of cross sections at an inner point of a beam with several nodes; scenes use its subclasses `beam_section`."""

    symbol: ClassVar[str] = "beam"
    has_reaction: ClassVar[bool] = False
    beyond: ClassVar[str] = BEYOND
    doubtful: ClassVar[float] = math.sqrt(0.5)
    doubt: ClassVar[str] = DOUBT
    forms: ClassVar[tuple[Mapping[str, object], ...]] = ()
    reflected: ClassVar[dict[str, str] | None] = {"stiffness": "matrix", "unloaded": "components"}

    nodes: tuple[MarkerReference, ...]
    reference: int = Field(description="place of the reference among the nodes, from 0")
    shapes: tuple[float, ...] = Field(description="value of each node's interpolation polynomial at the section")
    slopes: tuple[float, ...] = Field(description="their derivatives along the axis, 1/m")
    length: si.PositiveLength = Field(description="length of the beam represented by the section, m")
    unloaded: Any
    stiffness: Any
    damping_ratio: DampingRatio = Field(None, description="viscous over elastic stiffness, s")

    @model_validator(mode="after")
    def _of_nodes(self) -> Any:
        n = len(self.nodes)
        for name in ("shapes", "slopes"):
            if (found := len(getattr(self, name))) != n:
                raise ValueError(f"{name}: found {found} numbers, expected {n}, one for each node")
        if not 0 <= self.reference < n:
            raise ValueError(f"reference: found {self.reference}, expected the place of a node from 0 to {n - 1}")
        return self

    def _rotations(self) -> Iterator[tuple[Any, Any]]:
        yield from ((node, self.nodes[self.reference]) for node in self.nodes)

    def _with(self, markers: Sequence[Any]) -> Self:
        return self.model_copy(update={"nodes": tuple(markers)})

    @classmethod
    def compiled_terms(cls, kind: Any) -> CompiledTerms:
        """Return the patterns of the terms and the sources of the kernels."""
        slots = [slot for _, slot in dict(kind.fields)["nodes"][1]]
        damped = dict(kind.fields)["damping_ratio"] == ("number",)
        n, space = kind.n_bodies, kind.dimensions == 3
        n_u, n_q, d = (6, 7, 6) if space else (3, 3, 3)
        rows = range(n_u * n)
        patterns = {
            "f": [(row, 0) for row in rows], "f_q": [(row, column) for row in rows for column in range(n_q * n)],
            "f_u": [(row, column) for row in rows for column in rows] * damped, "potential": [(0, 0)],
            "power": [(0, 0)] * damped, "measured": [(row, 0) for row in range(d)],
            "limit": [(row, 0) for row in range(len(slots) - 1)],
        }  # fmt: skip
        patterns = {name: pattern for name, pattern in patterns.items() if pattern}
        form = _Form(tuple(slots), n, int(space), int(damped), patterns)
        return CompiledTerms(patterns, form.source)


@dataclass(frozen=True)
class _Form:
    """Form of sections with common kernels."""

    slots: tuple[int, ...]  # body of each node
    n_bodies: int
    # space, damped: 1 or 0
    space: int
    damped: int
    patterns: Mapping[str, Any]  # of the terms

    def source(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel with some of the terms, by their places."""
        n, space, width = len(self.slots), self.space, 2 * self.n_bodies + 1
        to = {name: f"shifted(value, place[{1 + k}] + {len(self.patterns[name])}*e)" for name, k in places.items()}
        state = "slots, numbers, row, q, turn, u"
        words = {
            "space": space, "damped": self.damped, "n": n, "bodies": self.n_bodies, "rest": state, "f_u": to.get("f_u", "value"),
            "state": f"{space}, {self.damped}, {n}, {state}",
        }  # fmt: skip
        called = [(CALLS[name], to[name]) for name in places if name in CALLS]
        imports = dict.fromkeys(f"beams.{module} import {function}" for (module, function, _), _ in called)
        lines = [
            f"from {MACHINE}.native.access import room, shifted",
            *(f"from {MACHINE}.{each}" for each in imports),
            "", "",
            "def kernel(count, index, number, t, q, turn, u, a, lam, mu, place, value):",
            f"    slots = room({n})  # of the nodes among the bodies, whose turn[0:9] is read",
            *(f"    slots[{k}] = {float(slot)}" for k, slot in enumerate(self.slots)),
            "    for e in range(count):",
            f"        row = shifted(index, {width}*e)",
            f"        numbers = shifted(number, row[{width - 1}])",
            *(f"        {function}({arguments.format(to=place, **words)})" for (_, function, arguments), place in called),
            "",
        ]  # fmt: skip
        return "\n".join(lines)
