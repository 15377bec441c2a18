"""Elastic cross section of a beam whose strain is interpolated between nodes, the same in the plane and in space."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from ...reading.marker import MarkerReference
from ...reading.units import si
from ..element import CompiledTerms, Force
from ..turns import WithinHalfATurn
from .beam_strain import BEYOND, DOUBT, DampingRatio

NATIVE = "stiffmbs.compile.machine.native"
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
        return CompiledTerms(patterns, form.source, form.along)


@dataclass(frozen=True)
class _Form:
    """Form of sections with common kernels."""

    slots: tuple[int, ...]  # body of each node
    n_bodies: int
    # space, damped: 1 or 0
    space: int
    damped: int
    patterns: Mapping[str, Any]  # of the terms

    def calls(self, places: Mapping[str, int], state: str, to: Mapping[str, str]) -> list[tuple[str, str, str]]:
        """Return the calls for the terms with given places: term, module and call."""
        n, space = len(self.slots), self.space
        words = {
            "space": space, "damped": self.damped, "n": n, "bodies": self.n_bodies, "rest": state, "f_u": to.get("f_u", "value"),
            "state": f"{space}, {self.damped}, {n}, {state}",
        }  # fmt: skip
        found = []
        for name in places:
            if name in CALLS:
                module, function, arguments = CALLS[name]
                found.append(
                    (name, f"beams.{module} import {function}", f"{function}({arguments.format(to=to[name], **words)})")
                )
        return found

    def to(self, places: Mapping[str, int]) -> dict[str, str]:
        """Return the expressions of the pointers to the values of the terms."""
        return {name: f"shifted(value, place[{1 + k}] + {len(self.patterns[name])}*e)" for name, k in places.items()}

    def source(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel."""
        calls = self.calls(places, "slots, numbers, row, q, turn, u", self.to(places))
        return self.kernel([], calls, "", [call for _, _, call in calls])

    def along(self, places: Mapping[str, int]) -> str:
        """Return the source of a kernel of directional derivatives, by central differences of fourth order."""
        smooth = {name: k for name, k in places.items() if name in CALLS and name != "f_q"}
        calls = self.calls(smooth, "slots, moved, places, q_m, turn_m, u_m", dict.fromkeys(smooth, "found"))
        n, d, n_q, n_u = len(self.slots), *((6, 7, 6) if self.space else (3, 3, 3))
        numbers = n * (16 if self.space else 5) + 2 + 2 * n + d + d * d + self.space + self.damped
        bodies = f"{self.space}, {self.n_bodies}, {numbers}"
        rooms = {
            "moved": numbers, "places": 2 * self.n_bodies, "q_m": n_q * self.n_bodies, "turn_m": 2 * n_q * self.n_bodies,
            "u_m": n_u * self.n_bodies, "found": max((len(self.patterns[name]) for name in smooth), default=1),
        }  # fmt: skip
        to = self.to(smooth)
        lines = [
            "numbers_d = shifted(number_d, row[{width}])",
            f"h = step_size({self.space}, {n}, {self.n_bodies}, {numbers}, numbers, row, numbers_d, q_d)",
            *(f"clear({len(self.patterns[name])}, {to[name]})" for name in smooth),
            "for k in range(4):",
            "    side = -2.0 if k == 0 else (-1.0 if k == 1 else (1.0 if k == 2 else 2.0))",
            "    weight = (1.0 if k == 0 else (-8.0 if k == 1 else (8.0 if k == 2 else -1.0))) / (12.0 * h)",
            f"    move({bodies}, side * h, numbers, row, q, u, numbers_d, q_d, u_d, moved, places, q_m, turn_m, u_m)",
        ]
        for name, _, call in calls:
            size = len(self.patterns[name])
            lines += [f"    {call}", f"    add_times({size}, weight, found, {to[name]})"]
        imports = ["beams.along import move, step_size", "vectors import add_times, clear"]
        arguments = ", number_d, t_d, q_d, turn_d, u_d, a_d, lam_d, mu_d"
        return self.kernel(
            [f"    {name} = room({size})" for name, size in rooms.items()], calls, arguments, lines, imports
        )

    def kernel(
        self, first: list[str], calls: Any, arguments: str, body: list[str], imports: Iterable[str] = ()
    ) -> str:  # fmt: skip
        """Return the text of a kernel with statements for each element."""
        width = 2 * self.n_bodies + 1
        modules = dict.fromkeys([*imports, *(module for _, module, _ in calls)])
        lines = [
            f"from {NATIVE}.access import room, shifted",
            *(f"from {NATIVE}.{module}" for module in modules),
            "", "",
            f"def kernel(count, index, number, t, q, turn, u, a, lam, mu, place, value{arguments}):",
            f"    slots = room({len(self.slots)})  # of the nodes among the bodies, whose turn[0:9] is read",
            *(f"    slots[{k}] = {float(slot)}" for k, slot in enumerate(self.slots)),
            *first,
            "    for e in range(count):",
            f"        row = shifted(index, {width}*e)",
            f"        numbers = shifted(number, row[{width - 1}])",
            *(f"        {line.format(width=width - 1)}" for line in body),
            "",
        ]  # fmt: skip
        return "\n".join(lines)
